"""Ensemble of our docking predictor: it learns the position errors of the equations of motion."""

from dataclasses import dataclass

import numpy as np
import torch

from shipcosim.angles import wrap
from shipcosim.learn.docking import fitting
from shipcosim.learn.docking.fitting import tensor
from shipcosim.learn.docking.inputs import Replay
from shipcosim.learn.networks import Arrays
from shipcosim.learn.training import Epochs, Progress, repeatable
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.prediction import docking
from shipcosim.models.prediction.docking import CUT
from shipcosim.models.ship.hull import HullParameters

HEADING = 10.0
"""What a radian of heading counts in the loss. [m/rad]"""
METRES = 5.0
RADIANS = 0.2
"""Scales of the outputs."""
MIRROR_SIGNS = np.array(
    [1, -1, 1, 1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, -1, -1, 1, -1]
    + [1, -1, 1, -1, -1, 1, -1, 1, -1, -1, -1, -1]
)  # fmt: skip
MIRROR_ORDER = np.r_[0:18, 23:28, 18:23, 28:30]
"""Features of the ship seen in a mirror along her centreline: signs, and whose places they take."""


@dataclass(frozen=True)
class DockingTraining:
    """How the ensemble is trained.

    Parameters
    ----------
    description : str
        One line for users.
    seed : int
        Of weights and order.
    members, width, layers : int
        Networks; units of an LSTM layer, layers.
    dropout : float
        As `Recurrent`. [1]
    epochs, batch : int
        Epochs at most; dockings in a step of the optimiser.
    learning_rate, decay : float
        Of Adam at the start, it falls as a cosine; weight decay. [1]
    noise : float
        Standard deviation of what is added to standardised features in training. [1]
    """

    description: str = "Our docking predictor: equations of motion with a load of their own record, and an ensemble"
    seed: int = 1
    members: int = 3
    width: int = 48
    layers: int = 1
    dropout: float = 0.0
    epochs: int = 40
    batch: int = 8
    learning_rate: float = 4e-3
    decay: float = 1e-4
    noise: float = 0.1


def features(replay: Replay, hull: HullParameters) -> np.ndarray:
    """Inputs of the ensemble, (m, n, 30) array."""
    return docking.features(replay.aboard, replay.own, replay.ours[-1], hull)


def targets(replay: Replay) -> np.ndarray:
    """Errors of the equations of motion: (m, n, 3, `LONGEST`) array, ahead, starboard [m], heading
    [rad].

    NaN beyond the end of the record.
    """
    # Error = measured later - predicted, at each horizon.
    ahead = np.stack([np.stack(motion[:3]) for motion in replay.ours])
    true = np.stack([replay.later[name][1:] for name in ("x", "y", "psi")], axis=1)
    north, east, turn = np.moveaxis(true - ahead, 1, 0)
    # In body axes at the start: the error then does not depend on the course.
    errors = np.stack([*to_body(replay.own.ship.psi, north, east), wrap(turn)])
    return np.moveaxis(errors, (0, 1), (2, 3))


def distance(given: torch.Tensor, target: torch.Tensor, polynomials: torch.Tensor) -> torch.Tensor:
    """Mean remaining position error plus weighted heading error. [m]

    Parameters
    ----------
    given : (m, n, 3 k) tensor
        Outputs with their scale.
    target : (m, n, 3, LONGEST) tensor
        As `targets`.
    polynomials : (k, LONGEST) tensor
        As `docking.basis`.
    """
    # Error that remains after the correction, a polynomial in the horizon.
    left = target - given.unflatten(-1, (3, len(docking.POWERS))) @ polynomials
    # Horizons beyond the end of a record are NaN and do not count.
    there = torch.isfinite(left).all(dim=2)
    left = torch.nan_to_num(left)
    # Distance; 1e-2 m2 keeps its gradient finite at zero.
    place = torch.sqrt(left[:, :, 0] ** 2 + left[:, :, 1] ** 2 + 1e-2)
    return ((place + HEADING * abs(left[:, :, 2])) * there).sum() / there.sum()


def scale() -> np.ndarray:
    """Scale of the outputs."""
    k = len(docking.POWERS)
    return np.repeat([METRES, METRES, RADIANS], k) * np.tile([0.2] + [1.0] * (k - 1), 3)


def fit(
    training: tuple[np.ndarray, np.ndarray],
    choice: tuple[np.ndarray, np.ndarray],
    recipe: DockingTraining,
    progress: Progress,
) -> tuple[Arrays, Epochs]:
    """Train the ensemble on every docking and on its mirror image.

    Parameters
    ----------
    training, choice : tuples of two arrays
        Features and targets, to train on and to choose the epoch by.
    recipe : DockingTraining
        How.
    progress : callable
        Called with how many steps are done, and of how many.

    Returns
    -------
    dict of str to array, and list of dict
        As `docking.trained_of` takes them; losses by member and epoch.
    """
    # Standardise features; clip outliers as the predictor does.
    mean, std = standard(training[0])
    x, held = (tensor(np.clip((data[0] - mean) / std, -CUT, CUT)) for data in (training, choice))
    y = tensor(training[1])
    sizes = tensor(scale())
    polynomials = tensor(docking.basis())
    # Add the mirror image of every docking: port and starboard then give mirrored corrections.
    x = torch.cat((x, (x * tensor(MIRROR_SIGNS))[..., torch.tensor(MIRROR_ORDER)]))
    y = torch.cat((y, y * tensor(np.array([1.0, -1.0, -1.0])).reshape(1, 1, 3, 1)))

    def loss(given, target):
        return distance(sizes * given, target, polynomials)

    # Train the members; the error is counted in metres, after the outputs are scaled.
    with repeatable(recipe.seed):
        weights, epochs = fitting.fit(
            (x, y), (held, tensor(choice[1])), loss, len(sizes), recipe, progress
        )
    arrays = {"mean": mean, "std": std, "scale": scale()} | weights
    # Largest features seen in training: beyond these the predictor trusts its ensemble less.
    limits = np.append(abs((training[0] - mean) / std).reshape(-1, len(mean)).max(axis=0), np.inf)
    # The same for the spread between members, which needs the trained members.
    trained = docking.trained_of(arrays | {"limits": limits})
    spread = docking.spread(given_by(trained, training[0]))
    return arrays | {"limits": np.append(limits[:-1], max(float(spread.max()), 1e-6))}, epochs


def standard(inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of features, equal for both sides of the ship."""
    both = np.concatenate((inputs, (inputs * MIRROR_SIGNS)[..., MIRROR_ORDER]))
    return both.mean(axis=(0, 1)), both.std(axis=(0, 1)) + 1e-9


def given_by(trained: docking.Trained, inputs: np.ndarray) -> np.ndarray:
    """Outputs of members over (m, n) features, from empty memories: (members, m, n, 3 k) array."""
    memory = ()
    rows = []
    inputs = docking.standardised(inputs, trained)
    for k in range(inputs.shape[1]):
        given, memory = docking.outputs(inputs[:, k], memory, trained)
        rows.append(given)
    return np.stack(rows, axis=2)
