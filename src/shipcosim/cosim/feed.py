"""A table that feeds the inputs of a system."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.series import conversion

if TYPE_CHECKING:
    import xarray

    from shipcosim.ssp import System

INTERPOLATIONS = ("held", "linear")


def feed(table: xarray.Dataset, system: System, times: np.ndarray) -> dict[str, np.ndarray]:
    """Values of a system's inputs at the times of the steps.

    Parameters
    ----------
    table : Dataset
        Its variables are named like the inputs. The attribute ``interpolation`` of a variable says what it does
        between its rows: ``"held"`` (the default) or ``"linear"``.
    system : System
        With these inputs.
    times : (n,) array
        Of the steps. [s]

    Returns
    -------
    dict of str to (n,) array

    Raises
    ------
    ShipcosimError
        If a name, a unit or a time does not fit, or a value is not finite.
    """
    clock = table["time"].values
    if len(clock) == 0 or np.any(np.diff(clock) <= 0.0) or clock[0] > times[0] or clock[-1] < times[-1] - 1e-9:
        span = f"cover {clock[0]:g} to {clock[-1]:g} s" if len(clock) else "are none"
        remedy = f"They have to grow from 0 to at least {times[-1]:g} s."
        raise ShipcosimError(Problem("inputs", f"The times {span}, or do not grow.", remedy))
    problems, fed = [], {}
    for name, column in table.data_vars.items():
        try:
            fed[name] = _column(str(name), column, system, clock, times)
        except ShipcosimError as error:
            problems += error.problems
    if problems:
        raise ShipcosimError(problems)
    return fed


def _column(name, column, system, clock, times):
    where = f"inputs: {name}"
    if name not in system.inputs:
        raise ShipcosimError(Problem(where, f"{system.name} has no input '{name}'.", suggestion(name, system.inputs)))
    how, kind = column.attrs.get("interpolation", "held"), system.inputs[name].type
    if how not in INTERPOLATIONS or (how == "linear" and kind != "Real"):
        remedy = "It can be 'held', or 'linear' for a Real."
        raise ShipcosimError(Problem(where, f"interpolation = {how!r} of a {kind}.", remedy))
    if not np.isfinite(column.values).all():
        row = int(np.flatnonzero(~np.isfinite(column.values))[0])
        raise ShipcosimError(Problem(where, f"is {column.values[row]} at {clock[row]:g} s.", "Fill or drop such rows."))
    factor, offset = conversion(column.attrs.get("units"), system.inputs[name].unit)
    values = column.values if (factor, offset) == (1.0, 0.0) else factor * column.values + offset
    if how == "linear":
        return np.interp(times, clock, values)
    return values[np.searchsorted(clock, times + 1e-9, side="right") - 1]
