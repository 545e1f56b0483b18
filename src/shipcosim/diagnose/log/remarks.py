"""What is ordinary in a log and handled without naming a fault: unordered rows, dropouts, outliers, noisier parts."""

import numpy as np
import xarray

from shipcosim.diagnose.log.checks.noise import noisier_parts
from shipcosim.diagnose.log.checks.samples import outliers
from shipcosim.diagnose.log.rows import arrays_of, usable_rows
from shipcosim.diagnose.log.thresholds import HOLE, UNEVEN
from shipcosim.diagnose.numerics import finite
from shipcosim.errors import counted


def remarks(log: xarray.Dataset) -> list[str]:
    """One sentence for everything that a repair changes or leaves out, faults of the data apart.

    Parameters
    ----------
    log : xarray.Dataset
        As from `read_log`.
    """
    time = log["time"].values
    times = finite(time)
    sentences = []
    if len(times) < len(time):
        sentences.append(f"{counted(len(time) - len(times), 'row')} without a time: left out.")
    if (back := times[1:][np.diff(times) < 0.0]).size:
        sentences.append(
            f"{counted(back.size, 'row')} earlier than the one before, the first at {back[0]:g} s: sorted by time."
        )
    ordered = np.sort(times)
    if (again := ordered[1:][np.diff(ordered) == 0.0]).size:
        sentences.append(
            f"{counted(again.size, 'row')} with a time that was there, the first at {again[0]:g} s: the first is kept."
        )
    rows = usable_rows(time)
    sentences += _steps(time[rows])
    for name, variable in log.data_vars.items():
        if empty := int(np.sum(~np.isfinite(variable.values[rows]))):
            sentences.append(f"{name}: {counted(empty, 'row')} without a number.")
    right = arrays_of(log.isel(time=rows))
    far = outliers(right)
    sentences += [
        f"{role}: {counted(bad.sum(), 'row')} far off both neighbours: left out."
        for role, bad in far.items()
        if bad.any()
    ]
    return [*sentences, *noisier_parts(right)]


def handled(log: xarray.Dataset) -> list[str]:
    """Remarks on ordinary things, and how the file was read: which column is what, and which is not used and why."""
    of_columns = log.attrs.get("column_remarks", ())
    unused = ", ".join(map(str, log.attrs.get("unused_columns", ())))
    plain = [f"Columns without a role are not used: {unused}."] if unused else []
    sentences = list(map(str, of_columns))
    return [
        *remarks(log),
        *sentences,
        *([] if any("not used" in sentence for sentence in sentences) else plain),
    ]


def _steps(time):
    """Holes between rows, and rows that are unevenly spaced."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    holes = steps > HOLE * usual
    if holes.any():
        lost = int(np.sum(np.round(steps[holes] / usual) - 1))
        first = time[:-1][holes][0]
        yield f"{counted(lost, 'row')} of the usual step {usual:g} s not there, the first after {first:g} s: left empty."
    spread = float(np.median(np.abs(steps - usual)))
    if spread > UNEVEN * usual:
        yield f"rows are {usual:g} s apart, give or take {spread:.2g} s: interpolated to even steps."
