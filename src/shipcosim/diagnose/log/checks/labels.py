"""Navigation channels that are not what they are labelled: other sign, swapped, in another frame or unit.

Each hypothesis is a change of channels that would undo it. The innovations of position against velocity, or of heading
against rate, say for every row how much likelier the changed log is. A hypothesis is accepted only if it explains the
data: where it is said to be, the way seen must be about the way told under it, and clearly not as labelled.
"""

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.finding import Finding, Segment
from shipcosim.diagnose.log.checks.kinematics import (
    Filter,
    Motion,
    filter_for,
    heading_motion,
    is_clear,
    position_motion,
    whiteness,
)
from shipcosim.diagnose.log.checks.samples import quantum
from shipcosim.diagnose.log.mislabels import (
    HEADING_LABELS,
    POSITION_LABELS,
    Mislabel,
    finding_of,
    mislabel_in,
    possible,
    undone,
)
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log.thresholds import (
    CLEAR_LABEL_GAIN,
    LABEL_CLIP,
    LABEL_GAIN,
    LABEL_REACH,
    LABEL_SLOPE_FAR,
    LABEL_SLOPE_NEAR,
    LABEL_SLOPE_STD,
    LABEL_STEPS,
    SEGMENT_COST,
    SHORTEST_LABEL,
)
from shipcosim.diagnose.numerics import running_sums


@dataclass(frozen=True)
class _LabelHypothesis:
    """A mislabel, the evidence for it, where it is, and by how much its innovations hang together."""

    mislabel: Mislabel
    gain: float
    segment: Segment | None
    rough: float


def mislabelled(log: dict) -> tuple[list[Finding], dict]:
    """Navigation channels that are mislabelled in a part of a log, and the log with them put right.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; headings without jumps.
    """
    found = []
    # Heading before position, since velocities are turned by
    # it. Each comparison can have two mislabelled segments.
    for motion_of, labels in ((heading_motion, HEADING_LABELS), (position_motion, POSITION_LABELS)):
        for _ in range(2):
            finding = _best(log, motion_of, labels)
            if finding is None or not finding.segments:
                break
            log = undone(log, mislabel_in(finding), finding.segments)
            found.append(finding)
    return found, log


def _best(log, motion_of, labels):
    """The mislabel that explains most and explains it well, with its finding; None where there is none."""
    # Motion as labelled, and as it would be with each label undone.
    plain = motion_of(log)
    if plain is None:
        return None
    labels = possible(labels, log)
    others = [motion_of(log | label.undo(log)) for label in labels]
    # Innovations of each version under its own best filter give a log-likelihood for each row.
    levels = np.stack([plain.level, *(other.level for other in others)], axis=2)
    filters = filter_for(plain, levels)
    likely = np.stack([_log_likelihood(f, levels[:, :, k]) for k, f in enumerate(filters)], axis=1)
    hypotheses = []
    # For each label the segment in which undoing it gains
    # most, divided by the correlation of the innovations.
    for number, label in enumerate(labels, start=1):
        gain, segment = best_segment(plain.time, likely[:, number] - likely[:, 0])
        rough = whiteness(in_segment(filters[number](levels[:, :, number]), plain.time, segment))
        hypothesis = _LabelHypothesis(label, gain, segment, rough)
        # Besides the evidence, the motion must have the right slope under the hypothesis.
        if gain / rough > LABEL_GAIN and _explains(
            plain, others[number - 1], filters[number], hypothesis
        ):
            hypotheses.append(hypothesis)
    if not hypotheses:
        return None
    best = max(hypotheses, key=lambda hypothesis: hypothesis.gain)
    whitener = filters[1 + labels.index(best.mislabel)]
    # A unit changes the noise as well: if it is the same
    # outside the segment, the whole log is in that unit.
    if best.mislabel.scale is not None and _is_alike(log, best):
        best = replace(best, segment=None)
    return _finding(_refined(log, motion_of, whitener, best), best, hypotheses)


def _is_alike(log, hypothesis):
    """Whether the channels are as noisy outside a segment as inside, so that their unit is the same there."""
    if hypothesis.segment is None:
        return False
    # Second differences measure the noise of the channels inside and outside.
    here = inside(log["time"][2:], [hypothesis.segment])
    bends = np.mean(
        [np.abs(np.diff(log[role], n=2)) for role in hypothesis.mislabel.channels], axis=0
    )
    if (~here).sum() < 10:
        return True
    return bool(0.7 < np.nanmean(bends[~here]) / (np.nanmean(bends[here]) + 1e-12) < 1.4)


def _log_likelihood(whitener: Filter, level):
    """Of each row, with single rows counting only so much."""
    # Gaussian log-likelihood of the innovations, clipped against outliers.
    white = np.clip(whitener(level), -LABEL_CLIP, LABEL_CLIP)
    return -np.sum(0.5 * white**2 + np.log(whitener.std * whitener.scale)[:, None], axis=1)


def best_segment(time: np.ndarray, gains: np.ndarray) -> tuple[float, Segment | None]:
    """Where gains of rows add up to most: in all (None), or in a segment, less the cost of choosing it.

    Parameters
    ----------
    time, gains : (n,) arrays
        Of each row. [s, nats]
    """
    # Maximum subarray: the largest rise of the cumulated gains, by the running minimum.
    total = running_sums(gains)
    lowest = np.minimum.accumulate(total)
    last = int(np.argmax(total - lowest))
    first = int(np.argmin(total[: last + 1]))
    part = total[last] - total[first] - SEGMENT_COST
    # The whole log is preferred unless a segment gains more than its cost.
    if total[-1] >= part or last <= first or time[last - 1] - time[first] < SHORTEST_LABEL:
        return float(total[-1]), None
    return float(part), (float(time[first]), float(time[last - 1]))


def in_segment(values: np.ndarray, time: np.ndarray, segment: Segment | None) -> np.ndarray:
    """The rows within a segment; all if there is none."""
    return values if segment is None else values[(time >= segment[0]) & (time <= segment[1])]


def _explains(plain: Motion, other: Motion, whitener: Filter, hypothesis) -> bool:
    """Whether the way seen is the way told under the hypothesis, and is not as labelled.

    Noise in the velocity makes slopes too small, for a ship that hardly moves by half. That leaves signs and swapped
    channels clear, but not units.
    """
    if not _is_above_resolution(plain, other, hypothesis.segment):
        return False
    channels = hypothesis.mislabel.channels
    is_unit = hypothesis.mislabel.scale is not None
    # Slopes of the observed on the reported motion, with the label undone and as logged.
    under = _slopes(other, channels, whitener, hypothesis.segment)
    given = _slopes(plain, channels, whitener, hypothesis.segment)
    # Units need slopes close to 1, and motion well above the noise, which
    # attenuates slopes. Signs and swaps need only the right sign and size.
    lowest, highest = (1.0 - LABEL_SLOPE_NEAR, 1.0 + LABEL_SLOPE_NEAR) if is_unit else (0.3, 1.7)
    if is_unit and not is_clear(other, whitener, hypothesis.segment):
        return False
    # Near 1 with the label undone, precise, and clearly farther from 1 as labelled.
    near = [lowest < slope < highest or abs(slope - 1.0) < 2.0 * std for slope, std in under]
    sure = [std < LABEL_SLOPE_STD for _, std in under]
    apart = [
        abs(was - now) > max(LABEL_SLOPE_FAR, 4.0 * std) and abs(was - 1.0) > abs(now - 1.0)
        for (was, std), (now, _) in zip(given, under, strict=True)
    ]
    # Very clear evidence replaces the distance from the labelled slopes.
    clear = hypothesis.gain > CLEAR_LABEL_GAIN and hypothesis.rough < 1.5 and all(sure)
    return all(near) and (clear or any(a and s for a, s in zip(apart, sure, strict=True)))


def _is_above_resolution(plain: Motion, other: Motion, segment) -> bool:
    """Whether a label changes what is left of the way by more than steps of what is seen.

    Where a ship hardly moves, a coarse position stays the same, and what the velocity adds up to is rounding.
    """
    apart = in_segment(other.level - plain.level, plain.time, segment)
    steps = np.array([quantum(axis) for axis in plain.seen.T])
    return bool((np.ptp(apart, axis=0) > LABEL_STEPS * steps).any())


def _slopes(motion: Motion, channels, whitener: Filter, segment):
    """Slope of the way seen on the slow way told by each channel, with standard deviation."""
    # Regressors: the way by each channel, from its smoothed velocity.
    ways = [motion.way(motion.slow(motion.parts[role])) for role in channels]
    # Whiten observed and reported motion with the same filter, so that least squares is efficient.
    white = whitener(np.stack([motion.seen, *ways], axis=2))
    white = in_segment(white, motion.time, segment).reshape(-1, 1 + len(ways))
    y = white[:, 0]
    x = white[:, 1:]
    # Ordinary least squares; the pseudo-inverse allows for channels without motion.
    spread = np.linalg.pinv(x.T @ x + 1e-9 * np.eye(len(ways)))
    slopes = spread @ (x.T @ y)
    # Standard errors from the clipped residuals.
    rest = np.clip(y - x @ slopes, -LABEL_CLIP, LABEL_CLIP)
    return list(
        zip(slopes.tolist(), np.sqrt(np.mean(rest**2) * np.diag(spread)).tolist(), strict=True)
    )


def _refined(log, motion_of, whitener, best):
    """The segment with each end where the log with it undone is likeliest and leaps least; None for the whole log."""
    if best.segment is None:
        return None
    motion = motion_of(log)
    ends = [int(i) for i in np.searchsorted(log["time"], best.segment)]
    # Rows at which the position leaps are candidates too: a wrong label makes leaps at its ends.
    leaps = np.searchsorted(log["time"], motion.time[motion.starts])
    # Move one end at a time over all rows near it.
    for end in (0, 1):
        places = sorted(
            {*range(ends[end] - LABEL_REACH, ends[end] + LABEL_REACH + 1), *(leaps - end)}
        )
        places = [
            k
            for k in places
            if 0 <= k < len(log["time"]) and (k < ends[1] if end == 0 else k > ends[0])
        ]
        segments = [log["time"][[k, ends[1]] if end == 0 else [ends[0], k]] for k in places]
        # Cost of each place: squared innovations with the label
        # undone there, and a penalty for each leap that is left.
        tried = [motion_of(undone(log, best.mislabel, [one])) for one in segments]
        white = np.clip(
            whitener(np.stack([one.level for one in tried], axis=2)), -LABEL_CLIP, LABEL_CLIP
        )
        left = LABEL_CLIP**2 * np.array([one.starts.sum() for one in tried])
        ends[end] = places[int(np.argmin(np.sum(white**2, axis=(0, 1)) + left))]
    return tuple(float(t) for t in log["time"][ends])


def _finding(segment, best, hypotheses):
    rough = max(s.rough for s in hypotheses)
    # Posterior against the null hypothesis and all other labels.
    others = [(s.gain - best.gain) / rough for s in hypotheses if s is not best]
    probability = float(
        1.0 / (1.0 + np.exp(LABEL_GAIN - 6.0 - best.gain / best.rough) + np.sum(np.exp(others)))
    )
    return finding_of(best.mislabel, probability, segment)
