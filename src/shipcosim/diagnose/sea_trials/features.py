"""Features of sea trials: steady speed, rate and drift, times, speeds and distances over heading.

The log's clock is in none of them. Distances are IMO's (resolution MSC.137(76), 2002, annex, and MSC/Circ.1053): the
advance is the way along the first course, the transfer that across it, until the heading has changed by 90 deg; the
tactical diameter is the way across it until the heading has changed by 180 deg; all from where the order is given. IMO
takes them for the midship point, the log has them for the antenna; the model's are the antenna's too. The current is
taken from the track, as these notes do, by the drift of the steady circle.
"""

from itertools import pairwise

import numpy as np

from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.models.core.kinematics import to_ned

_TIMES = tuple(f"t{heading:.0f}" for heading in thresholds.HEADINGS)
_SPEEDS = tuple(f"speed at {heading:.0f}" for heading in thresholds.HEADINGS_OF_SPEED)
_WAYS = "advance", "transfer", "tactical diameter"
FEATURES = {
    "turning circle": ("speed", "rate", "drift", *_TIMES, *_SPEEDS, *_WAYS),
    "zig-zag": ("peak rate", "swing", "speed"),
    "straight run": ("speed",),
    "pull-out": ("rate at a quarter", "rate at half", "speed at the end"),
    "spiral": (
        "speed",
        "rate",
        "rate at the second helm",
        "rate at the third helm",
        "rate at the fourth helm",
    ),
    "change of speed": tuple(
        f"speed at {part} of the time" for part in ("1/4", "1/2", "3/4", "the end")
    ),
    "course held": ("speed", "drift", "turned"),
}
"""Names of the features by kind of trial.

Natural logarithms, but angles in rad, and of the kinds that are not sought in logs speeds and rates at a time or helm
as shares of the first.
"""
SOUGHT = ("straight run", "turning circle", "zig-zag")
"""Kinds of trials that are sought in logs."""
ANGLES = {"drift", "turned"}
"""Names of the features that are angles. [rad]"""


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
    if trial.kind in _OTHERS:
        return _OTHERS[trial.kind](trial, motion)
    return _circle(trial, motion, speed)


def _circle(trial, motion, speed):
    psi, u, v, r = motion[:, 2:].T
    side = trial.side
    # Heading turned so far, never decreasing; the steady circle is what follows half a circle.
    turned = np.maximum.accumulate(side * (psi - psi[0]))
    steady = turned > np.radians(thresholds.HALF_A_CIRCLE)
    steady[-1] = True
    # Steady rate of turn and drift angle, positive whatever the side.
    rate = max(side * float(np.mean(r[steady])), 1e-4)
    drift = -side * float(np.mean(np.arctan2(v, u)[steady]))
    # Times, speeds and distances at given changes of heading, by interpolation over the heading.
    rising = turned + 1e-9 * np.arange(turned.size)
    times = np.interp(np.radians(thresholds.HEADINGS), rising, trial.time)
    speeds = np.interp(np.radians(thresholds.HEADINGS_OF_SPEED), rising, speed)
    ways = np.maximum(_ways(motion, trial, rising), 1e-3)
    steady_state = np.log(np.mean(speed[steady])), np.log(rate), drift
    return np.concatenate(
        (steady_state, np.log(np.maximum(times, 0.1)), np.log(speeds), np.log(ways))
    )


def _ways(motion, trial, turned):
    """Advance and transfer at 90 deg, tactical diameter at 180 deg, from the heading turned. [m]

    Along and across the first course, not the first heading: what the compass is off would turn the track.
    """
    (north, east) = motion[:, :2].T
    time = trial.time
    # Direction of the first course through the water: velocity over ground less the drift.
    towards = np.array(to_ned(*motion[0, 2:5]))
    drift = _drift(motion, trial, turned)
    c, s = (towards - drift) / np.hypot(*(towards - drift))
    # Track relative to the drifting water.
    north = north - north[0] - drift[0] * time
    east = east - east[0] - drift[1] * time
    ahead = c * north + s * east
    across = trial.side * (c * east - s * north)
    quarter, half = np.radians((90.0, 180.0))
    return np.array(
        [np.interp(quarter, turned, way) for way in (ahead, across)]
        + [np.interp(half, turned, across)]
    )


def _drift(motion, trial, turned):
    """By how much the centre of a steady circle drifts, to north and east: the current, also of a ship in still water.

    Nothing where the ship did not turn round in steady state. [m/s]
    """
    # The drift only shows once the steady circle covers enough of the heading.
    half = np.radians(thresholds.HALF_A_CIRCLE)
    if (
        np.ptp(trial.measured[:, 2]) < half + np.radians(thresholds.DRIFT_TOLD)
        or turned[-1] < 1.5 * half
    ):
        return np.zeros(2)
    steady = turned > half
    psi = motion[steady, 2]
    since = trial.time[steady] - np.mean(trial.time[steady])
    none = np.zeros_like(psi)
    ones = np.ones_like(psi)
    c = np.cos(psi)
    s = np.sin(psi)
    # Least squares: a circle whose centre drifts, x = x0 + a cos psi - b sin psi + U t, y = y0 + a
    # sin psi + b cos psi + V t.
    rows = np.block(
        [
            [np.stack((ones, none, c, -s, since, none), 1)],
            [np.stack((none, ones, s, c, none, since), 1)],
        ]
    )
    return np.linalg.lstsq(
        rows, np.concatenate((motion[steady, 0], motion[steady, 1])), rcond=None
    )[0][4:]


def _zig_zag(trial, psi, r, speed):
    """Means over the swings of the largest rate and of the change of heading; the mean speed."""
    # Swings lie between changes of the helm's sign; short ones are left out.
    side = np.sign(_helm(trial))
    changes = np.flatnonzero(np.diff(side) != 0) + 1
    changes = changes[changes > 0]
    swings = [slice(a, b) for a, b in zip(changes[:-1], changes[1:], strict=True) if b - a > 4] or [
        slice(0, psi.size)
    ]
    peaks = [np.max(np.abs(r[swing])) for swing in swings]
    turned = [np.ptp(psi[swing]) for swing in swings]
    return np.array([np.mean(np.log(peaks)), np.mean(np.log(turned)), np.log(np.mean(speed))])


def is_logarithm(kind: str, name: str) -> bool:
    """Whether a feature is a natural logarithm."""
    return name not in ANGLES and (kind in SOUGHT or " at " not in name)


def _pull_out(trial, motion):
    """Rate of turn after the helm is put amidships, over that before; speed at the end over that before."""
    rate = trial.measured[0, 5]
    rows = len(motion) - 1
    return np.array(
        [
            motion[rows // 4, 5] / rate,
            motion[rows // 2, 5] / rate,
            motion[-1, 3] / trial.measured[0, 3],
        ]
    )


def _spiral(trial, motion):
    """Speed at the first helm and rates at all four, each as the mean over the last third of its time."""
    # Four equal parts; the last third of each is taken as steady.
    ends = np.linspace(0, len(motion), 5).astype(int)
    parts = [slice(b - (b - a) // 3, b) for a, b in pairwise(ends)]
    first = np.mean(trial.measured[parts[0], 5])
    speed = np.mean(np.hypot(*motion[parts[0], 3:5].T))
    rates = np.array([np.mean(motion[part, 5]) / first for part in parts])
    return np.concatenate(
        ([np.log(speed), np.log(max(rates[0], 1e-3)) + np.log(abs(first))], rates[1:])
    )


def _change_of_speed(trial, motion):
    """Speed ahead over the first, after each quarter of the time."""
    return motion[np.linspace(0, len(motion) - 1, 5).astype(int)[1:], 3] / trial.measured[0, 3]


def _course_held(trial, motion):
    """Mean speed and drift angle over the last third of the time, and the change of heading in all."""
    last = motion[-len(motion) // 3 :]
    drift = -trial.side * np.mean(np.arctan2(last[:, 4], last[:, 3]))
    return np.array(
        [
            np.log(np.mean(np.hypot(*last[:, 3:5].T))),
            drift,
            trial.side * (motion[-1, 2] - motion[0, 2]),
        ]
    )


_OTHERS = {
    "pull-out": _pull_out,
    "spiral": _spiral,
    "change of speed": _change_of_speed,
    "course held": _course_held,
}


def _helm(trial):
    """What steers in a zig-zag: the order whose sign changes, held where it passes through zero."""
    # Without a direction that changes, the difference of the first and last thruster's speed.
    angle = max((pair[1] for pair in trial.units.values()), key=np.ptp)
    if np.ptp(angle) < 0.02:
        pairs = list(trial.units.values())
        angle = pairs[0][0] - pairs[-1][0]
    return np.where(np.abs(angle) > 0.02 * np.max(np.abs(angle)), angle, 1e-12)


_SPREADS = {
    "zig-zag": (thresholds.PEAK_RATE, thresholds.SWING, thresholds.ZIG_ZAG_SPEED),
    "pull-out": (thresholds.PULL_OUT_RATE, thresholds.PULL_OUT_RATE, thresholds.ZIG_ZAG_SPEED),
    "spiral": (thresholds.SPEED, thresholds.RATE, *[thresholds.SPIRAL_RATE] * 3),
    "change of speed": [thresholds.CHANGED_SPEED] * 4,
    "course held": (thresholds.SPEED, thresholds.DRIFT, thresholds.TURNED),
}


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
    if trial.kind in _SPREADS:
        return np.diag(np.square(_SPREADS[trial.kind]))
    # Independent errors of each feature, then errors that features share: a late start, a common
    # error of speed, and one of rate.
    stds = [t.SPEED, t.RATE, t.DRIFT, *t.TIMES, *[t.SPEEDS] * len(t.HEADINGS_OF_SPEED), *t.WAYS]
    names = FEATURES[trial.kind]
    features = features_of(trial, trial.measured)
    late = t.START * np.sqrt(length)
    covariance = np.diag(np.square(stds))
    for shares in (
        {name: late / np.exp(x) for name, x in zip(names, features, strict=True) if name in _TIMES}
        | {
            "advance": late
            * np.hypot(*trial.measured[0, 3:5])
            / np.exp(features[names.index("advance")])
        },
        dict.fromkeys(("speed", *_SPEEDS, *_WAYS), t.COMMON),
        {"rate": t.COMMON} | dict.fromkeys((*_TIMES, *_WAYS), -t.COMMON),
    ):
        shared = np.array([shares.get(name, 0.0) for name in names])
        covariance += np.outer(shared, shared)
    return covariance
