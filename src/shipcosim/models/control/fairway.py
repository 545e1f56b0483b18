"""The fairway into a harbour: legs from the sea to the berth, and a ship's progress along it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, hypot, pi, sin, tan
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.parameters import quantity
from shipcosim.models.core.tables import parse


@dataclass(frozen=True)
class FairwayParameters:
    """The way to a berth; the ship's origin is to lie at x = y = 0."""

    waypoints: str = quantity(
        "-400 0; 0 0",
        "m",
        "rows 'north east': the way from the sea to the place off the berth",
        "set by the scenario",
    )
    berth_heading: float = quantity(
        0.0, "rad", "heading at the berth, clockwise from north", "set by the scenario"
    )
    berth_side: float = quantity(
        1.0,
        "1",
        "side to the quay: 1 starboard, -1 port",
        "set by the scenario",
        minimum=-1.0,
        maximum=1.0,
    )

    @cached_property
    def points(self) -> tuple[tuple[float, ...], ...]:
        """The waypoints. [m]"""
        return parse(self.waypoints)


class Progress(NamedTuple):
    """Position of a ship along the fairway.

    Parameters
    ----------
    leg : int
        Number of the leg that she follows, from 0. [1]
    to_go : float
        Way left to the last waypoint. [m]
    beside : float
        Distance from the leg, positive where she is to starboard of it. [m]
    course : float
        Direction of the leg, clockwise from north. [rad]
    """

    leg: int
    to_go: float
    beside: float
    course: float


def progress(
    x: float, y: float, u: float, leg: int, *, fairway: FairwayParameters, yaw_rate: float
) -> Progress:
    """Progress of a ship on the fairway; she changes to the next leg as early as her turn needs.

    Parameters
    ----------
    x, y : float
        Place. [m]
    u : float
        Speed. [m/s]
    leg : int
        Leg that she follows so far. [1]
    fairway : FairwayParameters
        The way.
    yaw_rate : float
        With which she turns. [rad/s]

    Returns
    -------
    Progress

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 12: path of straight
    lines, and the distance R tan(turn/2) before the waypoint at which a circle leaves one for the next.

    Examples
    --------
    100 m before the end of a way to the north, 5 m to starboard of it:

    >>> progress(-100.0, 5.0, 5.0, 0, fairway=FairwayParameters(), yaw_rate=0.02)
    Progress(leg=0, to_go=100.0, beside=5.0, course=0.0)
    """
    points = fairway.points
    # Follow the legs. The along-track distance left to the waypoint decides when the next one
    # begins.
    while True:
        (x_0, y_0) = points[leg]
        (x_1, y_1) = points[leg + 1]
        course = atan2(y_1 - y_0, x_1 - x_0)
        left = (x_1 - x) * cos(course) + (y_1 - y) * sin(course)
        # On the last leg there is no turn; else the leg ends where the turn must begin.
        if leg + 2 == len(points) or left > _early(points, leg, course, u, yaw_rate):
            break
        leg += 1
    # Cross-track error in the axes of the leg, positive to starboard.
    cross_track = (y - y_0) * cos(course) - (x - x_0) * sin(course)
    # Length of the legs after this one. [m]
    rest = points[leg + 1 :]
    beyond = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(rest, rest[1:], strict=False))
    return Progress(leg, left + beyond, cross_track, course)


def _early(points: Sequence, leg: int, course: float, u: float, yaw_rate: float) -> float:
    """Distance from the waypoint at which the turn begins. [m]"""
    (x_1, y_1) = points[leg + 1]
    (x_2, y_2) = points[leg + 2]
    # A sharp turn is limited: tan(turn / 2) grows without bound towards 180 degrees.
    turn = min(abs(wrap(atan2(y_2 - y_1, x_2 - x_1) - course)), 0.6 * pi)
    # Circle of radius R = u / r between the legs: it begins R tan(turn / 2) before the waypoint.
    return abs(u) * (tan(0.5 * turn) / yaw_rate + 8.0)  # 8 s until she turns
