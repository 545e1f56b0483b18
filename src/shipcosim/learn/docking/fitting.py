"""Ensembles of recurrent networks, trained over whole dockings; each keeps the weights of its best epoch."""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch

from shipcosim.learn.networks import Arrays, Recurrent, arrays_of
from shipcosim.learn.training import BestWeights, Descent, Epochs, Progress

Loss = Callable[[torch.Tensor, torch.Tensor], torch.Tensor]
"""From outputs and targets, (m, n, ...), to a mean."""


def fit(
    training: tuple[torch.Tensor, torch.Tensor],
    choice: tuple[torch.Tensor, torch.Tensor],
    loss: Loss,
    outputs: int,
    recipe: Any,
    progress: Progress,
) -> tuple[Arrays, Epochs]:
    """Train an ensemble; call `repeatable` around it.

    Parameters
    ----------
    training, choice : tuples of two tensors
        Inputs (m, n, inputs) and targets of dockings, to train on and to choose the epoch by.
    loss : callable
        What is minimised.
    outputs : int
        Of a network.
    recipe : DockingTraining or PaperIIITraining
        With members, width, layers, dropout, epochs, batch, learning_rate, decay and noise.
    progress : callable
        Called with how many steps are done, and of how many.

    Returns
    -------
    dict of str to array, and list of dict
        Weights of the networks, ``member1`` the first; losses by member and epoch.
    """
    # Members differ by their initial weights and the order of mini-batches.
    weights = {}
    history = []
    for member in range(recipe.members):

        def tell(done, total, member=member):
            progress(member * total + done, recipe.members * total)

        network = Recurrent(
            training[0].shape[-1], recipe.width, recipe.layers, outputs, recipe.dropout
        )
        losses = _fit_one(network, training, choice, loss, recipe, tell)
        history += [
            {"member": member + 1.0, "epoch": k + 1.0, **of_epoch}
            for k, of_epoch in enumerate(losses)
        ]
        weights |= arrays_of(network, f"member{member + 1}")
    return weights, history


def _fit_one(network, training, choice, loss, recipe, progress):
    """Fit one member; return losses by epoch. The network keeps the weights of the best epoch."""
    x, y = training
    batches = len(x) // recipe.batch
    steps = recipe.epochs * batches
    # AdamW with a learning rate that falls as a cosine over all steps; a network over 1000 s can have large gradients.
    adam = torch.optim.AdamW(network.parameters(), recipe.learning_rate, weight_decay=recipe.decay)
    descent = Descent(adam, steps, clipped=True)
    best = BestWeights(network.parameters())
    history = []
    for epoch in range(recipe.epochs):
        total = 0.0
        # Whole dockings in random order; noise on the inputs is a regularisation.
        for number, rows in enumerate(torch.randperm(len(x)).split(recipe.batch)[:batches]):
            network.train()
            given = network(x[rows] + recipe.noise * torch.randn(x[rows].shape))
            total += descent.step(loss(given, y[rows]))
            progress(epoch * batches + number + 1, steps)
        # Judge the epoch on other dockings.
        left = left_over(network, choice, loss)
        history.append({"training": total / batches, "choices": left})
        best.judge(left)
    # Early stopping: return to the best epoch.
    best.restore()
    network.eval()
    return history


def left_over(network: Recurrent, choice: tuple[torch.Tensor, torch.Tensor], loss: Loss) -> float:
    """Loss on dockings that a network was not trained on."""
    network.eval()
    with torch.no_grad():
        return float(loss(network(choice[0]), choice[1]))


def tensor(array: np.ndarray) -> torch.Tensor:
    """In single precision."""
    return torch.tensor(array, dtype=torch.float32)
