"""Position against velocity and heading against rate: what is left between them, as white noise.

The level between a position and the integral of the velocity wanders as the velocity's noise adds up, and is seen
through the position's noise. A Kalman filter of that level leaves innovations that are white when the log is right;
any change of the log that is linear goes through the same filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.log.roles import POSITION, VELOCITY
from shipcosim.diagnose.log.thresholds import (
    CLEAR_MOTION,
    LONGEST_BRIDGE,
    NOISE_WINDOWS,
    SLOW_MOTION,
    WHITENESS_LAGS,
)
from shipcosim.diagnose.numerics import (
    gaussian_filter,
    normal_size,
    quantile,
    solve_tridiagonal,
    spline_integral,
)

RATIOS = (
    0.0005,
    0.002,
    0.005,
    0.01,
    0.02,
    0.04,
    0.1,
    0.2,
    0.4,
    0.8,
    1.6,
    6.0,
    50.0,
)  # variance of wander over noise
_FEWEST_ROWS = 30  # in which position and velocity are compared. Assumed.


@dataclass(frozen=True)
class Motion:
    """A position of one or two axes, and the velocity that should be its rate.

    Attributes
    ----------
    time : (n,) array
        Of the rows where both are known. [s]
    seen : (n, a) array
        Position or heading. [m or deg]
    velocity : (n, a) array
        Rate of `seen` as logged. [m/s or deg/s]
    starts : (n,) array of bool
        Rows that cannot be compared with the one before.
    """

    time: np.ndarray
    seen: np.ndarray
    velocity: np.ndarray
    starts: np.ndarray

    def slow(self, velocity: np.ndarray) -> np.ndarray:
        """A velocity without its noise and waves."""
        return gaussian_filter(velocity, SLOW_MOTION / np.median(np.diff(self.time)), axis=0)

    @property
    def level(self) -> np.ndarray:
        """What is seen less the way made, (n, a)."""
        # By a spline, since the trapezium loses a tenth of a wave of 6 s at 1 Hz.
        return self.seen - spline_integral(self.time, self.velocity)


@dataclass(frozen=True)
class Logged:
    """A position of one or two axes as logged, and the velocity that is its rate once it is turned.

    Attributes
    ----------
    rows : (n,) array of int
        Of the log, in which all is known.
    time : (n,) array
        [s]
    seen : (n, a) array
        Position or heading, unwrapped. [m or deg]
    velocity, turn : (n,) complex arrays
        As logged, and by what it is turned: of surge and i sway by the heading. [m/s or deg/s, 1]
    """

    rows: np.ndarray
    time: np.ndarray
    seen: np.ndarray
    velocity: np.ndarray
    turn: np.ndarray

    def axes(self, series: np.ndarray) -> np.ndarray:
        """A complex series (n,) by the axes of the position, (n, a)."""
        return np.column_stack([np.real(series), np.imag(series)])[:, : self.seen.shape[1]]


def logged_position(log: dict) -> Logged:
    """Position with surge, sway and heading.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used.
    """
    rows = complete_rows(log, (*POSITION, *VELOCITY, "heading"))
    if not len(rows):
        return _EMPTY
    seen = np.column_stack([log[role][rows] for role in POSITION])
    velocity = log["surge"][rows] + 1j * log["sway"][rows]
    return Logged(
        rows, log["time"][rows], seen, velocity, np.exp(1j * np.radians(log["heading"][rows]))
    )


def logged_heading(log: dict) -> Logged:
    """Heading with the yaw rate; `log` as of `logged_position`."""
    rows = complete_rows(log, ("heading", "yaw_rate"))
    if not len(rows):
        return _EMPTY
    seen = np.degrees(unwrap_series(np.radians(log["heading"][rows])))[:, None]
    rate = log["yaw_rate"][rows].astype(complex)
    return Logged(rows, log["time"][rows], seen, rate, np.ones(len(rows)))


_EMPTY = Logged(np.zeros(0, int), np.zeros(0), np.zeros((0, 1)), np.zeros(0), np.zeros(0))


def position_motion(log: dict) -> Motion | None:
    """Positions against velocity turned by the heading; None where there is too little of them."""
    return _motion(logged_position(log))


def heading_motion(log: dict) -> Motion | None:
    """Relation of heading and yaw rate; None if there are too few rows."""
    return _motion(logged_heading(log))


def complete_rows(log: dict, roles: Sequence[str]) -> np.ndarray:
    """Rows in which all of some channels have a value; none where the log lacks one of them."""
    if not all(role in log for role in roles):
        return np.zeros(0, int)
    return np.flatnonzero(np.all([np.isfinite(log[role]) for role in roles], axis=0))


def _motion(logged):
    if len(logged.rows) < _FEWEST_ROWS:
        return None
    starts = after_gaps(logged.time) | jumps(logged.seen)
    velocity = logged.axes(logged.velocity * logged.turn)
    return Motion(logged.time, logged.seen, velocity, starts)


def after_gaps(time: np.ndarray) -> np.ndarray:
    """Rows before which more than so many usual steps are missing, the first row among them."""
    # The first row counts as after a gap, since the time before it is minus infinity.
    steps = np.diff(time, prepend=-np.inf)
    return steps > LONGEST_BRIDGE * np.median(steps[1:])


def jumps(seen: np.ndarray) -> np.ndarray:
    """Rows at which a position leaps and stays there: another reference, rows lost, channels exchanged."""
    # A leap differs from the median of its neighbours
    # by more than the usual scatter and their range.
    change = np.diff(seen, axis=0, prepend=seen[:1])
    leap = np.zeros(len(seen), bool)
    for axis in range(seen.shape[1]):
        change_here = change[:, axis]
        around = np.array([np.roll(change_here, k) for k in (-3, -2, -1, 1, 2, 3)])
        off = np.abs(change_here - np.median(around, axis=0))
        leap |= (
            off
            > 5.0 * quantile(off, 0.95) + 3.0 * np.ptp(np.sort(around, axis=0)[1:-1], axis=0) + 1e-9
        )
    return leap


@dataclass(frozen=True)
class Filter:
    """Kalman filter of a level: gains of each row and the standard deviation of the innovations.

    `ratio`: the variance of wander over noise that it is for; one of RATIOS.
    """

    gains: np.ndarray
    scale: np.ndarray
    std: float = 1.0
    ratio: float = 0.0

    def __call__(self, levels: np.ndarray) -> np.ndarray:
        """Innovations of levels (n, ...) in units of their standard deviation; 0 where a row starts again."""
        # The level that the filter predicts follows a linear recursion.
        # It is solved for all rows at once as a bidiagonal system.
        flat = levels.reshape(len(levels), -1)
        driven = np.vstack([flat[:1], self.gains[:-1, None] * flat[:-1]])
        before = np.append(
            0.0, self.gains[:-1] - 1.0
        )  # predicted[k + 1] - (1 - gain[k]) predicted[k] = driven[k + 1]
        innovations = flat - solve_tridiagonal(
            before, np.ones(len(flat)), np.zeros(len(flat)), driven
        )
        # Normalised innovations; rows that start anew have none.
        white = innovations / (self.std * self.scale)[:, None]
        white[self.gains >= 1.0] = 0.0
        return white.reshape(levels.shape)


def filter_for(motion: Motion, levels: np.ndarray | None = None) -> list[Filter]:
    """For each of several levels (n, a, k) the filter under which its innovations are most likely.

    The noise is taken from the calmer windows, so that a fault in a part of the log does not count as noise.
    """
    levels = motion.level[:, :, None] if levels is None else levels
    # Score each noise ratio by the mean log-likelihood of its innovations in calm windows.
    drafts = filters(motion.time, motion.starts)
    stds = np.zeros((len(drafts), levels.shape[2]))
    scores = np.zeros((len(drafts), levels.shape[2]))
    for number, draft in enumerate(drafts):
        settled = draft.gains < 1.0
        stds[number], calm = _spreads(draft(levels)[settled])
        scores[number] = -calm - np.mean(np.log(draft.scale[settled]))
    # The most likely ratio for each level.
    best = np.argmax(scores, axis=0)
    return [Filter(drafts[b].gains, drafts[b].scale, stds[b, k]) for k, b in enumerate(best)]


def filters(time: np.ndarray, starts: np.ndarray) -> tuple[Filter, ...]:
    """A filter for each of RATIOS.

    Parameters
    ----------
    time : (n,) array
    starts : (n,) array of bool
        Rows that cannot be compared with the one before.
    """
    # Steps in units of the usual one: wander grows with time.
    steps = np.diff(time, prepend=time[0])
    steps = steps / np.median(steps[1:])
    return _filters(tuple(steps.tolist()), tuple(starts.tolist()))


@lru_cache(maxsize=1)
def _filters(steps, starts):
    """Filters of steps in units of the usual one, kept as the next relation or label mostly has the same rows."""
    ratios = np.array(RATIOS)
    variance = np.ones(len(RATIOS))
    gains = np.ones((len(steps), len(RATIOS)))
    scale = np.ones((len(steps), len(RATIOS)))
    # Riccati recursion of the scalar Kalman filter, in units
    # of the measurement noise, for all ratios at once.
    for row, (step, anew) in enumerate(zip(steps, starts, strict=True)):
        if row == 0 or anew:
            variance = np.ones(len(RATIOS))
            continue
        # Innovation variance: prior variance, wander over the step, and
        # measurement noise of 1. The posterior variance equals the gain.
        total = variance + ratios * step + 1.0
        variance = np.minimum(1.0 - 1.0 / total, 1.0 - 1e-9)
        gains[row], scale[row] = variance, total
    return tuple(
        Filter(gains[:, k], np.sqrt(scale[:, k]), ratio=ratio) for k, ratio in enumerate(RATIOS)
    )


def _spreads(white):
    """Standard deviation in calm windows, and mean of its logarithm over the calmer ones, of (n, a, k): two of (k,)."""
    # Robust standard deviation (median absolute value) of each window.
    count = max(1, min(NOISE_WINDOWS, len(white) // 40))
    spreads = np.array(
        [normal_size(window, axis=(0, 1)) for window in np.array_split(white, count)]
    )
    spreads = np.sort(np.maximum(spreads, 1e-9), axis=0)
    # Scale from a quantile of the windows, and mean logarithm over the calmer 60 %.
    return np.quantile(spreads, 0.4, axis=0), np.mean(
        np.log(spreads[: max(1, int(0.6 * count))]), axis=0
    )


def whiteness(white: np.ndarray) -> float:
    """By how much to divide evidence because innovations (n, a) hang together, in the median window; 1 if white."""
    count = max(1, min(NOISE_WINDOWS, len(white) // 80))
    return float(np.median([_togetherness(window) for window in np.array_split(white, count)]))


def _togetherness(white):
    tame = np.clip(white, -4.0, 4.0)  # a part may have few rows
    # Integrated autocorrelation time: 1 + 2 times the sum
    # of the correlations; correlated rows count less.
    lags = range(1, min(WHITENESS_LAGS + 1, len(white)))
    power = np.mean(tame**2) + 1e-12
    products = (tame[lag:] * tame[:-lag] for lag in lags)
    together = [product.sum() / product.size / power for product in products]
    return max(1.0, 1.0 + 2.0 * sum(together))


def is_clear(motion: Motion, whitener: Filter) -> bool:
    """Whether the ship moves so much that the noise of its velocity hardly makes slopes on it too small."""
    moving = whitener.gains < 1.0
    slow = motion.slow(motion.velocity)
    # Noise of the velocity per unit of time, from gain and innovations of the filter.
    gain = np.median(whitener.gains[moving])
    std = whitener.std * np.median(whitener.scale[moving])
    wander = (gain * std) ** 2 / np.median(np.diff(motion.time))
    # A Gaussian kernel of width T leaves 1 / (2 sqrt(pi) T) of the density of white noise.
    return bool(np.mean(slow**2) > CLEAR_MOTION**2 * wander / (2.0 * np.sqrt(np.pi) * SLOW_MOTION))
