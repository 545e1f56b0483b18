"""Optimal thrust allocation of up to six units of any ship: least power within all limits.

The law is that of `sqp`. A unit with an `azimuth_rate` turns, within its interval of angles if it has one. It runs with
`thrust_least` or more, and reverses, to its `thrust_min`, only where another unit is missing. Any other unit has a
fixed direction and reverses to its `thrust_min`.
"""

from dataclasses import dataclass
from math import inf

from shipcosim.models.allocation.fixed_angles import UNITS, FixedAngleParameters
from shipcosim.models.allocation.sqp import (
    AllocatedThruster,
    OptimalProblem,
    Turned,
    designed,
    power_step,
    resting,
)
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity

_NONE = "none"


def _turning(number):
    return quantity(
        0.0,
        "rad/s",
        f"quickest turning of unit {number}; 0: its direction is fixed",
        _NONE,
        minimum=0.0,
    )


def _first(number):
    return quantity(
        0.0,
        "rad",
        f"unit {number} turns clockwise from here; no limit where it is `azimuth_last`",
        _NONE,
    )


def _last(number):
    return quantity(0.0, "rad", f"and to here; above azimuth_first_{number}", _NONE)


def _least(number):
    return quantity(0.0, "N", f"least thrust of unit {number} where it turns", _NONE, minimum=0.0)


def _specific(number):
    about = f"power of unit {number} at its largest thrust, over that thrust; only the ratios of the units count"
    return quantity(1.0, "W/N", about, "full power goes with full thrust, assumed", minimum=1e-9)


@dataclass(frozen=True, kw_only=True)
class OptimalUnitsParameters(FixedAngleParameters):
    """Places, limits, turning and prices of the units."""

    azimuth_rate_1: float = _turning(1)
    azimuth_first_1: float = _first(1)
    azimuth_last_1: float = _last(1)
    thrust_least_1: float = _least(1)
    specific_power_1: float = _specific(1)
    azimuth_rate_2: float = _turning(2)
    azimuth_first_2: float = _first(2)
    azimuth_last_2: float = _last(2)
    thrust_least_2: float = _least(2)
    specific_power_2: float = _specific(2)
    azimuth_rate_3: float = _turning(3)
    azimuth_first_3: float = _first(3)
    azimuth_last_3: float = _last(3)
    thrust_least_3: float = _least(3)
    specific_power_3: float = _specific(3)
    azimuth_rate_4: float = _turning(4)
    azimuth_first_4: float = _first(4)
    azimuth_last_4: float = _last(4)
    thrust_least_4: float = _least(4)
    specific_power_4: float = _specific(4)
    azimuth_rate_5: float = _turning(5)
    azimuth_first_5: float = _first(5)
    azimuth_last_5: float = _last(5)
    thrust_least_5: float = _least(5)
    specific_power_5: float = _specific(5)
    azimuth_rate_6: float = _turning(6)
    azimuth_first_6: float = _first(6)
    azimuth_last_6: float = _last(6)
    thrust_least_6: float = _least(6)
    specific_power_6: float = _specific(6)
    turning_time: float = quantity(
        10.0,
        "s",
        "time constant of turning to the cheapest direction",
        "tried with two azimuths and a tunnel",
        minimum=0.0,
    )


def design(parameters: OptimalUnitsParameters) -> OptimalProblem:
    """What the law needs of the parameters.

    Parameters
    ----------
    parameters : OptimalUnitsParameters
        The units.

    Returns
    -------
    OptimalProblem
        Unit 1 to 6.

    References
    ----------
    Definition.
    """
    # Parameters of each unit, in the order of `_unit`.
    p = parameters
    fixed = "x", "y", "azimuth", "thrust_min", "thrust_max", "thrust_rate"
    turning = "azimuth_rate", "azimuth_first", "azimuth_last", "thrust_least", "specific_power"
    units = tuple(
        _unit(*values)
        for values in zip(*(p.of_units(name) for name in fixed + turning), strict=True)
    )
    return designed(units, p.turning_time, p.yaw_lever, p.yaw_lever)


def _unit(x, y, azimuth, low, high, thrust_rate, azimuth_rate, first, last, least, specific_power):
    """A unit as `sqp` needs it."""
    # Power over thrust^1.5, from the power at the largest thrust.
    price = specific_power * max(high, -low, 1.0) ** -0.5
    # A unit that turns keeps its least thrust; without an interval it may turn anywhere.
    if azimuth_rate > 0.0:
        first, last = (first, last) if last > first else (-inf, inf)
        return AllocatedThruster(
            x, y, min(least, high), high, low, thrust_rate, first, last, azimuth_rate, price
        )
    return AllocatedThruster(x, y, low, high, low, thrust_rate, azimuth, azimuth, 0.0, price)


def at_rest(tau: Load, *, parameters: OptimalUnitsParameters) -> Turned:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : OptimalUnitsParameters
        Units and their angles at the start.

    Returns
    -------
    Turned
        The state.

    References
    ----------
    Definition.
    """
    return resting(tau, tuple(parameters.of_units("azimuth")))


def step(
    state: Turned,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: OptimalUnitsParameters,
    design: OptimalProblem,
    shares: tuple = (1.0,) * UNITS,
) -> Turned:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Turned
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of six bools or (...) arrays or tensors of bool
        Whether the units can be used; one that cannot gives 0 at once and keeps its angle. [1]
    h : float
        Time since the last commands, for the limits of the rates. [s]
    parameters : OptimalUnitsParameters
        Units and limits.
    design : OptimalProblem
        Made of the same parameters by `design`.
    shares : tuple of six floats or (...) arrays or tensors
        Shares of their limits of thrust that power leaves to the units. [1]

    Returns
    -------
    Turned
        Commands and the load they give.

    References
    ----------
    As `sqp.power_step`.
    """
    return power_step(state, tau, available, h, design=design, shares=shares)
