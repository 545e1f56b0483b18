"""The DP of a described ship: parameters of its components, or why there is none."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np

from shipcosim.models.allocation.fixed_angles import UNITS
from shipcosim.ships.described import Described
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates import control
from shipcosim.ships.estimates.estimate import EstimatedNumber
from shipcosim.ships.file import number
from shipcosim.ships.numbers import Numbers
from shipcosim.ships.thrusters import ShipThruster

COMPONENTS = {
    "sensors": "sensors",
    "reference": "reference",
    "controller": "dp_controller",
    "allocator": "optimal_units_allocator",
    "consequences": "consequence_analysis",
}
"""Component: the FMU that it is."""
WORTH = 1e-3
"""Thrust over the ship's weight, below which DP holds nothing. [1]"""
LEAST = 0.013
"""Least thrust of an azimuth that runs, over its largest: 800 N of 60 kN, as tried for the tuned loop. [1]"""


def why_no_dp(ship: Described) -> str:
    """Reason why the thrusters allow no DP; empty where they do.

    Parameters
    ----------
    ship : Described
    """
    if len(ship.units) > UNITS:
        return f"the allocator takes {UNITS} thrusters, she has {len(ship.units)}"
    if not (used := units_for_dp(ship)):
        return "no thruster takes a thrust command with known limits"
    # DP needs a force in surge, in sway and a moment, each without the others.
    X, Y, N = _loop(ship, used).reach
    weak = [name for name, load in (("surge", X), ("sway", Y), ("yaw", N)) if load <= 0.0]
    return f"her thrusters give no force in {' and '.join(weak)} alone" if weak else ""


def units_for_dp(ship: Described) -> list[ShipThruster]:
    """Thrusters that the DP uses: those that take a commanded thrust."""
    return [unit for unit in ship.units if unit.most > 0.0 and unit.kind != "rudder"]


def mass_matrix(ship: Described) -> np.ndarray:
    """Mass matrix with added mass. [kg, kg.m, kg.m2]

    Parameters
    ----------
    ship : Described

    Returns
    -------
    (3, 3) array
    """
    value = {
        name: float(entry.value)
        for name, entry in ship.vessel.items()
        if isinstance(entry.value, (int, float))
    }
    # M = M_RB + M_A with the origin midships; the centre of gravity couples sway and yaw.
    m = value["mass"]
    static = value["mass"] * value.get("centre_of_gravity_x", 0.0)
    return np.array(
        [
            [m + value["A11"], 0.0, 0.0],
            [0.0, m + value["A22"], static + value["A26"]],
            [0.0, static + value["A62"], value["inertia_yaw"] + value["A66"]],
        ]
    )


def dp_entries(ship: Described) -> dict[str, dict[str, Quantity]]:
    """Parameters of sensors, reference, controller, allocator and consequence analysis.

    Parameters
    ----------
    ship : Described
        One whose thrusters allow a DP.

    Returns
    -------
    dict of dict of Quantity
        By component and parameter.
    """
    # Loop and components; the file's own values come before the rule.
    used = units_for_dp(ship)
    loop = _loop(ship, used)
    length = ship.form.length
    where = f"{ship.path}: control"
    by_component = {
        name: Numbers(fmu, where, ship.path.parent, "", []) for name, fmu in COMPONENTS.items()
    }
    by_component["sensors"].estimates(control.sensors(length))
    by_component["reference"].estimates(control.reference(loop))
    # Frequencies and limits that the user gives override the rule.
    given = ship.file.control
    for name in ("surge_frequency", "sway_frequency"):
        by_component["controller"].give(name, given.position_frequency)
    by_component["controller"].give("yaw_frequency", given.heading_frequency)
    by_component["controller"].give("position_error_max", given.position_error_max)
    by_component["controller"].estimates(control.controller(loop) | control.mast(length))
    # Controller and vessel share the wind table: feedforward then matches the ship's wind load.
    by_component["controller"].entries["wind_table"] = ship.vessel["wind_table"]
    allocation = _allocation(used)
    by_component["allocator"].estimates(allocation)
    by_component["consequences"].estimates(_consequences(used, allocation))
    return {name: numbers.entries for name, numbers in by_component.items()}


def _loop(ship: Described, used: list[ShipThruster]) -> control.ControlledShip:
    # Load of one newton of each thruster, and its limits. An azimuth counts as a thruster forward and one
    # across: both within a square that lies in the circle of its thrust.
    rows = []
    for unit in used:
        if unit.azimuth_rate > 0.0:
            side = unit.most * sqrt(0.5)
            rows += [(replace(unit, direction=a), -side, side) for a in (0.0, 0.5 * pi)]
        else:
            rows.append((unit, unit.least, unit.most))
    effects = np.array([unit.effect for unit, _, _ in rows]).T
    least = np.array([low for _, low, _ in rows])
    most = np.array([high for _, _, high in rows])
    # Loads below this floor count as none: the DP cannot hold the ship with them.
    reach = control.reach_of(effects, least, most)
    floor = WORTH * 0.01 * number(ship.file.mass.mass, ship.form.mass)
    X, Y, N = (
        0.0 if load < least else load
        for load, least in zip(reach, (floor, floor, 0.1 * floor), strict=True)
    )
    return control.ControlledShip(length=ship.form.length, mass=mass_matrix(ship), reach=(X, Y, N))


def _allocation(used: list[ShipThruster]) -> dict[str, EstimatedNumber]:
    """Places, directions and limits of the thrusters, as the allocator needs them."""
    entries = {}
    for i, unit in enumerate(used, 1):
        places = {"x": unit.x, "y": unit.y, "azimuth": unit.direction, "thrust_rate": unit.rate}
        places |= {"thrust_min": unit.least, "thrust_max": unit.most}
        places["azimuth_rate"] = unit.azimuth_rate
        if unit.screw is not None:
            places["specific_power"] = unit.screw.power / unit.screw.thrust
        entries |= {
            f"{name}_{i}": EstimatedNumber(value, 0.0, f"thruster {unit.name}")
            for name, value in places.items()
        }
        # No sectors are forbidden: no slipstream takes thrust in her system.
        if unit.azimuth_rate > 0.0:
            least = EstimatedNumber(
                LEAST * unit.most, 0.0, "1.3 % of the most, as tried with 60 kN"
            )
            entries[f"thrust_least_{i}"] = least
    # A missed yaw moment weighs as a missed force at the largest lever.
    lever = max(max(abs(unit.effect[2]) for unit in used), 0.1)
    return entries | {"yaw_lever": EstimatedNumber(lever, 0.0, "largest lever of a thruster")}


def _consequences(
    used: list[ShipThruster], allocation: dict[str, EstimatedNumber]
) -> dict[str, EstimatedNumber]:
    """Places, directions and limits of the thrusters as the allocator has them, and the group of each."""
    shared = {
        f"{name}_{i}": allocation[f"{name}_{i}"]
        for i in range(1, len(used) + 1)
        for name in ("x", "y", "azimuth", "azimuth_rate", "thrust_min", "thrust_max")
    }
    groups = {
        f"group_{i}": EstimatedNumber(float(unit.group), 0.0, f"thruster {unit.name}")
        for i, unit in enumerate(used, 1)
    }
    return shared | groups
