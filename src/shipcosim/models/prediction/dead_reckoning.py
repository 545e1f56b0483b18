"""Dead reckoning: future motion if thrust, wind, current and remaining force stay constant."""

from math import ceil

from shipcosim.angles import wrap
from shipcosim.models.core.integrate import midpoint_motion
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import times, where
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
    thrusters = delivered
    predictions = []
    before = 0.0
    # Equal steps up to each horizon, none longer than allowed.
    for horizon in horizons:
        steps = int(ceil((horizon - before) / longest_step))
        h = (horizon - before) / steps
        motion = times(
            steps,
            lambda now, h=h: advance(now, thrusters, surroundings, h, hull=hull, wind=wind),
            motion,
        )
        predictions.append(Motion(*motion[:6]))
        before = horizon
    return tuple(predictions)


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
