"""Thrust allocation by a weighted generalised inverse at fixed azimuth angles.

An allocator is two functions: `design` computes once what it needs of its parameters, `step` turns a requested load
into commands.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.units import Allocated, NamedUnits, load, missed, unit_effect
from shipcosim.models.core.maths import clip, where
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
        Nine elements of the inverse for each set of free units: set k holds unit i where bit i of k is set; bit 3 is
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
    # Configuration matrix, and prices as W^-1/2.
    p = parameters
    b = effect(p)
    matrix = np.stack(np.broadcast_arrays(*(_vector(*unit) for unit in b)), -1)
    price = _vector(p.azimuth_weight, p.azimuth_weight, p.tunnel_weight) ** -0.5
    # An inverse for every set of free units, with both yaw levers.
    inverses = [
        _inverse(matrix, price, lever, [(k >> unit) & 1 for unit in range(3)])
        for lever in (p.yaw_lever, p.yaw_lever_degraded)
        for k in range(8)
    ]
    return ThrusterInverses(b, tuple(inverses))


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
    zero = 0.0 * tau[0]
    return Allocated((zero,) * 3, parameters.of_units("azimuth"), zero, zero, zero, zero > 0.0)


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
    wanted = _within_limits(tau, available, limits, design=design)
    X, Y, N = missed(tau, wanted, design.effect)
    # More than 1 N, or its moment at the yaw lever, counts as missed.
    squared = X * X + Y * Y + (N / parameters.yaw_lever) ** 2
    # Move each thrust at its largest rate; excess over the power limit is removed at once.
    reach = parameters.thrust_rate_max * h
    port, starboard, tunnel = [
        where(usable, clip(old + clip(new - old, -reach, reach), *limit), 0.0)
        for usable, old, new, limit in zip(available, state.thrusts, wanted, limits, strict=True)
    ]
    thrusts = (port, starboard, tunnel)
    return Allocated(thrusts, state.azimuths, *load(thrusts, design.effect), squared > 1.0)


def _within_limits(tau, available, limits, *, design):
    """Thrusts for a load, without rate limits; free units take over what another cannot give."""
    # Free units; number 8 on selects the inverses for a ship with a missing unit.
    free = [where(usable, 1.0, 0.0) for usable in available]
    missing = 8.0 * (1.0 - free[0] * free[1] * free[2])
    held = [0.0, 0.0, 0.0]
    # At most three rounds: each holds the units that are beyond a limit.
    for _ in range(3):
        # Solve for the free units, with the load that the held ones leave.
        a, b, c = _solve(missed(tau, held, design.effect), free, missing, design.inverses)
        given = clip(a, *limits[0]), clip(b, *limits[1]), clip(c, *limits[2])
        thrusts = [f + g for f, g in zip(held, given, strict=True)]
        over = a != given[0], b != given[1], c != given[2]
        # Stop when no unit is beyond its limit, in any element.
        anywhere = over[0] | over[1] | over[2]
        if not (anywhere.any() if hasattr(anywhere, "any") else anywhere):
            break
        # Hold the units beyond a limit, and ask the others for the rest.
        held = [where(o, g, f) for o, g, f in zip(over, given, held, strict=True)]
        free = [where(o, 0.0, f) for o, f in zip(over, free, strict=True)]
    return thrusts


def _solve(tau, free, missing, inverses):
    """Thrusts of the free units for a load, 0 for the others."""
    # Number of the set of free units; its inverse times the load.
    chosen = free[0] + 2.0 * free[1] + 4.0 * free[2] + missing
    a, b, c, d, e, f, g, h, i = _choose(chosen, inverses)
    X, Y, N = tau
    return a * X + b * Y + c * N, d * X + e * Y + f * N, g * X + h * Y + i * N


def _inverse(matrix, price, lever, free):
    """Nine elements of the generalised inverse of the free units' effect, row by row."""
    # W^-1/2 (S B W^-1/2)^+ S, with S for the yaw lever and only the free units' columns.
    scale = _vector(1.0, 1.0, 1.0 / lever)
    weighted = scale[..., :, None] * matrix * (price * free)[..., None, :]
    inverse = price[..., :, None] * np.linalg.pinv(weighted, rcond=1e-6) * scale[..., None, :]
    return tuple(_float(inverse[..., unit, axis]) for unit in range(3) for axis in range(3))


def _vector(*values):
    """(..., n) array of scalars or arrays of one shape."""
    return np.stack(np.broadcast_arrays(*values), -1)


def _choose(index, rows):
    """Row of an index that may differ from element to element."""
    # One number: pick its row.
    if isinstance(index, float):
        return rows[int(index)]
    # Many numbers: each element takes the row of its own index.
    chosen = rows[0]
    for number, row in enumerate(rows[1:], 1):
        chosen = [where(index == number, new, old) for new, old in zip(row, chosen, strict=True)]
    return chosen


def _float(value):
    """A Python float where the value is a scalar."""
    return float(value) if np.ndim(value) == 0 else value
