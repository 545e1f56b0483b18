"""Estimate current, remaining load and model errors of a ship from her own record.

Kalman filters whose states are the ship's motion, the current, a remaining load, and coefficients of a residual load
(`own_model`). Whether a load is of the current or a force is settled only in the drift, so one filter begins without
current and four with one from each side: a Gaussian sum, in which each has the weight of its likelihood. What they
believe before the record, of each coefficient its mean and standard deviation, and how fast everything changes, is
learned over many ships (`learn.prediction.drift`); from there each ship's own record corrects it, second by second.
"""

from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.maths import (
    Arithmetic,
    atan2,
    cos,
    exp,
    library_of,
    maximum,
    sin,
    sqrt,
    where,
    where_all,
)
from shipcosim.models.core.motion import Motion, Vector
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction.own_model import (
    COEFFICIENT,
    COEFFICIENTS,
    FASTEST,
    FORCE,
    MEASURED,
    STATES,
    Learned,
    Thrust,
    delivered,
    moved,
    thrust_told,
)
from shipcosim.models.prediction.predictor_inputs import Known, air_velocity
from shipcosim.models.ship.hull import HullParameters

DIRECTIONS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Current with which each filter begins, north and east, over `Learned.current_away`. [1]"""
DIFFERENCES = (
    1e-2,
    1e-2,
    1e-4,
    1e-3,
    1e-3,
    1e-4,
    1e-2,
    1e-2,
    1e2,
    1e2,
    1e3,
    *(0.05,) * len(COEFFICIENTS),
)
"""Differences over which slopes are taken. [units of `STATES`]"""
NOISE_OF_MEASURED = [0, 0, 1, 2, 2, 3]
"""Number in `Learned.noise` of each of `MEASURED`. [1]"""
STRONGEST = 5.0  # m/s, current from which on a filter has gone astray, as from `FASTEST` on
NO_NUMBER = 1e12  # beyond any sum of states and likelihood
LEAST = -30.0  # logarithm of a weight, below which none falls: so it can come back
_TINY = 1e-12


class Record(NamedTuple):
    """The estimate from the record up to now.

    Parameters
    ----------
    mean : (5, ..., 29) array or tensor
        Expected `STATES` by each filter. [their units]
    covariance : (5, ..., 29, 29) array or tensor
        Of them. [products of their units]
    likelihood : (5, ...) array or tensor
        Logarithms of the filters' weights. [1]
    thrust : Thrust
        Delivered now; (...) arrays or tensors. [N]
    air : tuple of two floats or (...) arrays or tensors
        Velocity of the air as measured now, north and east. [m/s]
    wind : like air
        Its mean. [m/s]
    """

    mean: Arithmetic
    covariance: Arithmetic
    likelihood: Arithmetic
    thrust: Thrust
    air: Vector
    wind: Vector


def begin(known: Known, *, learned: Learned, hull: HullParameters) -> Record:
    """Estimate before any record: the learned prior.

    Parameters
    ----------
    known : Known
        Inputs of the predictor now; floats, (...) arrays or tensors.
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
    like = 0.0 * (learned.mean[..., 0] + known.ship.u)
    library = library_of(like)
    # One filter without current, four with a current from each side; the same uncertainty for all.
    mean = library.stack(_believed(known, learned, like))
    std = learned.std + like[..., None]
    covariance = (std * std)[..., None] * library.eye(len(STATES), dtype=std.dtype)
    north, east = air_velocity(known)
    air = like + north, like + east
    covariance = library.stack([covariance] * len(DIRECTIONS))
    return Record(
        mean, covariance, 0.0 * mean[..., 0], thrust_told(known.thrusters, hull), air, air
    )


def weights(record: Record) -> Arithmetic:
    """Weights of the filters.

    Parameters
    ----------
    record : Record
        Arrays or tensors.

    Returns
    -------
    (5, ...) array or tensor
        Their sum is 1. [1]

    References
    ----------
    Definition.
    """
    shares = exp(record.likelihood)
    return shares / shares.sum(0)


def mixed(record: Record, motions: Motion) -> Motion:
    """Weighted mean of the filters' motions.

    Parameters
    ----------
    record : Record
        For the weights.
    motions : Motion
        (5, ...) arrays or tensors.

    Returns
    -------
    Motion
        (...) arrays or tensors; of headings the mean of their directions.

    References
    ----------
    Definition.
    """
    # Headings are averaged as unit vectors, since they wrap.
    share = weights(record)
    x, y, _, u, v, r = ((share * motion).sum(0) for motion in motions)
    psi = atan2((share * sin(motions.psi)).sum(0), (share * cos(motions.psi)).sum(0))
    return Motion(x, y, psi, u, v, r)


def step(
    record: Record,
    known: Known,
    h: float,
    *,
    learned: Learned,
    hull: HullParameters,
    wind: WindParameters,
) -> Record:
    """The record one sample later.

    Parameters
    ----------
    record : Record
        Up to the last sample; arrays or tensors.
    known : Known
        Inputs of the predictor now; floats, (...) arrays or tensors.
    h : float
        Time since the last sample. [s]
    learned : Learned
        Learned prior.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    Record
        With this sample.

    Notes
    -----
    Extended Kalman filters. From sample to sample the ship's equations of motion are integrated by the midpoint rule
    with the measured wind and the commanded thrust; the observer's place, heading and velocities correct the
    prediction. Slopes are differences. A wind that the controller does not believe is replaced by its mean. A filter
    that goes astray begins anew, with the least weight.

    References
    ----------
    Jazwinski, Stochastic processes and filtering theory, Academic Press, 1970, ch. 8; Gaussian sum: Alspach and
    Sorenson, Nonlinear Bayesian estimation using Gaussian sum approximations, IEEE Trans. Automatic Control 17, 1972.
    """
    library = library_of(record.mean)
    command = thrust_told(known.thrusters, hull)
    # A disbelieved wind is replaced by its mean.
    believed = known.wind_believed > 0.5
    air = where_all(believed, air_velocity(known), record.wind)
    # Thrust and wind at the middle of the step, as the midpoint rule needs them.
    thrust = delivered(record.thrust, command, h, learned=learned)
    held = Thrust(*[0.5 * (a + b) for a, b in zip(record.thrust, thrust, strict=True)])
    over = tuple(0.5 * (a + b) for a, b in zip(record.air, air, strict=True))
    # Extended Kalman filter: predict mean and covariance, P ← F P Fᵀ + Q, then correct by the
    # observer.
    then, slopes = _elapsed(
        record.mean, over, held, h, {"learned": learned, "hull": hull, "wind": wind}, library
    )
    covariance = slopes @ record.covariance @ library.swapaxes(slopes, -1, -2) + _grown(
        h, learned, library
    )
    mean, covariance, likelihood = _corrected(then, covariance, known.ship, h, learned, library)
    # Weights: sum of log-likelihoods with forgetting. Only a share counts, because errors of the
    # observer last.
    likelihood = (
        record.likelihood * exp(-h / learned.evidence_time) + learned.evidence * h * likelihood
    )
    # A filter that left the physical range restarts from the prior, with the least weight.
    astray, likelihood = _astray(then, mean, likelihood, library)
    if astray.any():
        fresh = begin(known, learned=learned, hull=hull)
        mean = where(astray[..., None], fresh.mean, mean)
        covariance = where(astray[..., None, None], fresh.covariance, covariance)
    # The mean wind follows with a lag of first order: gusts do not last over the horizon.
    share = 1.0 - exp(-h / learned.wind_time)
    slow = tuple(m + share * (a - m) for m, a in zip(record.wind, air, strict=True))
    return Record(mean, covariance, likelihood, thrust, air, slow)


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
        Inputs of the predictor now.
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
        One per horizon, of all filters along the first axis.

    References
    ----------
    Midpoint rule; wind, current and thrust commands are held, remaining force and moment fade.
    """
    # The course of the thrust is the same for all filters.
    command = thrust_told(known.thrusters, hull)
    course = _thrust_ahead(record.thrust, command, horizons, steps, learned)
    model = {"learned": learned, "hull": hull, "wind": wind}
    if isinstance(record.mean, np.ndarray) and record.mean.ndim == 2:
        # One ship: filter by filter in floats takes a fifth of the time of arrays of five numbers.
        try:
            motions = [
                _motions_ahead(states, tuple(map(float, record.wind)), course, model)
                for states in record.mean.tolist()
            ]
            return tuple(Motion(*np.array(at).T) for at in zip(*motions, strict=True))
        except (ValueError, OverflowError):
            # What is no number stops floats; in arrays it goes on as NaN.
            pass
    states = [record.mean[..., k] for k in range(len(STATES))]
    return tuple(_motions_ahead(states, record.wind, course, model))


def _thrust_ahead(thrust, command, horizons, steps, learned):
    """For each horizon the step, and the thrust held over each step up to it."""
    course = []
    before = 0.0
    for horizon, count in zip(horizons, steps, strict=True):
        # Equal steps up to each horizon.
        h = (horizon - before) / count
        held = []
        for _ in range(count):
            then = delivered(thrust, command, h, learned=learned)
            held.append(Thrust(*[_mean(a, b) for a, b in zip(thrust, then, strict=True)]))
            thrust = then
        course.append((h, held))
        before = horizon
    return course


def _motions_ahead(states, air, course, model):
    """Motion at each horizon, from states as a list."""
    coefficients = states[COEFFICIENT]
    states = states[: COEFFICIENT.start]
    motions = []
    for h, held in course:
        for thrust in held:
            states = moved(states, coefficients, air, thrust, h, **model)
        motions.append(Motion(*states[: len(MEASURED)]))
    return motions


def _believed(known, learned, like):
    """Prior means of the states, for each filter."""
    library = library_of(like)
    means = []
    for north, east in DIRECTIONS:
        current = learned.current_away * north, learned.current_away * east
        coefficients = (learned.mean[..., k] for k in range(len(COEFFICIENTS)))
        states = (*known.ship, *current, 0.0, 0.0, 0.0, *coefficients)
        means.append(library.stack([like + state for state in states], -1))
    return means


def _mean(a, b):
    """Mean over a step: geometric for a thrust that falls as 1/(1 + t/T)², else arithmetic."""
    return where(a * b > 0.0, sqrt(abs(a * b) + _TINY) * where(a > 0.0, 1.0, -1.0), 0.5 * (a + b))


def _elapsed(mean, air, thrust, h, model, library):
    """Expected states a step later, and their slopes by the present states."""
    # Slopes by differences: all states are displaced at once, along a second axis after the one of
    # the states, in one evaluation. Its first place has none displaced.
    differences = library.asarray(DIFFERENCES, dtype=mean.dtype)
    moves = library.eye(len(STATES), dtype=mean.dtype) * differences
    moves = library.concatenate([0.0 * moves[:, :1], moves], 1)
    moves = moves.reshape(*moves.shape, *(1,) * (mean.ndim - 1))
    at = library.moveaxis(mean, -1, 0)[:, None] + moves
    coefficients = at[COEFFICIENT]
    then = moved(at[: COEFFICIENT.start], coefficients, air, thrust, h, **model)
    then = library.stack([*then, *coefficients], -1)
    # Column j of F is (f(x + d_j) - f(x)) / d_j.
    return then[0], library.moveaxis(
        (then[1:] - then[:1]) / differences.reshape((-1,) + (1,) * mean.ndim), 0, -1
    )


def _grown(h, learned, library):
    """Covariance that a step adds."""
    # Gauss-Markov: variance σ² (1 - e^(-2h/T)) keeps the stationary variance σ².
    force = exp(-2.0 * h / learned.force_time)
    moment = exp(-2.0 * h / learned.moment_time)
    zero = 0.0 * learned.current_walk
    variances = learned.std * learned.std
    forces = [
        (1.0 - kept) * variances[..., k]
        for k, kept in enumerate((force, force, moment), FORCE.start)
    ]
    # Random walks of velocity, yaw rate and current grow with time. Positions and coefficients get
    # no noise.
    walks = [learned.disturbance[..., k] for k in (0, 0, 1)]
    walks += [learned.current_walk, learned.current_walk]
    grown = [h * walk**2 for walk in walks]
    still = len(COEFFICIENTS) * [zero]
    diagonal = library.stack([zero, zero, zero, *grown, *forces, *still], -1)
    return diagonal[..., None] * library.eye(len(STATES), dtype=variances.dtype)


def _corrected(mean, covariance, ship, h, learned, library):
    """Mean and covariance corrected by the observer's estimate, and its log-likelihood."""
    count = len(MEASURED)
    # The observer's estimates count as measurements; noise averaged over a second scales with 1/h.
    noise = learned.noise[..., NOISE_OF_MEASURED] ** 2 / h
    noise = noise[..., None] * library.eye(count, dtype=mean.dtype)
    # The measured states come first, so C P is the first rows of P.
    rows = covariance[..., :count, :]
    missed = [value - mean[..., k] for k, value in enumerate(ship)]
    missed[2] = wrap(missed[2])
    missed = library.stack(missed, -1)[..., None]
    # Innovation covariance S = C P Cᵀ + R. One solve gives gain and distance.
    expected = rows[..., :count] + noise
    solved = library.linalg.solve(expected, library.concatenate([rows, missed], -1))
    gain = library.swapaxes(solved[..., :-1], -1, -2)
    # log N(innovation; 0, S) up to a constant: -½ (eᵀ S⁻¹ e + ln det S).
    distance = (missed[..., 0] * solved[..., -1]).sum(-1)
    likelihood = -0.5 * (distance + library.linalg.slogdet(expected)[1])
    # Update P - K C P; the symmetric part removes rounding.
    covariance = covariance - gain @ rows
    mean = mean + (gain @ missed)[..., 0]
    return mean, 0.5 * (covariance + library.swapaxes(covariance, -1, -2)), likelihood


def _astray(then, mean, likelihood, library):
    """True for filters out of bounds, and likelihoods relative to the largest, at least `LEAST`."""
    # NaN fails the comparison, so it counts as astray too.
    astray = ~(abs(mean.sum(-1) + likelihood) < NO_NUMBER)
    bounds = library.asarray((*FASTEST, STRONGEST, STRONGEST), dtype=mean.dtype)
    astray = astray | (abs(then[..., 3:8]) >= bounds).any(-1)
    zero = library.zeros_like(likelihood)
    likelihood = where(astray, zero - NO_NUMBER, likelihood)
    # A floor for the weights: a filter that was wrong so far can come back.
    return astray, maximum(likelihood - library.amax(likelihood, 0), zero + LEAST)
