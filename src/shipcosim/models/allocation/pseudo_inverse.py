"""Thrust allocation by a weighted generalised inverse at fixed azimuth angles.

An allocator is two functions: `design` computes once what it needs of its parameters, `step` turns a requested load
into commands.
"""

import functools
import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.units import (
    Allocated,
    NamedUnits,
    is_missed,
    load,
    missed,
    no_thrust,
    unit_effect,
)
from shipcosim.models.core.kinematics import moved
from shipcosim.models.core.maths import Arithmetic, clip, is_single, repeat, row_of, where
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import required


@dataclass(frozen=True, kw_only=True)
class AllocationParameters(NamedUnits):
    """Two azimuth thrusters at fixed angles and a tunnel thruster."""

    azimuth_weight: float = required("1", "price of an azimuth's thrust", minimum=1e-6)
    tunnel_weight: float = required("1", "price of the tunnel's thrust", minimum=1e-6)


class ThrusterInverses(NamedTuple):
    """Thruster configuration matrix and the generalised inverses of its parts.

    Parameters
    ----------
    effect : tuple of three tuples
        Effect of port, starboard and tunnel on X, Y, N, as `effect`. [1, 1, m]
    inverses : tuple of sixteen tuples
        For each set of free units a row of three for each unit: set k holds unit i where bit i of k is set; bit 3 is
        set where a unit is missing. [1, 1, 1/m]
    """

    effect: tuple
    inverses: tuple


def effect(parameters: AllocationParameters) -> tuple[tuple, tuple, tuple]:
    """Thruster configuration matrix B(α), column by column: load of one newton of each unit.

    Parameters
    ----------
    parameters : AllocationParameters
        Positions and angles of the units.

    Returns
    -------
    tuple of three tuples
        For port, starboard and tunnel: X, Y and N = x sin α - y cos α. [1, 1, m]

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, eq. 2.4, with the
    full yaw arm (nominal model, DP).
    """
    p = parameters
    port = unit_effect(p.port_x, p.port_y, p.port_azimuth)
    starboard = unit_effect(p.starboard_x, p.starboard_y, p.starboard_azimuth)
    return port, starboard, (0.0, 1.0, p.tunnel_x)


@kept(8)
def design(parameters: AllocationParameters) -> ThrusterInverses:
    """Weighted generalised inverses for all sets of free units.

    Parameters
    ----------
    parameters : AllocationParameters
        Units and weights; fields may be arrays of one shape.

    Returns
    -------
    ThrusterInverses
        What `step` needs.

    Notes
    -----
    f = W^-1/2 (S B W^-1/2)⁺ S τ: the thrusts with the smallest error of τ in the norm of S, and of those the smallest
    in the norm of W. S counts a moment as a force at the yaw lever.

    References
    ----------
    Weighted generalised inverse: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley,
    2021.
    """
    p = parameters
    units = effect(p)
    price = _vector(p.azimuth_weight, p.azimuth_weight, p.tunnel_weight) ** -0.5
    levers = (p.yaw_lever, p.yaw_lever_degraded)
    return ThrusterInverses(units, inverses_of(units, price, levers, (0, 1, 2)))


def inverses_of(effect: tuple, price: np.ndarray, levers: tuple, unit_of: tuple) -> tuple:
    """Generalised inverses for all sets of free units, with the yaw lever of a whole ship and of one that misses a unit.

    Parameters
    ----------
    effect : tuple of n tuples of three
        Load of one newton of each force component. [1, 1, m]
    price : (..., n) array
        Of the components, as W^-1/2. [1]
    levers : tuple
        A missed yaw moment weighs as a missed force at this distance. [m]
    unit_of : tuple of n int
        Unit of each component. [1]

    Returns
    -------
    tuple of tuples
        A set of inverses for each lever, as of `ThrusterInverses`. [1, 1, 1/m]

    References
    ----------
    As `design`.
    """
    matrix = np.stack(np.broadcast_arrays(*(_vector(*column) for column in effect)), -1)
    inverses = []
    for lever in levers:
        scale = _vector(1.0, 1.0, 1.0 / lever)
        # Every set of units, as a number with one bit a unit.
        for k in range(2 ** (max(unit_of) + 1)):
            # W^-1/2 (S B W^-1/2)^+ S, with S for the yaw lever and only the free units' columns.
            free = np.array([(k >> unit) & 1 for unit in unit_of])
            weighted = scale[..., :, None] * matrix * (price * free)[..., None, :]
            inverse = np.linalg.pinv(weighted, rcond=1e-6)
            inverse = price[..., :, None] * inverse * scale[..., None, :]
            inverses.append(
                tuple(
                    tuple(_float(inverse[..., row, axis]) for axis in range(3))
                    for row in range(len(unit_of))
                )
            )
    return tuple(inverses)


def missing_units(available: tuple) -> Arithmetic:
    """Number of the first inverse of `inverses_of` for a ship that has all units, or misses one.

    Parameters
    ----------
    available : tuple of three bools or (...) arrays or tensors of bool
        Whether port, starboard and tunnel can be used. [1]

    Returns
    -------
    float or (...) array or tensor
        0, or 8 where a unit is missing. [1]

    References
    ----------
    Definition.
    """
    port, starboard, tunnel = (where(usable, 1.0, 0.0) for usable in available)
    return 8.0 * (1.0 - port * starboard * tunnel)


def solved(tau: Load, free: list, missing: Arithmetic, inverses: tuple) -> list:
    """Force components of the free units for a load, 0 for the others.

    Parameters
    ----------
    tau : tuple of three
        Load. [N, N, N.m]
    free : list of floats or (...) arrays or tensors
        1 for a free unit, 0 for any other. [1]
    missing : like free
        Number of the first inverse for this yaw lever, as of `missing_units`. [1]
    inverses : tuple of tuples
        As of `inverses_of`. [1, 1, 1/m]

    Returns
    -------
    list of n, like tau
        Force components. [N]

    References
    ----------
    As `design`.
    """
    X, Y, N = tau
    # Number of the set of free units, bit i for unit i; for one number its inverse is known.
    chosen = sum((2.0**unit * is_free for unit, is_free in enumerate(free)), missing)
    if is_single(chosen):
        return [a * X + b * Y + c * N for a, b, c in row_of(inverses, math.floor(chosen))]
    # Many numbers: elements may have different sets, so try them all.
    forces = [0.0 * X] * len(inverses[0])
    for number, rows in enumerate(inverses):
        here = chosen == number
        forces = [
            where(here, a * X + b * Y + c * N, old)
            for (a, b, c), old in zip(rows, forces, strict=True)
        ]
    return forces


def at_rest(tau: Load, *, parameters: AllocationParameters) -> Allocated:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : AllocationParameters
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
    parameters: AllocationParameters,
    design: ThrusterInverses,
    shares: tuple = (1.0, 1.0, 1.0),
) -> Allocated:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Allocated
        State at the last commands.
    tau : tuple of three
        Requested load, body frame. [N, N, N.m]
    available : tuple of three bools or (...) arrays of bool
        Whether port, starboard and tunnel can be used; the others take over what they can. [1]
    h : float
        Time since the last commands, for the rate limit. [s]
    parameters : AllocationParameters
        Units, limits and weights.
    design : ThrusterInverses
        Made of the same parameters by `design`.
    shares : tuple of three floats or (...) arrays or tensors
        Shares of their limits of thrust that power leaves to port, starboard and tunnel. What exceeds them is taken
        back at once, without limit of the rate. [1]

    Returns
    -------
    Allocated
        Commands, the load they give, and whether limits of thrust or missing units keep them from meeting the request
        (the rate limit is passing, so it does not count).

    References
    ----------
    Weighted generalised inverse as `design`; that thrust beyond a limit is allocated to the free units is assumed.
    """
    # Thrusts within their limits, then the load that they miss.
    limits = [
        (share * low, share * high)
        for share, (low, high) in zip(shares, parameters.limits, strict=True)
    ]
    missing = missing_units(available)
    wanted = within_limits(
        tau,
        available,
        limits,
        design.effect,
        lambda left, free: solved(left, free, missing, design.inverses),
    )
    saturated = is_missed(missed(tau, wanted, design.effect), parameters.yaw_lever)
    # Move each thrust at its largest rate; excess over the power limit is removed at once.
    reach = parameters.thrust_rate_max * h
    port, starboard, tunnel = [
        where(usable, clip(moved(old, new, reach), *limit), 0.0)
        for usable, old, new, limit in zip(available, state.thrusts, wanted, limits, strict=True)
    ]
    thrusts = (port, starboard, tunnel)
    return Allocated(thrusts, state.azimuths, *load(thrusts, design.effect), saturated)


def within_limits(
    tau: Load,
    available: tuple,
    limits: list,
    effect: tuple,
    solve: Callable[[Load, list], list],
    tolerance: float = 0.0,
) -> list:
    """Thrusts for a load, without rate limits; free units take over what another cannot give.

    Parameters
    ----------
    tau : tuple of three
        Load. [N, N, N.m]
    available : tuple of n bools or (...) arrays or tensors of bool
        Whether the units can be used. [1]
    limits : list of n tuples of two
        Least and largest thrust. [N]
    effect : tuple of n tuples of three
        Load of one newton of each unit. [1, 1, m]
    solve : callable
        From a load and a 1 for each free unit to their thrusts. [N]
    tolerance : float
        Beyond a limit by more than this a unit is held there. [N]

    Returns
    -------
    list of n, like tau
        Thrusts. [N]

    References
    ----------
    Assumed.
    """

    # Each round holds the units that are beyond a limit, and asks the others for the rest.
    def solved_once(state):
        rounds, held, free, *_ = state
        # Solve for the free units, with the load that the held ones leave.
        wanted = solve(missed(tau, held, effect), free)
        given = [clip(f, *limit) for f, limit in zip(wanted, limits, strict=True)]
        thrusts = [f + g for f, g in zip(held, given, strict=True)]
        over = [abs(f - g) > tolerance for f, g in zip(wanted, given, strict=True)]
        held = [where(o, g, f) for o, g, f in zip(over, given, held, strict=True)]
        free = [where(o, 0.0, f) for o, f in zip(over, free, strict=True)]
        return rounds + 1, held, free, thrusts, functools.reduce(operator.or_, over)

    # Stop when no unit is beyond its limit, in any element.
    def goes_on(state):
        over = state[-1]
        anywhere = over.any() if hasattr(over, "any") else over
        return anywhere & (state[0] < len(limits))

    free = [where(usable, 1.0, 0.0) for usable in available]
    held = [0.0] * len(limits)
    *_, thrusts, _ = repeat(goes_on, solved_once, (0, held, free, held, True))
    return thrusts


def _vector(*values: Arithmetic) -> np.ndarray:
    """(..., n) array of scalars or arrays of one shape."""
    return np.stack(np.broadcast_arrays(*values), -1)


def _float(value):
    """A Python float where the value is a scalar."""
    return float(value) if np.ndim(value) == 0 else value
