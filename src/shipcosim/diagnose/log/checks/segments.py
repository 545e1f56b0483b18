"""Where a fault of a part of a log begins and ends, by what each row gains with the fault undone."""

import numpy as np

from shipcosim.diagnose.finding import Segment
from shipcosim.diagnose.log.checks.kinematics import filter_for, heading_motion, position_motion
from shipcosim.diagnose.log.mislabels import Mislabel, undone
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log.thresholds import (
    LABEL_CLIP,
    LABEL_REACH,
    SEGMENT_COST,
    SHORTEST_LABEL,
)
from shipcosim.diagnose.numerics import running_sums


def best_segment(
    time: np.ndarray, gains: np.ndarray, shortest: float = SHORTEST_LABEL
) -> tuple[float, Segment | None]:
    """Where gains of rows add up to most: in all (None), or in a segment, less the cost of choosing it.

    Parameters
    ----------
    time, gains : (n,) arrays
        Of each row. [s, nats]
    shortest : float
        Shortest segment. [s]
    """
    # Maximum subarray: the largest rise of the cumulated gains, by the running minimum.
    total = running_sums(gains)
    lowest = np.minimum.accumulate(total)
    last = int(np.argmax(total - lowest))
    first = int(np.argmin(total[: last + 1]))
    part = total[last] - total[first] - SEGMENT_COST
    # The whole log is preferred unless a segment gains more than its cost.
    if total[-1] >= part or last <= first or time[last - 1] - time[first] < shortest:
        return float(total[-1]), None
    return float(part), (float(time[first]), float(time[last - 1]))


def in_segment(values: np.ndarray, time: np.ndarray, segment: Segment | None) -> np.ndarray:
    """The rows within a segment; all if there is none."""
    return values[inside(time, [segment] if segment else [])]


def refined(log: dict, mislabel: Mislabel, segment: Segment) -> Segment:
    """A segment whose ends are the likeliest for a mislabel; the corrected log leaps least there.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used.
    mislabel : Mislabel
    segment : (float, float)
        [s]
    """
    motion_of = heading_motion if mislabel.channels == ("yaw_rate",) else position_motion
    motion = motion_of(log)
    if motion is None:
        return segment
    time = log["time"]
    right = motion_of(undone(log, mislabel, [segment])) or motion
    # What was rounded away in a unit that is too large leaves no rows whose places could be compared.
    if len(right.time) < len(motion.time):
        return segment
    whitener = filter_for(right)[0]
    ends = [int(i) for i in np.searchsorted(time, segment)]
    # Rows at which the position leaps are candidates too: a wrong label makes leaps at its ends.
    leaps = np.searchsorted(time, motion.time[motion.starts])
    # Move one end at a time over all rows near it.
    for end in (0, 1):
        near = range(ends[end] - LABEL_REACH, ends[end] + LABEL_REACH + 1)
        low, high = (0, ends[1]) if end == 0 else (ends[0] + 1, len(time))
        places = [k for k in sorted({*near, *(leaps - end)}) if low <= k < high]
        segments = [time[[k, ends[1]] if end == 0 else [ends[0], k]] for k in places]
        # Cost of each place: squared innovations with the label
        # undone there, and a penalty for each leap that is left.
        changed = [motion_of(undone(log, mislabel, [candidate])) for candidate in segments]
        # A place at which other rows can be compared has no cost that could be held against the others.
        kept = [
            (place, motion)
            for place, motion in zip(places, changed, strict=True)
            if motion is not None and len(motion.time) == len(right.time)
        ]
        if not kept:
            continue
        places, tried = zip(*kept, strict=True)
        levels = np.stack([motion.level for motion in tried], axis=2)
        white = np.clip(whitener(levels), -LABEL_CLIP, LABEL_CLIP)
        left = LABEL_CLIP**2 * np.array([motion.starts.sum() for motion in tried])
        ends[end] = places[int(np.argmin(np.sum(white**2, axis=(0, 1)) + left))]
    return float(time[ends[0]]), float(time[ends[1]])
