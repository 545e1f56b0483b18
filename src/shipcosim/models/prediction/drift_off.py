"""Drift predictor: filters that learn from the ship's own record, with a kinetic fallback.

Where the ship is unlike those over which was learned, or the filters disagree, the prediction goes over to that of the
kinetic predictor, `dead_reckoning` with `surroundings`, and beyond that is exactly it.

References
----------
Definition. The spread of an ensemble as a sign of what was not learned: Lakshminarayanan et al., Simple and scalable
predictive uncertainty estimation using deep ensembles, NeurIPS, 2017.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.maths import Arithmetic, clip, hypot, sqrt, where
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import dead_reckoning, own_record, surroundings
from shipcosim.models.prediction.own_model import COEFFICIENT, CURRENT, FORCE, MOMENT, Learned
from shipcosim.models.prediction.own_record import Record
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings, SurroundingsParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import through_water

STEPS = (5, 5, 8)
"""Steps of the filters' integration up to 10, 30 and 60 s, from the one before. [1]"""
OUT = 1.5
"""Share of the limits of what was learned at which nothing learned is left. [1]"""
MEASURES = (
    "speed ahead",
    "speed across",
    "yaw rate",
    "wind",
    "current",
    "force",
    "moment",
    "coefficients",
    "spread",
)
"""What is compared with its limit. [m/s, m/s, rad/s, m/s, m/s, standard deviations (3), m]"""


class Trained(NamedTuple):
    """Trained prior and limits.

    Parameters
    ----------
    learned : Learned
        Learned prior. [units of its fields]
    limits : (9,) array
        Of each of `MEASURES` the largest value in training. [their units]
    """

    learned: Learned
    limits: np.ndarray


class Hybrid(NamedTuple):
    """State of the predictor.

    Parameters
    ----------
    kinetic : Surroundings
        Of the kinetic predictor.
    own : Record
        Of the filters.
    """

    kinetic: Surroundings
    own: Record


def trained_of(arrays: Mapping[str, np.ndarray]) -> Trained:
    """Trained prior and limits, from arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        The fields of `Learned`, and ``limits``. [their units]

    Returns
    -------
    Trained
        [as in arrays]
    """
    values = (
        arrays[name] if arrays[name].ndim else float(arrays[name]) for name in Learned._fields
    )
    return Trained(Learned(*values), arrays["limits"])


def begin(
    known: Known, *, trained: Trained, hull: HullParameters, parameters: SurroundingsParameters
) -> Hybrid:
    """State at the start.

    Parameters
    ----------
    known : Known
        Inputs of the predictor now, in floats.
    trained : Trained
        The ensemble.
    hull : HullParameters
        The hull.
    parameters : SurroundingsParameters
        Of the kinetic predictor.

    Returns
    -------
    Hybrid
        The state.
    """
    kinetic = surroundings.unknown(known, hull=hull, parameters=parameters)
    return Hybrid(kinetic, own_record.begin(known, learned=trained.learned, hull=hull))


def step(
    state: Hybrid,
    known: Known,
    h: float,
    *,
    trained: Trained,
    hull: HullParameters,
    wind: WindParameters,
    ship: DpShip,
    parameters: SurroundingsParameters,
) -> Hybrid:
    """State one sample later.

    Parameters
    ----------
    state : Hybrid
        At the last sample.
    known : Known
        Inputs of the predictor now.
    h : float
        Time since the last sample. [s]
    trained : Trained
        The ensemble.
    hull, wind, ship, parameters : parameter sets
        As `surroundings.step` has them.

    Returns
    -------
    Hybrid
        With this sample.
    """
    # Both predictors follow every sample, so that the fallback is ready at any time.
    kinetic = surroundings.step(
        state.kinetic, known, h, hull=hull, wind=wind, ship=ship, parameters=parameters
    )
    return Hybrid(
        kinetic, own_record.step(state.own, known, h, learned=trained.learned, hull=hull, wind=wind)
    )


def predict(
    state: Hybrid,
    known: Known,
    *,
    horizons: tuple[float, ...],
    longest_step: float,
    trained: Trained,
    hull: HullParameters,
    wind: WindParameters,
) -> tuple[tuple[Motion, ...], Arithmetic]:
    """Predict the motion, and give the share of the learned part.

    Parameters
    ----------
    state : Hybrid
        With the sample of now.
    known : Known
        Inputs of the predictor now.
    horizons : tuple of three floats
        How far ahead. [s]
    longest_step : float
        Of the kinetic predictor. [s]
    trained : Trained
        The ensemble.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    tuple of Motion, float
        One per horizon; the share, 0 where the prediction is that of the kinetic predictor. [their units; 1]
    """
    # Each filter's prediction, and how far they can be trusted; without a believed wind not at all.
    own = state.own
    motions = own_record.predict(
        own, known, horizons=horizons, steps=STEPS, learned=trained.learned, hull=hull, wind=wind
    )
    numbers = measures(own, known, motions[-1], trained.learned)
    share = trust(numbers, trained.limits) * known.wind_believed
    learned = tuple(own_record.mixed(own, motion) for motion in motions)
    # The kinetic prediction is the fallback, for what is not trusted.
    if share == 1.0:
        return learned, share
    alone = dead_reckoning.predict(
        known, state.kinetic, horizons=horizons, longest_step=longest_step, hull=hull, wind=wind
    )
    return tuple(Motion(*blend(a, b, share)) for a, b in zip(alone, learned, strict=True)), share


def measures(record: Record, known: Known, last: Motion, learned: Learned) -> np.ndarray:
    """How far the ship is from usual conditions: `MEASURES`.

    Parameters
    ----------
    record : Record
        Of the filters.
    known : Known
        Inputs of the predictor now.
    last : Motion
        Their predictions at the last horizon.
    learned : Learned
        What was believed.

    Returns
    -------
    (9, ...) array
        [units of `MEASURES`]
    """
    # Weighted mean state of the filters: current, force, moment, coefficients.
    share = own_record.weights(record)
    (x, y) = last[:2]
    states = (share[..., None] * record.mean).sum(axis=0)
    psi, u, v, r = known.ship[2:]
    u_r, v_r = through_water(psi, u, v, states[..., CURRENT.start], states[..., CURRENT.start + 1])
    # Deviation from the prior in standard deviations: the record contradicts what was learned.
    off = (states[..., COEFFICIENT] - learned.mean) / learned.std[..., COEFFICIENT]
    force = states[..., FORCE] / learned.std[..., FORCE]
    # Weighted spread of the filters' positions at the last horizon.
    apart = share * ((x - (share * x).sum(axis=0)) ** 2 + (y - (share * y).sum(axis=0)) ** 2)
    numbers = [
        u_r,
        v_r,
        r,
        hypot(*record.wind),
        np.linalg.norm(states[..., CURRENT], axis=-1),
        np.linalg.norm(force, axis=-1),
        states[..., MOMENT] / learned.std[..., MOMENT],
        sqrt((off * off).mean(axis=-1)),
        sqrt(apart.sum(axis=0)),
    ]
    return np.abs(np.stack(numbers))


def trust(numbers: np.ndarray, limits: np.ndarray) -> Arithmetic:
    """Share of the learned part that is used: 1 within all limits, 0 from `OUT` of any limit.

    Parameters
    ----------
    numbers : (9, ...) array
        `MEASURES`. [their units]
    limits : (9,) array
        Largest in training. [their units]

    Returns
    -------
    (...) array
        0 also where a measure is no number. [1]
    """
    # The worst measure decides. NaN fails the comparison and gives 0.
    worst = (numbers.T / limits).T.max(axis=0)
    return where(worst < OUT, clip((OUT - worst) / (OUT - 1.0), 0.0, 1.0), 0.0 * limits[0])


def blend(alone: Sequence, learned: Sequence, share: Arithmetic) -> tuple:
    """Blend of two predictions; with a share of 0 exactly the first.

    Parameters
    ----------
    alone, learned : sequence of floats or (...) arrays
        North, east, heading and what follows, without and with what is learned. [m, m, rad, ...]
    share : float or (...) array
        Of the second. [1]

    Returns
    -------
    tuple, like alone
        The blend. [as alone]
    """
    away = [b - a for a, b in zip(alone, learned, strict=True)]
    # Headings blend along the shorter arc.
    away[2] = wrap(np.asarray(away[2]))
    moved = [where(share > 0.0, a + share * d, a) for a, d in zip(alone, away, strict=True)]
    moved[2] = where(share > 0.0, wrap(np.asarray(moved[2])), alone[2])
    return tuple(moved)
