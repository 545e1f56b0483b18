"""Faults of a log that show in the log itself, before any physics: each with its channels and where it is."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import xarray

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.clock import wrong_clock
from shipcosim.diagnose.log.checks.lag import late_channels
from shipcosim.diagnose.log.checks.position_jumps import position_jumps
from shipcosim.diagnose.log.checks.samples import gaps, lifeless, wraps
from shipcosim.diagnose.log.checks.wind import mislabelled_wind
from shipcosim.diagnose.log.checks.wind_jumps import jumping_wind
from shipcosim.diagnose.log.checks.yaw_rate import silent_rate
from shipcosim.diagnose.log.mislabels import undone
from shipcosim.diagnose.log.readings.parts import mislabelled
from shipcosim.diagnose.log.readings.reading import explained, is_as_labelled, misread
from shipcosim.diagnose.log.repair import rate_of, read_anew, without_findings
from shipcosim.diagnose.log.rows import arrays_of, inside, usable_rows
from shipcosim.diagnose.log.thresholds import SEGMENT_COST


def examine(log: xarray.Dataset) -> list[Finding]:
    """Faults of the data, of kind ``"data"``, most certain first; none in a log that is right.

    What holds throughout the log is judged first and jointly, by all relations between its channels. Where that leaves
    something open, only rows that are no measurement are looked for besides.

    Parameters
    ----------
    log : xarray.Dataset
        As from `read_log`.
    """
    # Rows that are no measurement come first: they would spoil all comparisons between channels.
    logged = _arrays(log)
    useless = [*wraps(logged), *lifeless(logged)]
    used = without_findings(logged, useless)
    # Mistakes of the whole log, judged jointly by all relations.
    labels = misread(used, _stated_units(log))
    throughout = _unless_in_part(labels.findings, used, _stated_units(log))
    # Gaps and faults of parts are looked for in the log with these corrected.
    table = read_anew(used, throughout)
    start = logged["time"][0]
    empty = {
        role: logged[role] for role, values in table.items() if np.isnan(values).all()
    }  # not lost, but unusable
    # Rows that are no measurement are no gap besides.
    lost = [segment for finding in useless for segment in finding.segments]
    in_parts = [
        replace(f, segments=tuple(s for s in f.segments if not _meets(s, lost)))
        for f in gaps(table | empty)
    ]
    in_parts = [finding for finding in in_parts if finding.segments]
    if not any(finding.alternatives for finding in throughout):
        right = without_findings(table, in_parts)
        in_parts += _in_parts(right, _stated_units(log), labels.contradiction)
    # Segments were found in corrected time; give them in the log's own.
    rate = rate_of(throughout)
    in_parts = [
        replace(f, segments=tuple(_as_logged(s, start, rate) for s in f.segments)) for f in in_parts
    ]
    return sorted([*useless, *throughout, *in_parts], key=lambda finding: -finding.probability)


def _meets(segment, others):
    """Whether a segment has a time in common with one of others."""
    return any(segment[0] <= end and start <= segment[1] for start, end in others)


def _unless_in_part(throughout, table, stated):
    """Mistakes throughout a log; none where wrong labels in parts of it explain more, and all of it."""
    # Labels wrong in parts are the rival: each segment costs some evidence.
    if throughout:
        labels, right = mislabelled(table, stated)
        more = labels and explained(right) > explained(table) + SEGMENT_COST * len(labels)
        if more and is_as_labelled(right, stated):
            return []
    return throughout


def _in_parts(table, stated, contradiction):
    """Mistakes of parts of a log, and those of the wind; a contradiction where no part explains it.

    A label is wrong in a part of a log only where all channels agree throughout once it is corrected.
    """
    # Wrong labels in parts count only if the corrected log has no wrong label left.
    labels, right = mislabelled(table, stated)
    if labels and not is_as_labelled(right, stated):
        labels = []
        right = table
    # Where the ship does not turn, a yaw rate in rad/s shows by its noise alone.
    quiet = silent_rate(right)
    labels = [*labels, *quiet]
    right = undone(right, quiet[0].mislabel, quiet[0].segments) if quiet else right
    # Positions that are labelled right may jump, and channels come late.
    for others_of in () if labels else (position_jumps, late_channels):
        others = others_of(right)
        for label in others:
            right = undone(right, label.mislabel, label.segments)
        labels = [*labels, *others]
    # A wrong clock can look like a wrong label. Where both were found at
    # one place, the label is dropped and the clock is estimated again.
    clock = wrong_clock(right)
    kept = [label for label in labels if not _is_the_clock(label, clock, table["time"])]
    if len(kept) < len(labels):
        right = table
        for label in kept:
            right = undone(right, label.mislabel, label.segments)
        clock = wrong_clock(right)
    clock = _agreeing(clock)
    # The wind is judged by headings and velocities, so not where these contradict each other.
    if contradiction is not None and not kept and not clock:
        return [contradiction]
    return [*kept, *(mislabelled_wind(right) or jumping_wind(right)), *clock]


def _agreeing(clock):
    """Segments of a wrong clock; none if one lies in another, because they contradict each other."""
    # Two segments that overlap by more than half of the shorter one contradict each other.
    segments = sorted(segment for finding in clock for segment in finding.segments)
    for (first, end), (start, later) in pairwise(segments):
        if min(end, later) - start > 0.5 * min(end - first, later - start):
            return []
    return clock


def _as_logged(segment, start, rate):
    """A segment of a time base corrected, in the times of the log."""
    first, last = (float(start + (end - start) / rate) for end in segment)
    return first, last


def _stated_units(log):
    """Stated units by role; for positions, whether they come from latitude and longitude."""
    geodetic = {"latitude": "deg"} if "latitude_origin" in log.attrs else {}
    return geodetic | {
        str(n): v.attrs["stated_unit"]
        for n, v in log.variables.items()
        if v.attrs.get("stated_unit")
    }


def _is_the_clock(label, clock, time):
    """Whether a mislabel of a part of the log is where the clock is wrong even with the label corrected."""
    if not label.segments or not clock:
        return False
    # The label is explained by the clock where it overlaps it by more than half.
    part = inside(time, label.segments)
    wrong = inside(time, [s for finding in clock for s in finding.segments])
    return bool((part & wrong).sum() > 0.5 * part.sum())


def _arrays(log):
    """The log as a dict of arrays, rows in order of time."""
    ordered = log.isel(time=usable_rows(log["time"].values))
    return {role: np.array(values, float) for role, values in arrays_of(ordered).items()}
