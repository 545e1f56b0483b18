"""How fast a ship answers: the times within which her damping takes away surge, sway and yaw."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shipcosim.models.ship.vessel import accelerations

if TYPE_CHECKING:
    from shipcosim.diagnose.ship.model import ShipModel
    from shipcosim.models.core.motion import Motion
    from shipcosim.models.ship.hull import HullParameters

__all__ = ["Scales", "response_times"]

_SMALL = 1e-3  # m/s, and rad/s over half the length in m: differences for slopes


class Scales(NamedTuple):
    """Time constants of a ship at the speeds of a log; infinite where nothing damps her.

    Attributes
    ----------
    surge, sway, yaw : float
        Inertia with added mass over the slope of the damping. [s]
    """

    surge: float
    sway: float
    yaw: float

    @property
    def fastest(self) -> float:
        """The shortest of the three; what happens faster than this the ship does not follow. [s]"""
        return min(self)

    @property
    def slowest(self) -> float:
        """The longest of the three. [s]"""
        return max(self)

    @property
    def middle(self) -> float:
        """Geometric mean of those that are finite, infinite where none is. [s]"""
        finite = [time for time in self if np.isfinite(time)]
        return float(np.exp(np.mean(np.log(finite)))) if finite else np.inf


def response_times(ship: ShipModel, motion: Motion) -> Scales:
    """Time constants of a ship at the speeds at which a log has her.

    Parameters
    ----------
    ship : ShipModel
    motion : Motion
        Near the measured one, (n,) arrays; rows with NaN do not count.

    Returns
    -------
    Scales
        By the mean over the rows of the rate at which each velocity alone would decay.
    """
    hull = ship.parts["hull"]
    speeds = np.stack([motion.u, motion.v, motion.r]).reshape(3, -1)
    speeds = speeds[:, np.isfinite(speeds).all(0)]
    if not speeds.size:
        return Scales(np.inf, np.inf, np.inf)
    here = _decelerations(speeds, hull)
    rates = []
    for axis, small in enumerate((_SMALL, _SMALL, 2.0 * _SMALL / hull.length)):
        moved = speeds.copy()
        moved[axis] += np.where(moved[axis] < 0.0, -small, small)
        slope = (_decelerations(moved, hull)[axis] - here[axis]) / (moved[axis] - speeds[axis])
        rates.append(float(np.mean(-slope)))
    return Scales(*(1.0 / rate if rate > 0.0 else np.inf for rate in rates))


def _decelerations(speeds: np.ndarray, hull: HullParameters) -> np.ndarray:
    """Rates of surge, sway and yaw, (3, n) array, of a ship that nothing drives."""
    u, v, r = speeds
    return np.stack(accelerations(u, v, r, 0.0, 0.0, 0.0, hull=hull))
