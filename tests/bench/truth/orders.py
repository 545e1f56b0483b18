"""What a ship is told to do when her log is over: where to sail, which thruster to push by hand, when to lose power.

The DP does it as it does everything: it is told places and forces, not a track to the second.
"""

from dataclasses import dataclass

import numpy as np

from truth.autopilot import FIXED, TURNING, ByHand, Plan
from truth.plant import to_earth

THRUSTERS = ("port", "starboard", "tunnel")
STOP = 30  # s until the ship has done with what she was about
LATE = 10  # s that the captain takes, at most
SPARE = 10  # s of log after the last order
FAST = 0.6  # m/s on a leg's average, above which units at fixed angles will not do


@dataclass(frozen=True)
class Orders:
    """A manoeuvre, in numbers that a captain could be told.

    Attributes
    ----------
    legs : sequence of (seconds, ahead, starboard, turn)
        One after the other, and where the ship is to be at its end, as seen from where she started. [s, m, m, rad]
    pushes : sequence of (thruster, start, end, force, azimuth, azimuth)
        A thruster by hand, with so much thrust (below zero reversed), turned evenly from one direction to the other;
        the others hold the ship. [s, s, N, rad, rad]
    free : sequence of (start, end)
        No thruster has power. If it is the end, power does not come back. [s]
    """

    legs: tuple
    pushes: tuple = ()
    free: tuple = ()

    @property
    def seconds(self):
        """Duration. [s]"""
        return int(np.ceil(sum(leg[0] for leg in self.legs)))

    @property
    def rows(self):
        """Seconds of log from when the ship is stopped."""
        return STOP + LATE + self.seconds + SPARE


def carried_out(plan, orders, rng, after):
    """A plan that goes on with orders.

    Parameters
    ----------
    plan : Plan
    orders : Orders
    rng : numpy.random.Generator
        Of the captain.
    after : int
        Seconds that the plan has after the orders.

    Returns
    -------
    Plan
    """
    before, ticks = plan.mode.size, orders.rows + after
    late = STOP + int(rng.integers(2, LATE + 1))
    sailed = np.concatenate([plan.eta, come_to_rest(plan.eta, ticks)], axis=1)
    sail(sailed, orders.legs, before + late)
    quick = any(speed > FAST for speed in leg_speeds(orders.legs))
    last = TURNING if quick and plan.mode[-1] == FIXED else plan.mode[-1]
    hand = ByHand.nothing(before + ticks)
    for push in orders.pushes:
        take_over(hand, push, before + late)
    for start, end in orders.free:
        until = before + late + int(end) if end < orders.seconds - 1 else before + ticks
        hand.dead[before + late + int(start) : until] = True
    return Plan(sailed, np.concatenate([plan.mode, np.full(ticks, last)]), hand)


def come_to_rest(eta, ticks):
    """Setpoints after a plan that may end under way. (3, ticks)"""
    fade = 0.5 + 0.5 * np.cos(np.pi * np.minimum(np.arange(1, ticks + 1) / (0.7 * STOP), 1.0))
    return eta[:, -1:] + (eta[:, -1] - eta[:, -2])[:, None] * np.cumsum(fade)


def sail(eta, legs, start):
    """Add legs to setpoints (3, ticks), in place; each is half a cosine."""
    psi, place, now = eta[2, start], np.zeros(3), float(start)
    ticks = np.arange(eta.shape[1])
    for seconds, ahead, starboard, turn in legs:
        there = np.array([*to_earth(psi, ahead, starboard), turn])
        share = 0.5 - 0.5 * np.cos(np.pi * np.clip((ticks - now) / seconds, 0.0, 1.0))
        eta += (there - place)[:, None] * share
        place, now = there, now + seconds


def leg_speeds(legs):
    """Mean speed of each leg. [m/s]"""
    places = np.array([[0.0, 0.0], *((ahead, starboard) for _, ahead, starboard, _ in legs)])
    return np.hypot(*np.diff(places, axis=0).T) / [leg[0] for leg in legs]


def take_over(hand, push, start):
    """Write one push into what is done by hand."""
    name, first, last, force, *azimuths = push
    thruster = THRUSTERS.index(name)
    rows = np.arange(start + int(first), start + int(last))
    hand.force[thruster, rows] = force
    if thruster < 2:
        hand.azimuth[thruster, rows] = np.linspace(*azimuths, rows.size)
