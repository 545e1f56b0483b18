"""Optimal thrust allocation of two azimuths and a tunnel thruster: least power within all limits.

The law is that of `sqp`; here are the units by name. An azimuth has two cones of allowed angles,
ahead and astern, and keeps to one of them: one unit ahead and one astern can give any small load
without a reversal. The parameters `port_azimuth` and `starboard_azimuth` belong to laws with fixed
angles; they are not used here.
"""

from dataclasses import dataclass
from math import pi

from shipcosim.models.allocation.sqp import (
    AllocatedThruster,
    OptimalProblem,
    Turned,
    designed,
    power_step,
    resting,
)
from shipcosim.models.allocation.units import NamedUnits
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity

_DEGREE = pi / 180.0
_SECTORS = "forbidden sectors of 80 to 100 deg to both sides, Skulstad 2021, paper V"


@dataclass(frozen=True, kw_only=True)
class OptimalParameters(NamedUnits):
    """Two azimuth thrusters that turn and a tunnel thruster."""

    port_azimuth_start: float = quantity(
        0.0, "rad", "angle of the port azimuth at the start", "as the thruster's"
    )
    starboard_azimuth_start: float = quantity(
        0.0, "rad", "the same of the starboard azimuth", "as the thruster's"
    )
    port_azimuth_first: float = quantity(
        -80 * _DEGREE, "rad", "port azimuth turns clockwise from here", _SECTORS
    )
    port_azimuth_last: float = quantity(80 * _DEGREE, "rad", "and to here", _SECTORS)
    starboard_azimuth_first: float = quantity(
        100 * _DEGREE, "rad", "starboard azimuth turns from here", _SECTORS
    )
    starboard_azimuth_last: float = quantity(260 * _DEGREE, "rad", "and to here", _SECTORS)
    azimuth_rate_max: float = quantity(
        10 * _DEGREE,
        "rad/s",
        "quickest turning of a command",
        "Skulstad 2021, paper V, Table I",
        minimum=0.0,
    )
    azimuth_thrust_least: float = quantity(
        1000.0,
        "N",
        "least thrust of an azimuth that runs",
        "tried: calm needs it to follow small loads",
        minimum=0.0,
    )
    tunnel_price: float = quantity(
        4.77,
        "1",
        "power of the tunnel thruster over that of an azimuth at the same thrust",
        "200 kW at 21.6 kN, its motor; 194 kW at 60 kN, bollard curve",
        minimum=1e-3,
    )
    turning_time: float = quantity(
        10.0,
        "s",
        "time constant of turning to the cheapest direction",
        "tried: 1 s turns twice as much",
        minimum=0.0,
    )


def design(parameters: OptimalParameters) -> OptimalProblem:
    """What the law needs of the parameters.

    Parameters
    ----------
    parameters : OptimalParameters
        The units.

    Returns
    -------
    OptimalProblem
        Port, starboard and tunnel.

    References
    ----------
    Definition.
    """
    # Limits that both azimuths share; each has an interval of angles of its own.
    p = parameters
    force = p.azimuth_thrust_least, p.azimuth_thrust_max, p.azimuth_thrust_min, p.thrust_rate_max
    port = p.port_azimuth_first, p.port_azimuth_last, p.azimuth_rate_max, 1.0
    starboard = p.starboard_azimuth_first, p.starboard_azimuth_last, p.azimuth_rate_max, 1.0
    # The tunnel points to starboard, cannot turn, and reverses.
    most = p.tunnel_thrust_max
    across = 0.5 * pi
    tunnel = -most, most, -most, p.thrust_rate_max, across, across, 0.0, p.tunnel_price
    units = (
        AllocatedThruster(p.port_x, p.port_y, *force, *port),
        AllocatedThruster(p.starboard_x, p.starboard_y, *force, *starboard),
        AllocatedThruster(p.tunnel_x, 0.0, *tunnel),
    )
    # The tunnel's price is relative to an azimuth, whose price is 1.
    return designed(units, p.turning_time, p.yaw_lever, p.yaw_lever_degraded)


def at_rest(tau: Load, *, parameters: OptimalParameters) -> Turned:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : OptimalParameters
        Units and their angles at the start.

    Returns
    -------
    Turned
        The state.

    References
    ----------
    Definition.
    """
    return resting(
        tau, (parameters.port_azimuth_start, parameters.starboard_azimuth_start, 0.5 * pi)
    )


def step(
    state: Turned,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: OptimalParameters,
    design: OptimalProblem,
    shares: tuple = (1.0, 1.0, 1.0),
) -> Turned:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Turned
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of three bools or (...) arrays or tensors of bool
        Whether port, starboard and tunnel can be used; one that cannot gives 0 at once and keeps its angle. [1]
    h : float
        Time since the last commands, for the limits of the rates. [s]
    parameters : OptimalParameters
        Units and limits.
    design : OptimalProblem
        Made of the same parameters by `design`.
    shares : tuple of three floats or (...) arrays or tensors
        Shares of their limits of thrust that power leaves to port, starboard and tunnel. [1]

    Returns
    -------
    Turned
        Commands and the load they give.

    References
    ----------
    As `sqp.power_step`.
    """
    return power_step(state, tau, available, h, design=design, shares=shares)
