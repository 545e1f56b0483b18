"""A current that changes speed and direction during a run."""

from dataclasses import dataclass

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, atan2, clip, hypot, where
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity

_STILL = 1e-9  # m/s, below which a current has no direction


@dataclass(frozen=True)
class VaryingCurrentParameters:
    """A current at two times."""

    north_start: float = quantity(
        0.0, "m/s", "velocity of the water towards north until the start", "neutral"
    )
    east_start: float = quantity(
        0.0, "m/s", "velocity of the water towards east until the start", "neutral"
    )
    north_end: float = quantity(
        0.0, "m/s", "velocity of the water towards north from the end on", "neutral"
    )
    east_end: float = quantity(
        0.0, "m/s", "velocity of the water towards east from the end on", "neutral"
    )
    time_start: float = quantity(
        0.0, "s", "time from which on the current varies", "set by the system"
    )
    time_end: float = quantity(600.0, "s", "time until which it varies", "set by the system")


def varying_current(
    t: Arithmetic,
    north_start: Arithmetic,
    east_start: Arithmetic,
    north_end: Arithmetic,
    east_end: Arithmetic,
    *,
    time_start: float,
    time_end: float,
) -> Vector:
    """Current between two times: speed and direction are each linear in time, the direction turns the shorter way.

    Before the start and after the end it stays as it is there. Where one of the two currents has no speed, its
    direction is that of the other.

    Parameters
    ----------
    t : float or (...) array or tensor
        Time. [s]
    north_start, east_start, north_end, east_end : like t
        Velocity of the water at the start and at the end. [m/s]
    time_start, time_end : float
        Times of start and end; the end is later. [s]

    Returns
    -------
    tuple of two, like t
        Speed, and direction the current flows to, clockwise from north in [-π, π). [m/s, rad]

    References
    ----------
    Assumed: linear in speed and direction.

    Examples
    --------
    Half way from north to east at 0.4 m/s it flows north-east at 0.4 m/s:

    >>> from math import degrees
    >>> speed, to = varying_current(50.0, 0.4, 0.0, 0.0, 0.4, time_start=0.0, time_end=100.0)
    >>> round(speed, 6), round(degrees(to), 6)
    (0.4, 45.0)
    """
    # Share of the change that is done: 0 before the start, 1 after the end.
    share = clip((t - time_start) / (time_end - time_start), 0.0, 1.0)
    start = hypot(north_start, east_start)
    end = hypot(north_end, east_end)
    from_ = atan2(east_start, north_start)
    to = atan2(east_end, north_end)
    # Still water has no direction; take that of the other current, so it does not turn needlessly.
    from_, to = where(start < _STILL, to, from_), where(end < _STILL, from_, to)
    return start + share * (end - start), wrap(from_ + share * wrap(to - from_))
