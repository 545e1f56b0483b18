"""A capability as numbers: a DP capability number for each direction, the notation of the standard, tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from shipcosim.capability.conditions import BOW_SECTOR, CONDITIONS, DIRECTIONS, DYNAMIC_FACTOR
from shipcosim.capability.thrust import Thruster
from shipcosim.capability.vessel import Vessel

if TYPE_CHECKING:
    import xarray

LEVEL_1 = "level 1"
SIMULATOR = "simulator"
"""The two ways in which loads and thrust are computed."""

BALANCED = 1.0 + 1e-6
"""Share of the thrust up to which a load counts as balanced: 1, and what a linear programme leaves."""

SCHEMA = "shipcosim-capability/1"


@dataclass(frozen=True)
class Case:
    """A state of the thrusters: its name, and the names of those that do not work."""

    name: str
    failed: tuple[str, ...]

    def split(self, thrusters: Iterable[Thruster]) -> tuple[list[Thruster], list[Thruster]]:
        """Split thrusters into working and failed ones."""
        listed = list(thrusters)
        return [t for t in listed if t.name not in self.failed], [
            t for t in listed if t.name in self.failed
        ]


@dataclass(frozen=True)
class Capability:
    """Static DP capability of a ship.

    Attributes
    ----------
    vessel : Vessel
    cases : tuple of Case
        The first is the intact ship.
    used : mapping of str to (cases, conditions, directions) array
        By `LEVEL_1` and `SIMULATOR` the share of the thrust that the balance uses; above 1: there is none. Infinite
        where the thrusters that work cannot act against the load at all. [1]
    """

    vessel: Vessel
    cases: tuple[Case, ...]
    used: Mapping[str, NDArray]

    def numbers(self, method: str = LEVEL_1) -> NDArray:
        """DP capability numbers, (cases, directions): the condition before the first unbalanced."""
        # A condition counts only if all lower ones hold too: the product turns 0 at the first that
        # fails.
        holds = np.cumprod(self.used[method] <= BALANCED, axis=1)
        return holds.sum(axis=1)

    def worst(self, method: str = LEVEL_1, *, most_lost: int | None = None) -> NDArray:
        """Lowest number after any failure, (directions,); `most_lost` limits the lost thrusters."""
        lost = [len(case.failed) for case in self.cases]
        # The intact case loses none and does not count here.
        counts = [0 < number <= (most_lost or number) for number in lost]
        return self.numbers(method)[counts].min(axis=0)

    def elements(
        self, method: str = LEVEL_1, *, most_lost: int | None = None
    ) -> tuple[int, int, int, int]:
        """A, B, C, D of the notation.

        A: the lowest number of the intact ship with the weather within 30 deg of the bow; B: from anywhere; C and D:
        the same after the worst single failure, with `most_lost` of so many thrusters at most.
        """
        # Weather from ahead: angles on both sides within the bow sector.
        near_bow = np.minimum(DIRECTIONS, 2.0 * np.pi - DIRECTIONS) <= BOW_SECTOR + 1e-9
        intact = self.numbers(method)[0]
        worst = self.worst(method, most_lost=most_lost)
        return (
            int(intact[near_bow].min()),
            int(intact.min()),
            int(worst[near_bow].min()),
            int(worst.min()),
        )


def notation(capability: Capability) -> str:
    """The result as the standard writes it, ``"DP capability-L1(4, 3, 2, 0)"``."""
    return f"DP capability-L1({', '.join(map(str, capability.elements()))})"


def numbers_table(capability: Capability) -> str:
    """DP capability numbers as CSV: a row per direction, a column per case and method."""
    import pandas

    columns = {
        f"{method}, {name} [1]": values
        for method in capability.used
        for name, values in _named(capability, method)
    }
    # Degrees in tables, for readers.
    angles = np.degrees(DIRECTIONS).round(9)
    table = pandas.DataFrame({"weather_from [deg]": angles, **columns})
    return table.to_csv(index=False, lineterminator="\n")


def _named(capability: Capability, method: str) -> list[tuple[str, NDArray]]:
    """Numbers of each case, and of the worst failure, by name."""
    names = [case.name for case in capability.cases]
    return [
        *zip(names, capability.numbers(method), strict=True),
        ("worst failure", capability.worst(method)),
    ]


def dataset(capability: Capability) -> xarray.Dataset:
    """Numbers and shares of thrust by basis (method), case, condition and direction."""
    # Stack both methods along one axis, so that a plot can compare them.
    import xarray

    methods = list(capability.used)
    used = np.stack([capability.used[method] for method in methods])
    numbers = np.stack([capability.numbers(method) for method in methods])
    coordinates = {
        "basis": methods,
        "case": [case.name for case in capability.cases],
        "condition": [condition.number for condition in CONDITIONS],
        "weather_from": (
            "weather_from",
            np.degrees(DIRECTIONS).round(9),
            {"units": "deg", "long_name": "clockwise from the bow"},
        ),
    }
    for name, unit in {
        "wind_speed": "m/s",
        "wave_height": "m",
        "wave_period": "s",
        "current_speed": "m/s",
    }.items():
        coordinates[name] = ("condition", [getattr(c, name) for c in CONDITIONS], {"units": unit})
    about = {
        "units": "1",
        "long_name": "share of the thrust that the balance uses; above 1 there is none",
    }
    return xarray.Dataset(
        {
            "thrust_used": (("basis", "case", "condition", "weather_from"), used, about),
            "number": (
                ("basis", "case", "weather_from"),
                numbers,
                {"units": "1", "long_name": "DP capability number"},
            ),
        },
        coordinates,
        {
            "ship": capability.vessel.name,
            "system": capability.vessel.system,
            "notation": notation(capability),
        }
        | {"dynamic_factor": DYNAMIC_FACTOR},
    )


def as_json(capability: Capability) -> dict[str, Any]:
    """The numbers for programs."""
    lists = {
        m: {name: values.tolist() for name, values in _named(capability, m)}
        for m in capability.used
    }
    return {
        "schema": SCHEMA,
        "ship": capability.vessel.name,
        "system": capability.vessel.system,
        "notation": notation(capability),
        **dict(zip("ABCD", capability.elements(), strict=True)),
        "weather_from_deg": np.degrees(DIRECTIONS).round(9).tolist(),
        "numbers": lists,
    }
