"""Features of sea trials: steady speed, rate and drift, time and speed over heading; no clock of the log is in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shipcosim.diagnose.sea_trials import thresholds

if TYPE_CHECKING:
    from shipcosim.diagnose.sea_trials.windows import SeaTrial

__all__ = ["FEATURES", "covariance_of", "features_of"]

FEATURES = {
    "turning circle": (
        "speed",
        "rate",
        "drift",
        *(f"t{heading:.0f}" for heading in thresholds.HEADINGS),
        *(f"speed at {heading:.0f}" for heading in thresholds.HEADINGS_OF_SPEED),
    ),
    "zig-zag": ("peak rate", "swing", "speed"),
    "straight run": ("speed",),
}
"""Names of the features by kind of trial; all are natural logarithms but the drift angle, which is in rad."""


def features_of(trial: SeaTrial, motion: np.ndarray) -> np.ndarray:
    """Features of a motion on the orders of a trial.

    Parameters
    ----------
    trial : SeaTrial
    motion : (n, 6) array
        The trial's `measured`, or what `sailed` gives.

    Returns
    -------
    (f,) array
        In the order of `FEATURES`. [1, rad]
    """
    psi, u, v, r = motion[:, 2:].T
    speed = np.hypot(u, v)
    if trial.kind == "straight run":
        settled = speed if motion.shape[0] == trial.time.size else speed[-1:]
        return np.array([np.log(np.mean(settled))])
    if trial.kind == "zig-zag":
        return _zig_zag(trial, psi, r, speed)
    side = trial.side
    turned = np.maximum.accumulate(side * (psi - psi[0]))
    steady = turned > np.radians(thresholds.HALF_A_CIRCLE)
    steady[-1] = True
    rate = max(side * float(np.mean(r[steady])), 1e-4)
    drift = -side * float(np.mean(np.arctan2(v, u)[steady]))
    rising = turned + 1e-9 * np.arange(turned.size)
    times = np.interp(np.radians(thresholds.HEADINGS), rising, trial.time)
    speeds = np.interp(np.radians(thresholds.HEADINGS_OF_SPEED), rising, speed)
    return np.concatenate(
        ([np.log(np.mean(speed[steady])), np.log(rate), drift], np.log(np.maximum(times, 0.1)), np.log(speeds))
    )


def _zig_zag(trial, psi, r, speed):
    """Means over the swings of the largest rate and of the change of heading; the mean speed."""
    side = np.sign(_helm(trial))
    changes = np.flatnonzero(np.diff(side) != 0) + 1
    changes = changes[changes > 0]
    swings = [slice(a, b) for a, b in zip(changes[:-1], changes[1:], strict=True) if b - a > 4] or [slice(0, psi.size)]
    peaks = [np.max(np.abs(r[swing])) for swing in swings]
    turned = [np.ptp(psi[swing]) for swing in swings]
    return np.array([np.mean(np.log(peaks)), np.mean(np.log(turned)), np.log(np.mean(speed))])


def _helm(trial):
    """What steers in a zig-zag: the order whose sign changes, held where it passes through zero."""
    angle = max((pair[1] for pair in trial.units.values()), key=np.ptp)
    if np.ptp(angle) < 0.02:
        pairs = list(trial.units.values())
        angle = pairs[0][0] - pairs[-1][0]
    return np.where(np.abs(angle) > 0.02 * np.max(np.abs(angle)), angle, 1e-12)


def covariance_of(trial: SeaTrial, length: float) -> np.ndarray:
    """How well the features of a trial repeat: their covariance.

    Parameters
    ----------
    trial : SeaTrial
    length : float
        Of the ship. [m]

    Returns
    -------
    (f, f) array
    """
    t = thresholds
    if trial.kind == "straight run":
        return np.array([[t.STRAIGHT_SPEED**2]])
    if trial.kind == "zig-zag":
        return np.diag(np.square([t.PEAK_RATE, t.SWING, t.ZIG_ZAG_SPEED]))
    own = np.diag(np.square([t.SPEED, t.RATE, t.DRIFT, *t.TIMES, *[t.SPEEDS] * len(t.HEADINGS_OF_SPEED)]))
    count = len(t.HEADINGS)
    times = np.exp(features_of(trial, trial.measured)[3 : 3 + count])
    start = np.concatenate(([0.0, 0.0, 0.0], t.START * np.sqrt(length) / times, np.zeros(len(t.HEADINGS_OF_SPEED))))
    speed = t.COMMON * np.concatenate(([1.0, 0.0, 0.0], np.zeros(count), np.ones(len(t.HEADINGS_OF_SPEED))))
    rate = t.COMMON * np.concatenate(([0.0, 1.0, 0.0], -np.ones(count), np.zeros(len(t.HEADINGS_OF_SPEED))))
    return own + np.outer(start, start) + np.outer(speed, speed) + np.outer(rate, rate)
