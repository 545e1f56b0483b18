"""Estimate wind, current and remaining force around a ship from her own measurements.

The bias load of the DP observer is one load at one state. Held while the ship drifts, it would push her for ever;
but what pushes her most is the water's motion, and she comes to move with the water. So the bias is taken apart, into a
current that loads the hull, and a force: only as she moves does she learn which is which. And into what thrusters give
beyond their commands: that is gone as soon as the commands are, while the observer's bias still holds it.
"""

from dataclasses import dataclass
from operator import mul
from typing import NamedTuple

from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, exp, maximum, sqrt
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.predictor_inputs import Known, air_velocity
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.vessel import through_water

_LEAST = 0.05  # m/s, least half of the span over which slopes are taken
_STATES = 8  # current, force: north and east each; moment; errors of thrust: X, Y, N
_ARM = 0.42  # of the length, bow and stern thrusters from midships: assumed


@dataclass(frozen=True, kw_only=True)
class SurroundingsParameters:
    """Prior assumptions on current, remaining force and wind."""

    current_std: float = quantity(
        0.4,
        "m/s",
        "standard deviation of the current north and east, before it is estimated",
        "assumed",
        minimum=1e-3,
    )
    current_drift: float = quantity(
        1e-5,
        "m2/s3",
        "intensity of the random walk of the current",
        "assumed: 0.2 m/s in an hour",
        minimum=0.0,
    )
    force_std: float = required(
        "N", "standard deviation of the remaining force north and east", minimum=1.0
    )
    force_time: float = quantity(
        100.0,
        "s",
        "correlation time of the remaining force",
        "assumed: slow wave drift",
        minimum=1.0,
    )
    load_noise: float = required(
        "N2.s",
        "intensity of the white noise of the load that the observer leaves to explain",
        minimum=1.0,
    )
    force_lever: float = quantity(
        0.1,
        "1",
        "lever of the remaining force and of the noise, over the length",
        "assumed",
        minimum=1e-3,
    )
    thrust_error: float = quantity(
        0.3,
        "1",
        "standard deviation of what thrusters give beside the allocated load, over its size",
        "assumed; 0.25 to 0.4 alike on worlds 300-311",
        minimum=0.0,
    )
    thrust_error_time: float = quantity(
        30.0,
        "s",
        "time for which the bias holds an error of thrust",
        "assumed: that of the observer; 25 to 40 s alike on worlds 300-311",
        minimum=1.0,
    )
    wind_time: float = quantity(
        30.0, "s", "time constant of the mean of the wind", "assumed: gusts pass", minimum=1e-3
    )


class Surroundings(NamedTuple):
    """Wind, current and remaining load as estimated.

    Parameters
    ----------
    wind_north, wind_east : float or (...) array or tensor
        Mean velocity of the air. [m/s]
    current_north, current_east : like wind_north
        Velocity of the water. [m/s]
    force_north, force_east, moment : like wind_north
        Load that neither explains: wave drift, errors of the models. [N, N, N.m]
    covariance : tuple of eight tuples of eight, like wind_north
        Of current north, current east, force north, force east, moment, thrust error. [products of their units]
    thrust_error : tuple of three, like wind_north
        What thrusters give beside the allocated load, in body axes, as the bias has it. [N, N, N.m]
    """

    wind_north: Arithmetic
    wind_east: Arithmetic
    current_north: Arithmetic
    current_east: Arithmetic
    force_north: Arithmetic
    force_east: Arithmetic
    moment: Arithmetic
    covariance: tuple
    thrust_error: Load = (0.0, 0.0, 0.0)


def unknown(
    known: Known, *, hull: HullParameters, parameters: SurroundingsParameters
) -> Surroundings:
    """Surroundings at the start: the wind as measured, the rest unknown.

    Parameters
    ----------
    known : Known
        Floats, (...) arrays or tensors.
    hull : HullParameters
        Whose length gives the lever of the remaining force.
    parameters : SurroundingsParameters
        Prior assumptions.

    Returns
    -------
    Surroundings
        With the current, the force, the moment and the thrust error 0.

    References
    ----------
    Definition.
    """
    zero = 0.0 * known.wind_speed
    variances = (
        *(parameters.current_std * parameters.current_std,) * 2,
        *_of_force(hull, parameters),
        0.0,
        0.0,
        0.0,
    )
    indices = range(_STATES)
    # Diagonal at the start: nothing is known of the relations.
    covariance = tuple(tuple(zero + variances[i] * (i == j) for j in indices) for i in indices)
    return Surroundings(
        *air_velocity(known), zero, zero, zero, zero, zero, covariance, (zero, zero, zero)
    )


def step(
    surroundings: Surroundings,
    known: Known,
    h: float,
    *,
    hull: HullParameters,
    wind: WindParameters,
    ship: DpShip,
    parameters: SurroundingsParameters,
) -> Surroundings:
    """Surroundings one sample later, from the known quantities at its end.

    Parameters
    ----------
    surroundings : Surroundings
        As estimated at the last sample; floats, (...) arrays or tensors.
    known : Known
        Inputs of the predictor now.
    h : float
        Time since the last sample. [s]
    hull : HullParameters
        The hull, which the current loads.
    wind : WindParameters
        Wind load coefficients.
    ship : DpShip
        Model in which the bias load was estimated, for its linear damping.
    parameters : SurroundingsParameters
        Prior assumptions.

    Returns
    -------
    Surroundings
        As estimated now.

    Notes
    -----
    A Kalman filter of eight states: current V_c (a random walk), force f north and east, moment n, and what thrusters
    give beside the allocated load, e in body axes (first-order Gauss-Markov; the standard deviation of e is in
    proportion to the allocated load). The observer of the DP controller has explained the motion by the bias b and its
    damping -D ν; here the same load is that of the hull in the water, and the others:

        b - D ν = τ_hull(ν - R(ψ)ᵀ V_c) + R(ψ)ᵀ f + (0, 0, n) + e + noise.

    The bias follows with the time of the observer, and e with the same time: when thrust is lost nothing new is added,
    and what the bias still holds of it fades. `dead_reckoning` leaves it out then.

    Hull loads are quadratic and have no slope at rest. So their slopes over the velocity through the water are taken
    between one standard deviation of the current below and above it, as in a central-difference filter. While the
    measured wind is not believed, its mean is held, and its load taken off the bias, which then has it. Left out: what
    the added mass does in turns beside its part in the hull's loads, some A22 r u_r.

    References
    ----------
    Nørgaard, Poulsen, Ravn, New developments in state estimation for nonlinear systems, Automatica 36, 2000.
    """
    # Wind first: its load is known and not to be explained by the current.
    air = _averaged(surroundings, known, h, parameters)
    wind_load = wind_loads(*apparent_wind(*known.ship[2:5], *air), wind=wind)
    left = _left_to_explain(known, wind_load, ship)
    # Predict the states, then correct by three scalar measurements: X, Y and N.
    mean, covariance = _elapsed(surroundings, known.thrusters, h, hull, parameters)
    # Hull loads are quadratic and flat at rest. Their slope is taken over one standard deviation of
    # the current.
    spread = maximum(sqrt(0.5 * (covariance[0][0] + covariance[1][1])), _LEAST)
    rows = _slopes(known, mean, spread, hull)
    missed = _missed(known, left, mean, hull)
    # White noise of intensity Q sampled with h has the variance Q / h; the moment's is larger by
    # lever².
    noise = parameters.load_noise / h
    lever = parameters.force_lever * hull.length
    predicted = mean
    # Sequential update: later innovations are reduced by what earlier ones explained already.
    for innovation, row, unit in zip(missed, rows, (1.0, 1.0, lever * lever), strict=True):
        explained = sum(
            slope * (now - before) for slope, now, before in zip(row, mean, predicted, strict=True)
        )
        mean, covariance = _corrected(mean, covariance, row, innovation - explained, unit * noise)
    return Surroundings(*air, *mean[:5], covariance=covariance, thrust_error=tuple(mean[5:]))


def _of_force(hull, parameters):
    """Variances of remaining force, north and east, and of the moment."""
    force = parameters.force_std * parameters.force_std
    lever = parameters.force_lever * hull.length
    return force, force, lever * lever * force


def _left_to_explain(known, wind_load, ship):
    """Load left to explain, body axes: bias minus damping, minus a disbelieved wind's load."""
    motion = known.ship
    bias = known.bias
    # The observer explains the motion by b - D ν. If it has no wind, the bias contains the wind's
    # load.
    lost = 1.0 - known.wind_believed
    damping = (
        ship.damping_surge * motion.u,
        ship.damping_sway * motion.v,
        ship.damping_yaw * motion.r,
    )
    return [
        load - damped - lost * air
        for load, damped, air in zip(bias, damping, wind_load, strict=True)
    ]


def _missed(known, left, mean, hull):
    """Load that current, force, moment and thrust errors do not explain."""
    motion = known.ship
    error = mean[5:]
    X, Y, N = hull_loads(*through_water(*motion[2:5], *mean[:2]), motion.r, hull=hull)
    force_X, force_Y = to_body(motion.psi, *mean[2:4])
    return (
        left[0] - X - force_X - error[0],
        left[1] - Y - force_Y - error[1],
        left[2] - N - mean[4] - error[2],
    )


def _slopes(known, mean, span, hull):
    """Slopes of X, Y and N over all states."""
    psi = known.ship.psi
    r = known.ship.r
    u_r, v_r = through_water(*known.ship[2:5], *mean[:2])
    # Central differences over the span, in u_r and in v_r.
    X_u, Y_u, N_u = _slope(
        hull_loads(u_r + span, v_r, r, hull=hull), hull_loads(u_r - span, v_r, r, hull=hull), span
    )
    X_v, Y_v, N_v = _slope(
        hull_loads(u_r, v_r + span, r, hull=hull), hull_loads(u_r, v_r - span, r, hull=hull), span
    )
    one = 1.0 + 0.0 * psi
    # Current: by the slopes of the hull; force: turned into body axes; moment and thrust errors:
    # directly.
    return (
        (*to_ned(psi, X_u, X_v), *to_ned(psi, one, 0.0), 0.0, 1.0, 0.0, 0.0),
        (*to_ned(psi, Y_u, Y_v), *to_ned(psi, 0.0, one), 0.0, 0.0, 1.0, 0.0),
        (*to_ned(psi, N_u, N_v), 0.0, 0.0, 1.0, 0.0, 0.0, 1.0),
    )


def _slope(above, below, span):
    """Slopes of loads by a current, which takes from the velocity through the water."""
    return [(b - a) / (2.0 * span) for a, b in zip(above, below, strict=True)]


def _elapsed(surroundings, thrusters, h, hull, parameters):
    """Mean and covariance of all states a sample later, before the measurement."""
    p = parameters
    (X, Y, N) = thrusters
    arm = _ARM * hull.length
    keep = exp(-h / p.force_time)
    held = exp(-h / p.thrust_error_time)
    turning = N / arm
    # Factors of a Gauss-Markov process; the current is a random walk and keeps its value.
    kept = (1.0, 1.0, keep, keep, keep, held, held, held)
    # Added variances: (1 - k²) σ² keeps the stationary σ². Thrust errors scale with the thrust
    # itself.
    force = [(1.0 - keep * keep) * variance for variance in _of_force(hull, p)]
    error = (
        (1.0 - held * held) * p.thrust_error * p.thrust_error * (X * X + Y * Y + turning * turning)
    )
    grown = (h * p.current_drift, h * p.current_drift, *force, error, error, arm * arm * error)
    before = (*surroundings[2:7], *surroundings.thrust_error)
    mean = [factor * value for factor, value in zip(kept, before, strict=True)]
    P = surroundings.covariance
    indices = range(_STATES)
    covariance = tuple(
        tuple(kept[i] * kept[j] * P[i][j] + grown[i] * (i == j) for j in indices) for i in indices
    )
    return mean, covariance


def _corrected(mean, covariance, row, innovation, noise):
    """Kalman update of mean and covariance by one scalar measurement."""
    # P cᵀ, then c P cᵀ + R: a scalar, so no matrix is inverted.
    spread = [sum(map(mul, line, row)) for line in covariance]
    variance = sum(map(mul, row, spread)) + noise
    gain = [p / variance for p in spread]
    mean = [value + k * innovation for value, k in zip(mean, gain, strict=True)]
    covariance = tuple(
        tuple(p - k * other for p, other in zip(line, spread, strict=True))
        for line, k in zip(covariance, gain, strict=True)
    )
    return mean, covariance


def _averaged(surroundings, known, h, parameters):
    """Mean velocity of the air a sample later; held while the wind is not believed."""
    keep = 1.0 - known.wind_believed * (1.0 - exp(-h / parameters.wind_time))
    before = surroundings.wind_north, surroundings.wind_east
    return tuple(
        now + keep * (mean - now) for now, mean in zip(air_velocity(known), before, strict=True)
    )
