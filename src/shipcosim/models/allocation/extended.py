"""Thrust allocation by a weighted generalised inverse over rectangular force components.

Each azimuth thruster counts as two units, one forward and one to starboard; their forces are turned back into thrust
and angle. The inverse knows no limits: the unit furthest beyond its limit of thrust is held there and the others are
asked for the rest, round by round; while a unit still turns, it gives the part of its force that lies in its direction.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.pseudo_inverse import (
    AllocationParameters,
    inverses_of,
    missing_units,
    solved,
)
from shipcosim.models.allocation.units import Allocated, is_missed, load, missed, no_thrust
from shipcosim.models.core.kinematics import moved, turned
from shipcosim.models.core.maths import atan2, clip, cos, hypot, minimum, pi, sin, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity

_DEG = pi / 180.0
_UNIT_OF = (0, 0, 1, 1, 2)  # of each force component: port, starboard or tunnel


@dataclass(frozen=True, kw_only=True)
class ExtendedParameters(AllocationParameters):
    """Two azimuth thrusters that turn, and a tunnel thruster."""

    sway_price: float = quantity(
        1.0,
        "1",
        "price of an azimuth's force to the side over that of its force forward",
        "choice",
        minimum=1e-6,
    )
    azimuth_rate_max: float = quantity(
        10.0 * _DEG, "rad/s", "quickest turning of a command", "Skulstad 2021, paper V", minimum=0.0
    )
    turning_thrust: float = quantity(
        500.0,
        "N",
        "an azimuth turns for forces beyond this; below, it keeps its angle",
        "assumed",
        minimum=1.0,
    )


class ComponentInverses(NamedTuple):
    """Configuration matrix of the force components and the generalised inverses of its parts.

    Parameters
    ----------
    effect : tuple of five tuples
        X, Y, N of one newton of each component: port forward, port to starboard, the same of starboard, tunnel.
        [1, 1, m]
    inverses : tuple of sixteen tuples
        For each set of free units five rows of three, as of `ThrusterInverses`. [1, 1, 1/m]
    """

    effect: tuple
    inverses: tuple


def design(parameters: ExtendedParameters) -> ComponentInverses:
    """Weighted generalised inverses for all sets of free units.

    Parameters
    ----------
    parameters : ExtendedParameters
        Units and weights.

    Returns
    -------
    ComponentInverses
        What `step` needs.

    Notes
    -----
    As `pseudo_inverse.design`, over the force components.

    References
    ----------
    Extended thrust: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021;
    Sordalen, Optimal thrust allocation for marine vessels, Control Engineering Practice 5 (1997).
    """
    # Columns of the configuration matrix: a force X at (x, y)
    # gives N = -y X, a force Y gives N = x Y.
    p = parameters
    effect = (
        (1.0, 0.0, -p.port_y),
        (0.0, 1.0, p.port_x),
        (1.0, 0.0, -p.starboard_y),
        (0.0, 1.0, p.starboard_x),
        (0.0, 1.0, p.tunnel_x),
    )
    # Prices of the components, as W^-1/2 of the weighted inverse.
    side = p.azimuth_weight * p.sway_price
    price = np.array([p.azimuth_weight, side, p.azimuth_weight, side, p.tunnel_weight]) ** -0.5
    levers = (p.yaw_lever, p.yaw_lever_degraded)
    return ComponentInverses(effect, inverses_of(effect, price, levers, _UNIT_OF))


def at_rest(tau: Load, *, parameters: ExtendedParameters) -> Allocated:
    """State at the start: no thrust, angles as the parameters say.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : ExtendedParameters
        Units.

    Returns
    -------
    Allocated
        The state.

    References
    ----------
    Definition.
    """
    return no_thrust(tau, parameters.of_units("azimuth"))


def step(
    state: Allocated,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: ExtendedParameters,
    design: ComponentInverses,
    shares: tuple = (1.0, 1.0, 1.0),
) -> Allocated:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Allocated
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of three bools or (...) arrays or tensors of bool
        Whether port, starboard and tunnel can be used; the others take over what they can. [1]
    h : float
        Time since the last commands, for the limits of the rates. [s]
    parameters : ExtendedParameters
        Units, limits and weights.
    design : ComponentInverses
        Made of the same parameters by `design`.
    shares : tuple of three floats or (...) arrays or tensors
        Shares of their limits of thrust that power leaves to port, starboard and tunnel. [1]

    Returns
    -------
    Allocated
        Commands, the load they give, and whether limits of thrust or missing units keep them from meeting the request.

    References
    ----------
    As `design`; that thrust beyond a limit is asked of the free units is assumed.
    """
    p = parameters
    # Forces within the limits of thrust, then the load that they miss.
    reach = parameters.thrust_rate_max * h
    forces = _within_limits(tau, available, shares, parameters=p, design=design)
    saturated = is_missed(missed(tau, forces, design.effect), p.yaw_lever)
    # Turn each azimuth towards its force; until it has turned, it gives the part of the force along its angle.
    angles = []
    wanted = []
    for unit, (low, high) in enumerate(p.limits[:2]):
        X, Y = forces[2 * unit : 2 * unit + 2]
        angle = _turned(state.azimuths[unit], X, Y, available[unit], h, parameters=p)
        wanted.append(clip(X * cos(angle) + Y * sin(angle), low, high))
        angles.append(angle)
    # The tunnel cannot turn. Thrusts move at their rate; any excess over the power limit is removed at once.
    units = zip(state.thrusts, (*wanted, forces[4]), shares, p.limits, available, strict=True)
    thrusts = tuple(
        where(on, clip(moved(old, new, reach), share * low, share * high), 0.0 * new)
        for old, new, share, (low, high), on in units
    )
    # Load of these commands; components of the azimuths in body axes, as the columns of the matrix.
    components = []
    for thrust, angle in zip(thrusts, angles, strict=False):
        components += [thrust * cos(angle), thrust * sin(angle)]
    given = load((*components, thrusts[2]), design.effect)
    return Allocated(thrusts, (*angles, 0.5 * pi), *given, saturated)


def _turned(old, X, Y, usable, h, *, parameters):
    """Angle of an azimuth that turns to the direction of a force."""
    # Small forces have no reliable direction: the angle stays.
    far = (X * X + Y * Y > parameters.turning_thrust**2) & usable
    wanted = atan2(where(far, Y, sin(old)), where(far, X, cos(old)))
    # Turn the short way round, at most as fast as the thruster can.
    reach = parameters.azimuth_rate_max * h
    return turned(old, wanted, reach)


def _within_limits(tau, available, shares, *, parameters, design):
    """Forces for a load within limits of thrust; free units take over the rest."""
    p = parameters
    free = [where(usable, 1.0, 0.0) for usable in available]
    missing = missing_units(available)
    most = [share * high for share, (_, high) in zip(shares, p.limits, strict=True)]
    # At most three rounds: in each, the unit furthest beyond its limit is held.
    held = forces = [0.0 * tau[0]] * 5
    for _ in range(3):
        # Solve for the free units, with the load that the held ones leave.
        more = solved(missed(tau, held, design.effect), free, missing, design.inverses)
        forces = [f + g for f, g in zip(held, more, strict=True)]
        # Thrust of each unit, and the share of it within its limit.
        port = hypot(forces[0], forces[1])
        starboard = hypot(forces[2], forces[3])
        tunnel = abs(forces[4])
        parts = [
            minimum(1.0, limit / where(size > 1.0, size, 1.0))
            for size, limit in zip((port, starboard, tunnel), most, strict=True)
        ]
        # The unit with the smallest share is furthest beyond its limit: hold it there.
        worst = minimum(minimum(parts[0], parts[1]), parts[2])
        over = [(part < 1.0) & (part <= worst) for part in parts]
        # Scale the force of a unit, so that its direction stays.
        forces = [force * parts[unit] for force, unit in zip(forces, _UNIT_OF, strict=True)]
        held = [where(over[unit], f, h) for f, h, unit in zip(forces, held, _UNIT_OF, strict=True)]
        free = [where(o, 0.0, f) for o, f in zip(over, free, strict=True)]
    return forces
