"""Differences between the tables of two runs, and their causes in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.master.inputs import ANGLES
from shipcosim.errors import shortened

if TYPE_CHECKING:
    import xarray

TOLERANCE = 1e-9
"""Largest difference that counts as none, over a signal's range. [1]"""


@dataclass(frozen=True)
class Difference:
    """Largest difference of a signal between two runs.

    Parameters
    ----------
    largest : float
        In the signal's unit. NaN where a value is no number.
    relative : float
        To the signal's range in our run; the largest itself where that is 0.
    time : float
        When. [s]
    """

    largest: float
    relative: float
    time: float


def differs(name: str, ours: xarray.Dataset, theirs: xarray.Dataset, tolerance: float) -> bool:
    """True if a signal differs by more than a tolerance, relative to its range in our run."""
    # NaN fails the comparison, so a NaN counts as a difference.
    return not difference(name, ours, theirs).relative <= tolerance


def difference(name: str, ours: xarray.Dataset, theirs: xarray.Dataset) -> Difference:
    """Largest difference of a signal between two tables."""
    # NaN counts as infinitely far, so that its row is the one reported.
    distance = np.abs(_distance(name, ours, theirs))
    row = int(np.argmax(np.where(np.isnan(distance), np.inf, distance)))
    largest = float(distance[row])
    # A constant signal has no range: its difference is taken as absolute.
    spread = float(np.ptp(ours[name].values.astype(float))) or 1.0
    return Difference(largest, largest / spread, float(theirs["time"].values[row]))


def _distance(name, ours, theirs):
    """Theirs minus ours in the last rows that both have, angles the shorter way round; (n,)."""
    # A tool may lack the first row (start values), so the tables are aligned at their ends.
    n = min(len(ours["time"]), len(theirs["time"]))
    distance = theirs[name].values[-n:].astype(float) - ours[name].values[-n:].astype(float)
    # An angle may differ by full turns: wrap the difference to half a turn either way.
    turn = ANGLES.get(ours[name].attrs.get("units"))
    return distance if turn is None else (distance + turn / 2.0) % turn - turn / 2.0


def explained(
    ours: xarray.Dataset, theirs: xarray.Dataset, step_size: float, tolerance: float = TOLERANCE
) -> list[str]:
    """Explain in words the differences of a run from ours.

    Only the signals that differ first are looked at: what differs later may follow from them.

    Parameters
    ----------
    ours, theirs : Dataset
        Tables of the same signals and times.
    step_size : float
        Of both. [s]
    tolerance : float
        Relative to a signal's range.

    Returns
    -------
    list of str
        Empty if no signal differs.
    """
    first = {}
    # Align the tables at their ends; theirs may lack the start.
    ours = ours.isel(time=slice(len(ours["time"]) - len(theirs["time"]), None))
    # Find the first row where each signal leaves its tolerance.
    for name in (name for name in ours.data_vars if name in theirs):
        spread = float(np.ptp(ours[name].values.astype(float))) or 1.0
        beyond = np.flatnonzero(~(np.abs(_distance(name, ours, theirs)) <= tolerance * spread))
        if len(beyond):
            first[str(name)] = int(beyond[0])
    if not first:
        return []
    # What differs later may follow from the first difference, so only the first row is explained.
    row = min(first.values())
    names = [name for name in first if first[name] == row]
    time = float(ours["time"].values[row])
    where = "from the start" if row == 0 else f"from t = {time:.9g} s on"
    causes = list(dict.fromkeys(_cause(name, ours, theirs, step_size) for name in names[:5]))
    return [f"{len(first)} signals differ, {where}: {shortened(names)}.", *causes]


def _cause(name, ours, theirs, step_size):
    """Find the simplest relation that removes most of a signal's difference."""
    x, y = (table[name].values.astype(float) for table in (ours, theirs))
    time = ours["time"].values
    distance = _distance(name, ours, theirs)
    largest = np.max(np.abs(distance))
    if not np.isfinite(largest):
        return f"{name} is not a number in some rows."
    # The relations need a signal that moves. Each counts if it leaves less than 1 % of the largest
    # difference.
    if len(x) > 2 and np.ptp(x) > 0.0:
        # Shifted by a row: a connection passes the value on a step later or earlier.
        if np.max(np.abs(y[1:] - x[:-1])) < 0.01 * largest:
            return f"{name} comes one row late: a connection passes it on a step later."
        if np.max(np.abs(y[:-1] - x[1:])) < 0.01 * largest:
            return (
                f"{name} comes one row early: a component gets it within the step, not at its end."
            )
        # A line, y = a x + b: a factor or offset is missing, such as a unit.
        factor, offset = np.polyfit(x, y, 1)
        if np.max(np.abs(factor * x + offset - y)) < 0.01 * largest:
            return (
                f"{name} is ours times {factor:.6g} plus {offset:.6g}: "
                "a transformation, a unit or a parameter is not applied."
            )
        # What is wrong with a time that was summed up step by step, at each time; (n,). [s]
        counts = np.rint(time / step_size).astype(int)
        summed = np.concatenate([[0.0], np.cumsum(np.full(counts[-1], step_size))])
        drift = summed[counts] - time
        # A time error dt changes a signal by about its rate times dt. The rate from the table is
        # rough, hence 30 %.
        if np.max(np.abs(np.gradient(x, time) * drift - distance)) < 0.3 * largest:
            return f"{name} differs as its rate times {drift[-1]:.1e} s: the engine's time, a sum of steps, drifts."
    # No relation fits: the start tells parameters apart from decisions on the way.
    if np.abs(distance[0]) > 0.0:
        return f"{name} differs at the start: a parameter or start value is not applied, or settled otherwise."
    return f"{name} was the same before: something is decided otherwise there, e.g. a sample, a limit or an event."
