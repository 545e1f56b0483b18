"""The truth's own DP: where to go, how hard to push, and which thruster does it. One array entry per ship.

No Kalman filter: a complementary filter on position and velocity, proportional and derivative action as a
linear-quadratic regulator of a double integrator has it, a rough feed-forward of planned motion and wind, and a bias in
the earth frame that leaks in slowly outside a dead band.
"""

from dataclasses import dataclass

import numpy as np

from truth.plant import to_body, to_earth
from truth.ship import (
    AZIMUTH_RPM_MAX,
    BOLLARD_AHEAD,
    BOLLARD_ASTERN,
    PROPELLER_DIAMETER,
    TUNNEL_RPM_MAX,
    TUNNEL_THRUST,
    TUNNEL_X,
    UNIT_X,
    UNIT_Y,
    WATER_DENSITY,
    wind_table,
)

INERTIA = np.array([[557e3], [743e3], [62e6]])
LINEAR_DRAG = np.array([[5e3], [10e3], [2e6]])  # rough resistance to the planned motion
SQUARE_DRAG = np.array([[2e3], [60e3], [75e6]])
LIMIT = np.array([[50e3], [30e3], [450e3]])
ERROR_LIMIT = np.array(
    [[2.5], [2.5], [np.radians(25.0)]]
)  # a larger one is not answered by more thrust
THRUST_RATE = 2000.0
HAND_RATE = 600.0  # of a thruster pushed by hand, so that the others can follow
TURN_RATE = np.radians(10.0)
BIAS_LIMIT = np.array([[15e3], [15e3], [200e3]])
DEAD_BAND = np.array([[0.15], [0.15], [np.radians(0.2)]])
TICK = 1.0
FIXED, TURNING, OPPOSED = 0, 1, 2
LOADS = np.array(
    [[1, 0, 1, 0, 0], [0, 1, 0, 1, 1], [-UNIT_Y[0], UNIT_X, -UNIT_Y[1], UNIT_X, TUNNEL_X]]
)
ARM = np.array(
    [1.0, 1.0, 8.0]
)  # of moments against forces, where the thrusters that are left cannot hold everything
NOMINAL_WIND = wind_table(np.ones(3), rough=False)


@dataclass(frozen=True)
class Style:
    """How the DP of one log is tuned."""

    bandwidth: float  # [rad/s]
    bias_time: float  # [s]
    wind_share: float  # of the wind load that is fed forward
    toe: float  # angle of the fixed units, outwards [rad]
    opposed: float  # how hard the units push against each other, below zero face to face [N]


def draw_style(rng):
    """A DP as people tune them."""
    return Style(
        bandwidth=rng.uniform(0.07, 0.10),
        bias_time=rng.uniform(90.0, 160.0),
        wind_share=rng.uniform(0.5, 0.9),
        toe=np.radians(rng.uniform(40.0, 55.0)),
        opposed=rng.choice((-1.0, 1.0)) * rng.uniform(3e3, 6e3),
    )


@dataclass(frozen=True)
class ByHand:
    """Where somebody else than the DP has the thrusters, one column per tick."""

    force: np.ndarray  # (3, ticks) thrust that one is told, not a number where it is the DP's [N]
    azimuth: np.ndarray  # (2, ticks) and where it points [rad]
    dead: np.ndarray  # (ticks,) no thruster has power

    @classmethod
    def nothing(cls, ticks):
        """All is the DP's."""
        return cls(np.full((3, ticks), np.nan), np.full((2, ticks), np.nan), np.zeros(ticks, bool))


@dataclass(frozen=True)
class Plan:
    """Setpoints of one log, one column per tick."""

    eta: np.ndarray  # (3, ticks) position and heading, continuous [m, m, rad]
    mode: np.ndarray  # (ticks,) how the units are used: FIXED, TURNING or OPPOSED
    hand: ByHand | None = None


class Planner:
    """Writes a plan leg by leg; every leg starts and ends at rest and is half a cosine in between."""

    def __init__(self, start, ticks_before, ticks):
        self.eta = np.repeat(np.asarray(start, float)[:, None], ticks_before + ticks, axis=1)
        self.mode = np.zeros(ticks_before + ticks, int)
        self.now = ticks_before

    @property
    def full(self):
        """Whether no time is left."""
        return self.now >= self.mode.size

    def use(self, mode):
        """Use the units like this from now on."""
        self.mode[self.now :] = mode

    def wait(self, seconds):
        """Stay."""
        self.now = min(self.now + int(seconds), self.mode.size)

    def go(self, change, seconds):
        """Change north, east and heading by so much in that time."""
        steps = np.arange(1, self.mode.size - self.now + 1)
        share = 0.5 - 0.5 * np.cos(np.pi * np.minimum(steps / seconds, 1.0))
        self.eta[:, self.now :] += np.asarray(change, float)[:, None] * share
        self.wait(seconds)

    def move(self, ahead, starboard, turn, seconds):
        """Change place as seen from the heading at the start of the leg, and turn."""
        if not self.full:
            psi = self.eta[2, self.now]
            self.go([*to_earth(psi, ahead, starboard), turn], seconds)

    def plan(self):
        """The plan as written so far."""
        return Plan(self.eta, self.mode)


def plan_trial(planner, rng, modes):
    """Box, circle on the spot, a run ahead and back and heading steps in turn, each with another use of the units."""

    def box():
        side, turn = rng.uniform(15, 25), rng.choice((-1, 1))
        for ahead, starboard in ((1, 0), (0, turn), (-1, 0), (0, -turn)):
            planner.move(side * ahead, side * starboard, 0, rng.uniform(70, 90))
            planner.wait(8)

    def circle():
        planner.move(0, 0, rng.choice((-1, 1)) * 2 * np.pi, rng.uniform(220, 260))
        planner.wait(10)

    def run():
        if planner.mode[-1] == FIXED:
            planner.use(TURNING)
        length = rng.uniform(80, 120)
        planner.move(length, 0, 0, length * rng.uniform(0.95, 1.15))
        planner.wait(5)
        planner.move(-length, 0, 0, length * rng.uniform(1.1, 1.4))
        planner.wait(5)

    def turns():
        for _ in range(2):
            across = rng.uniform(-12, 12)
            planner.move(
                0,
                across,
                rng.choice((-1, 1)) * np.radians(rng.uniform(40, 90)),
                rng.uniform(60, 75),
            )
            planner.wait(12)

    modes, blocks = rng.permutation(modes), 0
    while not planner.full:
        for leg in rng.permutation([box, circle, run, turns]):
            planner.use(modes[blocks % len(modes)])
            blocks += 1
            leg()


def plan_work(planner, rng, modes):
    """Now and then a move of 5 to 25 m or a turn, or both."""
    planner.use(rng.choice(modes))
    while not planner.full:
        planner.wait(rng.uniform(60, 200))
        move, to = rng.uniform(5, 25), rng.uniform(-np.pi, np.pi)
        turn = rng.choice((-1, 1)) * np.radians(rng.uniform(15, 80))
        which = rng.integers(3)
        move, turn = move * (which != 0), turn * (which != 1)
        seconds = max(
            move / rng.uniform(0.2, 0.35), np.degrees(abs(turn)) / rng.uniform(0.4, 0.7), 30
        )
        planner.move(move * np.cos(to), move * np.sin(to), turn, seconds)


def plan_hold(planner, rng, modes):
    """Stay."""
    planner.use(rng.choice(modes))


PLANS = {"trial": plan_trial, "work": plan_work, "hold": plan_hold}


class Autopilot:
    """DP of a batch of ships.

    Parameters
    ----------
    plans : sequence of Plan
    styles : sequence of Style
    azimuth : (2, n) array
        Where the units stand. [rad]
    """

    def __init__(self, plans, styles, azimuth):
        self.eta = np.stack([plan.eta for plan in plans], axis=-1)
        self.rates = np.gradient(self.eta, TICK, axis=1)
        self.accelerations = np.gradient(self.rates, TICK, axis=1)
        self.mode = np.stack([plan.mode for plan in plans], axis=-1)
        self.bandwidth, self.bias_time, self.wind_share, self.toe, self.opposed = (
            np.array([getattr(style, name) for style in styles])
            for name in Style.__dataclass_fields__
        )
        hands = [plan.hand or ByHand.nothing(plan.mode.size) for plan in plans]
        self.told, self.told_azimuth, self.dead = (
            np.stack([getattr(hand, name) for hand in hands], axis=-1)
            for name in ByHand.__dataclass_fields__
        )
        self.stiffness = INERTIA * self.bandwidth**2
        self.damping = np.sqrt(3.0) * INERTIA * self.bandwidth
        self.position = self.eta[:, 0].copy()
        self.velocity = np.zeros_like(self.position)
        self.bias = np.zeros_like(self.position)
        self.moved = np.zeros_like(
            self.position
        )  # setpoint from the plan's: where the ship is when power comes back
        self.wind = None
        self.azimuth = azimuth.copy()
        self.thrust = np.zeros((3, azimuth.shape[1]))

    def command(self, k, eta, nu, wind):
        """Targets of the drives at tick k.

        Parameters
        ----------
        k : int
        eta, nu : (3, n) array
            Measured position and heading (continuous), measured velocity. [m, m, rad; m/s, m/s, rad/s]
        wind : (2, n) array
            Measured relative wind, where it blows to, ahead and to starboard. [m/s]

        Returns
        -------
        tuple of two arrays
            Propeller speeds (3, n) [rpm] and unit directions (2, n) [rad].
        """
        self.observe(eta, nu, wind)
        self.moved = np.where(self.dead[k], self.position - self.eta[:, k], self.moved)
        load = np.clip(self.load(k), -LIMIT, LIMIT)
        thrust, azimuth = self.allocate(load, self.mode[k])
        for i in np.flatnonzero(np.isfinite(self.told[:, k]).any(axis=0)):
            thrust[:, i], azimuth[:, i] = self.by_hand(load[:, i], k, i)
        most = np.where(np.isfinite(self.told[:, k]), HAND_RATE, THRUST_RATE) * TICK
        thrust = self.thrust + np.clip(thrust - self.thrust, -most, most)
        self.thrust = np.where(self.dead[k], 0.0, thrust)
        self.azimuth = np.where(self.dead[k], self.azimuth, azimuth)
        return revolutions(self.thrust), self.azimuth

    def observe(self, eta, nu, wind):
        """Complementary filter: the velocity for the short, the position for the long."""
        north, east = to_earth(eta[2], nu[0], nu[1])
        predicted = self.position + TICK * np.array([north, east, nu[2]])
        self.position = predicted + 0.12 * (eta - predicted)
        self.velocity = self.velocity + 0.3 * (nu - self.velocity)
        self.wind = wind if self.wind is None else self.wind + 0.15 * (wind - self.wind)

    def load(self, k):
        """Load that brings the ship to its setpoint. (3, n)"""
        psi = self.position[2]
        off = np.clip(self.eta[:, k] + self.moved - self.position, -ERROR_LIMIT, ERROR_LIMIT)
        error = self.into_body(psi, off)
        planned = self.into_body(psi, self.rates[:, k])
        slow = planned - self.velocity
        leak = self.bandwidth**2 * INERTIA * np.sign(off) * np.maximum(np.abs(off) - DEAD_BAND, 0)
        self.bias = np.clip(self.bias + TICK / self.bias_time * leak, -BIAS_LIMIT, BIAS_LIMIT)
        push = INERTIA * self.into_body(psi, self.accelerations[:, k])
        push = push + (LINEAR_DRAG + SQUARE_DRAG * np.abs(planned)) * planned - self.wind_feed()
        return self.stiffness * error + self.damping * slow + push + self.into_body(psi, self.bias)

    @staticmethod
    def into_body(psi, vector):
        """(3, n) vector of the earth frame in the body frame."""
        return np.array([*to_body(psi, vector[0], vector[1]), vector[2]])

    def wind_feed(self):
        """Share of the wind load by the tables that the DP has. (3, n)"""
        angle = np.mod(np.degrees(np.arctan2(self.wind[1], self.wind[0])), 360.0)
        grid = np.arange(0, 361, 10)
        load = np.array([np.interp(angle, grid, row) for row in NOMINAL_WIND])
        return self.wind_share * load * (self.wind[0] ** 2 + self.wind[1] ** 2)

    def allocate(self, load, mode):
        """Thrusts (3, n) and directions (2, n): units at fixed angles, turning together, or pushing apart."""
        x, y, n = load
        bow = (n - UNIT_X * y) / (TUNNEL_X - UNIT_X)
        fixed, fixed_bow = self.fixed(x, y, n)
        apart = np.where(mode == OPPOSED, self.opposed, 0.0)
        force_x = np.array([x, x]) / 2
        force_y = (y - bow) / 2 + np.array([apart, -apart])
        size = np.hypot(force_x, force_y)
        turned = np.where(size > 1200.0, np.arctan2(force_y, force_x), self.azimuth)
        toe = np.array([-self.toe, self.toe])
        azimuth = np.where(mode == FIXED, toe, turned)
        turn = np.mod(azimuth - self.azimuth + np.pi, 2 * np.pi) - np.pi
        azimuth = self.azimuth + np.clip(turn, -TURN_RATE * TICK, TURN_RATE * TICK)
        along = np.maximum(np.cos(azimuth) * force_x + np.sin(azimuth) * force_y, 0.0)
        units = np.where(mode == FIXED, fixed, along)
        bow = np.where(mode == FIXED, fixed_bow, bow)
        most = TUNNEL_THRUST * TUNNEL_RPM_MAX**2
        return np.array([*np.clip(units, -30e3, 60e3), np.clip(bow, -most, most)]), azimuth

    def by_hand(self, load, k, i):
        """Thrusts (3,) and directions (2,) of one ship: as told, and the others hold her against it."""
        told, c, s = (
            np.isfinite(self.told[:, k, i]),
            np.cos(self.azimuth[:, i]),
            np.sin(self.azimuth[:, i]),
        )
        pushed = np.where(told, self.thrust[:, i], 0.0)
        forces = np.array(
            [pushed[0] * c[0], pushed[0] * s[0], pushed[1] * c[1], pushed[1] * s[1], pushed[2]]
        )
        free = np.repeat(~told, (2, 2, 1))
        rest = (load - LOADS @ forces) / ARM
        forces[free] = np.linalg.lstsq((LOADS / ARM[:, None])[:, free], rest, rcond=None)[0]
        wish = forces[:4].reshape(2, 2).T
        turned = np.where(
            np.hypot(*wish) > 1200.0, np.arctan2(wish[1], wish[0]), self.azimuth[:, i]
        )
        turned = np.where(told[:2], self.told_azimuth[:, k, i], turned)
        turn = np.mod(turned - self.azimuth[:, i] + np.pi, 2 * np.pi) - np.pi
        azimuth = self.azimuth[:, i] + np.clip(turn, -TURN_RATE * TICK, TURN_RATE * TICK)
        along = np.maximum(np.cos(azimuth) * wish[0] + np.sin(azimuth) * wish[1], 0.0)
        most = TUNNEL_THRUST * TUNNEL_RPM_MAX**2
        thrust = np.array([*np.clip(along, 0.0, 60e3), np.clip(forces[4], -most, most)])
        return np.where(told, self.told[:, k, i], thrust), azimuth

    def fixed(self, x, y, n):
        """Thrusts of units at the fixed angles (2, n) and of the tunnel that give a load."""
        c, s = np.cos(self.toe), np.sin(self.toe)
        rest = n - TUNNEL_X * y
        port = -(UNIT_X - TUNNEL_X) * s - UNIT_Y[0] * c
        starboard = (UNIT_X - TUNNEL_X) * s - UNIT_Y[1] * c
        total = x / c
        right = (rest - port * total) / (starboard - port)
        left = total - right
        return np.array([left, right]), y + s * left - s * right


def revolutions(thrust):
    """Propeller speeds (3, n) that give a thrust at bollard, by the nominal numbers. [rpm]"""
    ahead = WATER_DENSITY * PROPELLER_DIAMETER**4 / 3600 * BOLLARD_AHEAD
    astern = WATER_DENSITY * PROPELLER_DIAMETER**4 / 3600 * BOLLARD_ASTERN
    units = np.where(
        thrust[:2] > 0, np.sqrt(np.abs(thrust[:2]) / ahead), -np.sqrt(np.abs(thrust[:2]) / astern)
    )
    tunnel = np.sign(thrust[2]) * np.sqrt(np.abs(thrust[2]) / TUNNEL_THRUST)
    return np.array(
        [
            *np.clip(units, -AZIMUTH_RPM_MAX, AZIMUTH_RPM_MAX),
            np.clip(tunnel, -TUNNEL_RPM_MAX, TUNNEL_RPM_MAX),
        ]
    )
