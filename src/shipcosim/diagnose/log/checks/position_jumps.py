"""Positions that jump and stay there, as where a receiver takes another reference or loses its corrections.

What is seen less the way made by the velocity is a level that changes slowly. A line through the rows before a place
and one through the rows behind it meet there, unless the position jumps between both.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.log.checks.kinematics import (
    after_gaps,
    complete_rows,
    jumps,
    logged_heading,
    position_motion,
)
from shipcosim.diagnose.log.mislabels import Mislabel, finding_of
from shipcosim.diagnose.log.roles import POSITION
from shipcosim.diagnose.log.thresholds import (
    JUMP_AT_ONCE,
    JUMP_OVER_USUAL,
    JUMP_ROWS,
    MOST_JUMPS,
    MOST_SURE,
    ON_HER_WAY,
)
from shipcosim.diagnose.numerics import normal_size, quantile, running_sums, trapezium


def position_jumps(log: dict) -> list[Finding]:
    """One finding of all places at which the position jumps to stay, or none.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; labels corrected.
    """
    time, level, velocity = _level(log)
    if len(time) < 10 * max(JUMP_ROWS):
        return []
    # As many rows to either side as leave the least: over many the noise averages out, over few the ship hardly turns.
    starts = after_gaps(time)
    steps = min(
        (_steps(level, starts, count) for count in JUMP_ROWS),
        key=lambda steps: quantile(np.hypot(*steps.T), 0.95),
    )
    size = np.hypot(*steps.T)
    # It jumps where this is many times what is usual, and from one row to the next.
    at_once = np.hypot(*np.diff(level, axis=0, prepend=level[:1]).T)
    leaps = (size > JUMP_OVER_USUAL * quantile(size, 0.95)) & (at_once > JUMP_AT_ONCE * size)
    rows = [row for row in np.flatnonzero(leaps) if size[row] == size[_near(row)].max()]
    # What leaps again and again is no other reference.
    if not 0 < len(rows) <= MOST_JUMPS:
        return []
    # Where rows were lost that the clock does not show, she leaps along her way, or her heading leaps too.
    if any(_is_on_her_way(steps[row], velocity[_near(row)]) for row in rows):
        return []
    heading = logged_heading(log)
    if len(heading.rows) and np.isin(time[rows], heading.time[jumps(heading.seen)]).any():
        return []
    return [_finding(log, time[rows], steps[rows], normal_size(steps))]


def _near(row):
    return slice(max(row - max(JUMP_ROWS), 0), row + max(JUMP_ROWS))


def _is_on_her_way(step, velocity):
    """Whether a step (2,) goes as the ship goes, by her velocities (k, 2) around it."""
    usual = np.median(velocity, axis=0)
    return step @ usual > ON_HER_WAY * np.hypot(*step) * np.hypot(*usual)


def _level(log):
    """Times, the position less the way by the velocity (n, 2), and the velocity; without one the position itself."""
    motion = position_motion(log)
    if motion is not None:
        # By the trapezium: a spline overshoots where a velocity has a spike.
        way = trapezium(motion.velocity, np.diff(motion.time)[:, None])
        return motion.time, motion.seen - way, motion.velocity
    rows = complete_rows(log, POSITION)
    seen = (
        np.stack([log[role][rows] for role in POSITION], axis=1) if len(rows) else np.zeros((0, 2))
    )
    return log["time"][rows], seen, np.diff(seen, axis=0, append=seen[-1:])


def _steps(level, starts, count):
    """By how much a level (n, 2) jumps at each row, between lines through some rows before and from there on."""
    # Weights that continue a line by half a row beyond its rows.
    away = np.arange(count) + 0.5
    rest = away - away.mean()
    weights = 1.0 / count - away.mean() * rest / np.sum(rest**2)
    steps = np.zeros_like(level)
    windows = np.lib.stride_tricks.sliding_window_view(level, 2 * count, axis=0)
    inner = slice(count, len(level) - count + 1)
    steps[inner] = windows @ np.concatenate([-weights[::-1], weights])
    # No line goes across a gap.
    lost = running_sums(starts)
    first = np.arange(len(level)) - count + 1
    last = np.minimum(first + 2 * count - 1, len(level))
    steps[lost[last] > lost[np.maximum(first, 0)]] = 0.0
    return steps


def _finding(log, times, steps, noise):
    """The finding that the position jumps by steps (k, 2) [m] at some times [s]."""
    sizes = np.hypot(*steps.T)
    largest = int(np.argmax(sizes))
    where = f"by {sizes[largest]:.3g} m at {times[largest]:.6g} s"
    note = (
        f"north and east jump {where}"
        if len(times) == 1
        else (f"north and east jump {len(times)} times, most {where}")
    )
    label = Mislabel("position_jump", POSITION, note, partial(_moved_back, times, steps))
    fault = finding_of(label, MOST_SURE, (float(times[0]), float(log["time"][-1])))
    jump = ParameterEstimate(float(sizes[largest]), float(noise), "m")
    return replace(fault, parameters={"jump": jump})


def _moved_back(times, steps, log):
    """Positions without the steps that they made up to each row."""
    past = np.searchsorted(times, log["time"], side="right")
    moved = np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])[past]
    return {role: log[role] - moved[:, i] for i, role in enumerate(POSITION)}
