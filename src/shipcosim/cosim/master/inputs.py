"""A table that feeds the inputs of a system."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.master.plan import WIDE
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, shortened, suggestion
from shipcosim.series import conversion

if TYPE_CHECKING:
    import xarray

    from shipcosim.ssp import System

INTERPOLATIONS = ("held", "linear")
ANGLES = {"deg": 360.0, "rad": 2.0 * np.pi}
"""Units of angles and what a full turn is in them."""
LONGEST_GAP = 5.0
"""Longest gap of a table with evenly spaced rows, in times the usual distance. [1]"""
CLOSE = 1e-6  # s; times of a log in seconds since 1970 are no finer


def input_values(table: xarray.Dataset, system: System, times: np.ndarray) -> dict[str, np.ndarray]:
    """Values of a system's inputs at the times of the steps.

    Parameters
    ----------
    table : Dataset
        Its variables are named like the inputs. A variable's attribute ``interpolation`` says what it does between
        its rows: ``"held"`` (the default) or ``"linear"``, angles the shorter way round. The table's attribute
        ``max_gap`` is the longest time between two rows; where there is none and the rows are evenly spaced, it is
        five times their distance.
    system : System
        With these inputs.
    times : (n,) array
        Of the steps. [s]

    Returns
    -------
    dict of str to (n,) array
        In the units of the inputs.

    Raises
    ------
    ShipcosimError
        If a name, a unit or a time does not fit, or a value that is needed is not finite. Only rows that these times
        need are looked at.
    """
    try:
        return _values(table, system, times)
    # Name the file in the messages, if the table came from one.
    except ShipcosimError as error:
        file = table.encoding.get("source", "inputs")
        raise ShipcosimError(
            [replace(p, where=p.where.replace("inputs", file, 1)) for p in error.problems]
        ) from error


def _values(table, system, times):
    clock = table["time"].values.astype(float)
    problems = [*_unknown(table, system), *_clock_problems(clock)]
    raise_errors(problems)
    # Only rows that the run needs are checked: gaps and NaN elsewhere do no harm.
    rows = _rows(clock, times)
    problems = list(_gaps(table, clock[rows]))
    # Integers have 32 bits, and 64 where an FMU of the system has larger ones.
    is_wide = any(variable.type in WIDE for _, variable in system.all_variables())
    largest = (-(2**63), 2**63 - 1) if is_wide else (-(2**31), 2**31 - 1)
    # Convert each column; collect the problems of all before raising.
    fed = {}
    for name in table.data_vars:
        try:
            signal = system.inputs[name]
            fed[str(name)] = _column(table[name][rows], signal, clock[rows], times, largest)
        except ShipcosimError as error:
            problems += [Problem(f"inputs: {name}", p.found, p.remedy) for p in error.problems]
    raise_errors(problems)
    return fed


def interpolated(table: xarray.Dataset, system: System, names: Iterable[str]) -> xarray.Dataset:
    """Mark some columns of a table to change linearly between their rows.

    Parameters
    ----------
    table : Dataset
        As for `input_values`.
    system : System
        With these inputs.
    names : iterable of str
        Columns. With * and ? in it a name stands for all columns that it matches and that feed a Real.

    Raises
    ------
    ShipcosimError
        If there is no such column.
    """
    # Only Reals can lie between two values.
    columns = map(str, table.data_vars)
    reals = {
        name for name in columns if name in system.inputs and system.inputs[name].type == "Real"
    }
    table = table.copy()
    problems = []
    # A pattern may match nothing numeric; an exact name is taken as given.
    for pattern in names:
        matching = [name for name in reals if fnmatchcase(name, pattern)]
        matching = [pattern] if pattern in table.data_vars else matching
        if not matching:
            remedy = suggestion(pattern, map(str, table.data_vars))
            problems.append(
                Problem("inputs", f"no column '{pattern}' can be interpolated.", remedy)
            )
        for name in matching:
            table[name].attrs["interpolation"] = "linear"
    raise_errors(problems)
    return table


def digest(table: xarray.Dataset) -> str:
    """SHA-256 of a table's times, names, units, interpolation and values."""
    # Sorted by name: the order of the columns has no effect on the run.
    sha = hashlib.sha256(np.ascontiguousarray(table["time"].values, dtype=float).tobytes())
    for name, column in sorted(table.data_vars.items()):
        about = (
            str(name),
            column.attrs.get("units") or "",
            column.attrs.get("interpolation", "held"),
        )
        sha.update("\0".join(about).encode())
        sha.update(np.ascontiguousarray(column.values, dtype=float).tobytes())
    return sha.hexdigest()


def _unknown(table, system):
    unknown = [str(name) for name in table.data_vars if name not in system.inputs]
    if unknown:
        yield Problem(
            "inputs",
            f"{system.name} has no input {shortened(map(repr, unknown), 8)}.",
            f"{suggestion(unknown[0], system.inputs)} Rename or drop such columns.",
        )
    if not table.data_vars:
        yield Problem(
            "inputs", "The table has no column beside time.", suggestion("", system.inputs)
        )


def _clock_problems(clock):
    if len(clock) == 0:
        yield Problem("inputs", "The table has no row.")
    elif not np.isfinite(clock).all():
        row = int(np.flatnonzero(~np.isfinite(clock))[0])
        yield Problem("inputs", f"The time of row {row + 1} is {clock[row]}.", "Drop such rows.")
    # Two rows of one time are a jump, as FMI's tools write it; three say nothing more.
    elif len(back := np.flatnonzero((np.diff(clock) < 0.0) | _third_of_a_time(clock))):
        row = int(back[0]) + 1
        message = f"The time of row {row + 1} is {clock[row]:g} s, after {clock[row - 1]:g} s in the row before."
        yield Problem(
            "inputs", message, "Times have to grow; two rows of one time are a jump. Sort the rows."
        )


def _third_of_a_time(clock):
    """Whether each row after the first is at least the third of its time."""
    is_same = np.diff(clock) == 0.0
    return is_same & np.concatenate([[False], is_same[:-1]])


def _rows(clock, times):
    """Rows from the last at or before the first time to the first at or after the last."""
    start = times[0]
    end = times[-1]
    # No extrapolation: the table must cover the whole run.
    if clock[0] > start + CLOSE or clock[-1] < end - CLOSE:
        message = f"The table goes from {clock[0]:.9g} s to {clock[-1]:.9g} s, the run from {start:.9g} s to {end:.9g} s."
        remedy = "Start later or stop earlier: the table has to cover the run from the first step to the last."
        raise error_at("inputs", message, remedy)
    first = max(0, np.searchsorted(clock, start + CLOSE, side="right") - 1)
    last = int(np.searchsorted(clock, end - CLOSE)) + 1
    # A jump at the end has its second row there too.
    return slice(int(first), max(last, int(np.searchsorted(clock, end + CLOSE, side="right"))))


def _gaps(table, clock):
    """Times between rows that are longer than allowed."""
    apart = np.diff(clock)
    longest = table.attrs.get("max_gap")
    # Without a given limit: if 90 % of the rows are evenly spaced, five missing rows are a gap.
    # Uneven logs have no usual distance.
    if longest is None:
        usual = float(np.median(apart)) if len(apart) else 0.0
        even = len(apart) >= 10 and np.mean(np.abs(apart - usual) <= 0.5 * usual) >= 0.9
        longest = LONGEST_GAP * usual if even else np.inf
    for row in np.flatnonzero(apart > longest * (1.0 + 1e-9))[:5]:
        between = f"{clock[row]:.9g} s and {clock[row + 1]:.9g} s"
        yield Problem(
            "inputs",
            f"There is no row between {between}; {longest:.3g} s are allowed.",
            "Run the components before and after it, fill it, or allow it (max_gap, --max-gap).",
        )


def _column(column, signal, clock, times, largest):
    """Values of a column at the times, in the unit of the input that it feeds; `largest` bounds integers."""
    how = column.attrs.get("interpolation", "held")
    values = column.values
    if how not in INTERPOLATIONS or (how == "linear" and signal.type != "Real"):
        raise error_at(
            "",
            f"interpolation = {how!r} of a {signal.type}.",
            "It can be 'held', or 'linear' for a Real.",
        )
    if len(bad := np.flatnonzero(~np.isfinite(values))):
        more = f" So are {len(bad) - 1} more of the rows that are needed." if len(bad) > 1 else ""
        raise error_at(
            "",
            f"is {values[bad[0]]} at {clock[bad[0]]:.9g} s.{more}",
            "Fill or drop such rows; a dropped row is held or interpolated over.",
        )
    # Flags and integers must be whole and fit: a rounded or wrapped value would hide an error of the log.
    low, high = (0, 1) if signal.type == "Boolean" else largest
    off = (values != np.round(values)) | (values < low) | (values > high)
    if signal.type != "Real" and off.any():
        raise error_at(
            "",
            f"is {values[off][0]} at {clock[off][0]:.9g} s.",
            f"It feeds an input of type {signal.type}: whole numbers from {low} to {high}.",
        )
    # Convert the unit before interpolating, so that a full turn is in the input's unit.
    factor, offset = conversion(column.attrs.get("units"), signal.unit)
    values = values if (factor, offset) == (1.0, 0.0) else factor * values + offset
    if how == "linear":
        return _interpolated(clock, values, times, ANGLES.get(signal.unit))
    return values[_before(clock, times)]


def _before(clock, times):
    """Index of the last row at or before each time."""
    return np.searchsorted(clock, times + CLOSE, side="right") - 1


def _interpolated(clock, values, times, turn):
    """Values between the rows, (n,); `turn` is a full turn of an angle, or None."""
    if len(clock) == 1:
        return values[_before(clock, times)]
    # The interval of each time; the last row belongs to the last interval.
    row = np.minimum(_before(clock, times), len(clock) - 2)
    rise = np.diff(values)
    # Angles go the shorter way round: wrap each rise to half a turn either way.
    if turn is not None:
        rise = (rise + 0.5 * turn) % turn - 0.5 * turn
    # Linear: x = x₀ + s (x₁ - x₀), s within 0 and 1. At a jump the value after it holds.
    length = np.diff(clock)[row]
    share = np.ones(len(row))
    np.divide(times - clock[row], length, out=share, where=length > 0.0)
    share = np.clip(share, 0.0, 1.0)
    return values[row] + share * rise[row]
