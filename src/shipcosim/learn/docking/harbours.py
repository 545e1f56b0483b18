"""Eighteen harbours: a number gives the way in, the berth, and what land, channel and river do to wind and current.

References
----------
Assumed. 18 harbours, of which the home port is called at most, as in Skulstad, Data-based modelling of ships for motion
prediction and control allocation, NTNU, 2021, paper III; its home port lies in the outlet of a river.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

FAMILIAR = range(1, 15)
UNSEEN = range(15, 19)
"""Numbers of the harbours to train at, and of those that are never trained at."""
_LAST = (180.0, 400.0)  # m, lengths of the legs
_BEFORE = (400.0, 900.0)
_SEA = 5000.0


@dataclass(frozen=True)
class Harbour:
    """A harbour; its berth is at 0, 0.

    Parameters
    ----------
    number : int
        From 1. [1]
    berth_heading : float
        Heading at the berth, clockwise from north. [rad]
    berth_side : float
        Side to the quay: 1 starboard, -1 port. [1]
    courses : tuple of floats
        Courses of the legs from the sea, clockwise from north. [rad]
    lengths : tuple of floats
        Their lengths. [m]
    tide : float
        Largest current of the tide at sea, along the first leg or against it. [m/s]
    land : dict of str to float
        Values of the FMU `harbour`, by their names; the river's speed is its mean. [1, m, rad, m/s]
    """

    number: int
    berth_heading: float
    berth_side: float
    courses: tuple[float, ...]
    lengths: tuple[float, ...]
    tide: float
    land: dict[str, float]

    def waypoints(self, stand_off: float, length: float) -> list[tuple[float, float]]:
        """The way in, to the place off the berth.

        Parameters
        ----------
        stand_off : float
            Distance of that place off the quay. [m]
        length : float
            Of the whole way, at most all legs. [m]

        Returns
        -------
        list of tuples of two floats
            North and east of each waypoint. [m]
        """
        # The place off the berth: stand-off at a right angle to the quay.
        off = self.berth_heading - self.berth_side * 0.5 * pi
        points = [(stand_off * cos(off), stand_off * sin(off))]
        # Follow the legs backwards from the berth until the way is as long as asked for.
        left = length
        for course, leg in zip(self.courses[::-1], self.lengths[::-1], strict=True):
            leg = min(leg, left)
            x, y = points[0]
            points.insert(0, (x - leg * cos(course), y - leg * sin(course)))
            left -= leg
            if left <= 0.0:
                break
        return points


def harbour(number: int) -> Harbour:
    """A harbour.

    Parameters
    ----------
    number : int
        1, the home port, to 18. [1]

    Returns
    -------
    Harbour
    """
    # Berth: any heading, either side.
    rng = np.random.default_rng([26, 3, 0, number])
    heading = rng.uniform(-pi, pi)
    side = float(rng.choice((-1.0, 1.0)))
    # Courses of the legs: the last one approaches the quay, the others bend before it.
    last = heading + side * rng.uniform(0.15, 0.8)  # towards the quay
    before = last + rng.choice((-1.0, 1.0)) * rng.uniform(0.3, 1.1)
    first = before + rng.uniform(-0.7, 0.7)
    # The leg at sea is long enough for any way.
    lengths = float(rng.uniform(*_LAST)), float(rng.uniform(*_BEFORE)), _SEA
    # Shelter from wind and tide near land; the channel guides the tide along the last leg.
    land = {
        "wind_shelter": rng.uniform(0.2, 0.8),
        "land_towards": heading + side * 0.5 * pi + rng.uniform(-0.5, 0.5),
        "wind_reach": rng.uniform(150.0, 600.0),
        "tide_shelter": rng.uniform(0.3, 0.9),
        "channel": last,
        "tide_reach": rng.uniform(150.0, 600.0),
        **_river(rng, number, heading, side),
    }
    tide = float(rng.uniform(0.1, 0.5))
    return Harbour(number, heading, side, (first, before, last), lengths[::-1], tide, land)


def _river(rng, number, heading, side):
    """Every third harbour lies in the outlet of a river, which flows past the berth or across the way to it."""
    # Direction along the quay, either way, turned away from it.
    speed = rng.uniform(0.2, 0.45) if number % 3 == 1 else 0.0
    to = heading + rng.choice((0.0, pi)) - side * rng.uniform(0.0, 0.8)  # along the quay and off it
    # The mouth lies upstream of the berth, shifted across the flow.
    mouth = rng.uniform(50.0, 250.0)
    offset = rng.uniform(-40.0, 80.0)
    off = heading - side * 0.5 * pi
    return {
        "river_speed": speed,
        "river_to": to,
        "river_x": -mouth * cos(to) + offset * cos(off),
        "river_y": -mouth * sin(to) + offset * sin(off),
        "river_width": rng.uniform(40.0, 120.0),
    }
