"""Checks of a described ship: what is impossible, and what is unusual."""

from collections.abc import Iterator, Mapping
from math import pi
from typing import Any

import numpy as np

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.ships.control import mass_matrix, why_no_dp
from shipcosim.ships.described import Described, describe, file_of, read_file
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates.hull import FLATTEST
from shipcosim.ships.estimates.propulsion import MOST_KT, most_thrust
from shipcosim.ships.estimates.resistance import MOST_FROUDE, froude_number
from shipcosim.ships.file import number
from shipcosim.ships.folder import read_ship
from shipcosim.ships.numbers import ESTIMATED
from shipcosim.ships.passivity import driven_by_water
from shipcosim.ships.system import check_numbers, steering_units
from shipcosim.ships.thrusters import ShipThruster

BLOCK = (0.2, 1.0)
"""Block coefficients of ships."""
OWN_BLOCK = 0.05
"""Share by which the displacement may differ from the block coefficient's."""
SLENDER = (1.0, 20.0)
SHALLOW = (0.3, 30.0)
"""Length over breadth, breadth over draught."""
GYRADIUS = (0.15, 0.40)
BEYOND = 0.6
"""Share of the length or breadth from the middle, beyond which a thruster hangs outside of the ship."""
DRIVING = ("X_u", "X_uu", "Y_v", "Y_modvv", "N_r", "N_modrr")
"""Damping coefficients that are negative in every ship."""


def check_ship(path: str) -> list[Problem]:
    """Find everything that is missing, unreadable or impossible in a ship file.

    Parameters
    ----------
    path : str
        The file, or the folder around a ``ship.toml``.

    Returns
    -------
    list of Problem
        Errors, and remarks on what is odd.
    """
    file = file_of(path)
    # Files without particulars describe a ship by parameter files: read these.
    try:
        content = read_file(file)
        if "particulars" not in content.model_fields_set and not content.thrusters:
            return [*driven_by_water(f"{file}: vessel", _vessel(read_ship(file.parent).entries))]
        ship = describe(file, content)
    except ShipcosimError as error:
        return error.problems
    return check_described(ship)


def check_described(ship: Described) -> list[Problem]:
    """Find what is impossible or unusual in a ship whose file could be read.

    Parameters
    ----------
    ship : Described
    """
    return [*check_numbers(ship), *_hull(ship), *_matrix(ship), *_thrusters(ship), *_remarks(ship)]


def _vessel(entries: Mapping[str, Mapping[str, Quantity]]) -> dict[str, Any]:
    """Values of the vessel's parameters by name."""
    return {name: entry.value for name, entry in entries.get("vessel", {}).items()}


def _mass(kilograms: float) -> str:
    return f"{kilograms / 1000:.4g} t" if kilograms >= 1000.0 else f"{kilograms:.4g} kg"


def estimated(ship: Described) -> list[tuple[str, str, str, str]]:
    """Estimated parameters: name, value, tolerance, source.

    Parameters
    ----------
    ship : Described
    """
    rows = []
    for component, entries in ship.entries.items():
        for name, entry in entries.items():
            if entry.origin.startswith(ESTIMATED):
                value = (
                    f"{entry.value:.4g} {entry.unit}".removesuffix(" 1")
                    if not entry.columns
                    else "table"
                )
                tolerance = f"{entry.tolerance:.2g}" if entry.tolerance else ""
                rows.append(
                    (f"{component}.{name}", value, tolerance, entry.origin.removeprefix(ESTIMATED))
                )
    return rows


def _hull(ship: Described) -> Iterator[Problem]:
    form = ship.form
    p = ship.file.particulars
    m = ship.file.mass
    where = f"{ship.path}: particulars"
    # Mass against the box of length, breadth and draught: the block coefficient that follows.
    box = form.density * form.hulls * form.length * form.breadth * form.draught
    mass = float(ship.vessel["mass"].value)
    dimensions = f"{form.length:g} m x {form.breadth:g} m x {form.draught:g} m"
    dimensions = f"{form.hulls} hulls of {dimensions}" if form.hulls > 1 else dimensions
    # Outside the range of ships: mass or a dimension is wrong.
    if not BLOCK[0] <= mass / box <= BLOCK[1]:
        remedy = (
            f"That is a block coefficient of {mass / box:.2g}; ships have {BLOCK[0]:g} to {BLOCK[1]:g}: "
            f"{_mass(BLOCK[0] * box)} to {_mass(BLOCK[1] * box)} would fit."
        )
        yield Problem(f"{ship.path}: mass", f"{_mass(mass)} do not fit {dimensions}.", remedy)
    elif p.block_coefficient is not None and abs(mass / box / form.block - 1.0) > OWN_BLOCK:
        message = f"{_mass(mass)} and a block coefficient of {form.block:g} do not fit {dimensions} together."
        yield Problem(
            f"{ship.path}: mass",
            message,
            f"The mass is that of {mass / box:.3f}; leave one of them out.",
        )
    # Mass and displacement of a floating ship are the same.
    if m.mass and p.displacement and abs(m.mass.value / p.displacement.value - 1.0) > OWN_BLOCK:
        message = (
            f"the mass is {_mass(m.mass.value)}, the displacement {_mass(p.displacement.value)}."
        )
        yield Problem(
            f"{ship.path}: mass",
            message,
            "A ship that floats displaces her mass; give one of them.",
        )
    # Ratios of dimensions outside the usual range point to a wrong unit.
    breadth = number(p.breadth)
    for name, ratio, (low, high) in (
        ("length over breadth", form.length / breadth, SLENDER),
        ("breadth over draught", form.breadth / form.draught, SHALLOW),
    ):
        if not low <= ratio <= high:
            yield Problem(
                where,
                f"{name} is {ratio:.3g}.",
                f"Ships have {low:g} to {high:g}; is a unit missing?",
            )
    # Hulls must fit into the breadth of the ship.
    if form.hulls > 1 and form.hulls * form.breadth > breadth:
        message = (
            f"{form.hulls} hulls of {form.breadth:g} m are broader than the ship, {breadth:g} m."
        )
        yield Problem(where, message, "hull_breadth is that of one hull.")


def _matrix(ship: Described) -> Iterator[Problem]:
    value = {name: float(e.value) for name, e in ship.vessel.items() if not e.columns}
    where = f"{ship.path}: mass"
    length = ship.form.length
    mass = value["mass"]
    centre = value.get("centre_of_gravity_x", 0.0)
    # The mass matrix must be positive definite, or the motion is unstable.
    matrix = mass_matrix(ship)
    least = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
    diagonal = np.diag(matrix)
    if not (diagonal > 0.0).all() or least <= 0.0:
        names = [f"{n} {d:.3g}" for n, d in zip(("surge", "sway", "yaw"), diagonal, strict=True)]
        remedy = (
            "Mass with added mass must be positive, and sway_yaw squared less than sway times yaw: "
            f"at most {np.sqrt(max(diagonal[1] * diagonal[2], 0.0)):.3g} kg.m."
        )
        yield Problem(
            where,
            f"the mass matrix is not positive: {', '.join(names)}, sway by yaw {matrix[1, 2]:.3g}.",
            remedy,
        )
    # Gyration radius about the centre of gravity, by Steiner's theorem.
    about_centre = value["inertia_yaw"] - mass * centre**2
    gyradius = np.sqrt(max(about_centre, 0.0) / mass) / length
    if not GYRADIUS[0] <= gyradius <= GYRADIUS[1]:
        low, high = (mass * (share * length) ** 2 for share in GYRADIUS)
        remedy = f"Ships have {GYRADIUS[0]:g} to {GYRADIUS[1]:g}, which is {low:.3g} to {high:.3g} kg.m2."
        yield Problem(
            where,
            f"the yaw inertia is that of a gyration radius of {gyradius:.2g} lengths.",
            remedy,
        )
    # A ship with the centre of gravity far from midships would trim.
    if abs(centre) > 0.2 * length:
        yield Problem(
            where,
            f"the centre of gravity lies {centre:g} m forward of midships.",
            f"With a length of {length:g} m it lies within about a tenth of the length.",
        )
    # Positive damping would drive the ship.
    for name in DRIVING:
        if value.get(name, 0.0) > 0.0:
            yield Problem(
                f"{ship.path}: hull",
                f"{name} is {value[name]:g}: the water drives her.",
                "Damping coefficients are negative.",
            )


def _thrusters(ship: Described) -> Iterator[Problem]:
    p = ship.file.particulars
    length = ship.form.length
    breadth = number(p.breadth)
    draught = ship.form.draught
    # Thrusters outside the hull point to a wrong origin or unit.
    for unit in ship.units:
        where = f"{ship.path}: thruster {unit.name}"
        if abs(unit.x) > BEYOND * length:
            yield Problem(
                where,
                f"x is {unit.x:g} m, outside of the hull of {length:g} m.",
                f"x is forward of midships: {-0.5 * length:g} to {0.5 * length:g} m.",
            )
        if abs(unit.y) > BEYOND * breadth:
            yield Problem(
                where,
                f"y is {unit.y:g} m, outside of the hull of {breadth:g} m.",
                f"y is to starboard: {-0.5 * breadth:g} to {0.5 * breadth:g} m.",
            )
        yield from _thrust(unit, where, draught)


def _thrust(unit: ShipThruster, where: str, draught: float) -> Iterator[Problem]:
    """Find thrust that no such propeller gives."""
    screw = unit.screw
    if screw is None:
        return
    # Momentum theory without losses is the upper bound of thrust for this power and diameter.
    most = most_thrust(screw.kind, screw.diameter, screw.power, screw.density)
    if screw.thrust > 1.02 * most:
        message = (
            f"{screw.thrust / 1000:.4g} kN of {screw.power / 1000:.4g} kW and {screw.diameter:g} m."
        )
        yield Problem(
            where,
            message,
            f"No {screw.kind} propeller of that power gives more than {most / 1000:.4g} kN.",
        )
    # Thrust coefficients above MOST_KT do not occur: speed or diameter is wrong.
    if screw.thrust_coefficient > MOST_KT:
        message = (
            f"{screw.thrust / 1000:.4g} kN at {screw.rpm:.4g} rpm is a thrust coefficient of "
            f"{screw.thrust_coefficient:.2g}."
        )
        yield Problem(
            where,
            message,
            f"Propellers have at most {MOST_KT:g}: is the speed, or the diameter, right?",
        )
    # A propeller larger than the draught points to a wrong unit.
    if screw.diameter > 1.2 * draught:
        message = f"the propeller of {screw.diameter:g} m does not fit under a ship of {draught:g} m of draught."
        yield Problem(where, message, "Diameter and draught are in m; is a unit missing?")
    # Tip speed: too high if the motor's speed was given.
    tip = pi * screw.diameter * screw.rpm / 60.0
    if tip > 80.0:
        message = f"the tips run at {tip:.0f} m/s."
        yield Problem(
            where, message, "Propellers stay below some 50 m/s: is rpm that of the motor?", "remark"
        )


def _remarks(ship: Described) -> Iterator[Problem]:
    yield from _speed(ship)
    yield from _flat(ship)
    yield from driven_by_water(f"{ship.path}: hull", _vessel(ship.entries))
    if why := why_no_dp(ship):
        yield Problem(f"{ship.path}: thrusters", f"there is no DP system: {why}.", "", "remark")
    if not steering_units(ship):
        message = "there are no steering trials: she has no rudder, and no azimuth at the stern."
        yield Problem(f"{ship.path}: thrusters", message, "", "remark")
    count = len(estimated(ship))
    if count:
        yield Problem(
            str(ship.path),
            f"{count} numbers are estimated.",
            "Give what you know; the rest has the tolerance of its formula.",
            "remark",
        )


def _flat(ship: Described) -> Iterator[Problem]:
    """Check that the hull is within the formulae of loads across."""
    ratio = ship.form.breadth / ship.form.draught
    if ratio > FLATTEST and "cross_flow_drag" in ship.vessel:
        if ship.vessel["cross_flow_drag"].origin.startswith(ESTIMATED):
            message = f"breadth over draught is {ratio:.3g}, beyond {FLATTEST:g}, where the formulae of her loads end."
            remedy = "What is estimated of sway and yaw is a guess: give added_sway, added_yaw and drag.cross_flow."
            yield Problem(f"{ship.path}: particulars", message, remedy, "remark")


def _speed(ship: Described) -> Iterator[Problem]:
    """Check that she reaches her service speed, and that the resistance formulae hold there."""
    form = ship.form
    p = ship.file.particulars
    entry = ship.vessel.get("X_uu")
    if entry is None or p.service_speed is None:
        return
    where = f"{ship.path}: resistance"
    # Resistance at service speed against the bollard thrust of all thrusters that point ahead.
    drag = -float(entry.value) * form.speed**2
    ahead = sum(
        unit.most for unit in ship.units if unit.kind != "tunnel" and abs(unit.direction) < 0.5 * pi
    )
    if ahead and drag > ahead:
        message = (
            f"at {form.speed:.3g} m/s she has a resistance of {drag / 1000:.4g} kN, "
            f"more than the {ahead / 1000:.4g} kN that her thrusters give at rest."
        )
        yield Problem(where, message, "She does not reach her service speed.", "remark")
    # Holtrop and Mennen hold only below MOST_FROUDE.
    if entry.origin.startswith(ESTIMATED) and froude_number(form) > MOST_FROUDE:
        message = f"{form.speed:.3g} m/s is Froude number {froude_number(form):.2g}, beyond the formulae of resistance."
        yield Problem(
            where,
            message,
            "Give a point of her speed trial: resistance.speed and resistance.resistance.",
            "remark",
        )
