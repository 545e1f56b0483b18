"""Definitions of all allocators: two azimuths and a tunnel thruster, commands, and their power."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from shipcosim.models.core.maths import Arithmetic, cos, maximum, pi, sin, sqrt, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity, required


@dataclass(frozen=True, kw_only=True)
class NamedUnits:
    """Places and limits of two azimuth thrusters and a tunnel thruster."""

    port_x: float = required("m", "port azimuth forward of the origin")
    port_y: float = required("m", "port azimuth to starboard of the origin")
    starboard_x: float = required("m", "starboard azimuth forward of the origin")
    starboard_y: float = required("m", "starboard azimuth to starboard of the origin")
    tunnel_x: float = required("m", "tunnel thruster forward of the origin")
    port_azimuth: float = required(
        "rad", "angle of the port azimuth at the start; fixed where the law turns no unit"
    )
    starboard_azimuth: float = required("rad", "the same of the starboard azimuth")
    azimuth_thrust_min: float = required("N", "most thrust astern of an azimuth", maximum=0.0)
    azimuth_thrust_max: float = required("N", "most thrust ahead of an azimuth", minimum=0.0)
    tunnel_thrust_max: float = required(
        "N", "most thrust of the tunnel thruster to either side", minimum=0.0
    )
    thrust_rate_max: float = required("N/s", "quickest change of a command", minimum=0.0)
    yaw_lever: float = required(
        "m", "a missed yaw moment weighs as a missed force at this distance", minimum=0.1
    )
    yaw_lever_degraded: float = required(
        "m", "the same where a unit is missing: position before heading", minimum=0.1
    )

    @property
    def limits(self) -> tuple:
        """Least and most thrust of port, starboard and tunnel. [N]"""
        azimuth = self.azimuth_thrust_min, self.azimuth_thrust_max
        return azimuth, azimuth, (-self.tunnel_thrust_max, self.tunnel_thrust_max)

    @property
    def by_unit(self) -> dict[str, tuple]:
        """Quantities of port, starboard and tunnel by the names that units with numbers have."""
        least, most = zip(*self.limits, strict=True)
        return {
            "x": (self.port_x, self.starboard_x, self.tunnel_x),
            "y": (self.port_y, self.starboard_y, 0.0),
            "azimuth": (self.port_azimuth, self.starboard_azimuth, 0.5 * pi),
            "thrust_min": least,
            "thrust_max": most,
            "thrust_rate": (self.thrust_rate_max,) * 3,
        }

    def of_units(self, name: str) -> tuple:
        """A quantity of port, starboard and tunnel."""
        return self.by_unit[name]


class Allocated(NamedTuple):
    """State of an allocator: its last commands and their load.

    A law with more memory has a record of its own with these fields and more.

    Parameters
    ----------
    thrusts : tuple of three or six floats or (...) arrays or tensors
        Commanded thrust of each unit: port, starboard, tunnel; or unit 1 to 6. [N]
    azimuths : tuple, as many
        Commanded direction of each unit, clockwise from the bow. [rad]
    tau_X, tau_Y, tau_N : like a thrust
        Load of these commands, body frame. [N, N, N.m]
    saturated : bool or (...) array or tensor of bool
        True where limits of thrust or missing units keep the commands from meeting the request. [1]
    """

    thrusts: tuple
    azimuths: tuple
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic
    saturated: Arithmetic


def no_thrust(tau: Load, azimuths: tuple) -> Allocated:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    azimuths : tuple of floats
        Angles of the units. [rad]

    Returns
    -------
    Allocated
        The state.

    References
    ----------
    Definition.
    """
    # Angles in the shape of the load, so that arrays of loads give arrays of states.
    zero = 0.0 * tau[0]
    angles = tuple(zero + angle for angle in azimuths)
    return Allocated((zero,) * len(azimuths), angles, zero, zero, zero, zero > 0.0)


def used_shares(thrusts: tuple, least: tuple, most: tuple) -> tuple:
    """Shares of their limits of thrust that units use.

    Parameters
    ----------
    thrusts : tuple of floats or (...) arrays or tensors
        Commanded thrusts. [N]
    least, most : tuple of floats, as many
        Limits of thrust, astern negative; a unit without thrust has the share 0. [N]

    Returns
    -------
    tuple, as many
        0 to 1. [1]

    References
    ----------
    Definition.

    Examples
    --------
    >>> used_shares((30e3, -15e3, 0.0), (-30e3, -30e3, 0.0), (60e3, 60e3, 0.0))
    (0.5, 0.5, 0.0)
    """
    limits = zip(thrusts, least, most, strict=True)
    return tuple(abs(f) / maximum(where(f < 0.0, -low, high), 1e-9) for f, low, high in limits)


def thruster_power(shares: tuple, full: tuple) -> Arithmetic:
    """Power that commands take, all units together: P = P_full (T / T_max)^1.5.

    Parameters
    ----------
    shares : tuple of floats or (...) arrays or tensors
        As of `used_shares`. [1]
    full : tuple of floats, as many
        Power of each unit at its limit of thrust. [W]

    Returns
    -------
    like a share
        Power. [W]

    References
    ----------
    Power over thrust of a propeller at bollard: abs(T)^1.5.

    Examples
    --------
    >>> thruster_power((1.0, 0.25, 0.0), (100e3, 80e3, 50e3))
    110000.0
    """
    return sum(
        most * (share * sqrt(maximum(share, 1e-12)))
        for share, most in zip(shares, full, strict=True)
    )


def unit_effect(x: Arithmetic, y: Arithmetic, azimuth: Arithmetic) -> Load:
    """Column of the thruster configuration matrix: load of one newton of a unit.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Place, forward and to starboard of the origin. [m]
    azimuth : like x
        Direction of positive thrust, clockwise from the bow. [rad]

    Returns
    -------
    tuple of three, like azimuth
        cos α, sin α, x sin α - y cos α. [1, 1, m]

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, eq. 2.4, with the
    full yaw arm.

    Examples
    --------
    >>> unit_effect(10.0, 2.0, 0.0)
    (1.0, 0.0, -2.0)
    """
    c = cos(azimuth)
    s = sin(azimuth)
    return c, s, x * s - y * c


def load(thrusts: Sequence, effect: tuple) -> Load:
    """Load of thrusts, B f.

    Parameters
    ----------
    thrusts : sequence of floats or (...) arrays or tensors
        Thrusts of the units, or force components. [N]
    effect : tuple of tuples of three, as many
        Load of one newton of each: X, Y, N. [1, 1, m]

    Returns
    -------
    tuple of three, like a thrust
        X, Y, N. [N, N, N.m]

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, eq. 2.4.

    Examples
    --------
    >>> load((1e3, 2e3), ((1.0, 0.0, 2.0), (0.0, 1.0, -5.0)))
    (1000.0, 2000.0, -8000.0)
    """
    X = Y = N = 0.0
    for thrust, (x, y, n) in zip(thrusts, effect, strict=True):
        X = X + x * thrust
        Y = Y + y * thrust
        N = N + n * thrust
    return X, Y, N


def missed(tau: Load, thrusts: Sequence, effect: tuple) -> Load:
    """Load that thrusts leave unmet.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    thrusts, effect : sequence and tuple
        As of `load`. [N; 1, 1, m]

    Returns
    -------
    tuple of three, like tau
        X, Y, N. [N, N, N.m]

    References
    ----------
    Definition.

    Examples
    --------
    >>> missed((3e3, 2e3, 0.0), (1e3, 2e3), ((1.0, 0.0, 2.0), (0.0, 1.0, -5.0)))
    (2000.0, 0.0, 8000.0)
    """
    X, Y, N = load(thrusts, effect)
    return tau[0] - X, tau[1] - Y, tau[2] - N


def is_missed(unmet: Load, yaw_lever: Arithmetic) -> Any:
    """Whether a load that is left unmet counts: more than 1 N, or its moment at the yaw lever.

    Parameters
    ----------
    unmet : tuple of three floats or (...) arrays or tensors
        As of `missed`. [N, N, N.m]
    yaw_lever : float
        A missed yaw moment weighs as a missed force at this distance. [m]

    Returns
    -------
    bool or (...) array or tensor of bool
        [1]

    References
    ----------
    Definition.
    """
    X, Y, N = unmet
    return X * X + Y * Y + (N / yaw_lever) ** 2 > 1.0


def slack(tau: Load, given: Load) -> Load:
    """Load that commands leave unmet; differences below a millionth count as rounding.

    Parameters
    ----------
    tau, given : tuple of three floats or (...) arrays or tensors
        Requested load, and load of the commands, body frame. [N, N, N.m]

    Returns
    -------
    tuple of three, like tau
        Request minus what is given. [N, N, N.m]

    References
    ----------
    Definition.

    Examples
    --------
    >>> slack((3e3, 0.0, 1e4), (1e3, 1e-12, 1e4))
    (2000.0, 0.0, 0.0)
    """
    X, Y, N = (where(abs(a - b) < 1e-6, 0.0 * a, a - b) for a, b in zip(tau, given, strict=True))
    return X, Y, N


_NONE = "no such unit"


def unit_fields(number: int) -> dict:
    """Fields of parameters: place, direction and limits of a unit with a number.

    Parameters
    ----------
    number : int
        Of the unit. [1]

    Returns
    -------
    dict of str to dataclasses.Field
        By name, without the number. [as the fields]

    References
    ----------
    Definition.
    """
    unit = f"unit {number}"
    direction = f"direction of positive thrust of {unit}, clockwise from the bow"
    least = f"least thrust of {unit}, negative"
    most = f"most thrust of {unit}; 0: there is none"
    return {
        "x": quantity(0.0, "m", f"{unit} forward of the origin", _NONE),
        "y": quantity(0.0, "m", f"{unit} to starboard of the origin", _NONE),
        "azimuth": quantity(0.0, "rad", direction, _NONE),
        "thrust_min": quantity(0.0, "N", least, _NONE, maximum=0.0),
        "thrust_max": quantity(0.0, "N", most, _NONE, minimum=0.0),
    }


def turning_fields(number: int) -> dict:
    """Fields of parameters: turning of a unit with a number.

    Parameters
    ----------
    number : int
        Of the unit. [1]

    Returns
    -------
    dict of str to dataclasses.Field
        By name, without the number. [as the fields]

    References
    ----------
    Definition.
    """
    none = "none"
    turns = f"quickest turning of unit {number}; 0: its direction is fixed"
    first = f"unit {number} turns clockwise from here; no limit where it is `azimuth_last`"
    last = f"and to here; above azimuth_first_{number}"
    return {
        "azimuth_rate": quantity(0.0, "rad/s", turns, none, minimum=0.0),
        "azimuth_first": quantity(0.0, "rad", first, none),
        "azimuth_last": quantity(0.0, "rad", last, none),
    }
