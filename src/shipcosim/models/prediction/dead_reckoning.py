"""Dead reckoning: motion to come if thrust, wind, current and waves stay as they are."""

from math import ceil

from shipcosim.angles import wrap
from shipcosim.models.core.integrate import midpoint_motion
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations, through_water


def predict(
    vessel: Motion,
    thrusters: Load,
    drift: Load,
    air: tuple[Arithmetic, Arithmetic],
    current: tuple[Arithmetic, Arithmetic],
    *,
    horizons: tuple[float, ...],
    longest_step: float,
    hull: HullParameters,
    wind: WindParameters,
) -> tuple[Motion, ...]:
    """Motion of the ship ahead in time by its equations of motion, with constant thrust, wind, current and wave drift.

    Parameters
    ----------
    vessel : Motion
        State now.
    thrusters : tuple of three
        Load of the thrusters, held in body axes. [N, N, N.m]
    drift : tuple of three
        Mean wave drift load, held in body axes. [N, N, N.m]
    air, current : tuple of two
        Velocity of air and water, north and east, held; the wind load follows the heading of the ship. [m/s]
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
    Midpoint rule, with the wind load at the middle heading of each step.

    References
    ----------
    Equations of motion as `ship.vessel`; integration as `core.integrate.midpoint_motion`.
    """
    held = [thrust + wave for thrust, wave in zip(thrusters, drift, strict=True)]
    motion = *vessel, *through_water(vessel.psi, vessel.u, vessel.v, *current)
    predictions, before = [], 0.0
    for horizon in horizons:
        steps = ceil((horizon - before) / longest_step)
        for _ in range(steps):
            motion = _advance(motion, held, air, current, (horizon - before) / steps, hull=hull, wind=wind)
        predictions.append(Motion(*motion[:6]))
        before = horizon
    return tuple(predictions)


def _advance(motion, held, air, current, h, *, hull, wind):
    """The ship one step of the midpoint rule later, integrated in the frame of the water as in `vessel.step`.

    `motion` is x, y, psi, u, v, r and the velocity through the water, u_r and v_r.
    """
    x, y, psi, u, v, r, u_r, v_r = motion
    wind_X, wind_Y, wind_N = wind_loads(*apparent_wind(psi + 0.5 * h * r, u, v, *air), wind=wind)
    X, Y, N = held[0] + wind_X, held[1] + wind_Y, held[2] + wind_N

    def rates(u_r, v_r, r):
        return accelerations(u_r, v_r, r, X, Y, N, hull=hull)

    x, y, psi, u_r, v_r, r = midpoint_motion(rates, x, y, psi, u_r, v_r, r, h, *current)
    psi = wrap(psi)
    u_c, v_c = to_body(psi, *current)
    return x, y, psi, u_r + u_c, v_r + v_c, r, u_r, v_r
