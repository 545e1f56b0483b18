"""Our drift predictor: prior beliefs about ships, trained through estimator and equations.

The loss is the prediction error 10, 30 and 60 s ahead, after a loss of thrust. Its gradient
passes the prediction and the Kalman filter over the minutes before, back to the filter's priors.
The targets are the ship's later estimates of position and heading: a real ship has these too.
"""

from dataclasses import dataclass
from types import ModuleType

import numpy as np
import torch

from shipcosim.learn.prediction.rollouts import Sailed, Ship, ahead, errors, followed
from shipcosim.learn.training import Descent, Epochs, Progress
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.prediction.own_model import COEFFICIENT, COEFFICIENTS, STATES, Learned

STD = np.array(
    [0.3, 0.3, 0.01, 0.05, 0.05, 0.002, 0.2, 0.2, 600.0, 600.0, 3e3]
    + [0.5, 0.5, 0.25, 0.25, 0.05, 0.05, 0.1, 0.05, 0.05]
    + [0.15, 0.15, 0.15, 0.3]
    + [0.1, 0.1, 0.1, 1.0, 1.0]
)
"""Standard deviations of the states where training begins: assumed. [units of `STATES`]"""
REST = np.array(
    [
        0.003,
        0.0003,
        0.07,
        0.003,
        0.1,
        0.006,
        0.003,
        100.0,
        60.0,
        60.0,
        1.0,
        3.0,
        1.6,
        0.3,
        0.3,
        1000.0,
    ]
)
"""The other fields of `Learned` where training begins: assumed. [their units]"""
SCALES = np.array([[0.15, 0.15, 0.0087], [0.7, 0.7, 0.035], [2.0, 2.0, 0.07]])
"""Errors that count alike, north, east and in heading, by horizon: larger ones count in proportion. [m, m, rad]"""
STARTS = (1, 2, 3, 4, 5, 7, 9, 12, 16, 20)
"""Seconds after the loss at which predictions of the loss function start. [s]"""


@dataclass(frozen=True)
class DriftTraining:
    """How it is trained.

    Parameters
    ----------
    description : str
        One line for users.
    seeds : tuple of int
        Worlds to train on.
    steps : int
        Steps of the optimiser.
    seed : int
        Of the random numbers, of which none are drawn.
    before : int
        Seconds before the loss that are used. [s]
    learning_rate : float
        Of Adam at the start; it falls as a cosine. [1]
    pull : float
        Price of the square of each number that leaves where training begins. [1]
    kept : float
        Share of the way from there that is kept in the end: few worlds are learned by heart. [1]
    margin : float
        Limits of what was learned over the largest in training. [1]
    """

    description: str
    seeds: tuple[int, ...]
    steps: int = 10
    seed: int = 1
    before: int = 170
    learning_rate: float = 0.15
    pull: float = 0.002
    kept: float = 0.25
    margin: float = 1.5


def learned_of(numbers: Arithmetic, library: ModuleType = np) -> Learned:
    """Beliefs from the numbers that are trained: of means in standard deviations, of all others logarithms of factors.

    Parameters
    ----------
    numbers : (..., 61) array or tensor
        Zero where training begins. [1]
    library : module
        numpy or torch.

    Returns
    -------
    Learned
        (...) arrays or tensors.
    """
    # The numbers in order: means, standard deviations, other parameters.
    first = len(COEFFICIENTS)
    second = len(COEFFICIENTS) + len(STATES)
    std, rest = (library.asarray(scale, dtype=numbers.dtype) for scale in (STD, REST))
    # Logarithms keep standard deviations and rates positive.
    rest = rest * library.exp(numbers[..., second:])
    # Means in standard deviations, so that all numbers have one scale.
    mean = numbers[..., :first] * std[COEFFICIENT]
    std = std * library.exp(numbers[..., first:second])
    return Learned(mean, std, rest[..., 0:2], rest[..., 2:6], *(rest[..., k] for k in range(6, 16)))


SIZE = len(COEFFICIENTS) + len(STATES) + len(REST)


def loss(numbers: torch.Tensor, sailed: Sailed, ship: Ship, recipe: DriftTraining) -> torch.Tensor:
    """Prediction error, nearly proportional where it is large, plus a pull to the start.

    Parameters
    ----------
    numbers : (61,) tensor
        As `learned_of` takes them.
    sailed : Sailed
        Records.
    ship : Ship
        The ship's own model.
    recipe : DriftTraining
        For the pull.

    Returns
    -------
    () tensor
        [1]
    """
    # Run the filter up to each start, then predict; the coarse grid before the loss saves time.
    learned = learned_of(numbers, torch)
    motions = ahead(learned, *followed(learned, sailed, STARTS, ship, torch, grid=2), ship)
    # Errors over the size that counts equally at each horizon.
    missed = errors(motions, sailed, STARTS) / torch.from_numpy(SCALES)[:, None, None, :]
    # Pseudo-Huber loss sqrt(1 + e^2) - 1, so that single
    # worlds do not dominate; ridge on the numbers.
    return (torch.sqrt(1.0 + missed * missed) - 1.0).mean() + recipe.pull * (
        numbers * numbers
    ).sum()


def fit(
    sailed: Sailed, ship: Ship, recipe: DriftTraining, progress: Progress
) -> tuple[np.ndarray, Epochs]:
    """Minimise the loss by Adam.

    Parameters
    ----------
    sailed : Sailed
        Records of the training worlds.
    ship : Ship
        The ship's own model.
    recipe : DriftTraining
        How.
    progress : callable
        Called with how many steps are done, and of how many.

    Returns
    -------
    (61,) array, list of dict
        Numbers as `learned_of` takes them; loss before each step.
    """
    # Zero is the assumed belief; training moves from there.
    at = torch.zeros(SIZE, dtype=torch.float64, requires_grad=True)
    history = []
    # All worlds in each step; the rate falls as a cosine.
    # The gradient passes minutes of filter and prediction, so it is clipped.
    descent = Descent(torch.optim.Adam([at], lr=recipe.learning_rate), recipe.steps, clipped=True)
    for done in range(1, recipe.steps + 1):
        history.append({"all worlds": descent.step(loss(at, sailed, ship, recipe))})
        progress(done, recipe.steps)
    return at.detach().numpy().copy(), history
