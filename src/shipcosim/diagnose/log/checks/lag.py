"""Channels that come later than others: headings against yaw rates, positions against velocities.

A velocity that comes late by a lag tells the way made that long before; a late position is the way up to then. For every
lag the level between what is seen and the way told leaves innovations. The right lag leaves the smallest.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.finding import Finding, ParameterEstimate, Segment
from shipcosim.diagnose.log.checks.kinematics import (
    Motion,
    after_gaps,
    complete_rows,
    filter_for,
    jumps,
    whiteness,
)
from shipcosim.diagnose.log.checks.segments import best_segment
from shipcosim.diagnose.log.mislabels import POSITION, VELOCITY, finding_of, late, undone
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log.thresholds import (
    LABEL_CLIP,
    LAG_GAIN,
    LAG_SPACING,
    LARGEST_LAG,
    MOST_FITTED,
    MOST_SURE,
    NOISIER,
    ROUGHEST,
    SEGMENT_COST,
    SMALLEST_LAG,
    SMALLEST_LAG_ROWS,
)
from shipcosim.diagnose.numerics import spline_integral


@dataclass(frozen=True)
class _Pair:
    """A position (n, a), and the velocity (n,) that is its rate once it is turned, as complex numbers."""

    time: np.ndarray
    seen: np.ndarray
    velocity: np.ndarray
    turn: np.ndarray

    def way(self, lag: float) -> np.ndarray:
        """The way told (n, a) if the velocity comes late by `lag`, or below 0 the position by as much. [s]"""
        velocity = np.interp(self.time + max(lag, 0.0), self.time, self.velocity)
        way = spline_integral(self.time, velocity * self.turn)
        way = np.interp(self.time + min(lag, 0.0), self.time, way)
        return np.column_stack([way.real, way.imag])[:, : self.seen.shape[1]]


class _Lag(NamedTuple):
    """By how much a velocity comes later than its position [s], with its standard deviation, and where."""

    seconds: float
    std: float
    segment: Segment | None


def late_channels(log: dict) -> list[Finding]:
    """Channels that come later than those of which they are the rate or the integral, the heading first.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; labels corrected.
    """
    found = []
    pairs = ((_heading, ("heading",), ("yaw_rate",)), (_position, POSITION, VELOCITY))
    for pair_of, position, velocity in pairs:
        lag = _lag(pair_of(log))
        if lag is None:
            continue
        # No sensor is early: the later of both is late.
        channels, others = (velocity, position) if lag.seconds > 0.0 else (position, velocity)
        size = ParameterEstimate(abs(lag.seconds), lag.std, "s")
        finding = finding_of(late(channels, others, size.estimate), MOST_SURE, lag.segment)
        found.append(replace(finding, parameters={"lag": size}))
        # The corrected heading turns the velocities that are compared next.
        log = undone(log, finding.mislabel, finding.segments)
    return found


def _heading(log):
    rows = complete_rows(log, ("heading", "yaw_rate"))
    if not len(rows):
        return None
    seen = np.degrees(unwrap_series(np.radians(log["heading"][rows])))[:, None]
    rate = log["yaw_rate"][rows].astype(complex)
    return _Pair(log["time"][rows], seen, rate, np.ones(len(rows)))


def _position(log):
    rows = complete_rows(log, (*POSITION, *VELOCITY, "heading"))
    if not len(rows):
        return None
    seen = np.column_stack([log[role][rows] for role in POSITION])
    velocity = (log["surge"] + 1j * log["sway"])[rows]
    turn = np.exp(1j * np.radians(log["heading"][rows]))
    return _Pair(log["time"][rows], seen, velocity, turn)


def _lag(pair: _Pair | None) -> _Lag | None:
    """The lag that makes a log likeliest; None where none is large and clear enough."""
    if pair is None or len(pair.time) < 2:
        return None
    time = pair.time
    step = float(np.median(np.diff(time)))
    spacing = max(step, LAG_SPACING)
    lags = spacing * np.arange(-np.floor(LARGEST_LAG / spacing), LARGEST_LAG / spacing)
    # Few enough rows, for which the way is known at all lags.
    rows = np.flatnonzero((time > time[0] + LARGEST_LAG) & (time < time[-1] - LARGEST_LAG))
    rows = rows[:: int(np.ceil(len(time) / MOST_FITTED))]
    if len(rows) < 2 * len(lags):
        return None
    time = time[rows]
    white, rival = _white(pair, rows, lags)
    squares = _squares(white)
    none = int(np.argmin(np.abs(lags)))
    gains = 0.5 * (squares[:, [none]] - squares)
    # The lag and the part of the log that explain most.
    judged = [best_segment(time, of_lag) for of_lag in gains.T]
    best = int(np.argmax([gain for gain, _ in judged]))
    segment = judged[best][1]
    here = inside(time, [segment] if segment else [])
    # The rival: the way is turned or has another scale, and the position is of another place of the ship. In a steady
    # turn, or at a steady speed, that looks like a lag.
    explained = np.linalg.lstsq(rival[here], white[here, none], rcond=None)[0]
    otherwise = _squares(white[here, none] - rival[here] @ explained)
    # What the lag leaves is white noise as elsewhere; of another fault it would explain a part only.
    rest = white[here, best]
    rough = whiteness(np.column_stack([rest.real, rest.imag])[:, : pair.seen.shape[1]])
    gain = min(gains[here, best].sum(), 0.5 * np.sum(otherwise - squares[here, best])) / rough
    is_noise = squares[here, best].mean() < NOISIER * pair.seen.shape[1] and rough < ROUGHEST
    is_clear = gain - (SEGMENT_COST if segment else 0.0) > LAG_GAIN
    if not (0 < best < len(lags) - 1 and is_noise and is_clear):
        return None
    # A parabola through the gains of the neighbours has its top at the estimate, and its width is the error.
    before, top, after = gains[here, best - 1 : best + 2].sum(axis=0) / rough
    bend = 2.0 * top - before - after
    seconds = lags[best] + 0.5 * spacing * (after - before) / bend
    if abs(seconds) < max(SMALLEST_LAG, SMALLEST_LAG_ROWS * step):
        return None
    if segment is not None and segment[1] > pair.time[-1] - 2.0 * LARGEST_LAG:
        segment = segment[0], float(pair.time[-1])
    return _Lag(float(seconds), float(spacing / np.sqrt(bend)), segment)


def _white(pair, rows, lags):
    """What each lag leaves of some rows, (n, k), and way and turn without a lag, (n, 2), as complex white noise."""
    time = pair.time[rows]
    seen = pair.seen[rows]
    axes = seen.shape[1]
    levels = np.stack([seen - pair.way(lag)[rows] for lag in lags], axis=2)
    starts = after_gaps(time) | jumps(seen)
    whiteners = filter_for(Motion(time, seen, seen, starts), levels)
    # The filter of the lag that leaves least is that of the log's noise.
    noise = [np.mean(np.log(one.std * one.scale[one.gains < 1.0])) for one in whiteners]
    turn = np.column_stack([pair.turn.real, pair.turn.imag])[rows, :axes]
    series = np.dstack([levels, pair.way(0.0)[rows], turn])
    white = whiteners[int(np.argmin(noise))](series)
    white = white[:, 0] + (1j * white[:, 1] if axes == 2 else 0.0)
    return white[:, :-2], white[:, -2:]


def _squares(white):
    """Squares of white noise; single rows count only so much."""
    return np.minimum(np.abs(white), LABEL_CLIP) ** 2
