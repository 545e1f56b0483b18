"""The ship of a system in array form: what moves her, what her instruments show, and every number that may be wrong.

All suspects are numbers of one flat mapping, named ``place.name``: parameters of components (``vessel.mass``,
``port.thrust_loss``), of the surroundings (``water.current_north``) and of the instruments (``instruments.lever_x``).
"""

from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np

from shipcosim.diagnose.surroundings import Instruments, Water, stern_of
from shipcosim.diagnose.wiring import wiring_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models import instruments, thruster, wind
from shipcosim.models.current import varying_current
from shipcosim.models.earth import drift_force, earth_force
from shipcosim.models.hull import HullParameters
from shipcosim.models.kinematics import to_body, to_ned
from shipcosim.models.maths import cos, sin, wrap
from shipcosim.models.thruster import AzimuthParameters, TunnelParameters
from shipcosim.models.vessel import accelerations
from shipcosim.models.wind import WindParameters

__all__ = [
    "Drivers",
    "Instruments",
    "Motion",
    "Plant",
    "Water",
    "current_at",
    "loads",
    "motion_rates",
    "plant_of",
    "shown",
]


class Motion(NamedTuple):
    """Position, heading, velocity over ground, all of the low-frequency ship; arrays of one shape."""

    x: Any
    y: Any
    psi: Any
    u: Any
    v: Any
    r: Any


class Drivers(NamedTuple):
    """What acts on the ship at some times, arrays of one shape.

    Attributes
    ----------
    time : array
        [s]
    units : dict of str to tuple of two arrays
        By thruster: speed and direction as logged. [rev/s, rad]
    wind_speed, wind_from : array or None
        Wind at the mast, apparent or true as `Plant.wind_is_true` says. [m/s, rad]
    """

    time: Any
    units: dict
    wind_speed: Any
    wind_from: Any


@dataclass(frozen=True)
class Plant:
    """A ship with her thrusters, as the diagnosis moves her.

    Attributes
    ----------
    parts : dict of str to dataclass
        Parameter sets by place: ``vessel``'s hull and wind under ``hull`` and ``wind``, thrusters by component,
        ``water``, ``instruments``.
    vessel : str
        Name of the ship's component.
    tolerances : dict of str to float
        By ``place.name`` as the system names it, in its unit.
    span : tuple of two floats
        First and last time of the log, between which the current varies. [s]
    wind_is_true : bool
        The log has the wind over ground instead of the apparent one.
    wiring : Wiring or None
        Where the system wires thrusters otherwise than named.
    """

    parts: dict
    vessel: str = "vessel"
    tolerances: dict = field(default_factory=dict)
    span: tuple = (0.0, 1.0)
    wind_is_true: bool = False
    wiring: Any = None

    @property
    def thrusters(self):
        """Names of the thrusters."""
        return [name for name in self.parts if isinstance(self.parts[name], AzimuthParameters | TunnelParameters)]

    @property
    def azimuths(self):
        """Names of the thrusters with a direction."""
        return [name for name in self.thrusters if isinstance(self.parts[name], AzimuthParameters)]

    def get(self, path):
        """Value of a number."""
        part, name = self._where(path)
        return getattr(self.parts[part], name)

    def about(self, path):
        """The field of a number: unit, bounds, origin."""
        part, name = self._where(path)
        return next(item for item in fields(self.parts[part]) if item.name == name).metadata

    def has(self, path):
        """Whether there is such a number."""
        try:
            self._where(path)
        except KeyError:
            return False
        return True

    def with_values(self, values):
        """The same ship with other numbers.

        Parameters
        ----------
        values : mapping of str to float or array

        Returns
        -------
        Plant
        """
        changes = {}
        for path, value in values.items():
            part, name = self._where(path)
            changes.setdefault(part, {})[name] = value
        return replace(
            self, parts=self.parts | {part: replace(self.parts[part], **new) for part, new in changes.items()}
        )

    def _where(self, path):
        place, _, name = path.rpartition(".")
        for part in ("hull", "wind") if place == self.vessel else (place,):
            if part in self.parts and any(item.name == name for item in fields(self.parts[part])):
                return part, name
        raise KeyError(path)


def plant_of(system):
    """The ship of a system of our FMUs.

    Parameters
    ----------
    system : System
        With one vessel, and thrusters whose loads go into it.

    Returns
    -------
    Plant

    Raises
    ------
    ShipcosimError
        No vessel, or loads on it that are not of our thrusters.
    """
    vessels = [c for c in system.components.values() if _holds(c, HullParameters)]
    if len(vessels) != 1:
        found = ", ".join(f"{name} ({c.fmu.model_name})" for name, c in system.components.items())
        raise ShipcosimError(
            Problem(
                system.file,
                f"{len(vessels)} components with the parameters of a hull among: {found}.",
                "The diagnosis needs a system with exactly one vessel.fmu.",
            )
        )
    ship = vessels[0]
    parts = {"hull": _values(ship, HullParameters), "wind": _values(ship, WindParameters)}
    sources = {c.source[0] for c in system.connections if c.target[0] == ship.name and c.target[1].startswith("tau_")}
    for name, component in system.components.items():
        kind = next((kind for kind in (AzimuthParameters, TunnelParameters) if _holds(component, kind)), None)
        if name in sources and kind:
            parts[name] = _values(component, kind)
    strangers = sorted(sources - set(parts))
    if strangers:
        raise ShipcosimError(
            [
                Problem(
                    system.file,
                    f"'{name}' ({system.components[name].fmu.model_name}) puts a load on '{ship.name}'.",
                    "The diagnosis knows azimuth_thruster.fmu and tunnel_thruster.fmu.",
                )
                for name in strangers
            ]
        )
    water = Water(tow_x=stern_of(parts["hull"].length))
    parts = _neighbours_placed(parts) | {"water": water, "instruments": Instruments()}
    plant = Plant(parts, ship.name, _tolerances(system, parts, ship.name))
    return replace(plant, wiring=wiring_of(system, ship.name, plant.thrusters))


def _holds(component, kind):
    """Whether an FMU has the parameters of a kind; one built by an earlier version may lack a few."""
    there = [item.name in component.fmu.variables for item in fields(kind)]
    return sum(there) >= 0.7 * len(there)


def _values(component, kind):
    names = [item.name for item in fields(kind) if item.name in component.fmu.variables]
    return kind(**{name: component.start_value(name) for name in names})


def _tolerances(system, parts, vessel):
    """Tolerances of the system's parameter sets, where they are silent those of our defaults relative to size."""
    found = {}
    for part, values in parts.items():
        place = vessel if part in ("hull", "wind") else part
        known = system.components[place].tolerances if place in system.components else {}
        for item in fields(values):
            path, default = f"{place}.{item.name}", item.metadata["tolerance"]
            if item.name in known:
                found[path] = known[item.name]
            elif default and isinstance(getattr(values, item.name), float):
                share = abs(getattr(values, item.name) / item.default) if item.default else 1.0
                found[path] = default * share
    return {path: tolerance for path, tolerance in found.items() if tolerance > 0.0}


def current_at(time, plant):
    """Velocity of the water towards north and east. [m/s]"""
    water, (first, last) = plant.parts["water"], plant.span
    share = np.clip((time - first) / (last - first), 0.0, 1.0)
    north = water.current_north + water.trend_north * share
    east = water.current_east + water.trend_east * share
    ends = (water.north_start, water.east_start, water.north_end, water.east_end)
    if any(ends):
        speed, to = varying_current(time, *ends, time_start=first, time_end=last)
        return north + speed * cos(to), east + speed * sin(to)
    return north, east


def loads(motion, drivers, plant, like=None):
    """Loads on the ship by name: each thruster, wind, drift, tow.

    Parameters
    ----------
    motion : Motion
    drivers : Drivers
        At the same times.
    plant : Plant
    like : tuple of Plant, dict, optional
        Another ship in the same motion with the same drivers, and her loads: what is alike is not computed again.

    Returns
    -------
    dict of str to tuple of three arrays
        X, Y, N. [N, N, N.m]
    """
    parts, found = plant.parts, {}
    c_north, c_east = current_at(drivers.time, plant)
    u_c, v_c = to_body(motion.psi, c_north, c_east)
    u_r, v_r, r = motion.u - u_c, motion.v - v_c, motion.r
    same = _alike(plant, *like) if like else {}
    for name in plant.thrusters:
        found[name] = same.get(name) or _thruster_loads(name, drivers, u_r, v_r, r, plant)
    if drivers.wind_speed is not None:
        found["wind"] = same.get("wind") or _wind_loads(motion, drivers, plant)
    water = parts["water"]
    if np.any(water.drift_north) or np.any(water.drift_east):
        law = {"surge_share": water.drift_surge_share, "yaw_arm": water.drift_yaw_arm}
        found["drift"] = drift_force(motion.psi, water.drift_north, water.drift_east, **law)
    if np.any(water.tow_north) or np.any(water.tow_east):
        found["tow"] = earth_force(motion.psi, water.tow_north, water.tow_east, x=water.tow_x)
    return found


def _alike(plant, other, found):
    """Those of another ship's loads that this one has too."""
    if plant.parts["water"] is not other.parts["water"]:
        return {"wind": found["wind"]} if "wind" in found and plant.parts["wind"] is other.parts["wind"] else {}
    return {name: load for name, load in found.items() if plant.parts.get(name) is other.parts.get(name, 0)}


def _thruster_loads(name, drivers, u_r, v_r, r, plant):
    if plant.wiring is None:
        return _loads_of(name, drivers.units, u_r, v_r, r, plant)
    units = {other: plant.wiring.driven(other, drivers.units) for other in plant.thrusters}
    return plant.wiring.loaded(name, _loads_of(name, units, u_r, v_r, r, plant))


def _loads_of(name, units, u_r, v_r, r, plant):
    unit, (n, azimuth) = plant.parts[name], units[name]
    if isinstance(unit, TunnelParameters):
        return thruster.tunnel_loads(thruster.tunnel_replay(n, tunnel=unit), u_r, tunnel=unit)[-3:]
    state = thruster.azimuth_replay(n, azimuth, u_r, v_r, r, unit=unit)
    neighbour = _neighbour(name, plant.parts)
    extra = {}
    if neighbour:
        n_other, azimuth_other = units[neighbour]
        extra = {"neighbour_azimuth": azimuth_other, "neighbour_rpm": 60.0 * n_other}
    return thruster.azimuth_loads(state, u_r, v_r, r, unit=unit, **extra)[-3:]


def _neighbour(name, parts):
    """The nearest other azimuth thruster, whose slipstream can hit this one."""
    here = parts[name]
    others = [o for o, part in parts.items() if isinstance(part, AzimuthParameters) and o != name]
    return min(others, key=lambda o: abs(parts[o].x - here.x) + abs(parts[o].y - here.y), default=None)


def _neighbours_placed(parts):
    """The parts, in which each azimuth thruster knows where its neighbour is."""
    placed = dict(parts)
    for name, part in parts.items():
        if isinstance(part, AzimuthParameters) and part.neighbour_x == part.neighbour_y == 0.0:
            other = parts.get(_neighbour(name, parts))
            if other:
                placed[name] = replace(part, neighbour_x=other.x, neighbour_y=other.y)
    return placed


def _wind_loads(motion, drivers, plant):
    parameters = plant.parts["wind"]
    speed, direction = drivers.wind_speed, drivers.wind_from
    if plant.wind_is_true:
        north, east = -speed * cos(direction), -speed * sin(direction)
        speed, direction = wind.apparent_wind(motion.psi, motion.u, motion.v, north, east)
    return wind.wind_loads(
        speed, wrap(direction - parameters.apparent_wind_offset), wind=replace(parameters, apparent_wind_offset=0.0)
    )


def motion_rates(motion, drivers, plant, extra=(0.0, 0.0, 0.0), like=None):
    """Rates of position, heading and velocity over ground.

    Parameters
    ----------
    motion : Motion
    drivers : Drivers
    plant : Plant
    extra : tuple of three
        Further loads. [N, N, N.m]
    like : tuple of Plant, dict, optional
        As for `loads`.

    Returns
    -------
    Motion
        Rates.
    """
    X, Y, N = (sum(axis) for axis in zip(extra, *loads(motion, drivers, plant, like).values(), strict=True))
    u_c, v_c = to_body(motion.psi, *current_at(drivers.time, plant))
    u_dot, v_dot, r_dot = accelerations(motion.u - u_c, motion.v - v_c, motion.r, X, Y, N, hull=plant.parts["hull"])
    north, east = to_ned(motion.psi, motion.u, motion.v)
    return Motion(north, east, motion.r, u_dot + motion.r * v_c, v_dot - motion.r * u_c, r_dot)


def shown(motion, plant):
    """What the instruments show of a motion, without noise, heading not wrapped.

    Position and velocity are the antenna's; surge and sway are its velocity over ground resolved with the measured
    heading.

    Parameters
    ----------
    motion : Motion
    plant : Plant

    Returns
    -------
    Motion
    """
    i = plant.parts["instruments"]
    errors = {name: getattr(i, name) for name in ("heading_bias", "lever_x", "lever_y", "velocity_scale")}
    return Motion(*instruments.shown(*motion, **errors))._replace(psi=motion.psi + i.heading_bias)
