"""Verdicts on a run: does its table meet the expectations of the scenario?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.angles import TURN, wrap_series
from shipcosim.errors import Problem, raise_errors, suggestion
from shipcosim.scenario.amounts import UnitOf, amount_complaints, expectation_in_numbers
from shipcosim.scenario.locations import problem_at
from shipcosim.scenario.model import Expectation, Scenario
from shipcosim.units import RADIAN, conversion, find_unit, relation

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class Verdict:
    """Whether an expectation holds.

    Parameters
    ----------
    expect : Expectation
        What was expected, in plain numbers in the units of the signals.
    passed : bool
        Whether it holds.
    worst : float
        Value farthest on the wrong side: a distance where `near` was given, else the signal. NaN without a row.
    time : float
        When. [s]
    """

    expect: Expectation
    passed: bool
    worst: float
    time: float

    def __str__(self) -> str:
        measure = "distance" if self.expect.near is not None else "value"
        message = (
            f"worst {measure} {self.worst:.4g} at {self.time:g} s"
            if np.isfinite(self.time)
            else "no row to judge"
        )
        return f"{'holds' if self.passed else 'FAILS'}: {self.expect} ({message})"


def within_run(
    scenario: Scenario, table: xarray.Dataset, planned: float = 0.0
) -> tuple[list[Expectation], list[Expectation]]:
    """Expectations of a scenario within a table's times, and the others.

    An expectation on every row also holds for part of a run, if more than its start; a statistic of the whole run
    does not.

    Parameters
    ----------
    scenario : Scenario
    table : xarray.Dataset
        The run, or a part of it.
    planned : float
        Stop time for which the expectations were written, where the scenario's is shorter. [s]
    """
    # The whole run contains every expectation.
    first, last = table["time"].values[[0, -1]]
    is_whole = first == 0.0 and last >= max(planned, scenario.stop_time) - 1e-9
    split: tuple[list[Expectation], list[Expectation]] = [], []
    for expect in scenario.expect:
        # A window counts where all of it ran, also where a study or the scenario itself ends before it does.
        if expect.during:
            lies_within = first <= expect.during[0] and expect.during[1] <= last + 1e-9
        else:
            lies_within = is_whole or (last > first and not expect.statistic)
        split[0 if lies_within else 1].append(expect)
    return split


def judge(table: xarray.Dataset, scenario: Scenario) -> list[Verdict]:
    """Verdict on each expectation of a scenario, in its order.

    A window without a row, or a signal that is not finite, fails.

    Raises
    ------
    ShipcosimError
        If a signal is not in the table, or an expectation takes different things together: metres and radians.
    """
    # Expected signals must be in the table.
    missing = [
        Problem(
            scenario.name,
            f"the table has no signal '{signal}'.",
            suggestion(signal, map(str, table.data_vars)),
        )
        for expect in scenario.expect
        for signal in expect.signals
        if signal not in table
    ]
    raise_errors(missing)
    # Units as the table states them, since it may come from another tool.
    unit_of = lambda signal: find_unit(table[signal].attrs.get("units") or None)  # noqa: E731
    wrong = [
        problem_at(scenario, ("expect", number, key), *complaint)
        for number, expect in enumerate(scenario.expect)
        for key, *complaint in amount_complaints(expect, unit_of)
    ]
    raise_errors(wrong)
    return [
        verdict_on(table, expectation_in_numbers(expect, unit_of), unit_of)
        for expect in scenario.expect
    ]


def verdict_on(table: xarray.Dataset, expect: Expectation, unit_of: UnitOf) -> Verdict:
    """Verdict on an expectation in plain numbers whose signals are all in the table; see `judge`."""
    # Without a row in its window an expectation fails.
    times = table["time"].values
    rows = rows_of(table, expect)
    if len(rows) == 0:
        return Verdict(expect, False, np.nan, np.nan)
    # Apply the statistic, then look for the row that misses the most.
    rows, values = _reduced(rows, values_of(table, expect, rows, unit_of), expect.statistic)
    excess = _excess(values, expect)
    # A value that is not finite is worse than any other.
    worst = int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))
    measure = values[worst, 0] if expect.near is None else np.hypot.reduce(values[worst])
    return Verdict(expect, bool(excess[worst] <= 0.0), float(measure), float(times[rows[worst]]))


def rows_of(table: xarray.Dataset, expect: Expectation) -> np.ndarray:
    """Rows in the window of an expectation; all rows without a window."""
    times = table["time"].values
    start, end = expect.during or (-np.inf, np.inf)
    # Times from files are rounded: rows at the edge count.
    tolerance = 1e-9 * max(1.0, abs(times[-1])) if len(times) else 0.0
    return np.flatnonzero((times >= start - tolerance) & (times <= end + tolerance))


def values_of(
    table: xarray.Dataset, expect: Expectation, rows: np.ndarray, unit_of: UnitOf
) -> np.ndarray:
    """Signals of an expectation as numbers, or differences from `near` in the first unit.

    Parameters
    ----------
    table : xarray.Dataset
        With all signals.
    expect : Expectation
    rows : (n,) array of int
        Of the table.
    unit_of : callable
        Unit of a signal.

    Returns
    -------
    (n, signals) array
    """
    # One column for each signal.
    values = np.column_stack([table[s].values[rows].astype(float) for s in expect.signal])
    if expect.near is None:
        return values
    first = unit_of(expect.signal[0])
    # Difference from the target, which is a number or another signal in its own unit.
    for i, (signal, target) in enumerate(zip(expect.signal, expect.near, strict=True)):
        unit = unit_of(signal)
        if isinstance(target, str):
            factor, offset = conversion(unit_of(target), unit)
            target = factor * table[target].values[rows].astype(float) + offset
        values[:, i] -= target
        # Angles the short way round: 359 deg is 1 deg from north.
        if unit is not None and relation(unit, RADIAN) in ("same", "convertible"):
            values[:, i] = wrap_series(values[:, i], TURN / unit.factor)
        # All differences in one unit, so that they form one distance.
        values[:, i] *= conversion(unit, first)[0]
    return values


def _reduced(
    rows: np.ndarray, values: np.ndarray, statistic: str | None
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and values after the statistic: one, or all."""
    # Mean and final value belong to the last row, extremes to their own row.
    if statistic == "mean":
        return rows[-1:], values.mean(axis=0, keepdims=True)
    if statistic == "final":
        return rows[-1:], values[-1:]
    if statistic in ("max", "min"):
        extreme = getattr(np, statistic)(values, axis=0, keepdims=True)
        return rows[np.argmax(values[:, 0] == extreme[0, 0])][None], extreme
    return rows, values


def _excess(values: np.ndarray, expect: Expectation) -> np.ndarray:
    """Amount by which each row misses the expectation; negative where it holds."""
    # Distance from the target beyond its tolerance.
    if expect.near is not None:
        return np.hypot.reduce(values, axis=1) - expect.within
    # Distance beyond the limit on either side.
    below = -np.inf if expect.at_least is None else expect.at_least - values[:, 0]
    above = -np.inf if expect.at_most is None else values[:, 0] - expect.at_most
    return np.maximum(below, above)
