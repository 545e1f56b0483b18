"""The networks of paper IV trained over whole predictions, through the equations of motion.

Same networks, inputs and first weights as `paper_iv`, same records before the loss of thrust. Only the loss differs:
what a prediction of a minute misses of place and heading, in place of the acceleration that a second misses. As in a
simulation the recorded wind and thrust of each second are given.
"""

from typing import NamedTuple

import numpy as np
import torch

from shipcosim.learn.datasets import mapped
from shipcosim.learn.prediction.drift import SCALES
from shipcosim.learn.prediction.paper_iv import PaperIVTraining, arrays_of, first_weights
from shipcosim.learn.prediction.rollouts import HORIZONS, Sailed, Ship, known_of
from shipcosim.learn.training import Progress, repeatable
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.prediction import paper_iv
from shipcosim.models.prediction.predictor_inputs import air_velocity

LENGTH = 60
"""Of a rollout. [s]"""
SCALE_NAMES = ("input_mean", "input_std", "output_mean", "output_std")


class Stretches(NamedTuple):
    """Pieces of records, each to be predicted from its first row.

    Parameters
    ----------
    first : (n, 9) tensor
        Place, averaged heading and velocities, last residual. [m, m, rad, m/s, m/s, rad/s, m/s2, m/s2, rad/s2]
    air, thrusters : (LENGTH, n, 2), (LENGTH, n, 3) tensor
        Velocity of the air and load of the thrusters, second by second. [m/s; N, N, N.m]
    reached : (3, n, 3) tensor
        Place and heading at `HORIZONS`, as estimated then. [m, m, rad]
    """

    first: torch.Tensor
    air: torch.Tensor
    thrusters: torch.Tensor
    reached: torch.Tensor


def stretches(sailed: Sailed, ship: Ship, first: int = 10, every: int = 8) -> Stretches:
    """Pieces of the records before the loss of thrust.

    Parameters
    ----------
    sailed : Sailed
        Records.
    ship : Ship
        The ship's own model.
    first, every : int
        First row, and rows from one piece to the next. [1]

    Returns
    -------
    Stretches
        Of all worlds.
    """
    everything = known_of(sailed.known, ship)
    air = np.stack(air_velocity(everything), axis=-1)
    thrusters = np.stack(everything.thrusters, axis=-1)
    places = np.stack(everything.ship[:3], axis=-1)
    past = paper_iv.begin(mapped(lambda array: array[0], everything))
    parts = []
    for row in range(1, sailed.lost - LENGTH + 1):
        now = mapped(lambda array, row=row: array[row], everything)
        past = paper_iv.step(past, now, hull=ship.hull, wind=ship.wind)
        if row >= first and (row - first) % every == 0:
            psi, *nu = (sum(one) / paper_iv.WINDOW for one in zip(*past.states, strict=True))
            start = np.stack([now.ship.x, now.ship.y, psi, *nu, *past.residual], axis=-1)
            seconds = slice(row, row + LENGTH)
            ends = [row + int(horizon) for horizon in HORIZONS]
            parts.append((start, air[seconds], thrusters[seconds], places[ends]))
    starts, *series = zip(*parts, strict=True)
    joined = [np.concatenate(starts), *(np.concatenate(one, axis=1) for one in series)]
    return Stretches(*map(torch.from_numpy, joined))


def ahead(
    weights: list[torch.Tensor], scales: dict[str, np.ndarray], data: Stretches, ship: Ship
) -> torch.Tensor:
    """Predictions by each network alone, as `models.prediction.paper_iv.predict` makes them.

    Parameters
    ----------
    weights : list of tensor
        Weights and biases, as `paper_iv.first_weights` gives them.
    scales : dict of str to array
        Scales of inputs and outputs. [as in paper_iv]
    data : Stretches
        What to predict.
    ship : Ship
        The ship's own model.

    Returns
    -------
    (horizons, members, n, 3) tensor
        Place and heading. [m, m, rad]
    """
    mean, std, out_mean, out_std = (torch.from_numpy(scales[name]) for name in SCALE_NAMES)
    shape = (len(weights[0]), len(data.first))
    found = []
    x, y, psi, *nu = (one.expand(shape) for one in data.first[:, :6].unbind(-1))
    residual = [one.expand(shape) for one in data.first[:, 6:].unbind(-1)]
    for second in range(LENGTH):
        given = data.air[second].unbind(-1), data.thrusters[second].unbind(-1)
        dot = paper_iv.model_acceleration(psi, tuple(nu), *given, hull=ship.hull, wind=ship.wind)
        inputs = (torch.stack(torch.broadcast_tensors(*nu, *dot, *residual), dim=-1) - mean) / std
        residual = (_network(weights, inputs) * out_std + out_mean).unbind(-1)
        then = [a + paper_iv.PERIOD * (b + c) for a, b, c in zip(nu, dot, residual, strict=True)]
        u, v, r = (0.5 * (a + b) for a, b in zip(nu, then, strict=True))
        north, east = to_ned(psi + 0.5 * paper_iv.PERIOD * r, u, v)
        x, y, psi, nu = (
            x + paper_iv.PERIOD * north,
            y + paper_iv.PERIOD * east,
            psi + paper_iv.PERIOD * r,
            then,
        )
        if second + 1 in HORIZONS:
            found.append(torch.stack([x, y, psi], dim=-1))
    return torch.stack(found)


def loss(
    weights: list[torch.Tensor], scales: dict[str, np.ndarray], data: Stretches, ship: Ship
) -> torch.Tensor:
    """What predictions miss at 10, 30 and 60 s, nearly in proportion where it is much; as of our predictor.

    Parameters
    ----------
    weights, scales, data, ship : as in `ahead`
        Networks, pieces of records, the ship's own model.

    Returns
    -------
    () tensor
        [1]
    """
    off = ahead(weights, scales, data, ship) - data.reached[:, None]
    turned = torch.atan2(off[..., 2].sin(), off[..., 2].cos())
    missed = (
        torch.stack([off[..., 0], off[..., 1], turned], dim=-1)
        / torch.from_numpy(SCALES)[:, None, None, :]
    )
    return (torch.sqrt(1.0 + missed * missed) - 1.0).mean()


def fit(
    scales: dict[str, np.ndarray],
    data: Stretches,
    ship: Ship,
    recipe: PaperIVTraining,
    steps: int,
    progress: Progress,
) -> tuple[dict[str, np.ndarray], list[float]]:
    """Train the ensemble from the first weights of one-step training.

    Parameters
    ----------
    scales : dict of str to array
        Of one-step training. [as in paper_iv]
    data : Stretches
        Pieces of records.
    ship : Ship
        The ship's own model.
    recipe : PaperIVTraining
        Members, width, seed and learning rate.
    steps : int
        Of Adam, each with all pieces. [1]
    progress : callable
        Is told how many steps are done, and of how many.

    Returns
    -------
    dict of str to array, list of float
        Arrays as `models.prediction.paper_iv.ensemble_of` reads them; the loss before each step.
    """
    with repeatable(recipe.seed):
        weights = first_weights((9, recipe.width, recipe.width, 3), recipe.members)
    optimiser = torch.optim.Adam(weights, lr=recipe.learning_rate)
    history = []
    for step in range(steps):
        optimiser.zero_grad()
        value = loss(weights, scales, data, ship)
        value.backward()
        torch.nn.utils.clip_grad_norm_(weights, 1.0)
        optimiser.step()
        history.append(float(value.detach()))
        progress(step + 1, steps)
    kept = {name: scales[name] for name in SCALE_NAMES}
    return arrays_of([one.detach() for one in weights]) | kept, history


def _network(weights: list[torch.Tensor], x: torch.Tensor) -> torch.Tensor:
    for k in range(0, len(weights) - 2, 2):
        x = torch.tanh(x @ weights[k] + weights[k + 1])
    return x @ weights[-2] + weights[-1]
