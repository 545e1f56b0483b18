"""Values that are possible but unlikely: an angle of 45 rad, a ship of 1 kg. Only remarks.

All bounds are here, each with its reason.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipcosim.errors import Problem
from shipcosim.scenario.locations import problem_at
from shipcosim.scenario.model import Scenario, Value
from shipcosim.units import RADIAN, relation, spelled_unit

if TYPE_CHECKING:
    from shipcosim.ssp import System

SHIP = ("x", "y", "psi", "mass")  # variables by which a component is a ship


@dataclass(frozen=True)
class Range:
    """Plausible range of a kind of variable.

    Parameters
    ----------
    name : str
        Pattern of the variable's name.
    unit : str
        Of the bounds; variables of another kind are not meant.
    low, high : float
        Values beyond them earn a remark.
    reason : str
        What the bounds stand for, as the end of a sentence.
    of_ship : bool
        Whether it holds for components alone that are ships.
    """

    name: str
    unit: str
    low: float
    high: float
    reason: str
    of_ship: bool = False


RANGES = (
    Range(
        "mass",
        "kg",
        5.0,
        1e9,
        "survey craft have 15 kg and more, the largest ship had 6.6e8 kg",
        of_ship=True,
    ),
    Range("(apparent_)?wind_speed", "m/s", 0.0, 60.0, "a hurricane of category 4 has 58 m/s"),
    Range("current_speed", "m/s", 0.0, 10.0, "the strongest tidal currents reach 10 m/s"),
    Range(
        "(significant_)?wave_height",
        "m",
        0.0,
        25.0,
        "the largest significant height ever measured is 19 m",
    ),
)


def odd_values(scenario: Scenario, system: System) -> Iterator[Problem]:
    """Remarks on unlikely values.

    Parameters
    ----------
    scenario : Scenario
        Its start values are those of the system already.
    system : System
        With its start values.
    """
    # Start values as numbers; a text with a unit was meant as it is written.
    for component in system.components.values():
        for name, value in component.start.items():
            signal = f"{component.name}.{name}"
            written = scenario.set.get(signal, value)
            if not isinstance(written, str) and (
                oddity := _odd(system, component.name, name, value)
            ):
                yield Problem(signal, *oddity, "remark")
    # Values that events set; a bias may be anything.
    for number, event in enumerate(scenario.events):
        for verb, signal, value in event.changes:
            if verb == "override" and (oddity := _odd(system, *system.split(signal), value)):
                message, remedy = oddity
                yield problem_at(
                    scenario,
                    ("events", number, verb, signal),
                    f"{signal}: {message}",
                    remedy,
                    "remark",
                )


def _odd(
    system: System, component: str | None, name: str, value: Value | None
) -> tuple[str, str] | None:
    """Why a value is odd in its unit, and what may be meant; None if it is not."""
    # Only numbers with a unit can be compared.
    unit = system.unit_of(component, name)
    if unit is None or isinstance(value, (bool, str)) or not isinstance(value, (int, float)):
        return None
    # Size of a value in rad in whole turns; 0 for other units.
    named = unit.name == "rad" or relation(unit, RADIAN) == "same"
    turns = abs(value) / (2.0 * math.pi) if named else 0.0
    # More than a whole turn: probably degrees without a unit.
    if turns > 1.0:
        return (
            f"{value:g} {unit.name} is more than a whole turn.",
            f'If degrees are meant, write "{value:g} deg".',
        )
    # Some ranges hold for ships only.
    variables = system.components[component].variables if component is not None else {}
    is_ship = all(name_of_ship in variables for name_of_ship in SHIP)
    # Compare in the unit of the range.
    for usual in RANGES:
        bounds = spelled_unit(usual.unit)
        if (
            bounds is None
            or relation(unit, bounds) not in ("same", "convertible")
            or (usual.of_ship and not is_ship)
        ):
            continue
        size = value * unit.factor / bounds.factor
        if re.fullmatch(usual.name, name) and not usual.low <= size <= usual.high:
            if size < 0.0:
                return f"{value:g} {unit.name} is negative.", "Check its sign."
            few = "little" if size < usual.low else "much"
            return f"{value:g} {unit.name} is very {few}: {usual.reason}.", "Check number and unit."
    return None
