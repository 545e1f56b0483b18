"""The networks of paper IV: residual accelerations of the equations of motion, a second ahead, in DP and manoeuvres.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper IV and ch. 4.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch

from shipcosim.learn.datasets import mapped
from shipcosim.learn.networks import Arrays
from shipcosim.learn.prediction.rollouts import Sailed, Ship, known_of
from shipcosim.learn.training import BestWeights, Descent, Epochs, Progress, repeatable
from shipcosim.models.prediction import paper_iv

NOTES = (
    "The paper prints these points. The nine inputs are velocities and accelerations of the equations of motion, and"
    " the last residual. There are two layers of 20 hyperbolic tangents and three linear outputs. The data are 3000"
    " samples at 1 Hz of DP and low-speed manoeuvring. The prediction is the mean of an ensemble. Velocity and heading"
    " are averaged over 3 s; wind and commands are held.",
    "The paper does not print these points, so they are chosen here. The ensemble has five members. Inputs and outputs"
    " are scaled to mean 0 and standard deviation 1. Adam has a learning rate of 0.003 and mini-batches of 100. A tenth"
    " of the samples is held out and decides when to stop. Accelerations are differences of the observer's velocities"
    " over a second. Steps are explicit and take a second.",
    "The paper trains on 50 minutes of one ship in one place and weather, right before the loss of thrust. Worlds here"
    " last three to five minutes, so the samples come from many worlds, before their loss.",
)


@dataclass(frozen=True)
class PaperIVTraining:
    """How the networks are trained.

    Parameters
    ----------
    description : str
        One line for users.
    seeds : tuple of int
        Worlds to train on.
    samples, members, width : int
        Samples, networks, units in each of two layers. [1]
    seed : int
        Of samples, order and weights.
    batch, most_epochs, patience : int
        Samples in a step, epochs at most, epochs without gain before the end. [1]
    learning_rate : float
        Of Adam. [1]
    """

    description: str
    seeds: tuple[int, ...]
    samples: int = 3000
    members: int = 5
    width: int = 20
    seed: int = 1
    batch: int = 100
    most_epochs: int = 200
    patience: int = 15
    learning_rate: float = 3e-3


def samples(sailed: Sailed, ship: Ship, first: int = 10) -> tuple[np.ndarray, np.ndarray]:
    """Inputs and targets of every second before the loss.

    Parameters
    ----------
    sailed : Sailed
        Records.
    ship : Ship
        The ship's own model.
    first : int
        Rows that are left out at the start. [1]

    Returns
    -------
    (n, 9) and (n, 3) array
        [m/s, rad/s, m/s2, rad/s2]
    """
    # Everything the ship knows at each second, in all worlds at once.
    everything = known_of(sailed.known, ship)
    now = mapped(lambda array: array[0], everything)
    past = paper_iv.begin(now)
    inputs = []
    targets = []
    for row in range(1, sailed.lost):
        now = mapped(lambda array, row=row: array[row], everything)
        # Inputs: velocity, model acceleration and last residual, before the step.
        psi, *nu = past.states[-1]
        dot = paper_iv.model_acceleration(
            psi, tuple(nu), past.wind, past.thrusters, hull=ship.hull, wind=ship.wind
        )
        before = [np.broadcast_to(signal, np.shape(psi)) for signal in (*nu, *dot, *past.residual)]
        # After the step the residual is known: it is the target.
        past = paper_iv.step(past, now, hull=ship.hull, wind=ship.wind)
        # Leave out the first rows, where averages and residual are not yet settled.
        if row >= first:
            inputs.append(np.stack(before, axis=-1))
            targets.append(np.stack(past.residual, axis=-1))
    return np.concatenate(inputs), np.concatenate(targets)


def fit(
    inputs: np.ndarray, targets: np.ndarray, recipe: PaperIVTraining, progress: Progress
) -> tuple[Arrays, Epochs]:
    """Train the ensemble, all networks at once.

    Parameters
    ----------
    inputs, targets : (n, 9), (n, 3) array
        As `samples` gives them; `recipe.samples` of them are drawn.
    recipe : PaperIVTraining
        How.
    progress : callable
        Called with how many epochs are done, and of how many at most.

    Returns
    -------
    dict of str to array, list of dict
        Arrays as `models.prediction.paper_iv.ensemble_of` reads them; losses of each epoch.
    """
    # Draw as many samples as the paper has.
    rng = np.random.default_rng(recipe.seed)
    chosen = rng.permutation(len(inputs))[: recipe.samples]
    x = inputs[chosen]
    y = targets[chosen]
    # Scales from these samples; they are stored with the weights.
    scales = {
        "input_mean": x.mean(0),
        "input_std": x.std(0),
        "output_mean": y.mean(0),
        "output_std": y.std(0),
    }
    x = torch.from_numpy((x - scales["input_mean"]) / scales["input_std"])
    y = torch.from_numpy((y - scales["output_mean"]) / scales["output_std"])
    # The first tenth of the shuffled samples is held out.
    held = len(x) // 10
    order = np.random.default_rng(recipe.seed)
    # All members in one tensor: they train side by side.
    with repeatable(recipe.seed):
        weights = first_weights(
            (x.shape[1], recipe.width, recipe.width, y.shape[1]), recipe.members
        )
    descent = Descent(torch.optim.Adam(weights, lr=recipe.learning_rate))
    best = BestWeights(weights)
    epochs = []
    for number in range(recipe.most_epochs):
        # One epoch of mini-batches in random order.
        for rows in np.array_split(
            held + order.permutation(len(x) - held), (len(x) - held) // recipe.batch or 1
        ):
            descent.step(squares(weights, x[rows], y[rows]))
        # Error on training and held-out samples after the epoch.
        with torch.no_grad():
            losses = {
                name: float(squares(weights, x[part], y[part]))
                for name, part in (("training", slice(held, None)), ("held out", slice(held)))
            }
        epochs.append(losses)
        progress(number + 1, recipe.most_epochs)
        # Keep the best weights; stop after `patience` epochs without gain.
        best.judge(losses["held out"])
        if best.since >= recipe.patience:
            break
    return arrays_of(best.kept) | scales, epochs


def first_weights(sizes: Sequence[int], members: int) -> list[torch.Tensor]:
    """Initial weights: uniform as by Glorot and Bengio, biases 0."""
    weights = []
    for n, m in pairwise(sizes):
        # Glorot limit sqrt(6/(n + m)): keeps the variance from layer to layer.
        limit = (6.0 / (n + m)) ** 0.5
        weights += [limit * (2.0 * torch.rand(members, n, m, dtype=torch.float64) - 1.0)]
        weights += [torch.zeros(members, 1, m, dtype=torch.float64)]
    return [weight.requires_grad_() for weight in weights]


def squares(weights: list[torch.Tensor], x: torch.Tensor, y: torch.Tensor) -> torch.Tensor:
    """Mean square error over all members."""
    # Hidden layers with tanh, the output layer linear.
    for k in range(0, len(weights) - 2, 2):
        x = torch.tanh(x @ weights[k] + weights[k + 1])
    return ((x @ weights[-2] + weights[-1] - y) ** 2).mean()


def arrays_of(weights: list[torch.Tensor]) -> Arrays:
    """Weights and biases by their names."""
    pairs = zip(weights[::2], weights[1::2], strict=True)
    return {
        f"{k}.{name}": array.numpy().copy()
        for k, pair in enumerate(pairs, 1)
        for name, array in zip(("weights", "bias"), pair, strict=True)
    }
