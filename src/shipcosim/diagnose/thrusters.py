"""Thrusters: loads of our own on the ship by the log's speeds and directions, and how a DP knows any of them."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcosim.models import thruster
from shipcosim.models.thruster import AzimuthParameters, TunnelParameters

__all__ = ["Pusher", "neighbours_placed", "pusher_of", "thruster_loads"]


class Pusher(NamedTuple):
    """A thruster as a DP knows it.

    Attributes
    ----------
    x, y : float
        [m]
    axis : float
        Direction of its thrust from the bow, added to its own where it has one. [rad]
    pointed, turns : bool
        Whether it has a direction, and whether the DP may change that.
    ahead, astern : float
        Bollard thrust over squared speed; 0 where the DP has to leave it alone. [N.s2]
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


def pusher_of(plant, name):
    """A thruster of a ship as her DP knows it.

    Parameters
    ----------
    plant : Plant
    name : str

    Returns
    -------
    Pusher
    """
    unit = plant.parts[name]
    if name in plant.strangers:
        law, pointed = plant.strangers[name].law, "azimuth" in plant.drives(name)
        b = law.bollard
        return Pusher(b.x, b.y, b.axis, pointed, False, 3600.0 * b.ahead, 3600.0 * b.astern, law.rpm_max / 60.0)
    if isinstance(unit, AzimuthParameters):
        return Pusher(unit.x, unit.y, 0.0, True, True, *unit.bollard[:2], unit.rpm_max / 60.0)
    thrust = 3600.0 * unit.thrust_coefficient
    return Pusher(unit.x, 0.0, 0.5 * np.pi, False, False, thrust, thrust, unit.rpm_max / 60.0)


def thruster_loads(name, drivers, u_r, v_r, r, plant):
    """Load of a thruster, as the system wires it.

    Parameters
    ----------
    name : str
    drivers : Drivers
    u_r, v_r, r : array
        Velocity of the ship through the water. [m/s, m/s, rad/s]
    plant : Plant

    Returns
    -------
    tuple of three arrays
        X, Y, N. [N, N, N.m]
    """
    if plant.wiring is None:
        return _loads_of(name, drivers.units, u_r, v_r, r, plant)
    units = drivers.units | {other: plant.wiring.driven(other, drivers.units) for other in plant.wiring.drives}
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


def neighbours_placed(parts):
    """The parts, in which each azimuth thruster knows where its neighbour is."""
    placed = dict(parts)
    for name, part in parts.items():
        if isinstance(part, AzimuthParameters) and part.neighbour_x == part.neighbour_y == 0.0:
            other = parts.get(_neighbour(name, parts))
            if other:
                placed[name] = replace(part, neighbour_x=other.x, neighbour_y=other.y)
    return placed
