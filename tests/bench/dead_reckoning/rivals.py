"""Rivals: the Kalman filter of paper II with its printed numbers, and two that need no model.

A rival is a module or an object with `start` and `step`, as the laws of `shipcosim.models.prediction` are.
"""

from typing import Any, NamedTuple

import numpy as np
from ships import parameters

from shipcosim.learn.dead_reckoning import worlds
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.propulsion import mapped
from shipcosim.models.ship.mast import MastParameters, wind_from_mast

M = np.array([[1.02e7, 0.0, 0.0], [0.0, 1.02e7, 8.44e6], [0.0, 8.44e6, 5.80e9]])
D = np.array([[300000.0, 0.0, 0.0], [0.0, 550000.0, 600000.0], [0.0, 600000.0, 1.38e8]])
R = np.diag([0.7, 0.7, 0.2])
Q = np.diag([0.1, 0.1, 0.1, 1e6, 1e6, 1e6, *(0.1 * np.diag(R))])
"""Paper II, eqs. (8) to (11). The order of Q is read as Fossen's: waves, bias, velocity."""
WAVE_FREQUENCY, WAVE_DAMPING = 2.0 * np.pi / 8.0, 0.1  # rad/s, 1; not printed
PLACES = [
    (37.0, 0.0, 1),
    (35.0, 0.0, 1),
    (-31.0, 0.0, 1),
    (-33.0, 0.0, 1),
    (-38.0, -6.0, 0),
    (-38.0, 6.0, 0),
]


class State(NamedTuple):
    """Position, velocity and time since the loss, and whatever the rival keeps."""

    x: Any
    y: Any
    u: Any
    v: Any
    lost_for: Any
    sea: Any
    kept: Any


def lost_for(state, measured, h):
    """Time since GNSS was lost."""
    return np.where(measured.valid < 0.5, state.lost_for + h, 0.0)


class Kalman:
    """Linear filter in vessel-parallel axes, states of the waves (6), position and heading, bias, velocity.

    Its gain is that of the steady state. Thrust is linear in the command, as the paper says of its own; the slope is
    what fits the map best up to 0.6 of the full command.
    """

    def __init__(self):
        self.slopes = [self._slope(name) for name in worlds.UNITS]
        self.wind, self.mast = (
            parameters(WindParameters, "osv"),
            parameters(MastParameters, "osv", "sensors"),
        )
        self.F, self.B, self.K = _discrete(1.0)

    def _slope(self, name):
        thruster = parameters(mapped.MapParameters, "osv", name)
        commands = np.linspace(-0.6, 0.6, 121) * mapped.mapped_command(1e9, thruster=thruster)
        thrust = mapped.mapped_thrust(commands, thruster=thruster)
        return float((thrust * commands).sum() / (commands * commands).sum())

    def start(self, measured, *, design=None):
        kept = np.zeros((15, *np.shape(measured.x)))
        kept[6:9] = (
            measured.x,
            measured.y,
            measured.psi,
        )  # turned by the heading, which starts at some 0
        zero = 0.0 * measured.x
        return State(measured.x, measured.y, zero, zero, zero, zero, (kept, measured.psi))

    def step(self, state, measured, h, *, design=None):
        """Vessel-parallel: position is turned by the measured heading at each sample."""
        kept, psi = state.kept[0].copy(), measured.psi
        north, east = to_ned(state.kept[1], kept[6], kept[7])
        kept[6], kept[7] = to_body(psi, north, east)
        load = self._load(state, measured)
        kept = np.einsum("ij,j...->i...", self.F, kept) + np.einsum("ij,j...->i...", self.B, load)
        seen = np.array([*to_body(psi, measured.x, measured.y), psi])
        innovation = seen - kept[6:9] - kept[3:6]
        innovation[2] = (innovation[2] + np.pi) % (2.0 * np.pi) - np.pi
        corrected = kept + np.einsum("ij,j...->i...", self.K, innovation)
        kept = np.where(measured.valid > 0.5, corrected, kept)
        kept[8] = np.where(measured.valid > 0.5, kept[8], psi)  # the compass still works
        x, y = to_ned(psi, kept[6], kept[7])
        return State(x, y, kept[12], kept[13], lost_for(state, measured, h), state.sea, (kept, psi))

    def _load(self, state, measured):
        total = 0.0
        for slope, command, (x, y, side) in zip(
            self.slopes, measured.commands, PLACES, strict=True
        ):
            thrust = slope * command
            total = total + np.array(
                [(1 - side) * thrust, side * thrust, x * side * thrust - (1 - side) * y * thrust]
            )
        air = wind_from_mast(
            measured.wind_speed, measured.wind_from, state.u, state.v, 0.0 * state.u, mast=self.mast
        )
        return total + np.array(wind_loads(*air, wind=self.wind))


def _discrete(h):
    """Transition, input and gain of the steady state."""
    A, B, E = np.zeros((15, 15)), np.zeros((15, 3)), np.zeros((15, 9))
    A[0:3, 3:6] = A[6:9, 12:15] = np.eye(3)
    A[3:6, 0:3], A[3:6, 3:6] = (
        -(WAVE_FREQUENCY**2) * np.eye(3),
        -2.0 * WAVE_DAMPING * WAVE_FREQUENCY * np.eye(3),
    )
    A[12:15, 9:12], A[12:15, 12:15], B[12:15] = (
        np.linalg.inv(M),
        -np.linalg.inv(M) @ D,
        np.linalg.inv(M),
    )
    E[3:6, 0:3], E[9:12, 3:6], E[12:15, 6:9] = np.eye(3), np.eye(3), np.linalg.inv(M)
    F, part, series = np.eye(15), np.eye(15), h * np.eye(15)
    for k in range(1, 20):
        part = part @ A * (h / k)
        F, series = F + part, series + part * (h / (k + 1))
    C = np.zeros((3, 15))
    C[:, 6:9] = C[:, 3:6] = np.eye(3)
    P, noise, K = np.eye(15), h * E @ Q @ E.T, np.zeros((15, 3))
    for _ in range(20000):
        P = F @ P @ F.T + noise
        K = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
        P = (np.eye(15) - K @ C) @ P
    return F, series @ B, K


class ConstantVelocity:
    """The mean position and velocity of the last ten seconds with GNSS, carried on."""

    def start(self, measured, *, design=None):
        zero = 0.0 * measured.x
        kept = [np.stack([one] * 10) for one in (measured.x, measured.y, zero, zero)]
        return State(measured.x, measured.y, zero, zero, zero, zero, kept)

    def step(self, state, measured, h, *, design=None):
        north, east = to_ned(measured.psi, measured.u, measured.v)
        new, works = (measured.x, measured.y, north, east), measured.valid > 0.5
        kept = [
            np.where(works, np.concatenate([a[1:], np.asarray(b)[None]]), a)
            for a, b in zip(state.kept, new, strict=True)
        ]
        since = lost_for(state, measured, h)
        x, y, north, east = (one.mean(0) for one in kept)
        x, y = x + (since + 4.5) * north, y + (since + 4.5) * east
        return State(x, y, *to_body(measured.psi, north, east), since, state.sea, kept)
