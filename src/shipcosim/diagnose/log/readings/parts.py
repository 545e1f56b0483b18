"""Labels that are wrong in a part of a log: where they begin and end, and whether the part alone says so.

A mistake predicts a form and a factor of each relation, so it leaves another difference between observed and reported
change. For every row that says how much likelier the log is with the mistake. Where this adds up to most is the part. It is
then judged as a log of its own, by all relations; a mistake in a part costs as much more as the choice of both ends.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.finding import Finding, Segment
from shipcosim.diagnose.log.checks.kinematics import after_gaps, filters, jumps, whiteness
from shipcosim.diagnose.log.checks.samples import quantum
from shipcosim.diagnose.log.checks.segments import best_segment, refined
from shipcosim.diagnose.log.mislabels import Mislabel, finding_of, undone
from shipcosim.diagnose.log.readings.changes import (
    STATED,
    LogInterpretation,
    LogMistake,
    changes,
)
from shipcosim.diagnose.log.readings.fit import thinned
from shipcosim.diagnose.log.readings.reading import misread
from shipcosim.diagnose.log.readings.relations import RowsOfRelation, rows_of_relations
from shipcosim.diagnose.log.rows import inside, usual_step
from shipcosim.diagnose.log.thresholds import (
    CALM_PARTS,
    FEWEST_FITTED,
    LABEL_CLIP,
    LABEL_GAIN,
    LABEL_ROWS,
    MOST_LABELS,
    MOST_PARTS,
    NOISE_SHARE,
    NOISE_WINDOWS,
    RARE_LABEL,
    SEGMENT_COST,
    SHORTEST_LABEL,
    SHORTEST_WRONG,
)


@dataclass(frozen=True)
class _Part:
    """A part of a log with a mislabel, and by how much that makes the log likelier. [nats]"""

    gain: float
    mislabel: Mislabel
    segment: Segment


@dataclass(frozen=True)
class _Noise:
    """A noise by how likely it is [nats a row], its standard deviation, and by how much its rows hang together."""

    score: float
    std: float = 1.0
    rough: float = 1.0


def mislabelled(log: dict, stated: dict[str, str]) -> tuple[list[Finding], dict]:
    """Navigation channels that are mislabelled in a part of a log, and the corrected log.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used.
    stated : dict of str to str
        Units that headers or a channel file state, by role.
    """
    findings = []
    # One part at a time: the corrected log shows the next one.
    for _ in range(MOST_PARTS):
        for part in _suspected(log, stated)[:MOST_LABELS]:
            segment = refined(log, part.mislabel, part.segment)
            probability = _probability(log, part.mislabel, segment, stated)
            if probability:
                findings.append(finding_of(part.mislabel, probability, segment))
                log = undone(log, part.mislabel, [segment])
                break
        else:
            break
    return findings, log


def _probability(log, mislabel, segment, stated):
    """Probability of a mislabel by the rows of a segment alone; 0 where they say anything else, or leave it open."""
    here = inside(log["time"], [segment])
    part = {role: values[here] for role, values in log.items()}
    findings = misread(part, stated, SEGMENT_COST).findings
    is_it = (
        len(findings) == 1
        and not findings[0].alternatives
        and findings[0].note == mislabel.sentence
    )
    return findings[0].probability if is_it else 0.0


def _suspected(log, stated) -> list[_Part]:
    """Mislabels with the part of the log in which each of them explains most, the largest gain first."""
    mistakes = {
        mistake.sentence: mistake
        for mistake in changes(stated)
        if mistake.mislabel is not None and _is_usual(mistake, stated)
    }
    # Gains of the log's rows by both relations: a wrong heading shows in both.
    gains: dict[str, np.ndarray] = {}
    for relation in rows_of_relations(log):
        for sentence, of_rows in _gains(log["time"], relation, mistakes):
            gains[sentence] = gains.get(sentence, 0.0) + of_rows
    step = usual_step(log["time"])
    shortest = min(SHORTEST_LABEL, max(SHORTEST_WRONG, LABEL_ROWS * step))
    parts = []
    for sentence, of_rows in gains.items():
        gain, segment = best_segment(log["time"], of_rows, shortest)
        mislabel = mistakes[sentence].mislabel
        if segment is not None and gain > LABEL_GAIN and mislabel is not None:
            parts.append(_Part(gain, mislabel, segment))
    return sorted(parts, key=lambda part: -part.gain)


def _is_usual(mistake, stated):
    """Whether a mistake is one of the usual ones, and no unit of what would leap by its factor."""
    is_stated = bool(stated.get(mistake.channels[0]))
    leaps = mistake.slot in ("unit of heading_unit", "unit of position")
    return mistake.cost - STATED * is_stated < RARE_LABEL and not leaps


def _gains(
    time, relation: RowsOfRelation, mistakes: dict[str, LogMistake]
) -> Iterator[tuple[str, np.ndarray]]:
    """By how much each row of a log is likelier with each mistake than as labelled, by one relation. [nats]"""
    few = thinned(len(relation.rows), [relation.seen])
    rows = relation.rows[few]
    seen = np.column_stack([np.real(relation.seen), np.imag(relation.seen)])[few, : relation.axes]
    starts = after_gaps(time[rows]) | jumps(seen)
    if (~starts).sum() < FEWEST_FITTED:
        return
    # What each reading predicts: the form of the reported change, and its factor. As labelled comes first.
    labelled = relation.predicted(LogInterpretation())
    readings = {
        sentence: relation.predicted(mistake.apply(LogInterpretation()))
        for sentence, mistake in mistakes.items()
    }
    readings = {sentence: reading for sentence, reading in readings.items() if reading != labelled}
    predicted = [labelled, *readings.values()]
    # Whitening is linear: whiten each form once, and take what each reading leaves of the white rows.
    names = list(relation.reported)
    series = np.column_stack([relation.seen, *relation.reported.values()])[few]
    column = [1 + names.index(form) for form, _ in predicted]
    factors = np.array([factor for _, factor in predicted])
    best = _Noise(-np.inf)
    for draft in filters(time[rows], starts):
        white = draft(np.real(series)) + 1j * draft(np.imag(series))
        left = white[:, :1] - factors * white[:, column]
        noise = _noise(left, draft, relation.axes)
        if noise.score > best.score:
            best = noise
            size = np.abs(left)
    # Noise is at least what rounding makes; single rows count only so much, and rows that hang together less.
    rounding = max(quantum(axis) for axis in seen.T) / math.sqrt(12.0)
    squares = np.minimum(size / max(best.std, rounding), LABEL_CLIP) ** 2
    for number, sentence in enumerate(readings, start=1):
        gains = np.zeros(len(time))
        gains[rows] = 0.5 * (squares[:, 0] - squares[:, number]) / best.rough
        yield sentence, gains


def _noise(left, draft, axes) -> _Noise:
    """The noise of white rows where in each window either the labels are right, or one and the same reading is.

    Parameters
    ----------
    left : (n, k) array
        What each reading leaves, as labelled first.
    draft : Filter
    axes : int
        2, or 1 where all is real.
    """
    settled = np.flatnonzero(draft.gains < 1.0)
    windows = np.array_split(settled, max(1, min(NOISE_WINDOWS, len(settled) // 40)))
    # Mean size in each window. Of the normal distribution it is sqrt(pi / 2) standard deviations
    # in a plane, sqrt(2 / pi) on a line.
    size = np.abs(left)
    usual = np.array([size[window].mean(axis=0) for window in windows])
    usual = np.maximum(usual, 1e-12) * math.sqrt(2.0 / math.pi if axes == 2 else math.pi / 2.0)
    # The calmer windows count: a leap at an end of the part, or another fault, is in a few.
    noise = np.sort(np.minimum(usual[:, :1], usual[:, 1:]), axis=0)
    calm = np.mean(np.log(noise[: max(1, int(CALM_PARTS * len(noise)))]), axis=0)
    number = int(np.argmin(calm))
    std = float(np.quantile(noise[:, number], NOISE_SHARE))
    score = -axes * float(calm[number] + np.mean(np.log(draft.scale[settled])))
    chosen = [
        left[w, 0 if scores[0] < scores[1 + number] else 1 + number]
        for w, scores in zip(windows, usual, strict=True)
    ]
    rest = np.concatenate(chosen)
    return _Noise(
        score, std, whiteness(np.column_stack([np.real(rest), np.imag(rest)][:axes]) / std)
    )
