"""Static balance of forces and moment: how much of a load thrusters can hold at most.

For every choice of one convex piece a thruster this is a linear programme; the best choice is the answer. All loads of
a choice are solved as one programme whose blocks do not touch.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import coo_array

MOST = 1e4
"""Largest share that is looked for: a load this much smaller than the thrust counts as none."""


@dataclass(frozen=True)
class Actuator:
    """Forces that one thruster can give.

    Attributes
    ----------
    x, y : float
        Where they act, forward and to starboard of the ship's origin. [m]
    pieces : list of (k, 2) array
        Each the corners of a convex set, with no force in it. [N]
    left : (m,) array
        Share of them that is left under each load. [1]
    """

    x: float
    y: float
    pieces: list[NDArray]
    left: NDArray


def largest_share(actuators: Sequence[Actuator], loads: NDArray) -> NDArray:
    """Largest share of each load that the thrusters can balance together.

    Parameters
    ----------
    actuators : sequence of Actuator
    loads : (m, 3) array
        X, Y, N on the ship. [N, N, N.m]

    Returns
    -------
    (m,) array
        0 where they can do nothing against it, at most `MOST`. At least 1: the ship keeps position and heading. [1]
    """
    loads = np.asarray(loads, float)
    best = np.zeros(len(loads))
    scale = _scale(actuators)
    if not len(loads) or scale is None:
        return best
    for choice in product(*(a.pieces for a in actuators)):
        columns = [_columns(a, piece) / scale for a, piece in zip(actuators, choice, strict=True)]
        best = np.maximum(best, _shares(columns, [a.left for a in actuators], -loads / scale))
    return best + 0.0  # what the solver calls -0 is 0


def _scale(actuators: Sequence[Actuator]) -> NDArray | None:
    """Sizes of force and moment that make the numbers of the programme about 1; None where there is no thrust."""
    force = sum(max((float(np.abs(piece).max(initial=0.0)) for piece in a.pieces), default=0.0) for a in actuators)
    lever = max((float(np.hypot(a.x, a.y)) for a in actuators), default=0.0)
    return np.array([force, force, force * max(lever, 1.0)]) if force > 0.0 else None


def _columns(actuator: Actuator, corners: NDArray) -> NDArray:
    """Forces and moment of the corners, (k, 3)."""
    moment = actuator.x * corners[:, 1] - actuator.y * corners[:, 0]
    return np.column_stack([corners, moment])


def _shares(columns: list[NDArray], left: list[NDArray], wanted: NDArray) -> NDArray:
    """Shares of (m, 3) wanted loads: maximise s where sum_j c_j columns_j = s wanted.

    A block has the unknowns c, one a corner, and s; those c that belong to one thruster sum to 1 at most.
    """
    sizes = [len(part) for part in columns]
    count, width, number = len(wanted), sum(sizes) + 1, len(columns)
    owner = np.repeat(np.arange(number), sizes)
    shrunk = np.stack(left, axis=1)[:, owner]  # (m, corners)
    dense = np.concatenate([shrunk[:, None, :] * np.vstack(columns).T[None], -wanted[:, :, None]], axis=2)
    equal = _blocks(dense)
    most = _blocks(
        np.broadcast_to(
            np.eye(number)[:, np.append(owner, 0)] * np.append(np.ones(width - 1), 0.0), (count, number, width)
        )
    )
    goal = np.tile(np.append(np.zeros(width - 1), -1.0), count)
    bounds = np.tile([[0.0, np.inf]] * (width - 1) + [[0.0, MOST]], (count, 1))
    done = linprog(goal, most, np.ones(number * count), equal, np.zeros(3 * count), bounds, method="highs")
    if done.status != 0:
        raise ArithmeticError(f"the balance was not found: {done.message}")
    return done.x[width - 1 :: width]


def _blocks(dense: NDArray) -> coo_array:
    """Block-diagonal matrix of (m, rows, columns) blocks."""
    count, rows, columns = dense.shape
    block, row, column = np.nonzero(dense)
    return coo_array(
        (dense[block, row, column], (block * rows + row, block * columns + column)), (count * rows, count * columns)
    )
