"""The training loop: mini-batches, Adam, early stopping, the same weights from the same seed."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

Epochs = list[dict[str, float]]
"""Losses of each epoch, by name."""


Progress = Callable[[int, int], None]
"""Called with how many steps are done, and of how many at most."""


def part_of(progress: Progress, before: float, share: float) -> Progress:
    """Progress of one part, told as progress of the whole in thousandths.

    Parameters
    ----------
    progress : callable
        Of the whole.
    before, share : float
        Of the whole: what is done when the part begins, and the part. [1]

    Returns
    -------
    callable
        Of the part.
    """
    return lambda done, total: progress(round(1000 * (before + share * done / total)), 1000)


@dataclass(frozen=True)
class Schedule:
    """How a network is trained.

    Parameters
    ----------
    seed : int
        Seed of the weights at the start and of the order of mini-batches.
    learning_rate : float
        Of Adam. [1]
    patience : int
        Training ends when the loss on held-out data has not improved for so many epochs. [1]
    most_epochs : int
        It ends after so many in any case. [1]
    """

    seed: int = 1
    learning_rate: float = 1e-3
    patience: int = 3
    most_epochs: int = 15


@contextmanager
def repeatable(seed: int) -> Iterator[None]:
    """One thread and a fixed seed: a second training gives the same weights, bit by bit, on the same processor.

    Parameters
    ----------
    seed : int
        Of torch's generator, which initialises weights.
    """
    # One thread and no denormals: sums then have one order, and vanishing gradients stay quick.
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    torch.set_flush_denormal(
        True
    )  # gradients that vanish along a sequence are slow to compute with
    try:
        # The caller's random state is kept; only this block uses the seed.
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            yield
    finally:
        torch.set_flush_denormal(False)
        torch.set_num_threads(threads)


class Descent:
    """Steps of an optimiser down a loss.

    Parameters
    ----------
    optimiser : Optimizer
        Adam or AdamW with the weights.
    steps : int
        Over which the learning rate falls as a cosine; 0: it stays. [1]
    least : float
        Learning rate at their end. [1]
    clipped : bool
        Whether the gradient is clipped: one that passes many samples can be very large.
    """

    def __init__(
        self,
        optimiser: torch.optim.Optimizer,
        steps: int = 0,
        least: float = 0.0,
        clipped: bool = False,
    ):
        self.optimiser = optimiser
        cosine = torch.optim.lr_scheduler.CosineAnnealingLR
        self.schedule = cosine(optimiser, steps, eta_min=least) if steps else None
        self.clipped = clipped

    def step(self, loss: Any) -> float:
        """Take one step.

        Parameters
        ----------
        loss : () tensor
            Loss with the present weights. [1]

        Returns
        -------
        float
            The same. [1]
        """
        self.optimiser.zero_grad()
        loss.backward()
        if self.clipped:
            torch.nn.utils.clip_grad_norm_(self.optimiser.param_groups[0]["params"], 1.0)
        self.optimiser.step()
        if self.schedule:
            self.schedule.step()
        return float(loss.detach())


class BestWeights:
    """Weights with the least held-out loss so far.

    Parameters
    ----------
    weights : iterable of tensor
        The weights that are trained.
    """

    def __init__(self, weights: Iterable[torch.Tensor]):
        self.weights = list(weights)
        self.kept = [weight.detach().clone() for weight in self.weights]
        self.loss = np.inf
        self.since = 0

    def judge(self, loss: float) -> None:
        """Keep the present weights if they are the best, and count how often none were since.

        Parameters
        ----------
        loss : float
            Held-out loss with the present weights. [1]
        """
        self.since += 1
        if loss < self.loss:
            self.loss = loss
            self.since = 0
            self.kept = [weight.detach().clone() for weight in self.weights]

    def restore(self) -> None:
        """Go back to the best weights."""
        with torch.no_grad():
            for weight, kept in zip(self.weights, self.kept, strict=True):
                weight.copy_(kept)


def fit(
    network: torch.nn.Module,
    losses: Callable[[Any], dict[str, torch.Tensor]],
    batches: Sequence[Any] | torch.Tensor,
    held_out: Sequence[Any] | torch.Tensor,
    schedule: Schedule,
    progress: Progress,
) -> Epochs:
    """Train a network; it is left with the weights of its best epoch.

    Parameters
    ----------
    network : torch.nn.Module
        The network; call `repeatable` around making it and this.
    losses : callable
        From a mini-batch to weighted losses by name; their sum is minimised.
    batches, held_out : sequence or tensor
        Mini-batches to train on and to decide when to stop by; what `losses` takes, by index.
    schedule : Schedule
        How to train.
    progress : callable
        Called after each mini-batch.

    Returns
    -------
    list of dict
        For each epoch the sum of losses in training, the sum on held-out data, and each of the latter.
    """
    # The order of mini-batches has its own generator: it does not depend on the network.
    order = np.random.default_rng(schedule.seed)
    weights = list(network.parameters())
    descent = Descent(torch.optim.Adam(weights, lr=schedule.learning_rate, fused=True))
    best = BestWeights(weights)
    epochs: Epochs = []
    total = schedule.most_epochs * len(batches)
    for number in range(schedule.most_epochs):
        # One epoch: a step for each mini-batch, in random order.
        trained = 0.0
        for done, index in enumerate(order.permutation(len(batches)), number * len(batches) + 1):
            trained += descent.step(sum(losses(batches[index]).values()))
            progress(done, total)
        # Judge the epoch on held-out data; stop when none of the last `patience` epochs was the best.
        held_out_losses = _held_out(losses, held_out)
        epochs.append(
            {"training": trained / len(batches), "held out": sum(held_out_losses.values())}
            | held_out_losses
        )
        best.judge(epochs[-1]["held out"])
        if best.since >= schedule.patience:
            break
    best.restore()
    return epochs


def _held_out(losses, held_out):
    """Mean of each loss over held-out mini-batches."""
    with torch.no_grad():
        batches = [losses(held_out[index]) for index in range(len(held_out))]
    return {name: float(np.mean([float(batch[name]) for batch in batches])) for name in batches[0]}
