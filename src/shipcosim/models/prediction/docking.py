"""Docking predictor: equations of motion with a load from the ship's record, plus an ensemble.

What the ensemble sees and gives is in the ship's own axes, so that a harbour turned by any angle is the same to it.
Where its inputs leave the range of the training, or its members disagree more than there, the prediction goes over to
the equations of motion alone, and beyond that is exactly that of paper III's kinetic model.

References
----------
Definition. Ensembles and their spread as a sign of what was not learned: Lakshminarayanan et al., Simple and
scalable predictive uncertainty estimation using deep ensembles, NeurIPS, 2017.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, cos, hypot, sin
from shipcosim.models.core.motion import Load, Motion, Triple, Vector
from shipcosim.models.core.networks import Memory, Network, evaluate_members, members_of
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import helm
from shipcosim.models.prediction.drift_off import blend, trust
from shipcosim.models.prediction.helm import LONGEST, Aboard, HelmParameters
from shipcosim.models.prediction.regions import RegionParameters, widening
from shipcosim.models.ship.hull import HullParameters

PLACE_GAIN = 0.2
VELOCITY_GAIN = 0.3
LOAD_GAIN = 0.03
"""Gains of the correction, a second later, for place and heading, velocity, and load. [1] Chosen on training
dockings."""
POWERS = (0, 1, 2, 3)
"""Powers of time whose sum over 30 s a correction is. [1]"""
CUT = 5.0
"""Standard deviations at which standardised features are cut. [1]"""
NEAR = 20.0
"""Distance from the quay below which inputs grow with the distance, above with its logarithm. [m]"""


class Own(NamedTuple):
    """State that the predictor keeps of the ship's own record.

    Parameters
    ----------
    ship : Motion
        The ship as estimated.
    load : tuple of three floats or (...) arrays
        In body axes, that thrusters, measured wind and hull in still water do not explain: current, waves, errors of
        the model. [N, N, N.m]
    """

    ship: Motion
    load: Load


class Trained(NamedTuple):
    """Trained weights and scaling.

    Parameters
    ----------
    networks : tuple of Network
        Members of the ensemble.
    mean, std : (n,) arrays
        By which `features` are standardised. [their units]
    scale : (3 k,) array
        Of the outputs: for each of `POWERS` forward and to starboard [m], then for each the heading [rad].
    limits : (n + 1,) array
        Largest standardised features in training, and spread of the members in 30 s. [1, m]
    """

    networks: tuple[Network, ...]
    mean: np.ndarray
    std: np.ndarray
    scale: np.ndarray
    limits: np.ndarray


def trained_of(arrays: Mapping[str, np.ndarray]) -> Trained:
    """Trained weights and scaling, from arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``member1.lstm.1.weights`` and so on, and the other fields of `Trained`. [their units]

    Returns
    -------
    Trained
        [as in arrays]
    """
    return Trained(members_of(arrays), *(arrays[name] for name in Trained._fields[1:]))


def begin(aboard: Aboard, age: float) -> Own:
    """Record at the start: the ship as measured, no load.

    Parameters
    ----------
    aboard : Aboard
        Inputs of the predictor now.
    age : float
        Of the measured place. [s]

    Returns
    -------
    Own
        [as its fields]
    """
    zero = 0.0 * aboard.wind_speed
    return Own(helm.moved_on(aboard.ship, age), (zero, zero, zero))


def follow(
    estimate: Own,
    before: Aboard,
    now: Aboard,
    *,
    hull: HullParameters,
    wind: WindParameters,
    helm_: HelmParameters,
) -> Own:
    """Record a second later: an observer of position, velocity and load with constant gains.

    Parameters
    ----------
    estimate : Own
        A second ago.
    before, now : Aboard
        Inputs of the predictor then and now.
    hull, wind, helm_ : HullParameters, WindParameters, HelmParameters
        The ship's model of herself.

    Returns
    -------
    Own
        [as its fields]
    """
    # Predict one second with the load known so far.
    (foreseen,) = helm.predict(
        before._replace(ship=estimate.ship),
        left=estimate.load,
        hull=hull,
        wind=wind,
        helm=helm_,
        seconds=1,
    )
    # Compare with the measurement, moved on by its age.
    measured = helm.moved_on(now.ship, helm_.position_age)
    missed = [seen - thought for seen, thought in zip(measured, foreseen, strict=True)]
    missed[2] = wrap(missed[2])
    # Correct position and velocity by fixed shares of the innovation.
    gains = (PLACE_GAIN,) * 3 + (VELOCITY_GAIN,) * 3
    ship = [
        thought + gain * miss for thought, gain, miss in zip(foreseen, gains, missed, strict=True)
    ]
    ship[2] = wrap(ship[2])
    # A velocity error means a missing load: acceleration times mass, by a small share.
    i11, i22, _, _, i66 = hull.inverse_mass
    load = tuple(
        load + LOAD_GAIN * miss / inverse
        for load, miss, inverse in zip(estimate.load, missed[3:], (i11, i22, i66), strict=True)
    )
    return Own(Motion(*ship), load)


def features(aboard: Aboard, estimate: Own, ahead: Motion, hull: HullParameters) -> np.ndarray:
    """Inputs of the ensemble, in the ship's axes.

    Parameters
    ----------
    aboard : Aboard
        Inputs of the predictor now; floats or (...) arrays.
    estimate : Own
        The record.
    ahead : Motion
        The ship in 30 s by the equations of motion with the load of the record.
    hull : HullParameters
        For the sizes of loads.

    Returns
    -------
    (..., 30) array
        Where the quay is now and in 30 s [1], velocities now and then [m/s, rad/s], turn [rad], load [m/s2, rad/s2],
        wind [m/s], commands and feedback of thrusters [N, rpm, rad].
    """
    ship = estimate.ship
    (i11, i22, _, _, i66) = hull.inverse_mass
    # Quay now and in 30 s, velocities now and then, and the turn between: the manoeuvre that is
    # under way.
    inputs = [
        *quay(ship),
        *quay(ahead),
        *ship[3:],
        *ahead[3:],
        wrap(np.asarray(ahead.psi - ship.psi)),
    ]
    # The load as an acceleration, so that it does not depend on the ship's size.
    inputs += [estimate.load[0] * i11, estimate.load[1] * i22, estimate.load[2] * i66]
    inputs += [aboard.wind_speed * cos(aboard.wind_from), aboard.wind_speed * sin(aboard.wind_from)]
    # Commands and feedback of both azimuths as vectors: an angle alone would jump at ±180 degrees.
    for k in (0, 1):
        for size, angle in (
            (aboard.thrust_cmd[k], aboard.azimuth_cmd[k]),
            (aboard.rpm[k], aboard.azimuth[k]),
        ):
            inputs += [size * cos(angle), size * sin(angle)]
        inputs += [aboard.azimuth[k]]
    inputs += [aboard.thrust_cmd[2], aboard.rpm[2]]
    return np.stack(np.broadcast_arrays(*inputs), axis=-1)


def quay(ship: Motion) -> Triple:
    """Direction and distance of the quay from the ship; large distances are compressed.

    Parameters
    ----------
    ship : Motion
        Her place relative to where she is to lie.

    Returns
    -------
    tuple of three floats or (...) arrays
        Logarithm of the distance over `NEAR`, in the direction of the quay and alone. [1]
    """
    forward, starboard = to_body(ship.psi, -ship.x, -ship.y)
    distance = hypot(forward, starboard)
    # Logarithmic beyond `NEAR`: differences matter close to the quay.
    size = np.log1p(distance / NEAR)
    share = size / (distance + 1e-9)
    return forward * share, starboard * share, size


def outputs(
    inputs: np.ndarray, memory: Sequence[tuple[Memory, ...]], trained: Trained
) -> tuple[np.ndarray, tuple]:
    """Outputs of all members for one sample.

    Parameters
    ----------
    inputs : (..., n) array
        Standardised features. [1]
    memory : sequence of tuples of Memory
        Of the sample before; empty before the first one. [1]
    trained : Trained
        The ensemble.

    Returns
    -------
    (members, ..., 3 k) array and tuple
        Outputs with their scale, memory after the sample. [m, m, rad; 1]
    """
    given, memory = evaluate_members(trained.networks, inputs, memory)
    return trained.scale * np.stack(given), memory


def standardised(inputs: np.ndarray, trained: Trained) -> np.ndarray:
    """Features standardised by mean and deviation of the training, cut at `CUT`.

    Parameters
    ----------
    inputs : (..., n) array
        As `features`. [their units]
    trained : Trained
        The ensemble.

    Returns
    -------
    (..., n) array
        [1]
    """
    return np.clip((inputs - trained.mean) / trained.std, -CUT, CUT)


def basis() -> np.ndarray:
    """Polynomials in time by which outputs correct the path.

    Returns
    -------
    (k, `LONGEST`) array
        Powers of the share of 30 s, one a second. [1]
    """
    share = np.arange(1, LONGEST + 1) / LONGEST
    return np.stack([share**power for power in POWERS])


def corrections(given: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corrections for each second from the outputs.

    Parameters
    ----------
    given : (..., 3 k) array
        Outputs with their scale, polynomials over the share of 30 s. [m, m, rad]

    Returns
    -------
    tuple of three (..., `LONGEST`) arrays
        Forward, to starboard, heading. [m, m, rad]
    """
    # Each correction is a polynomial in t / 30 s: smooth over time, with few outputs.
    k = len(POWERS)
    over = basis()
    return given[..., :k] @ over, given[..., k : 2 * k] @ over, given[..., 2 * k :] @ over


def spread(given: np.ndarray) -> np.ndarray:
    """Distance between the members' positions in 30 s.

    Parameters
    ----------
    given : (members, ..., 3 k) array
        Outputs. [m, m, rad]

    Returns
    -------
    (...) array
        Root of the sum of the variances forward and to starboard. [m]
    """
    forward, starboard, _ = corrections(given)
    return np.hypot(forward[..., -1].std(axis=0), starboard[..., -1].std(axis=0))


def share_of(inputs: np.ndarray, given: np.ndarray, trained: Trained) -> Arithmetic:
    """Share of the learned correction that is used.

    Parameters
    ----------
    inputs : (..., n) array
        As `features`. [their units]
    given : (members, ..., 3 k) array
        Outputs of the members. [m, m, rad]
    trained : Trained
        The ensemble.

    Returns
    -------
    (...) array
        1 within the limits of training, 0 far outside. [1]
    """
    # Inputs outside the training range, or members that disagree, reduce the share.
    sizes = abs((inputs - trained.mean) / trained.std)
    return trust(
        np.moveaxis(np.concatenate((sizes, np.asarray(spread(given))[..., None]), axis=-1), -1, 0),
        trained.limits,
    )


def corrected(ship: Motion, motions: Sequence[Motion], given: np.ndarray) -> list[tuple]:
    """Positions and headings with the ensemble's correction.

    Parameters
    ----------
    ship : Motion
        Now, for the axes of the correction.
    motions : sequence of `LONGEST` Motion
        By the equations of motion.
    given : (members, ..., 3 k) array
        Outputs of the members. [m, m, rad]

    Returns
    -------
    list of tuples of three
        North, east, heading, one a second. [m, m, rad]
    """
    # Mean of the members; the correction is in the ship's axes of now.
    forward, starboard, turn = corrections(given.mean(axis=0))
    places = []
    for k, motion in enumerate(motions):
        north, east = to_ned(ship.psi, forward[..., k], starboard[..., k])
        places.append(
            (motion.x + north, motion.y + east, wrap(np.asarray(motion.psi + turn[..., k])))
        )
    return places


def blended(kinetic: Sequence[Motion], learned: Sequence[tuple], share: Arithmetic) -> list[tuple]:
    """Blend of kinetic and learned predictions; with a share of 0 exactly the kinetic one.

    Parameters
    ----------
    kinetic : sequence of `LONGEST` Motion
        By the kinetic model.
    learned : sequence of tuples of three
        As `corrected`. [m, m, rad]
    share : float or (...) array
        Of the latter. [1]

    Returns
    -------
    list of tuples of three
        North, east, heading, one a second. [m, m, rad]
    """
    pairs = zip(kinetic, learned, strict=True)
    return [blend(motion[:3], place, share) for motion, place in pairs]


def regions(widths: np.ndarray, errors: Vector) -> tuple[list[Arithmetic], list[Arithmetic]]:
    """Regions about predictions, widened by the predictor's own record as in `regions.widening`.

    Parameters
    ----------
    widths : (8,) array
        Radii at 10, 20 and 30 s [m], half-widths of heading [rad], own errors of place [m] and heading [rad] at which
        they are 1.4 times as large.
    errors : tuple of two floats or (...) arrays
        Mean own errors of predictions 10 s ahead. [m, rad]

    Returns
    -------
    tuple of two lists of three, like errors
        Radii and half-widths. [m, rad]
    """
    # The widths were fitted offline; recent errors of the predictor scale them.
    without_time = RegionParameters(
        ordinary_position_error=float(widths[6]), ordinary_heading_error=float(widths[7])
    )
    position, heading = widening(errors, 0.0, regions=without_time)
    return [position * float(width) for width in widths[:3]], [
        heading * float(width) for width in widths[3:6]
    ]
