"""Every predictor of dockings over the same replayed records, and simple ones that know less."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from shipcosim.angles import wrap
from shipcosim.learn.docking import predictions
from shipcosim.learn.docking.inputs import Replay, ShipModel
from shipcosim.learn.docking.predictions import Predicted
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.prediction.helm import LONGEST

ROOT = Path(__file__).resolve().parents[3]
WEIGHTS = ROOT / "fmus" / "docking_predictor" / "weights"
SAMPLE, PUSHED, WALK, BIAS = 1.0, 0.02, 1e-5, 2e-3
"""Of the Kalman filter: time between samples [s], intensity of its velocity's white noise [m2/s3], of the current's
random walk [m2/s3], and standard deviation of the bias, an acceleration that decays in `FADES` [m/s2]; assumed."""
FADES, NOISE = 60.0, (0.25, 0.03)
"""Decay of the bias [s]; errors of place and velocity [m, m/s]."""


@cache
def arrays(name: str) -> dict[str, np.ndarray]:
    """Weights in the repository."""
    return read_arrays(WEIGHTS / f"{name}.npz")


def constant_velocity(replay: Replay, model: ShipModel) -> Predicted:
    """Velocity over ground and yaw rate stay as they are, averaged over three seconds."""
    return _straight(replay.start, replay)


def kalman_filter(replay: Replay, model: ShipModel) -> Predicted:
    """Kalman filter of place and velocity, with current and bias, one axis like the other.

    It is told the acceleration that her model has without current. Its states are place, velocity through the water,
    current and bias acceleration; it predicts with the same.
    """
    ahead, ship = replay.kinetic, replay.aboard.ship
    x, y = _filtered(replay, 0), _filtered(replay, 1)
    velocity, places = to_ned(replay.start.psi, *replay.start[3:5]), []
    for second, motion in enumerate(ahead, 1):
        held = FADES * (
            second - FADES * (1.0 - np.exp(-second / FADES))
        )  # what a bias that fades adds
        found = []
        for k, (place, speed, current, bias) in enumerate((x, y)):
            pushed = motion[k] - replay.start[k] - second * velocity[k]
            found.append(place + second * (speed + current) + held * bias + pushed)
        places.append((*found, motion.psi))
    return Predicted(places, np.zeros_like(ship.x))


def _filtered(replay, axis):
    """Place, velocity through the water, current and bias of one axis: four (m, n) arrays."""
    ship = replay.aboard.ship
    place, velocity = ship[axis], to_ned(ship.psi, ship.u, ship.v)[axis]
    pushed = replay.kinetic[0]
    told = (
        to_ned(pushed.psi, pushed.u, pushed.v)[axis]
        - to_ned(replay.start.psi, *replay.start[3:5])[axis]
    )
    keep = np.exp(-SAMPLE / FADES)
    F = np.array([[1, SAMPLE, SAMPLE, 0.5], [0, 1, 0, SAMPLE], [0, 0, 1, 0], [0, 0, 0, keep]])
    H = np.array([[1.0, 0, 0, 0], [0, 1, 1, 0]])
    Q = np.diag([PUSHED / 3, PUSHED, WALK, BIAS**2 * (1 - keep**2)])
    R = np.diag([NOISE[0] ** 2, NOISE[1] ** 2])
    mean = np.stack([place[:, 0], velocity[:, 0], 0.0 * place[:, 0], 0.0 * place[:, 0]])
    P, rows = np.diag([0.1, 0.1, 0.16, BIAS**2]), [mean]
    for k in range(1, place.shape[1]):
        mean = F @ mean
        mean[0], mean[1] = mean[0] + 0.5 * told[:, k - 1], mean[1] + told[:, k - 1]
        P = F @ P @ F.T + Q
        gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        mean = mean + gain @ (np.stack([place[:, k], velocity[:, k]]) - H @ mean)
        P = P - gain @ H @ P
        rows.append(mean)
    return np.stack(rows, axis=-1)


def own_load(replay: Replay, model: ShipModel) -> Predicted:
    """Our hybrid without its networks: the equations of motion with the load of the own record."""
    return Predicted([motion[:3] for motion in replay.ours], np.zeros_like(replay.start.x))


def _straight(start: Motion, replay: Replay) -> Predicted:
    north, east = to_ned(start.psi, start.u, start.v)
    places = [
        (start.x + h * north, start.y + h * east, wrap(start.psi + h * start.r))
        for h in range(1, LONGEST + 1)
    ]
    return Predicted(places, np.zeros_like(start.x))


PREDICTORS: dict[str, Callable[[Replay, ShipModel], Predicted]] = {
    "constant velocity": constant_velocity,
    "Kalman filter": kalman_filter,
    "kinetic": lambda replay, model: predictions.kinetic(replay),
    "kinetic with own load": own_load,
    "paper III": lambda replay, model: predictions.by_paper_iii(replay, arrays("paper-iii")),
    "ours": lambda replay, model: predictions.by_ours(replay, arrays("ours"), model.hull),
}
"""Predictor: what it says over replayed records."""
