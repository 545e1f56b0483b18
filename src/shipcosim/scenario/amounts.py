"""Amounts with a unit in events and expectations (``"45 deg"``), converted to signal units."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf
from typing import TYPE_CHECKING, Any

from shipcosim.scenario.model import Event, Expectation, Scenario
from shipcosim.units import Unit, UnitError, is_amount, number_in, relation

if TYPE_CHECKING:
    from shipcosim.ssp import System

UnitOf = Callable[[str], Unit | None]
"""Unit of a signal, or None."""


def units_of(system: System) -> UnitOf:
    """Units of a system's signals, as their FMUs define them."""
    return lambda signal: system.unit_of(*system.split(signal))


def with_numbers(scenario: Scenario, unit_of: UnitOf) -> Scenario:
    """Convert the events and expectations of a scenario to plain numbers in signal units.

    Parameters
    ----------
    scenario : Scenario
        Checked. Its start values are left as they are: `shipcosim.ssp.with_values` reads them.
    unit_of : callable
        Unit of a signal.

    Raises
    ------
    UnitError
        If an amount measures another thing than its signal.
    """
    # Texts with units become numbers; everything else stays.
    events = [_event(event, unit_of) for event in scenario.events]
    expect = [expectation_in_numbers(expectation, unit_of) for expectation in scenario.expect]
    return scenario.model_copy(update={"events": events, "expect": expect})


def _event(event: Event, unit_of: UnitOf) -> Event:
    # A bias is a difference: an offset between units does not apply.
    override = {
        signal: in_unit_of(value, signal, unit_of) for signal, value in event.override.items()
    }
    bias = {
        signal: in_unit_of(value, signal, unit_of, True) for signal, value in event.bias.items()
    }
    return event.model_copy(update={"override": override, "bias": bias})


def expectation_in_numbers(expect: Expectation, unit_of: UnitOf) -> Expectation:
    """Expectation in plain numbers: `near` in the units of its signals, all else in the first unit.

    Raises
    ------
    UnitError
        If an amount measures another thing than its signal.
    """
    values = {}
    # `within` is a difference, as a bias is.
    for key, signal, value in _amounts(expect):
        number = in_unit_of(value, signal, unit_of, key == "within")
        values[key] = [*values.get(key, ()), number] if key == "near" else number
    return expect.model_copy(update=values)


def _amounts(expect: Expectation) -> Iterator[tuple[str, str, Any]]:
    """(key, signal, value) of each value of an expectation, names of signals in `near` included."""
    # Targets belong to their signals, limits to the first one.
    for signal, value in zip(expect.signal, expect.near or (), strict=False):
        yield "near", signal, value
    for key in ("within", "at_least", "at_most"):
        if (value := getattr(expect, key)) is not None:
            yield key, expect.signal[0], value


def in_unit_of(value: Any, signal: str, unit_of: UnitOf, difference: bool = False) -> Any:
    """Convert a value with a unit; other texts, such as enumeration items, stay as they are."""
    if not is_amount(value):
        return value
    return number_in(value, unit_of(signal), difference=difference)


def amount_complaints(expect: Expectation, unit_of: UnitOf) -> Iterator[tuple[str, str, str]]:
    """Problems with the amounts of an expectation and their units: (key, found, remedy).

    Parameters
    ----------
    expect : Expectation
        All of whose signals there are.
    unit_of : callable
        Unit of a signal.
    """
    numbers: dict[str, Any] = {}
    # Signals of one distance must have one kind of unit.
    first = expect.signal[0]
    for other in expect.signal[1:]:
        if _differ(first, other, unit_of):
            message = f"{_in(first, unit_of)} and {_in(other, unit_of)}: no distance spans the two."
            yield "signal", message, "Write an expectation for each."
    # A target signal must measure the same as its signal.
    for key, signal, value in _amounts(expect):
        if key == "near" and value in expect.signals and _differ(signal, value, unit_of):
            message = (
                f"{_in(signal, unit_of)} and {_in(value, unit_of)}: they measure different things."
            )
            yield key, message, f"Compare {signal} with a signal of its unit."
        # Amounts must be convertible to the unit of their signal.
        try:
            numbers[key] = in_unit_of(value, signal, unit_of, key == "within")
        except UnitError as error:
            yield key, f"{key} of {signal}: {error.found}", error.remedy
    # Limits may have units of their own: as numbers they show which one is higher.
    if numbers.get("at_least", -inf) > numbers.get("at_most", inf):
        message = f"at_least = {expect.at_least} lies above at_most = {expect.at_most}."
        yield "at_least", message, "No value is between them. Exchange the two."


def _differ(first: str, other: str, unit_of: UnitOf) -> bool:
    """True if two signals cannot be compared; without a unit they can, as nothing is known."""
    units = unit_of(first), unit_of(other)
    return (
        units[0] is not None
        and units[1] is not None
        and relation(units[0], units[1]) == "incompatible"
    )


def _in(signal: str, unit_of: UnitOf) -> str:
    unit = unit_of(signal)
    return f"{signal} is in {unit.name if unit else '1'}"
