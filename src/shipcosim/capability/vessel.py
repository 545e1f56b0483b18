"""The ship of a system for the capability: hull, thrusters, and the simulator's models of her.

Thrusters are the components of a system whose forces go into the vessel. Positions and power come from the system's
parameter set, the rest from the ship's files `capability*.toml`.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeVar

from shipcosim.capability.particulars import CHOICES, Hull, HullParticulars, ThrusterParticulars
from shipcosim.capability.thrust import (
    ETA_1,
    ETA_2_ASTERN,
    ETA_2_INLET,
    ETA_M,
    Thruster,
    nominal_thrust,
)
from shipcosim.errors import Problem, error_at, raise_errors, suggestion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.ships import Quantity, Ship
from shipcosim.ssp import Component, System

Kind = TypeVar("Kind")
HULL_FILE = "capability"
_VESSEL = {"wind_table", "drift_table", "length", "breadth", "draught"}
_THRUSTER = {"x", "power_max", "thrust_min", "thrust_max"}
_PLAIN = {"x", "y", "direction"}
"""Parameters of a thruster that does not turn and has no limits: fixed_thruster, mapped_thruster."""


@dataclass(frozen=True)
class Limits:
    """Thrust limits of a thruster of the simulator. [N]"""

    ahead: float
    astern: float


@dataclass(frozen=True)
class Simulated:
    """The ship as the simulator has her: hull, wind, wave drift, and what her thrusters may be asked for by name."""

    hull: HullParameters
    wind: WindParameters
    drift: DriftParameters
    limits: Mapping[str, Limits]


@dataclass(frozen=True)
class Vessel:
    """A ship, as Level 1 and as the simulator have her.

    Attributes
    ----------
    name, description, system : str
        Of the ship, and the system's name.
    hull : Hull
    thrusters : tuple of Thruster
        With their nominal thrust.
    simulated : Simulated
    particulars : mapping of str to mapping of str to Quantity
        All that was read from the files of the ship, by file and name.
    buses : mapping of str to tuple of str
        Names of the thrusters that each bus of the switchboard feeds; empty where the system has none.
    """

    name: str
    description: str
    system: str
    hull: Hull
    thrusters: tuple[Thruster, ...]
    simulated: Simulated
    particulars: Mapping[str, Mapping[str, Quantity]]
    buses: Mapping[str, tuple[str, ...]]


def read_vessel(system: System, ship: Ship) -> Vessel:
    """Read the ship of a system.

    Parameters
    ----------
    system : System
        With a vessel of ours, and thrusters whose forces go into it.
    ship : Ship
        With `capability.toml`, and `capability-NAME.toml` of each thruster.

    Returns
    -------
    Vessel

    Raises
    ------
    ShipcosimError
        With everything that is missing or cannot be.
    """
    # Components are found by their parameters and connections, not by their names.
    body = _vessel_of(system)
    units = _thrusters_of(system, body.name)
    wanted = {HULL_FILE: (HullParticulars,)} | {
        _file(name): (ThrusterParticulars,) for name in units
    }
    # All values must be given: the default of a required parameter means that it was not set.
    if left_out := [
        f"{part.name}.{name}" for part in (body, *units.values()) for name in part.left_out
    ]:
        raise error_at(
            system.file, f"nothing says {', '.join(left_out)}.", "Give a set with --parameters."
        )
    # All files of the ship are read before anything is checked, so that all errors come together.
    stated = ship.parameter_set(wanted)
    values = {
        file: {name: q.value for name, q in entries.items()} for file, entries in stated.items()
    }
    problems = [
        p for name in units for p in _problems(ship, name, units[name], values[_file(name)])
    ]
    raise_errors(problems)
    dimensions = {name: _real(body, name) for name in ("length", "breadth", "draught")}
    # Shape and areas come from the ship's file, main dimensions from the system's parameter set.
    hull = Hull(**values[HULL_FILE], **dimensions)
    # Nominal thrust follows from diameter, power and kind of each thruster.
    particulars = {name: ThrusterParticulars(**values[_file(name)]) for name in units}
    made = [_thruster(unit, particulars[name], hull) for name, unit in units.items()]
    # The second method needs the simulator's own models and limits.
    limits = {
        n: Limits(_real(u, "thrust_max"), -_real(u, "thrust_min"))
        if "thrust_max" in u.variables
        else Limits(particulars[n].thrust_ahead, particulars[n].thrust_astern)
        for n, u in units.items()
    }
    simulated = Simulated(
        _filled(HullParameters, body),
        _filled(WindParameters, body),
        _filled(DriftParameters, body),
        limits,
    )
    buses = _buses(system, list(units))
    return Vessel(
        ship.name, ship.description, system.name, hull, tuple(made), simulated, stated, buses
    )


def _file(thruster: str) -> str:
    """Name of a thruster's file; one of a nested system has its own name only."""
    return f"{HULL_FILE}-{thruster.rpartition('.')[2]}"


def _vessel_of(system: System) -> Component:
    # The vessel is the component that receives thruster forces and has the tables of wind and
    # drift.
    driven = {target for _, target in _forces(system)}
    vessels = [
        c for n, c in system.components.items() if n in driven and c.variables.keys() >= _VESSEL
    ]
    if len(vessels) != 1:
        what = (
            "no vessel"
            if not vessels
            else f"{len(vessels)} vessels, {', '.join(c.name for c in vessels)},"
        )
        remedy = "It needs one whose FMU has the parameters of fmus/vessel, with the forces of thrusters connected to it."
        raise error_at(system.file, f"{what} found.", remedy)
    return vessels[0]


def _thrusters_of(system: System, vessel: str) -> dict[str, Component]:
    # Thrusters are the components with limits of thrust, or with a fixed direction, that feed this vessel.
    parts = {
        source: system.components[source] for source, target in _forces(system) if target == vessel
    }
    thrusters = {
        name: part
        for name, part in parts.items()
        if part.variables.keys() >= _THRUSTER or part.variables.keys() >= _PLAIN
    }
    steered = [name for name, part in parts.items() if "rudder_area" in part.variables]
    if steered:
        remedy = 'With kind = "fixed" in the ship file its thrust counts, without the rudder.'
        raise error_at(
            system.file,
            f"{', '.join(steered)}: a propeller with a rudder is not in this balance.",
            remedy,
        )
    if not thrusters:
        remedy = "It needs components with the parameters of azimuth_thruster, tunnel_thruster or fixed_thruster."
        raise error_at(system.file, f"no thruster is connected to {vessel}.", remedy)
    return thrusters


def _forces(system: System) -> list[tuple[str, str]]:
    """Pairs of components (from, to) with a force `tau_Y` between them."""
    ends = [(c.source, c.target[0]) for c in system.connections]
    return [
        (source[0], target)
        for source, target in ends
        if source[0] and target and source[1] == "tau_Y"
    ]


def _buses(system: System, thrusters: list[str]) -> dict[str, tuple[str, ...]]:
    """Thrusters by bus, from an allocator's parameters ``NAME_bus``: 0 is A, 1 is B."""
    # The allocator with a bus for every thruster is the one that knows the switchboard.
    for part in system.components.values():
        names = {thruster: f"{thruster.rpartition('.')[2]}_bus" for thruster in thrusters}
        if part.variables.keys() >= set(names.values()):
            number = {thruster: int(_real(part, name)) for thruster, name in names.items()}
            return {
                chr(ord("A") + k): tuple(t for t in thrusters if number[t] == k)
                for k in sorted(set(number.values()))
            }
    return {}


def _real(part: Component, name: str) -> float:
    """A start value as a number, or 0 without one."""
    return float(part.start_value(name) or 0.0)


def _problems(
    ship: Ship, name: str, unit: Component, values: Mapping[str, Any]
) -> Iterable[Problem]:
    where = str(ship.folder / f"{_file(name)}.toml")
    for key, allowed in CHOICES.items():
        if values[key] not in allowed:
            yield Problem(
                f"{where}: {key}", f"found {values[key]!r}.", suggestion(str(values[key]), allowed)
            )
    needed = {"diameter": ("diameter", "m"), "power_max": ("power", "W")}
    needed["thrust_max"] = ("thrust_ahead", "N")
    for parameter, (key, of) in needed.items():
        if not values[key] and parameter not in unit.variables:
            yield Problem(
                where, f"nothing says {key} [{of}].", f"The parameter set has none of {name}."
            )


def _thruster(unit: Component, particulars: ThrusterParticulars, hull: Hull) -> Thruster:
    """A thruster with its nominal thrust."""
    # The kind follows from the FMU: no azimuth is a tunnel, a rate of azimuth turns, else it is
    # fixed.
    has = unit.variables
    kind = (
        "fixed"
        if has.keys() >= _PLAIN
        else "tunnel"
        if "azimuth" not in has
        else "azimuth"
        if unit.start_value("azimuth_rate")
        else "fixed"
    )
    diameter = particulars.diameter or _real(unit, "diameter")
    power = particulars.power or _real(unit, "power_max")
    ducted = particulars.propeller == "ducted" and kind != "tunnel"
    # Factors of Level 1: by propeller (eta 1), by inlet or running astern (eta 2), by transmission
    # (eta M).
    eta_1 = ETA_1["tunnel" if kind == "tunnel" else particulars.propeller]
    eta_2 = (
        (ETA_2_INLET[particulars.inlet],) * 2
        if kind == "tunnel"
        else (1.0, ETA_2_ASTERN[particulars.pitch, ducted])
    )
    # A tunnel's thrust is the same both ways; others lose thrust astern.
    ahead, astern = (
        nominal_thrust(diameter, power, eta_1, eta, ETA_M[particulars.transmission])
        for eta in eta_2
    )
    # A fixed thruster points along its direction, or where its azimuth input starts.
    angles = {"tunnel": 0.5 * math.pi, "azimuth": 0.0}
    ahead_of = "direction" if has.keys() >= _PLAIN else "azimuth_in"
    return Thruster(
        name=unit.name,
        kind=kind,
        x=_real(unit, "x"),
        y=_real(unit, "y") if "y" in has else 0.0,
        diameter=diameter,
        submergence=hull.draught - particulars.shaft_height,
        power=power,
        ducted=ducted,
        ahead=ahead,
        astern=astern,
        angle=angles[kind] if kind in angles else _real(unit, ahead_of),
    )


def _filled(kind: type[Kind], part: Component) -> Kind:
    """Parameters of a component as the record that the models take."""
    names = [f.name for f in fields(kind) if f.init and f.name in part.variables]  # type: ignore[arg-type]
    return kind(**{name: part.start_value(name) for name in names})
