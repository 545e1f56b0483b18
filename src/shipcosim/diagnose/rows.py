"""The clock of a log: rows that are out of order, repeated, without a time, unevenly spaced or not there."""

from __future__ import annotations

import numpy as np

from shipcosim.diagnose.finding import Estimate, Finding

__all__ = ["check_times", "usable_rows"]

HOLE_FACTOR = 1.5  # over the usual spacing
LOST_TIME, LOST_ROWS = 10.0, 5  # [s, rows] a longer hole is a gap of the log, not an ordinary dropout
UNEVEN = 0.02  # share of the usual spacing


def usable_rows(time: np.ndarray) -> np.ndarray:
    """Rows in order of time, without those that have no time or one that was there already: (k,) indices."""
    rows = np.flatnonzero(np.isfinite(time))
    rows = rows[np.argsort(time[rows], kind="stable")]
    return rows[np.r_[True, np.diff(time[rows]) > 0.0]] if len(rows) else rows


def check_times(time: np.ndarray) -> list[Finding]:
    """Defects of the time stamps (n,), in the order of the file. [s]"""
    finite = time[np.isfinite(time)]
    ordered = np.sort(finite)
    again, back = ordered[1:][np.diff(ordered) == 0.0], finite[1:][np.diff(finite) < 0.0]
    found = []
    if len(finite) < len(time):
        found.append(_remark("missing", len(time) - len(finite), (), "without a time; left out."))
    if len(back):
        found.append(_remark("unordered", len(back), _points(back), "earlier than the one before; sorted by time."))
    if len(again):
        found.append(_remark("repeated", len(again), _points(again), "of a time that was there; the first is kept."))
    times = np.unique(ordered)
    return [*found, *_spacing(times)] if len(times) > 3 else found


def _remark(cause, rows, segments, what):
    sentence = f"{rows} row{'s' * (rows > 1)} {what}"
    return Finding(cause, ("time",), segments, severity="remark", sentence=sentence, rows=rows)


def _points(times):
    return tuple((float(t), float(t)) for t in times)


def _spacing(times):
    """Holes between the rows, and rows that are not evenly spaced."""
    steps, found = np.diff(times), []
    usual = float(np.median(steps))
    is_hole = steps > HOLE_FACTOR * usual
    lost = np.where(is_hole, np.round(steps / usual) - 1, 0).astype(int)
    is_gap = is_hole & (steps > LOST_TIME) & (lost >= LOST_ROWS)
    for severity, cause, holes in (("remark", "missing", is_hole & ~is_gap), ("fault", "gap", is_gap)):
        if holes.any():
            segments = tuple(zip(times[:-1][holes].tolist(), times[1:][holes].tolist(), strict=True))
            sentence = (
                f"{lost[holes].sum()} rows of the usual spacing {usual:g} s are not there, in {holes.sum()} "
                f"hole{'s' * (holes.sum() > 1)}, the longest of {steps[holes].max():g} s."
            )
            found.append(Finding(cause, ("time",), segments, {}, 1.0, severity, sentence, rows=int(lost[holes].sum())))
    spread = float(1.4826 * np.median(np.abs(steps - usual)))
    if spread > UNEVEN * usual:
        spacing = {"spacing": Estimate(usual, spread, "s")}
        sentence = f"Rows are {usual:g} s apart, give or take {spread:.2g} s."
        found.append(Finding("uneven", ("time",), (), spacing, 1.0, "remark", sentence))
    return found
