"""Wind and current in a harbour: shelter by land, and a river's outflow."""

from dataclasses import dataclass

from shipcosim.models.core.maths import Arithmetic, cos, exp, hypot, maximum, sin, sqrt
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity

_SET = "set by the scenario"
_NONE = "neutral"
_SLOW = 1e-6  # m/s, keeps the direction of no wind finite


@dataclass(frozen=True)
class HarbourParameters:
    """Land and river about a berth, which is the origin; by default there are none."""

    wind_shelter: float = quantity(
        0.0,
        "1",
        "share of the wind from land that land takes at the berth",
        _NONE,
        minimum=0.0,
        maximum=1.0,
    )
    land_towards: float = quantity(
        0.0,
        "rad",
        "direction in which land lies, and from which it shelters, clockwise from north",
        _SET,
    )
    wind_reach: float = quantity(
        300.0, "m", "distance from the berth at which 1/e of it is left", _SET, minimum=1.0
    )
    tide_shelter: float = quantity(
        0.0,
        "1",
        "share of the open sea's current that is missing at the berth",
        _NONE,
        minimum=0.0,
        maximum=1.0,
    )
    channel: float = quantity(
        0.0,
        "rad",
        "direction of the channel, along which alone the tide flows near the berth",
        _SET,
    )
    tide_reach: float = quantity(
        400.0, "m", "distance from the berth at which 1/e of that is left", _SET, minimum=1.0
    )
    river_speed: float = quantity(
        0.0, "m/s", "speed of the river in the middle of its mouth", _NONE, minimum=0.0
    )
    river_to: float = quantity(
        0.0, "rad", "direction the river flows to, clockwise from north", _SET
    )
    river_x: float = quantity(0.0, "m", "middle of the mouth, north of the berth", _SET)
    river_y: float = quantity(0.0, "m", "middle of the mouth, east of the berth", _SET)
    river_width: float = quantity(
        60.0, "m", "half-width of the river, to 1/e of the speed", _SET, minimum=1.0
    )
    river_spread: float = quantity(
        0.1,
        "1",
        "growth of the half-width over the distance from the mouth",
        "plane jet",
        minimum=0.0,
    )


def local_wind(
    x: Arithmetic, y: Arithmetic, north: Arithmetic, east: Arithmetic, *, harbour: HarbourParameters
) -> Vector:
    """Wind at a place: land shelters from the wind that blows off it, more so near the berth.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Place, from the berth. [m]
    north, east : like x
        Velocity of the air at the open sea. [m/s]
    harbour : HarbourParameters
        Land.

    Returns
    -------
    tuple of two, like x
        Velocity of the air. [m/s, m/s]

    References
    ----------
    Assumed: a factor 1 - s exp(-d²/R²) max(0, cos γ), γ between where the wind comes from and land.

    Examples
    --------
    Wind from the north loses half at a berth south of land, wind from the south nothing:

    >>> berth = HarbourParameters(wind_shelter=0.5)
    >>> [round(local_wind(0.0, 0.0, north, 0.0, harbour=berth)[0], 3) for north in (-10.0, 10.0)]
    [-5.0, 10.0]
    """
    # Component of the wind that comes from land, as the cosine of the angle between them.
    off_land = -(north * cos(harbour.land_towards) + east * sin(harbour.land_towards))
    share = maximum(off_land / (hypot(north, east) + _SLOW), 0.0)
    # Factor 1 - s exp(-d²/R²) max(0, cos γ).
    left = 1.0 - harbour.wind_shelter * _near(x, y, harbour.wind_reach) * share
    return left * north, left * east


def local_current(
    x: Arithmetic, y: Arithmetic, north: Arithmetic, east: Arithmetic, *, harbour: HarbourParameters
) -> Vector:
    """Current at a place: the tide, weaker and along the channel near the berth, and the river.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Place, from the berth. [m]
    north, east : like x
        Velocity of the water at the open sea. [m/s]
    harbour : HarbourParameters
        Channel and river.

    Returns
    -------
    tuple of two, like x
        Velocity of the water. [m/s, m/s]

    References
    ----------
    Assumed. The river goes on as a plane jet: its half-width w grows linearly with the distance s from the mouth, its
    speed in the middle falls with the root of that.

    Examples
    --------
    A river that flows north past the berth, at 1/e a half-width beside its middle:

    >>> berth = HarbourParameters(river_speed=0.5, river_spread=0.0)
    >>> [round(local_current(0.0, y, 0.0, 0.0, harbour=berth)[0], 3) for y in (0.0, 60.0)]
    [0.5, 0.184]
    """
    # Near the berth only the part of the tide along the channel remains, reduced by the shelter.
    near = _near(x, y, harbour.tide_reach)
    c = cos(harbour.channel)
    s = sin(harbour.channel)
    along = (1.0 - harbour.tide_shelter) * (north * c + east * s)
    # Position relative to the mouth, along and across the river.
    c_river = cos(harbour.river_to)
    s_river = sin(harbour.river_to)
    x_mouth = x - harbour.river_x
    y_mouth = y - harbour.river_y
    ahead = x_mouth * c_river + y_mouth * s_river
    across = y_mouth * c_river - x_mouth * s_river
    # Plane jet: the half-width grows linearly, and the speed on the axis falls with its root
    # (momentum is constant).
    width = 1.0 + harbour.river_spread * maximum(ahead, 0.0) / harbour.river_width
    river = (
        harbour.river_speed / sqrt(width) * exp(-((across / (width * harbour.river_width)) ** 2))
    )
    # Between open sea and channel the tide changes with the distance; the river is added.
    return (
        north + near * (along * c - north) + river * c_river,
        east + near * (along * s - east) + river * s_river,
    )


def _near(x, y, reach):
    """1 at the berth, 1/e at the distance `reach`. [1]"""
    return exp(-(x * x + y * y) / (reach * reach))
