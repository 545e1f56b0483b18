"""The ship of a system in array form: what moves her, what her instruments show, and every number that may be wrong.

All hypotheses are numbers of one flat mapping, named ``place.name``: parameters of components (``vessel.mass``,
``port.thrust_loss``), of the surroundings (``water.current_north``) and of the instruments (``instruments.lever_x``).
"""

from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.diagnose.ship.environment import share_of, swell_of, water_of
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.ship.third_party_fmu import drives_of, part_of, problem_of, third_party_fmu_of
from shipcosim.diagnose.ship.thrusters import fixed_of, neighbours_of, neighbours_placed, thruster_loads
from shipcosim.diagnose.ship.tolerances import tolerances_of
from shipcosim.diagnose.ship.wiring import wiring_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import cos, sin
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.parameters import acts
from shipcosim.models.environment import wind_loads as wind
from shipcosim.models.environment.current import varying_current
from shipcosim.models.environment.earth_fixed_loads import drift_force, earth_force
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.thruster import AzimuthParameters, TunnelParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

__all__ = [
    "Inputs",
    "Motion",
    "ShipModel",
    "current_at",
    "loads",
    "motion_rates",
    "ship_model_of",
    "rates_apart",
    "with_steady_current",
]

_OURS = (AzimuthParameters, TunnelParameters)
_CURRENT = tuple(f"{of}_{to}" for of in ("current", "trend") for to in ("north", "east"))
_CURRENT += tuple(f"{to}_{at}" for to in ("north", "east") for at in ("start", "end"))


class Inputs(NamedTuple):
    """What acts on the ship at some times, arrays of one shape.

    Attributes
    ----------
    time : array
        [s]
    units : dict of str to tuple of two arrays
        By thruster: speed, or thrust where that drives it, and direction as logged. [rev/s or N, rad]
    wind_speed, wind_from : array or None
        Wind at the mast, apparent or true as `ShipModel.wind_is_true` says. [m/s, rad]
    """

    time: Any
    units: dict
    wind_speed: Any
    wind_from: Any


@dataclass(frozen=True)
class ShipModel:
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
    third_party : dict of str to ThirdPartyFmu
        FMUs of somebody else that load the ship, with their laws once there is a log.
    fixed : dict of str to float
        Direction of azimuth thrusters of ours that neither the system nor the log turns. [rad]
    neighbours : dict of str to str
        By azimuth thruster of ours, the one whose slipstream can hit it.
    """

    parts: dict
    vessel: str = "vessel"
    tolerances: dict = field(default_factory=dict)
    span: tuple = (0.0, 1.0)
    wind_is_true: bool = False
    wiring: Any = None
    third_party: dict = field(default_factory=dict)
    fixed: dict = field(default_factory=dict)
    neighbours: dict = field(default_factory=dict)

    @property
    def thrusters(self):
        """Names of the thrusters."""
        return [name for name in self.parts if self.drives(name)]

    @property
    def azimuths(self):
        """Names of the thrusters that turn."""
        return [name for name in self.parts if "azimuth" in self.drives(name)]

    def drives(self, name):
        """What a log should have of a part: ``"rpm"``, ``"azimuth"``; nothing where it is no thruster."""
        if name in self.third_party:
            return self.third_party[name].drives
        if isinstance(self.parts[name], AzimuthParameters) and name not in self.fixed:
            return "rpm", "azimuth"
        return ("rpm",) if isinstance(self.parts[name], _OURS) else ()

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
        ShipModel
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
            if part in self.parts and name in self.parts[part].__dataclass_fields__:
                return part, name
        raise KeyError(path)


def ship_model_of(system):
    """The ship of a system with our vessel.fmu; what loads her may be anybody's.

    Parameters
    ----------
    system : System
        With one vessel, and FMUs whose loads go into it.

    Returns
    -------
    ShipModel

    Raises
    ------
    ShipcosimError
        No vessel, or loads on it of FMUs that no log feeds.
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
    third_party = {}
    for name in [name for name in system.components if name in sources]:
        kind = next((kind for kind in _OURS if _holds(system.components[name], kind)), None)
        if kind is None:
            third_party[name] = third_party_fmu_of(system, name, ship.name)
        parts[name] = _values(system.components[name], kind) if kind else part_of(third_party[name])
    if problems := list(filter(None, (problem_of(system, name, ship.name, one) for name, one in third_party.items()))):
        raise ShipcosimError(problems)
    ours = [name for name in parts if isinstance(parts[name], _OURS)]
    water = water_of(parts["hull"].length)
    neighbours = neighbours_of(system, parts)
    parts = neighbours_placed(parts, neighbours) | {"water": water, "instruments": Instruments()}
    found = {"wiring": wiring_of(system, ship.name, ours), "third_party": third_party}
    found |= {"fixed": fixed_of(system, parts), "neighbours": neighbours}
    return ShipModel(parts, ship.name, tolerances_of(system, parts, ship.name), **found)


def _holds(component, kind):
    """Whether an FMU has the parameters of a kind; one built by an earlier version may lack a few."""
    there = [item.name in component.fmu.variables for item in fields(kind)]
    return sum(there) >= 0.7 * len(there)


def _values(component, kind):
    names = [item.name for item in fields(kind) if item.name in component.fmu.variables]
    return kind(**{name: component.start_value(name) for name in names})


def current_at(time, model):
    """Velocity of the water towards north and east. [m/s]"""
    water, (first, last) = model.parts["water"], model.span
    share = share_of(time, model.span)
    north = water.current_north + water.trend_north * share
    east = water.current_east + water.trend_east * share
    ends = (water.north_start, water.east_start, water.north_end, water.east_end)
    if any(ends):
        speed, to = varying_current(time, *ends, time_start=first, time_end=last)
        return north + speed * cos(to), east + speed * sin(to)
    return north, east


def with_steady_current(model: ShipModel, time: float) -> ShipModel:
    """The ship in the current of a time [s], as one that does not vary."""
    north, east = (float(value) for value in current_at(np.array(time), model))
    steady = dict.fromkeys(_CURRENT, 0.0) | {"current_north": north, "current_east": east}
    return model.with_values({f"water.{name}": value for name, value in steady.items()})


def _current_along(psi, time, model):
    """Velocity of the water in the ship's axes. [m/s]"""
    if not any(acts(getattr(model.parts["water"], name)) for name in _CURRENT):
        return 0.0, 0.0
    return to_body(psi, *current_at(time, model))


def loads(motion, inputs, model, like=None):
    """Loads on the ship by name: each thruster, wind, drift, tow.

    Parameters
    ----------
    motion : Motion
    inputs : Inputs
        At the same times.
    model : ShipModel
    like : tuple of ShipModel, dict, optional
        Another ship in the same motion with the same inputs, and her loads: what is alike is not computed again.

    Returns
    -------
    dict of str to tuple of three arrays
        X, Y, N. [N, N, N.m]
    """
    parts, found = model.parts, {}
    u_c, v_c = _current_along(motion.psi, inputs.time, model)
    u_r, v_r, r = motion.u - u_c, motion.v - v_c, motion.r
    same = _alike(model, *like) if like else {}
    for name in [name for name in parts if isinstance(parts[name], _OURS)]:
        found[name] = same.get(name) or thruster_loads(name, inputs, u_r, v_r, r, model)
    for name in model.third_party:
        found[name] = same.get(name) or _third_party_loads(name, motion, inputs, (u_r, v_r), model)
    if inputs.wind_speed is not None:
        found["wind"] = same.get("wind") or _wind_loads(motion, inputs, model)
    water = parts["water"]
    if np.any(water.drift_north) or np.any(water.drift_east):
        law = {name: getattr(water, f"drift_{name}") for name in ("surge_share", "sway_power", "yaw_arm")}
        swell = swell_of(inputs.time, model.span, water)
        found["drift"] = drift_force(motion.psi, swell * water.drift_north, swell * water.drift_east, **law)
    if np.any(water.tow_north) or np.any(water.tow_east):
        found["tow"] = earth_force(motion.psi, water.tow_north, water.tow_east, x=water.tow_x)
    return found


def _alike(model, other, found):
    """Those of another ship's loads that this one has too."""
    if not _same_current(model, other):
        return {"wind": found["wind"]} if "wind" in found and model.parts["wind"] is other.parts["wind"] else {}
    return {name: load for name, load in found.items() if model.parts.get(name) is other.parts.get(name, 0)}


def _same_current(model, other):
    one, two = model.parts["water"], other.parts["water"]
    return one is two or all(getattr(one, name) == getattr(two, name) for name in _CURRENT)


def _third_party_loads(name, motion, inputs, through, model):
    given = motion._asdict() | dict(zip(("u_r", "v_r"), through, strict=True))
    given |= drives_of(*inputs.units.get(name, (0.0, 0.0)))
    return model.third_party[name].law.loads(inputs.time, given, model.parts[name])


def _wind_loads(motion, inputs, model):
    parameters = model.parts["wind"]
    speed, direction = inputs.wind_speed, inputs.wind_from
    if model.wind_is_true:
        north, east = -speed * cos(direction), -speed * sin(direction)
        speed, direction = wind.apparent_wind(motion.psi, motion.u, motion.v, north, east)
    return wind.wind_loads(
        speed, wrap(direction - parameters.apparent_wind_offset), wind=replace(parameters, apparent_wind_offset=0.0)
    )


def motion_rates(motion, inputs, model, extra=(0.0, 0.0, 0.0), like=None):
    """Rates of position, heading and velocity over ground.

    Parameters
    ----------
    motion : Motion
    inputs : Inputs
    model : ShipModel
    extra : tuple of three
        Further loads. [N, N, N.m]
    like : tuple of ShipModel, dict, optional
        As for `loads`.

    Returns
    -------
    Motion
        Rates.
    """
    north, east = to_ned(motion.psi, motion.u, motion.v)
    return Motion(north, east, motion.r, *_accelerations(motion, inputs, model, extra, like))


def _accelerations(motion, inputs, model, extra, like):
    """Rates of the velocity over ground."""
    X, Y, N = (sum(axis) for axis in zip(extra, *loads(motion, inputs, model, like).values(), strict=True))
    u_c, v_c = _current_along(motion.psi, inputs.time, model)
    u_dot, v_dot, r_dot = accelerations(motion.u - u_c, motion.v - v_c, motion.r, X, Y, N, hull=model.parts["hull"])
    return u_dot + motion.r * v_c, v_dot - motion.r * u_c, r_dot


def rates_apart(one, other, motion, inputs, like):
    """Rates of the velocity of one ship minus those of another in the same motion.

    Parameters
    ----------
    one, other : ShipModel
    motion : Motion
    inputs : Inputs
    like : tuple of ShipModel, dict
        As for `loads`.

    Returns
    -------
    tuple of three arrays
        [m/s2, m/s2, rad/s2]
    """
    hull = one.parts["hull"]
    if hull is not other.parts["hull"] or not _same_current(one, other):
        rates = (_accelerations(motion, inputs, model, (0.0, 0.0, 0.0), like) for model in (one, other))
        return tuple(a - b for a, b in zip(*rates, strict=True))
    mine, theirs = (loads(motion, inputs, model, like) for model in (one, other))
    pairs = [(mine[name], theirs[name]) for name in mine if mine[name] is not theirs[name]]
    X, Y, N = (sum(a[axis] - b[axis] for a, b in pairs) for axis in range(3))
    i11, i22, i26, i62, i66 = hull.inverse_mass
    return i11 * X, i22 * Y + i26 * N, i62 * Y + i66 * N
