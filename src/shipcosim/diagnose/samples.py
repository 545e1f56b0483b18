"""Samples of single channels that are no measurement: not there, far off, held, filled in, clipped, or turned
through the south on their way across north.

What is normal is taken from the channel itself, so nothing is assumed about its noise; runs are judged by how long
they get by chance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter, percentile_filter

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.roles import NAVIGATION

__all__ = ["check_samples"]

CHANCE = 1e-7  # of a run that long anywhere in the log
SHORTEST_RUN, SHORTEST_TIME = 6, 3.0  # [samples, s] of held or filled-in values
SMOOTH = 0.02  # of the usual fourth difference
OUTLIER = 12.0  # standard deviations from the running median
GLITCH = np.radians(4.0)  # steps between two samples that make a turn the wrong way round


def check_samples(time: np.ndarray, channels: dict[str, np.ndarray]) -> tuple[list[Finding], dict[str, np.ndarray]]:
    """Defects of the samples of each channel.

    Parameters
    ----------
    time : (n,) array
        Increasing. [s]
    channels : dict of (n,) arrays
        By role, SI units and rad, angles as logged.

    Returns
    -------
    list of Finding
    dict of (n,) arrays of bool
        For each channel: which samples can be used.
    """
    good, found = {role: np.isfinite(values) for role, values in channels.items()}, []
    tests = (_wrapped, _outlying, _invented, _clipped)
    for role, values in channels.items():
        if not good[role].all():
            found.append(_finding("missing", role, time, ~good[role], "without a number", "remark"))
        for test in tests:
            if good[role].sum() > 20:
                findings, bad = test(time, role, values, good[role])
                found += findings
                good[role] = good[role] & ~bad
    return _joined(found), good


def _finding(cause, role, time, bad, what, severity="fault"):
    rows = int(bad.sum())
    segments = tuple((float(time[a]), float(time[b - 1])) for a, b in runs(bad))
    return Finding(cause, (role,), segments, {}, 1.0, severity, f"{rows} sample{'s' * (rows > 1)} {what}.", rows=rows)


def runs(flags: np.ndarray) -> np.ndarray:
    """First and one past the last index of each run of true values: (k, 2)."""
    edges = np.flatnonzero(np.diff(np.r_[0, np.asarray(flags, np.int8), 0]))
    return edges.reshape(-1, 2)


def _joined(found):
    """Gaps of several channels at the same time as one finding each."""
    groups = {}
    for finding in found:
        key = (finding.cause, finding.severity, finding.sentence.split(" ", 2)[2], _rounded(finding.segments))
        groups.setdefault(key if finding.cause in ("gap", "stale") else id(finding), []).append(finding)
    return [replace(group[0], channels=tuple(f.channels[0] for f in group)) for group in groups.values()]


def _rounded(segments):
    return tuple((round(a / 10.0), round(b / 10.0)) for a, b in segments)


def _wrapped(time, role, values, good):
    """Samples of the heading between 0 and 360 that were interpolated the long way round."""
    bad = np.zeros(len(values), bool)
    if role != "heading":
        return [], bad
    rows = np.flatnonzero(good)
    steps = np.diff(values[rows])
    usual = GLITCH + 8.0 * np.median(np.abs(np.angle(np.exp(1j * steps))))
    for sign in (1.0, -1.0):
        for first, last in runs(sign * steps > usual):
            turn = np.angle(np.exp(1j * (values[rows[last]] - values[rows[first]])))
            if last - first > 1 and abs(abs(steps[first:last].sum() - turn) - 2 * np.pi) < 0.1 and abs(turn) < 1.0:
                bad[rows[first + 1 : last]] = True
    what = "interpolated across 0/360 the long way round"
    return ([_finding("heading_wrap", role, time, bad, what)] if bad.any() else []), bad


def _outlying(time, role, values, good):
    """Samples far from the median of their neighbours."""
    bad = np.zeros(len(values), bool)
    rows = np.flatnonzero(good)
    series = np.unwrap(values[rows]) if _is_angle(role) else values[rows]
    off = np.abs(series - median_filter(series, 7, mode="nearest"))
    if _is_angle(role):
        off = np.abs(np.angle(np.exp(1j * off)))
    low, high = np.quantile(series, [0.01, 0.99])
    usual = 1.4826 * np.median(off[off > 0.0]) if (off > 0.0).any() else 0.0
    local = percentile_filter(off, 90, 61, mode="nearest") / 1.645
    limit = OUTLIER * np.maximum(usual, local) + (0.0 if role in NAVIGATION else 0.5 * (high - low))
    far = off > limit
    for first, last in runs(far):
        bad[rows[first:last]] = last - first <= 3
    return ([_finding("outlier", role, time, bad, "far off their neighbours", "remark")] if bad.any() else []), bad


def _is_angle(role):
    return role == "heading" or role.endswith(("_from", "_azimuth"))


def _invented(time, role, values, good):
    """Stretches that are held or filled in: too smooth for a measurement with noise."""
    bad = np.zeros(len(values), bool)
    if role not in NAVIGATION:
        return [], bad
    rows = np.flatnonzero(good)
    series = np.unwrap(values[rows]) if role == "heading" else values[rows]
    bend = np.abs(np.diff(series, n=4))
    quantum = _quantum(values[rows])
    usual = np.median(bend[bend > 0.0]) if (bend > 0.0).any() else 0.0
    limit = max(SMOOTH * usual, 6.0 * quantum)
    found = []
    flat = np.diff(series) == 0.0
    smooth = bend < limit if limit < 0.5 * usual else np.zeros(len(bend), bool)
    spacing = np.median(np.diff(time))
    for kind, flags, reach in (("held at one value", flat, 1), ("filled in between others", smooth, 4)):
        here = np.zeros(len(values), bool)
        for first, last in _long_runs(flags):
            if last - first >= SHORTEST_RUN and (last - first + reach - 1) * spacing >= SHORTEST_TIME:
                here[rows[first : last + reach]] = True
        here &= ~bad
        if here.any():
            found.append(_finding("gap", role, time, here, kind))
        bad |= here
    return found, bad


def _quantum(values):
    """Resolution of a channel: the smallest difference of two of its values that is no rounding error."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > 1e-9 * (np.abs(values).max() + 1e-300)]
    return float(np.quantile(steps, 0.001)) if len(steps) and len(steps) < 0.5 * len(values) else 0.0


def _long_runs(flags):
    """Runs that are longer than chance makes them, by how often flags follow flags elsewhere nearby."""
    for first, last in runs(flags):
        reach = 300 + 5 * (last - first)
        nearby = np.r_[flags[max(0, first - reach) : first], flags[last : last + reach]]
        again = (nearby[1:] & nearby[:-1]).sum() + 1.0
        chance = again / (nearby[:-1].sum() + 2.0) if len(nearby) > 20 else 0.5
        if len(flags) * min(chance, 0.98) ** (last - first) < CHANCE:
            yield first, last


def _clipped(time, role, values, good):
    """Samples that stick to the largest or smallest value of the channel."""
    bad = np.zeros(len(values), bool)
    if _is_angle(role):
        return [], bad
    for extreme in (values[good].max(), values[good].min()):
        at = good & (values == extreme)
        levels = np.unique(values[good])
        if len(levels) < 20:
            continue
        beside = np.sort(np.abs(levels - extreme))[1:4].max()
        near = good & (np.abs(values - extreme) <= beside) & ~at
        spans = [last - first for first, last in runs(at)]
        if at.sum() >= 8 and max(spans) >= 3 and at.sum() > 5 * (near.sum() / 3.0 + 1.0):
            bad |= at
    if not bad.any():
        return [], bad
    severity = "fault" if role in NAVIGATION or "wind" in role else "remark"
    what = (
        "at its limit: the channel is clipped" if severity == "fault" else "at the largest or smallest of the channel"
    )
    return [_finding("clipped", role, time, bad, what, severity)], (bad if severity == "fault" else np.zeros_like(bad))
