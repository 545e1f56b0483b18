"""Our drift predictor: an ensemble that learns from the ship's own record, and the equations of motion to fall back on.

Where the ship is unlike those on which the ensemble was trained, or its members disagree, the prediction goes over to
that of the kinetic predictor, `dead_reckoning` with `surroundings`, and beyond that is exactly it.

References
----------
Definition. Ensembles and their spread as a sign of what was not learned: Lakshminarayanan et al., Simple and
scalable predictive uncertainty estimation using deep ensembles, NeurIPS, 2017.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.maths import Arithmetic, clip, cos, hypot, sin, sqrt, where
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import dead_reckoning, own_record, surroundings
from shipcosim.models.prediction.known import Known
from shipcosim.models.prediction.own_record import Learned, Record
from shipcosim.models.prediction.surroundings import Surroundings, SurroundingsParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import through_water

STEPS = (5, 5, 8)
"""Steps of the ensemble's integration up to 10, 30 and 60 s, from the one before. [1]"""
OUT = 1.5
"""Share of the limits of what was learned at which nothing learned is left. [1]"""
MEASURES = ("speed ahead", "speed across", "yaw rate", "wind", "current", "force", "moment", "coefficients", "spread")
"""What is compared with its limit. [m/s, m/s, rad/s, m/s, m/s, standard deviations (3), m]"""


class Trained(NamedTuple):
    """What training gives.

    Parameters
    ----------
    learned : Learned
        Of the members of the ensemble, along the first axis of its arrays. [units of its fields]
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
        Of the members, along the first axis of its arrays.
    """

    kinetic: Surroundings
    own: Record


def trained_of(arrays: Mapping[str, np.ndarray]) -> Trained:
    """What training gives, from its arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        The fields of `Learned`, and ``limits``. [their units]

    Returns
    -------
    Trained
        [as in arrays]
    """
    return Trained(Learned(*(arrays[name] for name in Learned._fields)), arrays["limits"])


def begin(known: Known, *, trained: Trained, hull: HullParameters, parameters: SurroundingsParameters) -> Hybrid:
    """State at the start.

    Parameters
    ----------
    known : Known
        What is known now, in floats or arrays that broadcast with the members.
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
    """State a sample later.

    Parameters
    ----------
    state : Hybrid
        At the last sample.
    known : Known
        What is known now.
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
    kinetic = surroundings.step(state.kinetic, known, h, hull=hull, wind=wind, ship=ship, parameters=parameters)
    return Hybrid(kinetic, own_record.step(state.own, known, h, learned=trained.learned, hull=hull, wind=wind))


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
    """Motion ahead, and the share of what is learned in it.

    Parameters
    ----------
    state : Hybrid
        With the sample of now.
    known : Known
        What is known now.
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
    tuple of Motion, float or (...) array
        One per horizon; the share, 0 where the prediction is that of the kinetic predictor. [their units; 1]
    """
    alone = dead_reckoning.predict(
        known, state.kinetic, horizons=horizons, longest_step=longest_step, hull=hull, wind=wind
    )
    members = _ahead(
        state.own, known, trained.learned, {"horizons": horizons, "steps": STEPS, "hull": hull, "wind": wind}
    )
    share = trust(measures(state.own, known, members[-1], trained.learned), trained.limits) * known.wind_believed
    return tuple(blended(a, mean(b), share) for a, b in zip(alone, members, strict=True)), share


def _ahead(own, known, learned, options):
    """Predictions of all members; one after another in floats where there is one ship, which is quicker."""
    if own.mean.ndim > 2:
        return own_record.predict(own, known, learned=learned, **options)
    found = []
    try:
        for index in range(len(own.mean)):
            record, believed = own_record.member(own, learned, index)
            found.append(own_record.predict(record, known, learned=believed, **options))
    except (ValueError, IndexError, OverflowError):  # what is no number stops floats; in arrays it goes on as NaN
        return own_record.predict(own, known, learned=learned, **options)
    return [Motion(*np.array(motions).T) for motions in zip(*found, strict=True)]


def mean(members: Motion) -> Motion:
    """Mean of the members of an ensemble, along their first axis; of headings that of their directions.

    Parameters
    ----------
    members : Motion
        (m, ...) arrays.

    Returns
    -------
    Motion
        (...) arrays.
    """
    x, y, psi, u, v, r = (np.asarray(one) for one in members)
    heading = np.arctan2(sin(psi).mean(axis=0), cos(psi).mean(axis=0))
    return Motion(x.mean(axis=0), y.mean(axis=0), heading, u.mean(axis=0), v.mean(axis=0), r.mean(axis=0))


def measures(own: Record, known: Known, last: Motion, learned: Learned) -> np.ndarray:
    """How far the ship is from where she is usually: `MEASURES`.

    Parameters
    ----------
    own : Record
        Of the members.
    known : Known
        What is known now.
    last : Motion
        Their predictions at the last horizon.
    learned : Learned
        What was believed.

    Returns
    -------
    (9, ...) array
        [units of `MEASURES`]
    """
    states = own.mean.mean(axis=0)
    u_r, v_r = through_water(known.ship.psi, known.ship.u, known.ship.v, states[..., 3], states[..., 4])
    std = learned.std.mean(axis=0)
    off = ((own.mean[..., 8:] - learned.mean) / learned.std[..., 8:]).mean(axis=0)
    found = [u_r, v_r, known.ship.r, hypot(own.wind_north, own.wind_east).mean(axis=0)]
    found += [hypot(states[..., 3], states[..., 4]), hypot(states[..., 5] / std[..., 5], states[..., 6] / std[..., 6])]
    found += [states[..., 7] / std[..., 7], sqrt((off * off).mean(axis=-1))]
    found += [hypot(np.asarray(last.x).std(axis=0), np.asarray(last.y).std(axis=0))]
    return np.abs(np.stack(np.broadcast_arrays(*found)))


def trust(found: np.ndarray, limits: np.ndarray) -> Arithmetic:
    """Share of what is learned that is used: 1 within all limits, 0 from `OUT` of one of them on.

    Parameters
    ----------
    found : (9, ...) array
        `MEASURES`. [their units]
    limits : (9,) array
        Largest in training. [their units]

    Returns
    -------
    (...) array
        0 also where a measure is no number. [1]
    """
    worst = (found.T / limits).T.max(axis=0)
    return where(worst < OUT, clip((OUT - worst) / (OUT - 1.0), 0.0, 1.0), 0.0 * limits[0])


def blended(alone: Motion, learned: Motion, share: Arithmetic) -> Motion:
    """One prediction between two; with a share of 0 exactly the first.

    Parameters
    ----------
    alone, learned : Motion
        Without and with what is learned; floats or (...) arrays.
    share : float or (...) array
        Of the second. [1]

    Returns
    -------
    Motion
        The blend.
    """
    away = [b - a for a, b in zip(alone, learned, strict=True)]
    away[2] = wrap(np.asarray(away[2]))
    moved = [where(share > 0.0, a + share * d, a) for a, d in zip(alone, away, strict=True)]
    moved[2] = where(share > 0.0, wrap(np.asarray(moved[2])), alone.psi)
    return Motion(*moved)
