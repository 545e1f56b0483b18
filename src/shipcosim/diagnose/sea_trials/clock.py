"""The clock that a log's own motion tells: true seconds from one row to the next, from the way over the speed."""

import numpy as np

from shipcosim.diagnose.numerics import moving_average, running_sums
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.models.core.constants import GRAVITY


def own_clock(time: np.ndarray, measured: np.ndarray, length: float) -> tuple[np.ndarray, float]:
    """Times of a log's rows by the way of its positions over its logged speed.

    The way is counted along the logged velocity, so that noise of the positions does not lengthen it. Where the ship
    hardly moves, the logged time stands.

    Parameters
    ----------
    time : (n,) array
        As logged. [s]
    measured : (n, 6) array
        North, east, heading, surge, sway, yaw rate, SI.
    length : float
        Of the ship. [m]

    Returns
    -------
    tuple of (n,) array, float
        Times [s], and the scale of the logged velocity [1]: way over integrated speed, divided where the ship turns by
        heading over integrated yaw rate. So a clock that runs wrong throughout is no scale of the velocity. Without a
        yaw rate the clock is taken to be right in the median.
    """
    psi = measured[:, 2]
    u = measured[:, 3]
    v = measured[:, 4]
    step = np.diff(time)
    # Speed along the course; without it the clock cannot be checked.
    speed = np.hypot(u, v)
    if not np.isfinite(speed).all():
        return time, 1.0
    # Direction of the course between neighbouring rows, by the mean of unit vectors.
    course = psi + np.arctan2(v, u)
    north = np.cos(course) + np.cos(np.roll(course, -1))
    east = np.sin(course) + np.sin(np.roll(course, -1))
    size = np.maximum(np.hypot(north, east), 1e-9)
    # Way by positions, projected on it; way by speed, by the trapezoidal rule.
    way = (np.diff(measured[:, 0]) * (north / size)[:-1]) + (
        np.diff(measured[:, 1]) * (east / size)[:-1]
    )
    sailed = 0.5 * step * (speed[1:] + speed[:-1])
    # Average both over a window in proportion to the ship's time scale, as positions are noisy.
    rows = max(round(thresholds.CLOCK_WINDOW * np.sqrt(length) / np.median(step)), 1)
    way = moving_average(way, rows)
    sailed = moving_average(sailed, rows)
    moving = sailed > thresholds.UNDER_WAY * np.sqrt(GRAVITY * length) * np.median(step)
    if not moving.any():
        return time, 1.0
    # True over logged seconds where the ship makes way. Its median is the scale of the speed log,
    # unless heading over yaw rate shows that the clock runs wrong.
    rate = np.where(moving, way / np.maximum(sailed, 1e-9), np.nan)
    scale = float(np.nanmedian(rate)) / _clock_by_heading(rate, measured, step, length, rows)
    # Integrate the rate to times.
    rate = np.clip(np.where(moving, rate / scale, 1.0), 0.2, 5.0)
    return running_sums(rate * step), scale


def _clock_by_heading(rate, measured, step, length, rows):
    """Median rate of the clock: heading turned over integrated yaw rate, of the rows in which the ship turns, by way.

    The way's own median there and throughout may differ, since a clock may be wrong where the ship turns.
    """
    psi, u, v, r = measured[:, 2:].T
    if not np.isfinite(r).all():
        return 1.0
    # The same ratio from heading and yaw rate, over rows in which the ship turns quickly.
    turned = moving_average(np.diff(psi), rows)
    integrated = moving_average(0.5 * step * (r[1:] + r[:-1]), rows)
    quick = np.abs(r[1:]) * length > thresholds.TURNS * np.hypot(u, v)[1:]
    quick &= np.isfinite(rate) & (np.abs(integrated) > 0.2 * np.max(np.abs(integrated)))
    if quick.sum() < 20:
        return 1.0
    by_heading = turned[quick] / integrated[quick]
    return float(np.nanmedian(rate) / np.median(rate[quick] / by_heading))
