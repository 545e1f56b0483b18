"""Predictions of the docking predictors over replayed records, all starts at once."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.learn.docking import distance_ensemble, paper_iii
from shipcosim.learn.docking.inputs import Replay
from shipcosim.models.core.motion import Motion
from shipcosim.models.prediction import docking
from shipcosim.models.prediction import paper_iii as networks_iii
from shipcosim.models.prediction.regions import FORESIGHT, RegionParameters, own_errors
from shipcosim.models.ship.hull import HullParameters

Places = Sequence[tuple]
"""North, east and heading in 1 to 30 s, each an (m, n) array. [m, m, rad]"""


class Predicted(NamedTuple):
    """Predictions from every second.

    Parameters
    ----------
    places : Places
        Where she is foreseen.
    share : (m, n) array
        Of what is learned. [1]
    """

    places: Places
    share: np.ndarray


def kinetic(replay: Replay) -> Predicted:
    """Predictions by the equations of motion alone."""
    return Predicted([motion[:3] for motion in replay.kinetic], np.zeros_like(replay.start.x))


def by_paper_iii(replay: Replay, arrays: Mapping[str, np.ndarray]) -> Predicted:
    """Predictions by the networks of paper III."""
    # Kinetic prediction plus the errors that the networks expect.
    expected = paper_iii.expected(arrays, paper_iii.inputs_of(replay))
    return Predicted(networks_iii.corrected(replay.kinetic, expected), np.ones_like(replay.start.x))


def by_ours(replay: Replay, arrays: Mapping[str, np.ndarray], hull: HullParameters) -> Predicted:
    """By our hybrid."""
    trained = docking.trained_of(arrays)
    # Features and outputs of the ensemble at every second.
    inputs = distance_ensemble.features(replay, hull)
    given = distance_ensemble.given_by(trained, inputs)
    # Trust in the ensemble falls outside the data it was trained on.
    share = docking.share_of(inputs, given, trained)
    # Correct the path by the equations of motion, then blend with the kinetic path.
    learned = docking.corrected(replay.own.ship, replay.ours, given)
    return Predicted(docking.blended(replay.kinetic, learned, share), share)


def own_record(places: Places, replay: Replay) -> tuple[np.ndarray, np.ndarray]:
    """Mean errors of predictions 10 s ahead as known aboard at every second: two (m, n) arrays. [m, rad]"""
    # Compare with the prediction made FORESIGHT seconds before: only past data, as aboard.
    ahead = round(FORESIGHT)
    # Measured positions with averaged velocity stand for the ship at each second.
    ship = Motion._make((*(replay.later[name][0] for name in ("x", "y", "psi")), *replay.start[3:]))
    errors = np.zeros_like(ship.x[:, 0]), np.zeros_like(ship.x[:, 0])
    rows = []
    for k in range(ship.x.shape[1]):
        if k >= ahead:
            # What was predicted for now; velocities are not compared.
            foreseen = Motion._make(
                (*(place[:, k - ahead] for place in places[ahead - 1]), 0.0, 0.0, 0.0)
            )
            now = Motion(*(series[:, k] for series in ship))
            # Exponential averages of position and heading errors (models.prediction.regions).
            errors = own_errors(errors, now, foreseen, 1.0, regions=RegionParameters())
        rows.append(errors)
    position, heading = (np.stack(values, axis=1) for values in zip(*rows, strict=True))
    return position, heading
