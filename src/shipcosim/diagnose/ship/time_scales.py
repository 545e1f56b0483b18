"""How fast a ship answers: the times within which her damping takes away surge, sway and yaw."""

from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

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
    def slowest(self) -> float:
        """The longest of the three. [s]"""
        return max(self)

    @property
    def middle(self) -> float:
        """Geometric mean of the finite values; infinite if there are none. [s]"""
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
    rates = [float(np.mean(rate)) if rate.size else 0.0 for rate in _rates(ship, motion)]
    return Scales(*(1.0 / rate if rate > 0.0 else np.inf for rate in rates))


def fastest_rate(ship: ShipModel, motion: Motion) -> float:
    """Rate of the fastest answer that a ship gives in a log, which an integration has to follow.

    Parameters
    ----------
    ship, motion
        As of `response_times`.

    Returns
    -------
    float
        Of the three velocities the largest rate of decay, exceeded in 1 % of the rows: a few may be faulty. [1/s]
    """
    return max(
        (float(np.percentile(rate, 99.0)) for rate in _rates(ship, motion) if rate.size),
        default=0.0,
    )


def _rates(ship: ShipModel, motion: Motion) -> list[np.ndarray]:
    """Rate at which each velocity alone would decay, by row. [1/s]"""
    # Deceleration at all speeds of the log, without any input.
    hull = ship.parts["hull"]
    speeds = np.stack([motion.u, motion.v, motion.r]).reshape(3, -1)
    speeds = speeds[:, np.isfinite(speeds).all(0)]
    here = _decelerations(speeds, hull)
    # Decay rate: minus the slope of the deceleration, by a finite difference away from zero.
    rates = []
    for axis, small in enumerate((_SMALL, _SMALL, 2.0 * _SMALL / hull.length)):
        moved = speeds.copy()
        moved[axis] += np.where(moved[axis] < 0.0, -small, small)
        slope = (_decelerations(moved, hull)[axis] - here[axis]) / (moved[axis] - speeds[axis])
        rates.append(-slope)
    return rates


def _decelerations(speeds: np.ndarray, hull: HullParameters) -> np.ndarray:
    """Rates of surge, sway and yaw, (3, n) array, of a ship that nothing drives."""
    u, v, r = speeds
    return np.stack(accelerations(u, v, r, 0.0, 0.0, 0.0, hull=hull))
