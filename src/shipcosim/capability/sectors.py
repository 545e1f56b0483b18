"""Thrust that a thruster can give by direction, as convex pieces, with forbidden and lossy sectors.

A thruster's race goes opposite to its thrust. Level 1 forbids an azimuth to blow onto a neighbour that works, and
takes thrust where it blows onto one that stands still; a tunnel may be blown at. What remains of the disc of an azimuth
is not convex. It is cut into sectors of at most half a turn, which are: the balance tries them all.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shipcosim.angles import wrap_series
from shipcosim.capability.thrust import Thruster

CORNERS = np.radians(5.0)
"""Angle between the corners of a sector's edge, which lies inside the circle by 0.1 % at most. [rad]"""

_TURN = 2.0 * np.pi
_LIVE_DISTANCE = 15.0  # diameters within which a working thruster must not be blown at
_DEAD_DISTANCE = {
    False: 8.0,
    True: 4.0,
}  # diameters within which one that stands still costs thrust: open, ducted
_DEAD_WIDTH = {False: 0.6, True: 0.35}


@dataclass(frozen=True)
class Sector:
    """Directions of thrust around a middle one.

    Attributes
    ----------
    middle, half : float
        Direction clockwise from the bow, and half the width. [rad]
    share : float
        Of the thrust that is left in the middle; from the edges inward the limit is a straight line. 0: forbidden.
    """

    middle: float
    half: float
    share: float = 0.0


def sectors(
    thruster: Thruster, working: Iterable[Thruster], failed: Iterable[Thruster]
) -> list[Sector]:
    """Sectors where a thruster must not push, or loses thrust.

    Parameters
    ----------
    thruster : Thruster
    working, failed : iterable of Thruster
        The others.

    Returns
    -------
    list of Sector

    Raises
    ------
    ValueError
        Two thrusters are in the same place.
    """
    possible = [_flushing(thruster, other, is_live=True) for other in working]
    possible += [_flushing(thruster, other, is_live=False) for other in failed]
    return [sector for sector in possible if sector is not None]


def _flushing(thruster: Thruster, other: Thruster, is_live: bool) -> Sector | None:
    # A thruster cannot blow onto itself, and tunnels lie protected in the hull.
    if other is thruster or other.kind == "tunnel":
        return None
    # The race goes opposite to the thrust: the critical thrust points away from the neighbour.
    # Distance in diameters.
    x = thruster.x - other.x
    y = thruster.y - other.y
    distance = float(np.hypot(x, y)) / thruster.diameter
    if distance == 0.0:
        raise ValueError(f"{thruster.name} and {other.name} are in the same place")
    middle = float(np.arctan2(y, x))
    # A working neighbour must not be blown at: within 15 D the sector is forbidden, arctan(0.1 + D
    # / distance) to each side.
    if is_live:
        return (
            Sector(middle, float(np.arctan(0.1 + 1.0 / distance)))
            if distance < _LIVE_DISTANCE
            else None
        )
    # A neighbour at rest costs thrust if it is near; the closer, the more.
    if distance >= _DEAD_DISTANCE[thruster.ducted]:
        return None
    left = 1.0 - 1.0 / (0.02 * distance**2 + 0.25 * distance + 1.2)
    return Sector(middle, float(np.arctan(_DEAD_WIDTH[thruster.ducted] / distance)), left)


def pieces(thruster: Thruster, narrowed: Sequence[Sector] = ()) -> list[NDArray]:
    """Forces that a thruster can give: in each piece any mixture of its corners and none.

    Parameters
    ----------
    thruster : Thruster
    narrowed : sequence of Sector
        Where it must not push, or loses; the edges of one are allowed.

    Returns
    -------
    list of (k, 2) array
        Corners, X and Y; a piece may be empty. [N]
    """
    if thruster.kind == "azimuth":
        return _of_azimuth(thruster.ahead, narrowed)
    # A thruster that cannot turn gives a segment of forces: ahead and astern along its axis.
    along = np.array([np.cos(thruster.angle), np.sin(thruster.angle)])
    left = [_share(angle, narrowed) for angle in (thruster.angle, thruster.angle + np.pi)]
    return [np.array([left[0] * thruster.ahead * along, -left[1] * thruster.astern * along])]


def _of_azimuth(thrust: float, narrowed: Sequence[Sector]) -> list[NDArray]:
    """Sectors of the disc: cut at every edge and middle of a narrowed one, none wider than half a turn."""
    # Without sectors the whole disc is one convex set, a polygon close to the circle.
    if not narrowed:
        return [thrust * _directions(np.arange(0.0, _TURN - 1e-9, CORNERS))]
    # Between neighbouring cuts the limit is of one kind (free, lossy or forbidden), so it is
    # convex.
    cuts = {
        edge % _TURN for s in narrowed for edge in (s.middle - s.half, s.middle, s.middle + s.half)
    }
    ordered = sorted(cuts)
    corners = []
    for start, end in zip(ordered, [*ordered[1:], ordered[0] + _TURN], strict=True):
        # The middle of the arc decides: a sector covers an arc fully or not at all.
        angle = 0.5 * (start + end)
        forbidden = any(s.share == 0.0 and abs(_apart(angle, s.middle)) < s.half for s in narrowed)
        if not forbidden:
            corners += [_corners(thrust, a, b, narrowed) for a, b in _halves(start, end)]
    return corners


def _halves(start: float, end: float) -> list[tuple[float, float]]:
    """An arc in equal parts of at most half a turn."""
    # A sector of the disc wider than half a turn is not convex.
    parts = int(np.ceil((end - start) / np.pi - 1e-9))
    edges = np.linspace(start, end, parts + 1)
    return list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))


def _corners(thrust: float, start: float, end: float, narrowed: Sequence[Sector]) -> NDArray:
    """Corners between two cuts. Where thrust is lost the edge is straight, so its ends are enough."""
    middle = 0.5 * (start + end)
    # A lossy edge is a straight line by definition; a free edge is an arc and needs corners.
    loses = any(abs(_apart(middle, s.middle)) < s.half for s in narrowed)
    number = 2 if loses else int(np.ceil((end - start) / CORNERS)) + 1
    angles = np.linspace(start, end, number)
    left = np.array([_share(angle, narrowed) for angle in angles])
    return thrust * left[:, None] * _directions(angles)


def _share(angle: float, narrowed: Sequence[Sector]) -> float:
    """Share of the thrust that is left in a direction."""
    return min((_share_of(angle, sector) for sector in narrowed), default=1.0)


def _share_of(angle: float, sector: Sector) -> float:
    away = abs(_apart(angle, sector.middle))
    # The edges are allowed; rounding must not close them.
    if away >= sector.half - 1e-12:
        return 1.0
    if sector.share == 0.0:
        return 0.0
    # The straight line in polar form: from full thrust at the edge (angle `half`) to `share` in the
    # middle.
    sine = np.sin(sector.half)
    return float(sector.share * sine / (np.sin(sector.half - away) + sector.share * np.sin(away)))


def _apart(angle: float, other: float) -> float:
    return wrap_series(angle - other, _TURN)


def _directions(angles: NDArray) -> NDArray:
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)
