"""Quantities: numbers and verdicts to which a run is reduced."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.errors import Problem
from shipcosim.scenario import Event, Expectation, Scenario, units_of
from shipcosim.scenario.amounts import expectation_in_numbers
from shipcosim.scenario.check import expectation_complaints
from shipcosim.scenario.judge import rows_of, values_of, verdict_on
from shipcosim.sweep.margin import UNITS, Margin, complaint_of_margin, margin_of
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.study_model import Quantity, Study
from shipcosim.units import Unit

if TYPE_CHECKING:
    import xarray

    from shipcosim.ssp import System

Reduction = Callable[[np.ndarray, np.ndarray, float], Any]


@dataclass(frozen=True)
class Measure:
    """A quantity with its signals in the units of a system.

    Parameters
    ----------
    name, description : str
        Of its column.
    unit : str or None
        Of its values; None where it is true or false.
    expect : tuple of Expectation
        In plain numbers: what is judged, or the one whose signals and window are reduced.
    units : mapping of str to Unit or None
        Of all signals.
    reduce : str
        How; empty where it is true or false.
    argument : float
        Time, percentile or limit.
    since : float
        Where the run's time begins to count. [s]
    margin : Margin or None
        What follows from start values, not from a table.
    needs : float
        Time that a run must reach: the end of the last window, or of the run that was planned. [s]
    remarks : tuple of str
        What of the scenario's expectations the study does not reach.
    """

    name: str
    description: str
    unit: str | None
    expect: tuple[Expectation, ...]
    units: Mapping[str, Unit | None]
    reduce: str = ""
    argument: float = np.nan
    since: float = 0.0
    margin: Margin | None = None
    needs: float = 0.0
    remarks: tuple[str, ...] = ()

    @property
    def is_truth(self) -> bool:
        """True if the quantity is a verdict."""
        return not self.reduce and self.margin is None

    @property
    def may_never_be(self) -> bool:
        """True if NaN means never, which counts as later than any time."""
        return self.reduce == "time_beyond"

    def of(self, table: xarray.Dataset) -> float | bool | None:
        """The quantity of a run from its table; NaN if it has no row or is never reached.

        A run that ends before all that is judged or reduced has happened has no value: None of a verdict, or NaN.
        """
        if not self.is_reached_at(table["time"].values[-1]):
            return None if self.is_truth else np.nan
        # A verdict: all expectations must hold.
        if self.is_truth:
            return all(
                verdict_on(table, expectation, self.units.__getitem__).passed
                for expectation in self.expect
            )
        rows = rows_of(table, self.expect[0])
        # Time counts from `since`; rows before it do not matter.
        rows = rows[table["time"].values[rows] >= self.since - 1e-9] if self.since else rows
        if len(rows) == 0:
            return np.nan
        values = values_of(table, self.expect[0], rows, self.units.__getitem__)
        # One signal by itself, or the distance √Σ(x - x₀)² of several from a point.
        single: Any = (
            values[:, 0] if self.expect[0].near is None else np.hypot.reduce(values, axis=1)
        )
        value = float(REDUCED[self.reduce](table["time"].values[rows], single, self.argument))
        return value - self.since if self.since else value

    def is_reached_at(self, end: float) -> bool:
        """True if a run with this end has all that the quantity needs. [s]"""
        return end >= self.needs - 1e-9 * max(1.0, abs(self.needs))


def _at(times: np.ndarray, values: np.ndarray, time: float) -> Any:
    """Value of the last row that is not after a time."""
    # Times are multiples of the step; the tolerance is for their rounding.
    row = int(np.searchsorted(times, time + 1e-9 * max(1.0, abs(time)), side="right")) - 1
    return values[row] if row >= 0 else np.nan


def _time_beyond(times: np.ndarray, values: np.ndarray, limit: float) -> Any:
    # First time of a magnitude above the limit; NaN means never.
    beyond = np.flatnonzero(np.abs(values) > limit)
    return times[beyond[0]] if len(beyond) else np.nan


REDUCED: dict[str, Reduction] = {
    "maximum": lambda times, values, _: values.max(),
    "minimum": lambda times, values, _: values.min(),
    "mean": lambda times, values, _: values.mean(),
    "rms": lambda times, values, _: np.sqrt(np.mean(values**2)),
    "final": lambda times, values, _: values[-1],
    "at": _at,
    "percentile": lambda times, values, percentile: np.percentile(values, percentile),
    "time_beyond": _time_beyond,
    "share_beyond": lambda times, values, limit: np.mean(np.abs(values) > limit),
}
"""Reductions of (times, values, argument)."""


def measures_of(
    study: Study,
    scenario: Scenario,
    system: System,
    events: Iterable[Event] = (),
    planned: float = 0.0,
) -> tuple[tuple[Measure, ...], list[Problem]]:
    """Quantities of a study in a system's units, and their problems.

    Parameters
    ----------
    study : Study
    scenario : Scenario
        Of all runs.
    system : System
        That runs.
    events : iterable of Event
        That some of the runs have.
    planned : float
        Stop time for which the scenario's expectations were written. [s]
    """
    # A case may run longer than the scenario: the longest end counts.
    ends = [case.stop_time or 0.0 for factor in study.factor for case in factor.case or ()]
    end = max(scenario.stop_time, *ends, 0.0)
    # Signals that events change count as known, though nothing may feed them.
    changed = {signal for event in [*scenario.events, *events] for _, signal, _ in event.changes}
    problems = [
        problem_of(
            study,
            ("quantity", number, *((key,) if quantity.signal else ("expect", i, key))),
            message,
            remedy,
        )
        for number, quantity in enumerate(study.quantity)
        for i, expect in enumerate(_claims(quantity, scenario, end, planned))
        for key, message, remedy in expectation_complaints(expect, system, changed)
    ]
    tracked = study.tracks.signals if study.tracks else []
    # Tracks need signals that exist; an expectation with any limit checks the same.
    for signal in tracked:
        for _, found, remedy in expectation_complaints(
            Expectation(signal=[signal], at_most=0.0), system, changed
        ):
            problems.append(problem_of(study, ("tracks", "signals"), found, remedy))
    margins = [i for i, quantity in enumerate(study.quantity) if quantity.margin]
    problems += filter(None, (complaint_of_margin(study, number, system) for number in margins))
    problems += _outside(study, scenario, end, planned)
    return () if problems else tuple(
        _measure(quantity, scenario, system, end, planned) for quantity in study.quantity
    ), problems


def _claims(
    quantity: Quantity, scenario: Scenario, end: float, planned: float
) -> list[Expectation]:
    if quantity.margin:
        return []
    if not quantity.judges:
        return [quantity.claim]
    within = [
        expectation for expectation in scenario.expect if _end_of(expectation, planned) <= end
    ]
    return [*quantity.expect, *(within if quantity.scenario_expectations else ())]


def _end_of(expect: Expectation, planned: float) -> float:
    """When all that an expectation of the scenario judges has happened; what holds in every row can be judged before."""
    if expect.during:
        return expect.during[1]
    return planned if expect.statistic else 0.0


def _remarks(quantity: Quantity, scenario: Scenario, end: float, planned: float) -> Iterable[str]:
    """Expectations of the scenario that the study does not judge."""
    if not quantity.scenario_expectations:
        return
    late = sum(_end_of(expectation, planned) > end for expectation in scenario.expect)
    if late:
        yield (
            f"{quantity.name}: {late} of {len(scenario.expect)} expectations of {scenario.name} are not judged: they"
            f" need more than the {end:g} s of the runs."
        )
    partly = sum(
        not expectation.during and not expectation.statistic for expectation in scenario.expect
    )
    if partly and end < planned:
        yield (
            f"{quantity.name}: {partly} of {len(scenario.expect)} expectations of {scenario.name} are judged on the"
            f" first {end:g} s of its {planned:g} s."
        )


def _outside(study: Study, scenario: Scenario, end: float, planned: float) -> Iterable[Problem]:
    """Windows and times that no run reaches."""
    for number, quantity in enumerate(study.quantity):
        times = [(("during",), time) for time in quantity.during or ()]
        times += [(("time",), quantity.time), (("since",), quantity.since)]
        for i, expect in enumerate(quantity.expect):
            times += [(("expect", i, "during"), time) for time in expect.during or ()]
        for keys, time in times:
            if time is None or 0.0 <= time <= end:
                continue
            message = f"{keys[-1]} lies beyond the end of the runs at {end:g} s."
            if time < 0.0:
                message = f"{keys[-1]} lies before the runs, which begin at 0 s."
            yield problem_of(
                study, ("quantity", number, *keys), message, "Take a time within them."
            )
        if quantity.scenario_expectations and len(_claims(quantity, scenario, end, planned)) == len(
            quantity.expect
        ):
            message = (
                f"The scenario {study.scenario} expects nothing within {scenario.stop_time:g} s."
            )
            keys = "quantity", number, "scenario_expectations"
            yield problem_of(study, keys, message, "Write expect = [...] here.")


def _measure(
    quantity: Quantity, scenario: Scenario, system: System, end: float, planned: float
) -> Measure:
    if quantity.margin:
        # A margin follows from start values and needs no table.
        text = (
            quantity.description
            or f"{quantity.margin} margin of {quantity.component}, the least of its axes"
        )
        margin = margin_of(quantity, system)
        return Measure(quantity.name, text, UNITS[quantity.margin], (), {}, margin=margin)
    unit_of = units_of(system)
    # Limits and windows in plain numbers, in the units of the signals.
    claims = _claims(quantity, scenario, end, planned)
    expect = tuple(expectation_in_numbers(claim, unit_of) for claim in claims)
    # The study's own expectations without a window are meant for each run as long as it is.
    needs = [_end_of(claim, 0.0 if claim in quantity.expect else planned) for claim in claims]
    units = {signal: unit_of(signal) for expectation in expect for signal in expectation.signals}
    if quantity.reduce is None:
        remarks = tuple(_remarks(quantity, scenario, end, planned))
        return Measure(
            quantity.name,
            quantity.description,
            None,
            expect,
            units,
            needs=max(needs),
            remarks=remarks,
        )
    first = units[quantity.signal[0]]
    unit = {"time_beyond": "s", "share_beyond": "1"}.get(
        quantity.reduce, first.name if first else "1"
    )
    # The limit of a distance or value is stored in the expectation, where its unit was converted.
    limit = expect[0].within if quantity.near is not None else expect[0].at_most
    argument = {"at": quantity.time, "percentile": quantity.percentile}.get(quantity.reduce, limit)
    text = quantity.description or f"{quantity.reduce} of {expect[0].subject}"
    since = quantity.since or 0.0
    return Measure(
        quantity.name,
        text,
        unit,
        expect,
        units,
        quantity.reduce,
        float(argument or 0.0),
        since,
        # What never happens within a run counts as later than any time, however long the run is.
        needs=0.0 if quantity.reduce == "time_beyond" else max(*needs, quantity.time or 0.0),
    )
