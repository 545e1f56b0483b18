"""Navigation channels that are not what they are labelled: other sign, swapped, in another frame or unit.

Each suspect is a change of channels that would undo it. The innovations of position against velocity, or of heading
against rate, say for every row how much likelier the changed log is. A suspect is accepted only if it explains the
data: where it is said to be, the way seen must be about the way told under it, and clearly not as labelled.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.mislabels import HEADING_LABELS, POSITION_LABELS, Mislabel, mislabel_of
from shipcosim.diagnose.motion import Filter, Motion, filter_for, heading_motion, position_motion, whiteness
from shipcosim.diagnose.repair import inside

__all__ = ["mislabelled", "undone"]

LEAST_GAIN = 14.0  # nats, of the whole log
SEGMENT_COST = 10.0  # nats, for the choice of both ends
CLIP = 5.0  # standard deviations beyond which an innovation counts no more
NEAR, FAR = 0.3, 0.35  # slopes nearer to 1 than this agree, farther off they do not
SHORTEST = 60.0  # [s] of a segment
REACH = 25  # rows on both sides in which an end of a segment is sought


@dataclass(frozen=True)
class _Suspect:
    """A mislabel, the evidence for it and where it is."""

    mislabel: Mislabel
    gain: float
    segment: tuple[float, float] | None


def mislabelled(log: dict) -> tuple[list[Finding], dict]:
    """Mislabelled navigation channels, and the log with them put right.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; headings without jumps.
    """
    found = []
    for motion_of, labels in ((heading_motion, HEADING_LABELS), (position_motion, POSITION_LABELS)):
        for _ in range(2):
            finding = _best(log, motion_of, labels)
            if finding is None:
                break
            log = undone(log, mislabel_of(finding), finding.segments)
            found.append(finding)
    return found, log


def undone(log: dict, mislabel: Mislabel, segments) -> dict:
    """The log with a mislabel undone in some segments, or throughout."""
    changed, here = mislabel.undo(log), inside(log["time"], segments)
    return log | {role: np.where(here, values, log[role]) for role, values in changed.items()}


def _best(log, motion_of, labels):
    """The mislabel that explains most and explains it well, with its finding; None where there is none."""
    plain = motion_of(log)
    if plain is None:
        return None
    labels = [label for label in labels if set(label.channels) <= set(log)]
    others = [motion_of(log | label.undo(log)) for label in labels]
    levels = np.stack([plain.level, *(other.level for other in others)], axis=2)
    filters = filter_for(plain, levels)
    likely = np.stack([_log_likelihood(f, levels[:, :, k]) for k, f in enumerate(filters)], axis=1)
    suspects = []
    for number, label in enumerate(labels, start=1):
        suspect = _located(plain.time, likely[:, number] - likely[:, 0], label)
        if suspect is None:
            continue
        rough = whiteness(_inside(filters[number](levels[:, :, number]), plain.time, suspect.segment))
        suspect = _Suspect(label, suspect.gain / rough, suspect.segment)
        if suspect.gain > LEAST_GAIN and _explains(plain, others[number - 1], filters[number], suspect):
            suspects.append(suspect)
    if not suspects:
        return None
    best = max(suspects, key=lambda suspect: suspect.gain)
    whitener = filters[1 + labels.index(best.mislabel)]
    return _finding(_refined(log, motion_of, whitener, best), best, suspects)


def _log_likelihood(whitener: Filter, level):
    """Of each row, with single rows counting only so much."""
    white = np.clip(whitener(level), -CLIP, CLIP)
    return -np.sum(0.5 * white**2 + np.log(whitener.std * whitener.scale)[:, None], axis=1)


def _located(time, gains, label):
    """Where a suspect gains most: throughout, or in the segment that gains more than the cost of choosing it."""
    total = np.r_[0.0, np.cumsum(gains)]
    lowest = np.minimum.accumulate(total)
    last = int(np.argmax(total - lowest))
    first = int(np.argmin(total[: last + 1]))
    whole, part = total[-1], total[last] - total[first] - SEGMENT_COST
    if whole >= part:
        return _Suspect(label, whole, None) if whole > 0.0 else None
    if last <= first or time[last - 1] - time[first] < SHORTEST:
        return None
    return _Suspect(label, part, (float(time[first]), float(time[last - 1])))


def _inside(values, time, segment):
    if segment is None:
        return values
    return values[(time >= segment[0]) & (time <= segment[1])]


def _explains(plain: Motion, other: Motion, whitener: Filter, suspect) -> bool:
    """Whether the way seen is the way told under the suspect, and is not as labelled."""
    under = _slopes(other, whitener, suspect.segment)
    given = _slopes(plain, whitener, suspect.segment)
    near = [abs(slope - 1.0) < max(NEAR, 3.0 * std) for slope, std in under]
    sure = [std < 0.2 for _, std in under]
    far = [abs(slope - 1.0) > FAR and abs(slope - 1.0) > 4.0 * std for slope, std in given]
    return all(near) and any(sure) and any(far)


def _slopes(motion: Motion, whitener: Filter, segment):
    """Slope of the way seen on the way told along each axis, with standard deviation."""
    slopes = []
    white_seen, white_way = whitener(motion.seen), whitener(motion.way())
    for axis in range(motion.seen.shape[1]):
        y, x = (_inside(white[:, axis], motion.time, segment) for white in (white_seen, white_way))
        energy = max(float(x @ x), 1e-12)
        slope = float(x @ y) / energy
        rest = np.clip(y - slope * x, -CLIP, CLIP)
        slopes.append((slope, float(np.sqrt(np.mean(rest**2) / energy)) + 1e-6))
    return slopes


def _refined(log, motion_of, whitener, best):
    """The segment with each end where the log with it undone is likeliest; None for the whole log."""
    segment = best.segment
    for end in (0, 1) if segment else ():
        places = log["time"][np.abs(log["time"] - segment[end]) <= REACH * np.median(np.diff(log["time"]))]
        tries = [(t, segment[1]) if end == 0 else (segment[0], t) for t in places]
        levels = np.stack([motion_of(undone(log, best.mislabel, [one])).level for one in tries], axis=2)
        white = np.clip(whitener(levels), -CLIP, CLIP)
        segment = tries[int(np.argmin(np.sum(white**2, axis=(0, 1))))]
    return tuple(float(t) for t in segment) if segment else None


def _finding(segment, best, suspects):
    others = [s.gain - best.gain for s in suspects if s is not best]
    probability = float(1.0 / (1.0 + np.exp(LEAST_GAIN - 6.0 - best.gain) + np.sum(np.exp(others))))
    segments = (segment,) if segment else ()
    label = best.mislabel
    return Finding(label.cause, None, "data", probability, {}, segments, label.channels, note=label.sentence)
