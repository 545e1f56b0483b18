"""Thrusters: loads of our own FMUs by logged speed and direction, and each thruster as a DP controller knows it."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.third_party_fmu import number_of
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Load
from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_given, azimuth_loads
from shipcosim.models.propulsion.tunnel import TunnelParameters, tunnel_loads, tunnel_replay
from shipcosim.ssp import System


class DpThruster(NamedTuple):
    """A thruster as a DP controller knows it.

    Attributes
    ----------
    x, y : float
        [m]
    axis : float
        Direction of its thrust from the bow, added to its own where it has one. [rad]
    pointed, turns : bool
        Whether it has a direction, and whether the DP may change that.
    ahead, astern : float
        Bollard thrust over squared speed; 0 where the DP controller has to leave it alone. [N.s2]
    most : float
        Largest speed. [rev/s]
    """

    x: float
    y: float
    axis: float
    pointed: bool
    turns: bool
    ahead: float
    astern: float
    most: float

    @property
    def pushes_sideways(self) -> bool:
        """Whether the thruster pushes across the ship, as in a tunnel."""
        return not self.pointed and bool(abs(np.cos(self.axis)) < 0.5)


def dp_thruster_of(model: ShipModel, name: str) -> DpThruster:
    """A thruster of a ship as her DP controller knows it.

    Parameters
    ----------
    model : ShipModel
    name : str

    Returns
    -------
    DpThruster
    """
    unit = model.parts[name]
    # Third-party thrusters by the fitted quadratic law. Its
    # coefficients are per rpm^2, those here per (rev/s)^2.
    if name in model.third_party:
        surrogate = model.third_party[name].built_surrogate
        pointed = "azimuth" in model.drives(name)
        b = surrogate.thrust
        most = surrogate.rpm_max / 60.0
        return DpThruster(
            b.x, b.y, b.axis, pointed, False, 3600.0 * b.ahead, 3600.0 * b.astern, most
        )
    # Azimuth thrusters by their bollard coefficients; they turn unless the system fixes them.
    if isinstance(unit, AzimuthParameters):
        turns = name not in model.fixed
        axis = model.fixed.get(name, 0.0)
        (ahead, astern) = unit.bollard[:2]
        return DpThruster(unit.x, unit.y, axis, turns, turns, ahead, astern, unit.rpm_max / 60.0)
    # Tunnel thrusters push to starboard.
    thrust = 3600.0 * unit.thrust_coefficient
    return DpThruster(unit.x, 0.0, 0.5 * np.pi, False, False, thrust, thrust, unit.rpm_max / 60.0)


def largest_loads(model: ShipModel, names: Iterable[str]) -> dict[str, float]:
    """The most that thrusters together can push the ship at rest; without limit with one of a third-party FMU.

    Parameters
    ----------
    model : ShipModel
    names : iterable of str
        Thrusters.

    Returns
    -------
    dict of str to float
        Of `surge`, `sway` and `yaw`. [N, N, N.m]
    """
    most = np.zeros(3)
    for name in names:
        if name in model.third_party:
            return dict.fromkeys(("surge", "sway", "yaw"), np.inf)
        unit = dp_thruster_of(model, name)
        thrust = max(unit.ahead, unit.astern) * unit.most**2
        # One that turns can push anywhere, a fixed one along its axis.
        along, across = (1.0, 1.0) if unit.turns else np.abs([np.cos(unit.axis), np.sin(unit.axis)])
        lever = (
            np.hypot(unit.x, unit.y)
            if unit.turns
            else abs(unit.x * np.sin(unit.axis) - unit.y * np.cos(unit.axis))
        )
        most += thrust * np.array([along, across, lever])
    return dict(zip(("surge", "sway", "yaw"), map(float, most), strict=True))


def thruster_loads(
    name: str, inputs: Inputs, u_r: Arithmetic, v_r: Arithmetic, r: Arithmetic, model: ShipModel
) -> Load:
    """Load of a thruster, as the system wires it.

    Parameters
    ----------
    name : str
    inputs : Inputs
    u_r, v_r, r : array
        Velocity of the ship through the water. [m/s, m/s, rad/s]
    model : ShipModel

    Returns
    -------
    tuple of three arrays
        X, Y, N. [N, N, N.m]
    """
    if model.wiring is None:
        return _loads_of(name, inputs.units, u_r, v_r, r, model)
    units = inputs.units | {
        other: model.wiring.driven(other, inputs.units) for other in model.wiring.drives
    }
    return model.wiring.loaded(name, _loads_of(name, units, u_r, v_r, r, model))


def _loads_of(
    name: str,
    units: dict[str, tuple[Arithmetic, Arithmetic]],
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    model: ShipModel,
) -> Load:
    unit = model.parts[name]
    (n, azimuth) = units[name]
    # The state of a tunnel thruster follows from its logged speed alone.
    if isinstance(unit, TunnelParameters):
        *_, surge, sway, yaw = tunnel_loads(tunnel_replay(n, tunnel=unit), u_r, tunnel=unit)
        return surge, sway, yaw
    # An azimuth thruster may stand in the slipstream of its
    # neighbour, whose speed and direction are needed then.
    state = azimuth_given(n, azimuth, unit=unit)
    neighbour = model.neighbours.get(name)
    extra = {}
    if neighbour:
        n_other, azimuth_other = units[neighbour]
        extra = {"neighbour_azimuth": azimuth_other, "neighbour_rpm": 60.0 * n_other}
    if model.slipstreams:
        extra["thrust_share"] = model.slipstreams.share(name, units)
    *_, surge, sway, yaw = azimuth_loads(state, u_r, v_r, r, unit=unit, **extra)
    return surge, sway, yaw


def neighbours_of(system: System, parts: Mapping[str, Any]) -> dict[str, str]:
    """By azimuth thruster of ours, the one whose slipstream can hit it: as the system wires it, else the nearest.

    Parameters
    ----------
    system : System
    parts : dict of str to dataclass

    Returns
    -------
    dict of str to str
    """
    units = [name for name, part in parts.items() if isinstance(part, AzimuthParameters)]
    wired = {
        (c.target[0], c.source[0])
        for c in system.connections
        if c.target[1].startswith("neighbour_")
    }
    neighbours = {}
    # Wired neighbours first, then the nearest by the sum of both distances.
    for name in units:
        here = parts[name]
        others = [other for other in units if other != name]
        near = sorted(
            others,
            key=lambda o: (
                (name, o) not in wired,
                abs(parts[o].x - here.x) + abs(parts[o].y - here.y),
            ),
        )
        neighbours |= {name: near[0]} if near else {}
    return neighbours


def neighbours_placed(parts: Mapping[str, Any], neighbours: Mapping[str, str]) -> dict[str, Any]:
    """The parts, in which each azimuth thruster knows where its neighbour is."""
    placed = dict(parts)
    for name, other in neighbours.items():
        if parts[name].neighbour_x == parts[name].neighbour_y == 0.0:
            placed[name] = replace(
                parts[name], neighbour_x=parts[other].x, neighbour_y=parts[other].y
            )
    return placed


def fixed_of(system: System, parts: Mapping[str, Any]) -> dict[str, float]:
    """Azimuth thrusters of ours that a system drives and never turns, as fixed propellers, and where they point.

    Parameters
    ----------
    system : System
    parts : dict of str to dataclass

    Returns
    -------
    dict of str to float
        [rad]
    """
    # A thruster turns if its direction is connected, or
    # if nothing drives it, and its azimuth rate is not 0.
    fed = {connection.target for connection in system.connections}
    directions = {}
    for name in [name for name, part in parts.items() if isinstance(part, AzimuthParameters)]:
        replays = bool(system.components[name].start_value("replay"))
        kinds = (
            ("rpm_in", "azimuth_in", "azimuth_in")
            if replays
            else ("thrust_cmd", "azimuth_cmd", "azimuth_start")
        )
        speed, direction, start = kinds
        turned = (name, direction) in fed or (name, speed) not in fed
        if not turned or parts[name].azimuth_rate == 0.0:
            directions[name] = number_of(system.components[name], start)
    return directions


def thrust_numbers(model: ShipModel) -> tuple[str, ...]:
    """The number of each thruster that scales all its thrust."""
    return tuple(path for name in model.thrusters if model.has(path := f"{name}.thrust_loss"))


def astern_numbers(model: ShipModel) -> tuple[str, ...]:
    """The number of each thruster that scales its thrust astern, where it has one."""
    kinds = ("reverse_loss", "gain_astern")
    paths = [f"{name}.{kind}" for name in model.thrusters for kind in kinds]
    return tuple(path for path in paths if model.has(path))


def with_thrust(model: ShipModel, ratio: float, std: float) -> ShipModel:
    """The ship with the thrust of all thrusters scaled; the standard deviation is the new tolerance.

    Parameters
    ----------
    model : ShipModel
    ratio, std : float
        Thrust over that of the model.

    Returns
    -------
    ShipModel
    """
    # The loss follows from 1 - loss_new = ratio (1 - loss_old);
    # tolerance and standard deviation add up as squares.
    paths = thrust_numbers(model)
    values = {path: 1.0 - ratio * (1.0 - model.get(path)) for path in paths}
    tolerances = {path: float(np.hypot(model.tolerances.get(path, 0.0), std)) for path in paths}
    return model.with_values(values).with_tolerances(tolerances)
