"""Faults of a log that show in the log itself, before any physics: each with its channels and where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.log.checks.clock import wrong_clock
from shipcosim.diagnose.log.checks.labels import mislabelled
from shipcosim.diagnose.log.checks.samples import gaps, outliers, wraps
from shipcosim.diagnose.log.checks.wind import mislabelled_wind
from shipcosim.diagnose.log.checks.wind_jumps import jumping_wind
from shipcosim.diagnose.log.checks.yaw_rate import silent_rate
from shipcosim.diagnose.log.mislabels import mislabel_in, undone
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log.rows import inside, usable_rows
from shipcosim.diagnose.stages import CheckedLog, ReadLog

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.result import Finding

__all__ = ["checked", "examine"]


def checked(read: ReadLog) -> CheckedLog:
    """A log with the faults that its own channels show, and repaired."""
    faults = tuple(examine(read.log))
    return CheckedLog(read.log, read.ship, read.causes, faults, repaired(read.log, faults))


def examine(log: xarray.Dataset) -> list[Finding]:
    """Faults of the data, of kind ``"data"``, most certain first; none in a log that is right.

    Parameters
    ----------
    log : xarray.Dataset
        As from `read_log`.
    """
    table = _arrays(log)
    found = [*gaps(table), *wraps(table)]
    table = _without(table, found)
    quiet = silent_rate(table)
    table = undone(table, mislabel_in(quiet[0]), quiet[0].segments) if quiet else table
    labels, right = mislabelled(table)
    clock = wrong_clock(right)
    kept = [label for label in labels if not _is_the_clock(label, clock, table["time"])]
    if len(kept) < len(labels):
        right = table
        for label in kept:
            right = undone(right, mislabel_in(label), label.segments)
        clock = wrong_clock(right)
    found += [*quiet, *kept, *(mislabelled_wind(right) or jumping_wind(right)), *clock]
    return sorted(found, key=lambda finding: -finding.probability)


def _is_the_clock(label, clock, time):
    """Whether a mislabel of a part of the log is where the clock is wrong even with the label put right."""
    if not label.segments or not clock:
        return False
    part, wrong = inside(time, label.segments), inside(time, [s for finding in clock for s in finding.segments])
    return bool((part & wrong).sum() > 0.5 * part.sum())


def _arrays(log):
    """The log as a dict of arrays, rows in order of time."""
    rows = usable_rows(log["time"].values)
    table = {str(name): np.array(variable.values[rows], float) for name, variable in log.data_vars.items()}
    return {"time": log["time"].values[rows], **table}


def _without(table, found):
    """The table with what is no measurement left out, and the heading without jumps."""
    table = dict(table)
    for role, bad in outliers(table).items():
        table[role] = np.where(bad, np.nan, table[role])
    for finding in found:
        bad = inside(table["time"], finding.segments)
        table |= {role: np.where(bad, np.nan, table[role]) for role in finding.channels if role in table}
    if "heading" in table:
        table["heading"][:] = np.degrees(unwrap_series(np.radians(table["heading"])))
    return table
