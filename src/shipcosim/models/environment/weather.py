"""Weather: mean wind and current that follow setpoints at limited rates, with gusts."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.kinematics import moved, turned
from shipcosim.models.core.maths import Arithmetic, cos, is_single, sin
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity
from shipcosim.models.environment.gusts import gust


@dataclass(frozen=True)
class EnvironmentParameters:
    """Rates of change of the weather, its gusts and its sea."""

    wind_speed_rate: float = quantity(
        0.5,
        "m/s2",
        "fastest change of the mean wind speed",
        "assumed: 5 m/s more in 10 s",
        minimum=0.0,
    )
    wind_turn_rate: float = quantity(
        0.02, "rad/s", "fastest turn of the mean wind", "assumed: 45 deg in 40 s", minimum=0.0
    )
    current_speed_rate: float = quantity(
        0.005,
        "m/s2",
        "fastest change of the current's speed",
        "assumed: 0.5 m/s in 100 s",
        minimum=0.0,
    )
    current_turn_rate: float = quantity(
        0.005, "rad/s", "fastest turn of the current", "assumed: 90 deg in 310 s", minimum=0.0
    )
    gust_scale: float = quantity(
        1.0, "1", "gusts over those of the spectrum; 0: none", "definition", minimum=0.0
    )
    significant_wave_height: float = quantity(
        0.0, "m", "significant wave height Hs; 0: no waves", "set by the scenario", minimum=0.0
    )
    peak_period: float = quantity(
        6.0, "s", "peak period Tp of the waves", "assumed: a coastal wind sea", minimum=0.5
    )
    waves_from: float = quantity(
        0.0, "rad", "where the waves come from, clockwise from north", "set by the scenario"
    )
    peak_enhancement: float = quantity(
        3.3,
        "1",
        "gamma of the JONSWAP spectrum",
        "mean of the JONSWAP measurements",
        minimum=1.0,
        maximum=7.0,
    )
    seed: int = quantity(1, "1", "seed of gusts and waves", "any", minimum=0)


class EnvironmentState(NamedTuple):
    """Mean wind and current at one time.

    Parameters
    ----------
    wind_speed, wind_from : float or (m,) array or tensor
        Mean wind at 10 m, where it comes from. [m/s, rad]
    current_speed, current_to : float or (m,) array or tensor
        Current, where it flows to. [m/s, rad]
    """

    wind_speed: Arithmetic
    wind_from: Arithmetic
    current_speed: Arithmetic
    current_to: Arithmetic


def step(
    h: float,
    state: EnvironmentState,
    wind_speed: Arithmetic,
    wind_from: Arithmetic,
    current_speed: Arithmetic,
    current_to: Arithmetic,
    *,
    parameters: EnvironmentParameters,
) -> EnvironmentState:
    """Means after a step: each moves to its setpoint within its rate limit.

    Parameters
    ----------
    h : float
        Step. [s]
    state : EnvironmentState
        Means at the start of the step.
    wind_speed, wind_from, current_speed, current_to : like those of the state
        Setpoints during the step. [m/s, rad, m/s, rad]
    parameters : EnvironmentParameters
        Rate limits.

    Returns
    -------
    EnvironmentState
        Means at the end of the step.

    References
    ----------
    Assumed: rate limits of mean wind and current.

    Examples
    --------
    From 350 to 10 deg the wind turns through north:

    >>> from math import degrees, radians
    >>> means = EnvironmentState(8.0, radians(-10.0), 0.0, 0.0)
    >>> means = step(1.0, means, 8.0, radians(10.0), 0.0, 0.0, parameters=EnvironmentParameters(wind_turn_rate=0.2))
    >>> round(degrees(means.wind_from), 2)
    1.46
    """
    return EnvironmentState(
        moved(state.wind_speed, wind_speed, parameters.wind_speed_rate * h),
        turned(state.wind_from, wind_from, parameters.wind_turn_rate * h),
        moved(state.current_speed, current_speed, parameters.current_speed_rate * h),
        turned(state.current_to, current_to, parameters.current_turn_rate * h),
    )


def air_velocity(
    t: Arithmetic, state: EnvironmentState, *, gust_scale: Arithmetic, seed: int | np.ndarray
) -> Vector:
    """Velocity of the air at 10 m over ground, gusts included: where it goes to.

    Parameters
    ----------
    t : float
        Time. [s]
    state : EnvironmentState
        Means at t.
    gust_scale : float or (m,) array
        Gusts over those of the spectrum. [1]
    seed : int or (m,) array of int
        Seed of the gusts, not negative. [1]

    Returns
    -------
    tuple of two, like the state
        North and east component. [m/s]

    References
    ----------
    Definition; gusts as `gusts.gust`.

    Examples
    --------
    A westerly of 10 m/s blows towards east:

    >>> from math import pi
    >>> westerly = EnvironmentState(10.0, -pi / 2.0, 0.0, 0.0)
    >>> [round(component, 9) for component in air_velocity(0.0, westerly, gust_scale=0.0, seed=1)]
    [-0.0, 10.0]
    """
    # Gusts add to the mean speed. The wind is given by where it comes from, its velocity by where
    # it goes.
    speed = state.wind_speed
    # Without gusts, as in a replay of measured wind, their spectrum would be most of a step's cost.
    if not is_single(gust_scale) or gust_scale != 0.0:
        speed = speed + gust_scale * gust(t, state.wind_speed, seed)
    return -speed * cos(state.wind_from), -speed * sin(state.wind_from)


def water_velocity(state: EnvironmentState) -> Vector:
    """Velocity of the water over ground: where it goes to.

    Parameters
    ----------
    state : EnvironmentState
        Means.

    Returns
    -------
    tuple of two, like the state
        North and east component. [m/s]

    References
    ----------
    Definition.
    """
    return state.current_speed * cos(state.current_to), state.current_speed * sin(state.current_to)
