"""The docking predictor of paper III: LSTMs add the kinetic model's error over 30 s directly.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper III: "A Hybrid
Approach to Motion Prediction for Ship Docking", Sec. III-C and Table III.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import atan2, hypot, pi
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.networks import Memory, Network, evaluate_members, members_of
from shipcosim.models.prediction.helm import LONGEST, Aboard

INPUTS = (
    "north",
    "east",
    "heading",
    "surge speed",
    "sway speed",
    "heading rate",
    "wind direction",
    "wind speed",
    "course",
    "total speed",
    "port rpm",
    "port angle",
    "starboard rpm",
    "starboard angle",
    "tunnel rpm",
)
"""Table III without roll, pitch and heave and their rates, which a ship of three degrees of freedom has not."""


class Ensemble(NamedTuple):
    """Trained weights and scaling.

    Parameters
    ----------
    networks : tuple of Network
        The members.
    mean, std : (15,) arrays
        By which `INPUTS` are standardised. [their units]
    target_mean, target_std : (2 `LONGEST`,) arrays
        Of the errors of the kinetic model, north in 1 to 30 s, then east. [m]
    """

    networks: tuple[Network, ...]
    mean: np.ndarray
    std: np.ndarray
    target_mean: np.ndarray
    target_std: np.ndarray


def ensemble_of(arrays: Mapping[str, np.ndarray]) -> Ensemble:
    """Trained weights and scaling, from arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``member1.lstm.1.weights`` and so on, and the other fields of `Ensemble`. [their units]

    Returns
    -------
    Ensemble
        [as in arrays]
    """
    return Ensemble(members_of(arrays), *(arrays[name] for name in Ensemble._fields[1:]))


def inputs(aboard: Aboard) -> np.ndarray:
    """Inputs of the networks, as `INPUTS`; angles in [0, 2π), position relative to the berth.

    Parameters
    ----------
    aboard : Aboard
        What is measured now; floats or (...) arrays.

    Returns
    -------
    (..., 15) array
        [m, rad, m/s, rad/s, rpm]
    """
    ship = aboard.ship
    turn = 2.0 * pi
    # Course and speed over ground, as paper III has them.
    north, east = to_ned(ship.psi, ship.u, ship.v)
    signals = [
        ship.x,
        ship.y,
        ship.psi % turn,
        ship.u,
        ship.v,
        ship.r,
        aboard.wind_from % turn,
        aboard.wind_speed,
    ]
    signals += [atan2(east, north) % turn, hypot(north, east)]
    signals += [aboard.rpm[0], aboard.azimuth[0], aboard.rpm[1], aboard.azimuth[1], aboard.rpm[2]]
    return np.stack(np.broadcast_arrays(*signals), axis=-1)


def errors(
    signals: np.ndarray, memory: Sequence[tuple[Memory, ...]], ensemble: Ensemble
) -> tuple[np.ndarray, tuple[tuple[Memory, ...], ...]]:
    """Errors of the kinetic model as the ensemble expects them: the mean of its members.

    Parameters
    ----------
    signals : (..., 15) array
        As `inputs`. [their units]
    memory : sequence of tuples of Memory
        Of the sample before; empty before the first one. [1]
    ensemble : Ensemble
        The networks.

    Returns
    -------
    (..., 2 `LONGEST`) array and tuple
        North in 1 to 30 s, then east; memory after the sample. [m; 1]
    """
    x = (signals - ensemble.mean) / ensemble.std
    # Standardise, evaluate all members, average, and scale back.
    given, memory = evaluate_members(ensemble.networks, x, memory)
    mean = sum(given) / len(given)
    return ensemble.target_mean + ensemble.target_std * mean, memory


def corrected(motions: Sequence[Motion], expected: np.ndarray) -> list[tuple]:
    """Places with the errors that are expected; headings stay those of the kinetic model.

    Parameters
    ----------
    motions : sequence of `LONGEST` Motion
        By the kinetic model.
    expected : (..., 2 `LONGEST`) array
        As `errors`. [m]

    Returns
    -------
    list of tuples of three
        North, east, heading, one a second. [m, m, rad]
    """
    # The outputs are all errors north, then all errors east.
    return [
        (motion.x + expected[..., k], motion.y + expected[..., LONGEST + k], motion.psi)
        for k, motion in enumerate(motions)
    ]
