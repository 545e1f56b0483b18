"""Static balance of forces and moment: the largest part of a load that the thrusters can hold.

For every choice of one convex piece a thruster the sum of the pieces is convex; the best choice is the answer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from shipcosim.ships.attainable import largest_multiple

MOST = 1e4
"""Largest share that is computed: a load so much smaller than the thrust counts as zero."""


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
    # Balance: thrust + s · load = 0. The ship holds the load if s can reach 1.
    loads = np.asarray(loads, float)
    best = np.zeros(len(loads))
    # Newton and newton metres differ in size; scaled to one size they suit the tolerance of the
    # linear programme.
    # Force: the sum of the largest thrusts. Moment: this force on the longest lever, at least 1 m.
    force = sum(
        max((float(np.abs(piece).max(initial=0.0)) for piece in a.pieces), default=0.0)
        for a in actuators
    )
    lever = max((float(np.hypot(a.x, a.y)) for a in actuators), default=0.0)
    scale = np.array([force, force, force * max(lever, 1.0)]) if force > 0.0 else None
    if not len(loads) or scale is None:
        return best
    left = np.stack([a.left for a in actuators], axis=1)
    # The reachable forces of a thruster may not be convex, but each of its pieces is. Try every
    # choice of one piece each: its linear programme gives the largest share.
    for choice in product(*(a.pieces for a in actuators)):
        sets = [_columns(a, piece) / scale for a, piece in zip(actuators, choice, strict=True)]
        best = np.maximum(best, np.minimum(largest_multiple(sets, left, -loads / scale), MOST))
    return best


def _columns(actuator: Actuator, corners: NDArray) -> NDArray:
    """Forces and moment of the corners, (k, 3)."""
    # N = x Y - y X, about the ship's origin.
    moment = actuator.x * corners[:, 1] - actuator.y * corners[:, 0]
    return np.column_stack([corners, moment])
