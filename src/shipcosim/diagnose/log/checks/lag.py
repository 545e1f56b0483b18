"""Channels that come later than others: headings against yaw rates, positions against velocities.

A velocity that comes late by a lag tells the way made that long before; a late position is the way up to then. For every
lag the level between what is seen and the way told leaves innovations. The right lag leaves the smallest.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.finding import Finding, ParameterEstimate, Segment
from shipcosim.diagnose.log.checks.kinematics import (
    Logged,
    Motion,
    after_gaps,
    filter_for,
    jumps,
    logged_heading,
    logged_position,
    whiteness,
)
from shipcosim.diagnose.log.checks.segments import best_segment
from shipcosim.diagnose.log.mislabels import finding_of, late, undone
from shipcosim.diagnose.log.roles import POSITION, VELOCITY
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
    findings = []
    relations = (
        (logged_heading, ("heading",), ("yaw_rate",)),
        (logged_position, POSITION, VELOCITY),
    )
    for logged_by, position, velocity in relations:
        lag = _lag(logged_by(log))
        if lag is None:
            continue
        # No sensor is early: the later of both is late.
        channels, others = (velocity, position) if lag.seconds > 0.0 else (position, velocity)
        size = ParameterEstimate(abs(lag.seconds), lag.std, "s")
        finding = finding_of(late(channels, others, size.estimate), MOST_SURE, lag.segment)
        findings.append(replace(finding, parameters={"lag": size}))
        # The corrected heading turns the velocities that are compared next.
        log = undone(log, finding.mislabel, finding.segments)
    return findings


def _way(logged: Logged, lag: float) -> np.ndarray:
    """The way told (n, a) if the velocity comes late by `lag`, or below 0 the position by as much. [s]"""
    time = logged.time
    velocity = np.interp(time + max(lag, 0.0), time, logged.velocity)
    way = spline_integral(time, velocity * logged.turn)
    return logged.axes(np.interp(time + min(lag, 0.0), time, way))


def _lag(logged: Logged) -> _Lag | None:
    """The lag that makes a log likeliest; None where none is large and clear enough."""
    if len(logged.time) < 2:
        return None
    time = logged.time
    step = float(np.median(np.diff(time)))
    spacing = max(step, LAG_SPACING)
    lags = spacing * np.arange(-np.floor(LARGEST_LAG / spacing), LARGEST_LAG / spacing)
    # Few enough rows, for which the way is known at all lags.
    rows = np.flatnonzero((time > time[0] + LARGEST_LAG) & (time < time[-1] - LARGEST_LAG))
    rows = rows[:: int(np.ceil(len(time) / MOST_FITTED))]
    if len(rows) < 2 * len(lags):
        return None
    time = time[rows]
    white, rival = _white(logged, rows, lags)
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
    rough = whiteness(logged.axes(rest))
    gain = min(gains[here, best].sum(), 0.5 * np.sum(otherwise - squares[here, best])) / rough
    is_noise = squares[here, best].mean() < NOISIER * logged.seen.shape[1] and rough < ROUGHEST
    is_clear = gain - (SEGMENT_COST if segment else 0.0) > LAG_GAIN
    if not (0 < best < len(lags) - 1 and is_noise and is_clear):
        return None
    # A parabola through the gains of the neighbours has its top at the estimate, and its width is the error.
    before, top, after = gains[here, best - 1 : best + 2].sum(axis=0) / rough
    bend = 2.0 * top - before - after
    seconds = lags[best] + 0.5 * spacing * (after - before) / bend
    if abs(seconds) < max(SMALLEST_LAG, SMALLEST_LAG_ROWS * step):
        return None
    if segment is not None and segment[1] > logged.time[-1] - 2.0 * LARGEST_LAG:
        segment = segment[0], float(logged.time[-1])
    return _Lag(float(seconds), float(spacing / np.sqrt(bend)), segment)


def _white(logged, rows, lags):
    """What each lag leaves of some rows, (n, k), and way and turn without a lag, (n, 2), as complex white noise."""
    time = logged.time[rows]
    seen = logged.seen[rows]
    axes = seen.shape[1]
    levels = np.stack([seen - _way(logged, lag)[rows] for lag in lags], axis=2)
    starts = after_gaps(time) | jumps(seen)
    whiteners = filter_for(Motion(time, seen, seen, starts), levels)
    # The filter of the lag that leaves least is that of the log's noise.
    noise = [
        np.mean(np.log(whitener.std * whitener.scale[whitener.gains < 1.0]))
        for whitener in whiteners
    ]
    turn = logged.axes(logged.turn)[rows]
    series = np.dstack([levels, _way(logged, 0.0)[rows], turn])
    white = whiteners[int(np.argmin(noise))](series)
    white = white[:, 0] + (1j * white[:, 1] if axes == 2 else 0.0)
    return white[:, :-2], white[:, -2:]


def _squares(white):
    """Squares of white noise; single rows count only so much."""
    return np.minimum(np.abs(white), LABEL_CLIP) ** 2
