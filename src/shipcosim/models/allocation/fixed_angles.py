"""Thrust allocation of up to six units at fixed directions by a weighted generalised inverse.

Parameters describe the units: a propeller, a tunnel thruster, an azimuth held at an angle. A unit
without thrust does not exist. As in `pseudo_inverse`, free units take over what another cannot
give.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.pseudo_inverse import inverses_of, solved, within_limits
from shipcosim.models.allocation.units import (
    Allocated,
    is_missed,
    load,
    missed,
    no_thrust,
    unit_effect,
    unit_fields,
)
from shipcosim.models.core.kinematics import moved
from shipcosim.models.core.maths import where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import UNITS, numbered_units, quantity, required


def _fields(number):
    """Place, direction and limits of a unit."""
    rate = f"quickest change of the command to unit {number}"
    return unit_fields(number) | {
        "thrust_rate": quantity(0.0, "N/s", rate, "no such unit", minimum=0.0)
    }


@dataclass(frozen=True, kw_only=True)
class FixedAngleParameters(numbered_units(_fields)):
    """Places, directions and limits of the units."""

    yaw_lever: float = required(
        "m", "a missed yaw moment weighs as a missed force at this distance", minimum=0.1
    )

    @property
    def start_azimuths(self) -> tuple[float, ...]:
        """Directions at the start. [rad]"""
        return tuple(self.of_units("azimuth"))


class Layout(NamedTuple):
    """What `step` needs of the parameters.

    Parameters
    ----------
    effect : tuple of six tuples
        Load of one newton of each unit: X, Y, N. [1, 1, m]
    inverses : tuple of 64 tuples of six tuples
        Generalised inverse for each set of free units: set k holds unit i where bit i of k is set. [1, 1, 1/m]
    least, most, rate : tuple of six floats
        Limits. [N, N, N/s]
    """

    effect: tuple
    inverses: tuple
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
    # Load of one newton of each unit.
    p = parameters
    effect = tuple(map(unit_effect, p.of_units("x"), p.of_units("y"), p.of_units("azimuth")))
    # The price of thrust is the square of its share of the unit's largest thrust.
    least = p.of_units("thrust_min")
    most = p.of_units("thrust_max")
    size = np.array([max(high, -low) for low, high in zip(least, most, strict=True)])
    size = size / max(size.max(), 1.0)
    inverses = inverses_of(effect, size, (p.yaw_lever,), tuple(range(UNITS)))
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
    return no_thrust(tau, parameters.start_azimuths)


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
    wanted = within_limits(
        tau,
        available,
        list(zip(design.least, design.most, strict=True)),
        design.effect,
        lambda left, free: solved(left, free, 0.0, design.inverses),
        1e-9,
    )
    saturated = is_missed(missed(tau, wanted, design.effect), parameters.yaw_lever)
    # Move each thrust at its largest rate; a missing unit gives nothing.
    limits = zip(state.thrusts, wanted, available, design.rate, strict=True)
    thrusts = tuple(
        where(on, moved(old, new, rate * h), 0.0 * new) for old, new, on, rate in limits
    )
    return Allocated(thrusts, state.azimuths, *load(thrusts, design.effect), saturated)
