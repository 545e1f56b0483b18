"""Current, remaining load and errors of the ship's own model, as she can tell them from her own record.

A Kalman filter whose states are the ship's velocity, the current, a remaining load, and coefficients of a residual load
that is linear in them (`residual_load`). What the filter believes before the record, of each coefficient its mean and
standard deviation, and how fast everything changes, is learned over many ships (`learn.prediction.drift`); from there
each ship's own record corrects it, second by second, while she runs.
"""

from typing import NamedTuple

import numpy as np

from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, exp, hypot, library_of, sqrt, where
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.known import Known, air_velocity
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

COEFFICIENTS = (
    *("surge_square", "surge_linear", "sway_square", "sway_linear"),
    *("yaw_by_sway_square", "yaw_by_sway_linear", "yaw_by_surge_sway", "yaw_square", "yaw_linear"),
    *("wind_X", "wind_Y", "wind_N", "wind_lever"),
    *("thrust_stern_X", "thrust_stern_Y", "thrust_bow", "wash_X", "wash_Y"),
)
"""Coefficients of the residual load, in their order in the state."""
STATES = ("u", "v", "r", "current_north", "current_east", "force_north", "force_east", "moment", *COEFFICIENTS)
"""States of the filter. [m/s, m/s, rad/s, m/s, m/s, N, N, N.m, 1]"""
DIFFERENCES = (1e-3, 1e-3, 1e-4, 1e-2, 1e-2, 1e2, 1e2, 1e3, *(0.05,) * len(COEFFICIENTS))
"""Over which slopes are taken. [units of `STATES`]"""
ARM = 0.42  # of the length, bow and stern thrusters from midships: assumed
SLOW = 0.2  # m/s, where linear and quadratic damping of one coefficient are alike
HELD = 1e4  # N, thrust at which run-down and wash are given
_TINY = 1e-6


class Learned(NamedTuple):
    """What is learned over many ships, and believed before the record of this one.

    Parameters
    ----------
    mean : (..., 18) array or tensor
        Expected coefficients. [1]
    std : (..., 26) array or tensor
        Standard deviations of all states at the start; of remaining force and moment at all times. [units of `STATES`]
    disturbance : (..., 2) array or tensor
        Random walk of the velocities u and v, and of r, in a second. [m/s, rad/s]
    noise : like disturbance
        Standard deviations of the observer's u and v, and of its r, each averaged over a second. [m/s, rad/s]
    current_walk : (...) array or tensor
        Random walk of the current in a second. [m/s]
    force_time, moment_time, wind_time : like current_walk
        Correlation times of remaining force and moment, time constant of the mean of the wind. [s]
    lag : like current_walk
        Time constant with which thrust follows what it is told. [s]
    run_down_bow, run_down_stern : like current_walk
        Time in which thrust of 10 kN falls to a quarter when power is lost. [s]
    """

    mean: Arithmetic
    std: Arithmetic
    disturbance: Arithmetic
    noise: Arithmetic
    current_walk: Arithmetic
    force_time: Arithmetic
    moment_time: Arithmetic
    wind_time: Arithmetic
    lag: Arithmetic
    run_down_bow: Arithmetic
    run_down_stern: Arithmetic


class Thrust(NamedTuple):
    """Thrust as it is delivered: across at the bow, along and across at the stern.

    Parameters
    ----------
    bow, stern_X, stern_Y : float or (...) array or tensor
        [N, N, N]
    """

    bow: Arithmetic
    stern_X: Arithmetic
    stern_Y: Arithmetic


class Record(NamedTuple):
    """What the record up to now says.

    Parameters
    ----------
    mean : (..., 26) array or tensor
        Expected `STATES`. [their units]
    covariance : (..., 26, 26) array or tensor
        Of them. [products of their units]
    thrust : Thrust
        Delivered now. [N]
    psi : float or (...) array or tensor
        Heading now. [rad]
    air_north, air_east : like psi
        Velocity of the air as measured now. [m/s]
    wind_north, wind_east : like psi
        Its mean. [m/s]
    """

    mean: Arithmetic
    covariance: Arithmetic
    thrust: Thrust
    psi: Arithmetic
    air_north: Arithmetic
    air_east: Arithmetic
    wind_north: Arithmetic
    wind_east: Arithmetic


def begin(known: Known, *, learned: Learned, hull: HullParameters) -> Record:
    """What is believed before any record.

    Parameters
    ----------
    known : Known
        What is known now; floats, (...) arrays or tensors.
    learned : Learned
        Arrays or tensors that broadcast with them.
    hull : HullParameters
        The hull.

    Returns
    -------
    Record
        The learned beliefs.

    References
    ----------
    Definition.
    """
    like, ship = 0.0 * (learned.current_walk + known.ship.u), known.ship
    library = library_of(like)
    start = [like + ship.u, like + ship.v, like + ship.r, *(like,) * 5]
    start += [like + learned.mean[..., k] for k in range(len(COEFFICIENTS))]
    std = learned.std + like[..., None]
    covariance = (std * std)[..., None] * library.eye(len(STATES), dtype=std.dtype)
    air = [like + one for one in air_velocity(known)]
    return Record(library.stack(start, -1), covariance, thrust_told(known.thrusters, hull), ship.psi, *air, *air)


def thrust_told(thrusters: Load, hull: HullParameters) -> Thrust:
    """The thrust at bow and stern that gives a load.

    Parameters
    ----------
    thrusters : tuple of three floats or (...) arrays or tensors
        Load of all thrusters. [N, N, N.m]
    hull : HullParameters
        Whose length says where bow and stern are.

    Returns
    -------
    Thrust
        [N]

    References
    ----------
    Statics; port and starboard units are taken together.
    """
    X, Y, N = thrusters
    turning = N / (ARM * hull.length)
    return Thrust(0.5 * (Y + turning), X, 0.5 * (Y - turning))


def delivered(thrust: Thrust, told: Thrust, h: float, *, learned: Learned) -> Thrust:
    """Thrust a step later: it follows what it is told; told nothing at all, power is lost and the propellers run down.

    Parameters
    ----------
    thrust : Thrust
        Delivered now; floats, (...) arrays or tensors.
    told : Thrust
        What is told.
    h : float
        Step. [s]
    learned : Learned
        Lag and times of running down.

    Returns
    -------
    Thrust
        Delivered then.

    Notes
    -----
    A free propeller is braked by its torque, which like its thrust goes with the square of its speed: 1/n grows evenly,
    and the thrust is that of now over (1 + h/T)², T in proportion to 1/n.

    References
    ----------
    Newton's law for a shaft with quadratic torque.
    """
    lost = (abs(told.bow) + abs(told.stern_X) + abs(told.stern_Y)) == 0.0
    share = 1.0 - exp(-h / learned.lag)
    stern = sqrt((hypot(thrust.stern_X, thrust.stern_Y) + _TINY) / HELD)
    bow = sqrt((abs(thrust.bow) + _TINY) / HELD)
    slowed_stern, slowed_bow = 1.0 + h * stern / learned.run_down_stern, 1.0 + h * bow / learned.run_down_bow
    factors = slowed_bow**-2, slowed_stern**-2, slowed_stern**-2
    values = zip(thrust, told, factors, strict=True)
    return Thrust(*[where(lost, now * factor, now + share * (then - now)) for now, then, factor in values])


def residual_load(
    coefficients: tuple,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    wind: Load,
    thrust: Thrust,
    hull: HullParameters,
) -> Load:
    """Load that the ship's own model lacks, linear in its coefficients.

    Parameters
    ----------
    coefficients : tuple of 18 floats or (...) arrays or tensors
        In the order of `COEFFICIENTS`: of resistance, cross flow and turning over sizes that hulls have (of the
        length, draught and density), of wind load and thrust over those that the model has, and of the wash of
        thrusters that run, as a damping. [1]
    u_r, v_r, r : float or (...) array or tensor
        Velocity through the water and yaw rate. [m/s, m/s, rad/s]
    wind : tuple of three, like u_r
        Wind load by the model. [N, N, N.m]
    thrust : Thrust
        Delivered, by the model. [N]
    hull : HullParameters
        Length, draught, density.

    Returns
    -------
    tuple of three, like u_r
        [N, N, N.m]

    References
    ----------
    Forms of the terms: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6;
    momentum drag of running thrusters in proportion to their speed, as `propulsion.azimuth`.
    """
    c, length = coefficients, hull.length
    size, arm = 0.5 * hull.water_density * length * hull.draught, ARM * length
    wash = HELD * sqrt((hypot(thrust.stern_X, thrust.stern_Y) + _TINY) / HELD)
    drag = -c[17] * wash * (v_r - arm * r)
    turn = length * r
    X = -0.034 * size * (c[0] * abs(u_r) + c[1] * SLOW) * u_r + c[9] * wind[0] + c[13] * thrust.stern_X
    Y = -size * (c[2] * abs(v_r) + c[3] * SLOW) * v_r + c[10] * wind[1] + drag
    N = (c[4] * abs(v_r) + c[5] * SLOW + c[6] * u_r) * v_r + (c[7] * abs(turn) + c[8] * SLOW) * turn
    N = -size * length * N + c[11] * wind[2] + 0.1 * length * c[12] * wind[1] - arm * drag
    stern, bow = c[14] * thrust.stern_Y, c[15] * thrust.bow
    return X - c[16] * wash * u_r, Y + stern + bow, N + arm * (bow - stern)


def step(
    record: Record, known: Known, h: float, *, learned: Learned, hull: HullParameters, wind: WindParameters
) -> Record:
    """The record a sample later.

    Parameters
    ----------
    record : Record
        Up to the last sample; arrays or tensors.
    known : Known
        What is known now; floats, (...) arrays or tensors.
    h : float
        Time since the last sample. [s]
    learned : Learned
        What was believed before the record.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    Record
        With this sample.

    Notes
    -----
    An extended Kalman filter. From sample to sample the ship's equations of motion are integrated by the midpoint rule
    with the measured wind and the thrust that is told; the observer's velocities correct the prediction. Slopes are
    differences. A wind that the controller does not believe is replaced by its mean.

    References
    ----------
    Jazwinski, Stochastic processes and filtering theory, Academic Press, 1970, ch. 8.
    """
    library, told = library_of(record.mean), thrust_told(known.thrusters, hull)
    believed, air = known.wind_believed > 0.5, air_velocity(known)
    air = [where(believed, now, mean) for now, mean in zip(air, (record.wind_north, record.wind_east), strict=True)]
    thrust = delivered(record.thrust, told, h, learned=learned)
    held = Thrust(*[0.5 * (a + b) for a, b in zip(record.thrust, thrust, strict=True)])
    over = 0.5 * (record.air_north + air[0]), 0.5 * (record.air_east + air[1])
    differences = library.asarray(DIFFERENCES, dtype=record.mean.dtype)
    moves = (library.eye(len(STATES), dtype=record.mean.dtype) * differences).reshape(
        len(STATES), *(1,) * (record.mean.ndim - 1), len(STATES)
    )
    at = library.concatenate([record.mean[None], record.mean[None] + moves])
    then = _elapsed(at, record.psi, over, held, h, learned, hull, wind)
    slopes = library.moveaxis((then[1:] - then[:1]) / differences.reshape((-1,) + (1,) * record.mean.ndim), 0, -1)
    covariance = slopes @ record.covariance @ library.swapaxes(slopes, -1, -2) + _grown(h, learned, library)
    mean, covariance = _corrected(then[0], covariance, known.ship, h, learned, library)
    share = 1.0 - exp(-h / learned.wind_time)
    means = [m + share * (a - m) for m, a in zip((record.wind_north, record.wind_east), air, strict=True)]
    return Record(mean, covariance, thrust, known.ship.psi, *air, *means)


def predict(
    record: Record,
    known: Known,
    *,
    horizons: tuple[float, ...],
    steps: tuple[int, ...],
    learned: Learned,
    hull: HullParameters,
    wind: WindParameters,
) -> tuple[Motion, ...]:
    """Motion ahead: the ship's equations of motion with what the record says of current, load and coefficients.

    Parameters
    ----------
    record : Record
        With the sample of now; arrays or tensors.
    known : Known
        What is known now.
    horizons : tuple of float, increasing
        How far ahead. [s]
    steps : tuple of int
        Steps of the integration up to each horizon from the one before. [1]
    learned : Learned
        Times of wind, load and thrust.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    tuple of Motion
        One per horizon.

    References
    ----------
    Midpoint rule; wind, current and what thrusters are told are held, remaining force and moment fade.
    """
    single = record.mean.ndim == 1  # in Python's floats it takes a tenth of the time
    states = record.mean.tolist() if single else [record.mean[..., k] for k in range(len(STATES))]
    x, y, psi, thrust = known.ship.x, known.ship.y, known.ship.psi, record.thrust
    told, air = thrust_told(known.thrusters, hull), (record.wind_north, record.wind_east)
    found, before = [], 0.0
    for horizon, count in zip(horizons, steps, strict=True):
        h = (horizon - before) / count
        for _ in range(count):
            then = delivered(thrust, told, h, learned=learned)
            mean = Thrust(*[_mean(a, b) for a, b in zip(thrust, then, strict=True)])
            states, middle = _moved(states, psi, air, mean, h, learned, hull, wind)
            north, east = to_ned(psi + 0.5 * h * middle[2], middle[0], middle[1])
            x, y, psi, thrust = x + h * north, y + h * east, psi + h * middle[2], then
        found.append(Motion(x, y, psi, *states[:3]))
        before = horizon
    return tuple(found)


def member(record: Record, learned: Learned, index: int) -> tuple[Record, Learned]:
    """One of an ensemble, with Python's floats wherever it has single numbers.

    Parameters
    ----------
    record : Record
        Of the members, along the first and only axis of its numbers.
    learned : Learned
        Likewise.
    index : int
        Which. [1]

    Returns
    -------
    tuple of Record and Learned
        Of this member.

    References
    ----------
    Definition.
    """

    def own(values):
        if np.ndim(values) == 2:
            return values[index]
        return float(values[index] if np.ndim(values) else values)

    thrust, rest = Thrust(*map(own, record.thrust)), map(own, record[3:])
    return Record(record.mean[index], record.covariance[index], thrust, *rest), Learned(*map(own, learned))


def _mean(a, b):
    """Mean of a thrust that falls as 1/(1 + t/T)², which is the geometric one; of others nearly the arithmetic one."""
    return where(a * b > 0.0, sqrt(abs(a * b) + _TINY * _TINY) * where(a > 0.0, 1.0, -1.0), 0.5 * (a + b))


def _moved(states, psi, air, thrust, h, learned, hull, wind):
    """All states a step later, and u, v and r in its middle; all that turns with the ship is taken at half the turn."""
    half, (u, v, r) = 0.5 * h, states[:3]
    psi = psi + half * r
    u_c, v_c = to_body(psi, states[3], states[4])
    load = wind_loads(*apparent_wind(psi, u, v, *air), wind=wind)
    force_X, force_Y = to_body(psi, states[5], states[6])
    X, Y = load[0] + thrust.stern_X + force_X, load[1] + thrust.stern_Y + thrust.bow + force_Y
    N = load[2] + ARM * hull.length * (thrust.bow - thrust.stern_Y) + states[7]
    coefficients = tuple(states[8:])

    def rates(u, v, r):
        more = residual_load(coefficients, u - u_c, v - v_c, r, load, thrust, hull)
        u_dot, v_dot, r_dot = accelerations(u - u_c, v - v_c, r, X + more[0], Y + more[1], N + more[2], hull=hull)
        return u_dot + r * v_c, v_dot - r * u_c, r_dot

    first = rates(u, v, r)
    middle = u + half * first[0], v + half * first[1], r + half * first[2]
    second = rates(*middle)
    moved = u + h * second[0], v + h * second[1], r + h * second[2]
    force, moment = exp(-h / learned.force_time), exp(-h / learned.moment_time)
    return [*moved, *states[3:5], states[5] * force, states[6] * force, states[7] * moment, *states[8:]], middle


def _elapsed(at, psi, air, thrust, h, learned, hull, wind):
    """`_moved` of states along the last axis."""
    states = [at[..., k] for k in range(len(STATES))]
    moved, _ = _moved(states, psi, air, thrust, h, learned, hull, wind)
    return library_of(at).stack(moved, -1)


def _grown(h, learned, library):
    """Covariance that a step adds."""
    force, moment = exp(-2.0 * h / learned.force_time), exp(-2.0 * h / learned.moment_time)
    zero, variances = 0.0 * learned.current_walk, learned.std * learned.std
    speed, rate = h * learned.disturbance[..., 0] ** 2, h * learned.disturbance[..., 1] ** 2
    current = h * learned.current_walk**2
    forces = [(1.0 - force) * variances[..., 5], (1.0 - force) * variances[..., 6], (1.0 - moment) * variances[..., 7]]
    diagonal = [speed, speed, rate, current, current, *forces, *(zero,) * len(COEFFICIENTS)]
    return library.stack(diagonal, -1)[..., None] * library.eye(len(STATES), dtype=variances.dtype)


def _corrected(mean, covariance, ship, h, learned, library):
    """Mean and covariance with the observer's velocities as measurement."""
    speed, rate = learned.noise[..., 0] ** 2 / h, learned.noise[..., 1] ** 2 / h
    noise = library.stack([speed, speed, rate], -1)[..., None] * library.eye(3, dtype=mean.dtype)
    rows = covariance[..., :3, :]
    gain = library.swapaxes(library.linalg.solve(rows[..., :3] + noise, rows), -1, -2)
    measured = (ship.u, ship.v, ship.r)
    missed = library.stack([value - mean[..., k] for k, value in enumerate(measured)], -1)
    covariance = covariance - gain @ rows
    mean = mean + (gain @ missed[..., None])[..., 0]
    return mean, 0.5 * (covariance + library.swapaxes(covariance, -1, -2))
