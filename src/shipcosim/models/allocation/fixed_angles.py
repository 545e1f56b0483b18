"""Thrust allocation of up to six units at fixed directions by a weighted generalised inverse.

Parameters describe the units: a propeller, a tunnel thruster, an azimuth held at an angle. A unit
without thrust does not exist. As in `pseudo_inverse`, free units take over what another cannot
give.
"""

import functools
import math
import operator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.units import Allocated, load, missed
from shipcosim.models.core.maths import clip, cos, is_single, row_of, sin, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity, required

UNITS = 6


def _place(unit, description):
    return quantity(0.0, unit, description, "no such unit")


def _least(number):
    return quantity(
        0.0, "N", f"least thrust of unit {number}, negative", "no such unit", maximum=0.0
    )


def _most(number):
    return quantity(
        0.0, "N", f"most thrust of unit {number}; 0: there is none", "no such unit", minimum=0.0
    )


def _rate(number):
    return quantity(
        0.0, "N/s", f"quickest change of the command to unit {number}", "no such unit", minimum=0.0
    )


@dataclass(frozen=True, kw_only=True)
class FixedAngleParameters:
    """Places, directions and limits of the units."""

    x_1: float = _place("m", "unit 1 forward of the origin")
    y_1: float = _place("m", "unit 1 to starboard of the origin")
    azimuth_1: float = _place(
        "rad", "direction of positive thrust of unit 1, clockwise from the bow"
    )
    thrust_min_1: float = _least(1)
    thrust_max_1: float = _most(1)
    thrust_rate_1: float = _rate(1)
    x_2: float = _place("m", "unit 2 forward of the origin")
    y_2: float = _place("m", "unit 2 to starboard of the origin")
    azimuth_2: float = _place(
        "rad", "direction of positive thrust of unit 2, clockwise from the bow"
    )
    thrust_min_2: float = _least(2)
    thrust_max_2: float = _most(2)
    thrust_rate_2: float = _rate(2)
    x_3: float = _place("m", "unit 3 forward of the origin")
    y_3: float = _place("m", "unit 3 to starboard of the origin")
    azimuth_3: float = _place(
        "rad", "direction of positive thrust of unit 3, clockwise from the bow"
    )
    thrust_min_3: float = _least(3)
    thrust_max_3: float = _most(3)
    thrust_rate_3: float = _rate(3)
    x_4: float = _place("m", "unit 4 forward of the origin")
    y_4: float = _place("m", "unit 4 to starboard of the origin")
    azimuth_4: float = _place(
        "rad", "direction of positive thrust of unit 4, clockwise from the bow"
    )
    thrust_min_4: float = _least(4)
    thrust_max_4: float = _most(4)
    thrust_rate_4: float = _rate(4)
    x_5: float = _place("m", "unit 5 forward of the origin")
    y_5: float = _place("m", "unit 5 to starboard of the origin")
    azimuth_5: float = _place(
        "rad", "direction of positive thrust of unit 5, clockwise from the bow"
    )
    thrust_min_5: float = _least(5)
    thrust_max_5: float = _most(5)
    thrust_rate_5: float = _rate(5)
    x_6: float = _place("m", "unit 6 forward of the origin")
    y_6: float = _place("m", "unit 6 to starboard of the origin")
    azimuth_6: float = _place(
        "rad", "direction of positive thrust of unit 6, clockwise from the bow"
    )
    thrust_min_6: float = _least(6)
    thrust_max_6: float = _most(6)
    thrust_rate_6: float = _rate(6)
    yaw_lever: float = required(
        "m", "a missed yaw moment weighs as a missed force at this distance", minimum=0.1
    )

    def of_units(self, name: str) -> list[float]:
        """A parameter of all units, in their order."""
        return [getattr(self, f"{name}_{number}") for number in range(1, UNITS + 1)]


class Layout(NamedTuple):
    """What `step` needs of the parameters.

    Parameters
    ----------
    effect : tuple of six tuples
        Load of one newton of each unit: X, Y, N. [1, 1, m]
    inverses : (64, 6, 3) array
        Generalised inverse for each set of free units: set k holds unit i where bit i of k is set. [1, 1, 1/m]
    least, most, rate : tuple of six floats
        Limits. [N, N, N/s]
    """

    effect: tuple
    inverses: np.ndarray
    least: tuple
    most: tuple
    rate: tuple


def design(parameters: FixedAngleParameters) -> Layout:
    """Effect of the units, and the generalised inverses for all sets of them.

    Parameters
    ----------
    parameters : FixedAngleParameters
        The units.

    Returns
    -------
    Layout
        What `step` needs.

    Notes
    -----
    As `pseudo_inverse.design`; the price of a unit's thrust is the square of its share of the unit's largest thrust.

    References
    ----------
    Weighted generalised inverse: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley,
    2021.
    """
    # Load of one newton of each unit: (cos a, sin a, x sin a - y cos a).
    p = parameters
    places = zip(p.of_units("x"), p.of_units("y"), p.of_units("azimuth"), strict=True)
    effect = tuple((cos(a), sin(a), x * sin(a) - y * cos(a)) for x, y, a in places)
    # The price of thrust is the square of its share of the unit's largest thrust.
    least = p.of_units("thrust_min")
    most = p.of_units("thrust_max")
    size = np.array([max(high, -low) for low, high in zip(least, most, strict=True)])
    size = size / max(size.max(), 1.0)
    # A missed moment counts as a missed force at the yaw lever.
    scale = np.array([1.0, 1.0, 1.0 / p.yaw_lever])
    weighted = scale[:, None] * np.array(effect).T * size
    # For every set of free units: W^-1/2 (S B W^-1/2)^+ S.
    inverses = np.zeros((1 << UNITS, UNITS, 3))
    for k in range(1, 1 << UNITS):
        free = np.array([(k >> unit) & 1 for unit in range(UNITS)])
        inverses[k] = size[:, None] * np.linalg.pinv(weighted * free, rcond=1e-6) * scale
    return Layout(effect, inverses, tuple(least), tuple(most), tuple(p.of_units("thrust_rate")))


def at_rest(tau: Load, *, parameters: FixedAngleParameters) -> Allocated:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : FixedAngleParameters
        The units.

    Returns
    -------
    Allocated
        The state.

    References
    ----------
    Definition.
    """
    zero = 0.0 * tau[0]
    return Allocated(
        (zero,) * UNITS, tuple(parameters.of_units("azimuth")), zero, zero, zero, zero > 0.0
    )


def step(
    state: Allocated,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: FixedAngleParameters,
    design: Layout,
) -> Allocated:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Allocated
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of six bools or (...) arrays or tensors of bool
        Whether the units can be used; the others take over what they can. [1]
    h : float
        Time since the last commands, for the limits of the rate. [s]
    parameters : FixedAngleParameters
        Units and limits.
    design : Layout
        Made of the same parameters by `design`.

    Returns
    -------
    Allocated
        Commands and the load they give.

    References
    ----------
    As `design`; that thrust beyond a limit is asked of the free units is assumed.
    """
    # Thrusts within their limits, then the load that they miss.
    wanted = _within_limits(tau, available, design)
    X, Y, N = missed(tau, wanted, design.effect)
    # More than 1 N, or its moment at the yaw lever, counts as missed.
    squared = X * X + Y * Y + (N / parameters.yaw_lever) ** 2
    # Move each thrust at its largest rate; a missing unit gives nothing.
    limits = zip(state.thrusts, wanted, available, design.rate, strict=True)
    thrusts = tuple(
        where(on, old + clip(new - old, -rate * h, rate * h), 0.0 * new)
        for old, new, on, rate in limits
    )
    return Allocated(thrusts, state.azimuths, *load(thrusts, design.effect), squared > 1.0)


def _within_limits(tau, available, design):
    """Thrusts for a load, without rate limits."""
    # Units beyond a limit are held there, and the free ones take over the rest.
    free = [where(on, 1.0, 0.0) for on in available]
    held = [0.0 * tau[0]] * UNITS
    thrusts = held
    for _ in range(UNITS):
        # Solve for the free units, with the load that the held ones leave.
        found = _solve(missed(tau, held, design.effect), free, design.inverses)
        given = [
            clip(f, low, high)
            for f, low, high in zip(found, design.least, design.most, strict=True)
        ]
        thrusts = [f + g for f, g in zip(held, given, strict=True)]
        # Stop when no unit is beyond its limit, in any element.
        over = [abs(f - g) > 1e-9 for f, g in zip(found, given, strict=True)]
        anywhere = functools.reduce(operator.or_, over)
        if not (anywhere.any() if hasattr(anywhere, "any") else anywhere):
            break
        # Hold the units beyond a limit, and go on with the others.
        held = [where(o, g, f) for o, g, f in zip(over, given, held, strict=True)]
        free = [where(o, 0.0, f) for o, f in zip(over, free, strict=True)]
    return thrusts


def _solve(tau, free, inverses):
    """Thrusts of the free units for a load, 0 for the others."""
    # Number of the set of free units: bit i stands for unit i.
    chosen = sum(2.0**unit * one for unit, one in enumerate(free))
    # One number: pick the inverse of this set.
    if is_single(chosen):
        return [
            a * tau[0] + b * tau[1] + c * tau[2]
            for a, b, c in row_of(inverses, math.floor(chosen)).tolist()
        ]
    # Many numbers: elements may have different sets, so try them all.
    found = [0.0 * tau[0]] * UNITS
    for k in range(1, 1 << UNITS):
        rows = inverses[k].tolist()
        found = [
            where(chosen == k, a * tau[0] + b * tau[1] + c * tau[2], old)
            for (a, b, c), old in zip(rows, found, strict=True)
        ]
    return found
