"""Dead reckoning: future motion if thrust, wind, current and remaining force stay constant."""

from collections.abc import Callable
from math import ceil
from typing import Any

from shipcosim.angles import wrap
from shipcosim.models.core.integrate import midpoint_motion
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import row_of, times, where
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations, through_water

_NO_LOAD = 1.0  # N and N.m, below which no thruster gets a command


def predict(
    known: Known,
    surroundings: Surroundings,
    *,
    horizons: tuple[float, ...],
    longest_step: float,
    hull: HullParameters,
    wind: WindParameters,
) -> tuple[Motion, ...]:
    """Predict the motion of the ship by her equations of motion.

    Parameters
    ----------
    known : Known
        State now, and load of the thrusters, which is held in body axes; floats, (...) arrays or tensors.
    surroundings : Surroundings
        Wind, current and remaining force, held earth-fixed, and remaining moment; the load of the wind follows heading
        and speed of the ship, that of the current her velocity through the water. The error of thrust is held while
        any thrust is commanded.
    horizons : tuple of float, increasing
        How far ahead. [s]
    longest_step : float
        Longest step of the integration; each stretch up to a horizon is divided into equal steps. [s]
    hull : HullParameters
        The hull.
    wind : WindParameters
        Wind load coefficients.

    Returns
    -------
    tuple of Motion
        One per horizon.

    Notes
    -----
    Midpoint rule, with the loads of wind and force at the middle heading of each step.

    References
    ----------
    Equations of motion as `ship.vessel`; integration as `core.integrate.midpoint_motion`.
    """
    ship = known.ship
    current = (surroundings.current_north, surroundings.current_east)
    # Delivered thrust: the command and its error, or nothing.
    acting = abs(known.thrusters[0]) + abs(known.thrusters[1]) + abs(known.thrusters[2]) > _NO_LOAD
    X, Y, N = [where(acting, error, 0.0 * error) for error in surroundings.thrust_error]
    delivered = known.thrusters[0] + X, known.thrusters[1] + Y, known.thrusters[2] + N
    # Integrate in the frame of the water, since hull loads depend on velocity through it.
    motion = (*ship, *through_water(ship.psi, ship.u, ship.v, *current))
    return at_horizons(
        lambda now, h: advance(now, delivered, surroundings, h, hull=hull, wind=wind),
        lambda now: Motion(*now[:6]),
        motion,
        horizons=horizons,
        longest_step=longest_step,
    )


def at_horizons(
    later: Callable[[Any, Any], Any],
    motion_of: Callable[[Any], Motion],
    state: Any,
    *,
    horizons: tuple[float, ...],
    longest_step: float,
) -> tuple[Motion, ...]:
    """Advance a state to each horizon, in equal steps, none longer than allowed.

    Parameters
    ----------
    later : callable
        ``later(state, h)`` gives the state a step later. [as state]
    motion_of : callable
        From a state to the motion that is shown.
    state : any
        Where it begins. [any units]
    horizons : tuple of float, increasing
        How far ahead. [s]
    longest_step : float
        Longest step. [s]

    Returns
    -------
    tuple of Motion
        One per horizon.

    References
    ----------
    Definition.
    """

    # A loop over the stretches, so that compiled code has the step once.
    def stretch(reached):
        number, before, state, predictions = reached
        horizon = row_of(horizons, number)
        steps = ceil((horizon - before) / longest_step)
        h = (horizon - before) / steps
        state = times(steps, lambda now: later(now, h), state)
        motion = motion_of(state)
        predictions = tuple(
            Motion(*(where(number == place, *pair) for pair in zip(motion, old, strict=True)))
            for place, old in enumerate(predictions)
        )
        return number + 1, horizon, state, predictions

    begin = 0, 0.0, state, (motion_of(state),) * len(horizons)
    *_, predictions = times(len(horizons), stretch, begin)
    return predictions


def advance(
    motion: tuple,
    thrusters: Load,
    around: Surroundings,
    h: float,
    *,
    hull: HullParameters,
    wind: WindParameters,
) -> tuple:
    """One step of the midpoint rule, integrated in the frame of the water as in `vessel.step`.

    Parameters
    ----------
    motion : tuple of eight floats, (...) arrays or tensors
        x, y, psi, u, v, r, and the velocity through the water, u_r and v_r. [m, m, rad, m/s, m/s, rad/s, m/s, m/s]
    thrusters : tuple of three, like them
        Load of the thrusters in body axes. [N, N, N.m]
    around : Surroundings
        As in `predict`.
    h : float
        Step. [s]
    hull, wind : HullParameters, WindParameters
        The ship.

    Returns
    -------
    tuple of eight
        As `motion`, with the heading wrapped. [as motion]

    References
    ----------
    As `predict`.
    """
    x, y, psi, u, v, r, u_r, v_r = motion
    current = (around.current_north, around.current_east)
    # Wind and remaining force are fixed to the earth: turn them at the heading of mid-step.
    middle = psi + 0.5 * h * r
    wind_X, wind_Y, wind_N = wind_loads(
        *apparent_wind(middle, u, v, around.wind_north, around.wind_east), wind=wind
    )
    force_X, force_Y = to_body(middle, around.force_north, around.force_east)
    X = thrusters[0] + wind_X + force_X
    Y = thrusters[1] + wind_Y + force_Y
    N = thrusters[2] + wind_N + around.moment

    def rates(u_r, v_r, r):
        return accelerations(u_r, v_r, r, X, Y, N, hull=hull)

    # M ν̇_r + C(ν_r) ν_r + D(ν_r) ν_r = τ, with these loads held over the step.
    x, y, psi, u_r, v_r, r = midpoint_motion(rates, x, y, psi, u_r, v_r, r, h, *current)
    psi = wrap(psi)
    # Velocity over ground = velocity through water + current.
    u_c, v_c = to_body(psi, *current)
    return x, y, psi, u_r + u_c, v_r + v_c, r, u_r, v_r
