"""Measured motion of a ship with errors of antenna, compass, speed log or clock.

Position and velocity are those of the antenna; surge and sway are its velocity over ground resolved with the measured
heading.

References
----------
Definition.
"""

from dataclasses import dataclass

from shipcosim.angles import wrap
from shipcosim.models.core.kinematics import to_body, to_ned, velocity_at
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.parameters import quantity


@dataclass(frozen=True)
class InstrumentParameters:
    """Errors of the instruments."""

    heading_bias: float = quantity(0.0, "rad", "measured heading minus the true one", "neutral")
    lever_x: float = quantity(0.0, "m", "antenna forward of the origin", "neutral")
    lever_y: float = quantity(0.0, "m", "antenna to starboard of the origin", "neutral")
    velocity_scale: float = quantity(
        1.0, "1", "logged over true surge and sway", "neutral", minimum=0.01
    )
    lag: float = quantity(0.0, "s", "by how much all of it is late", "neutral", minimum=0.0)


def readings(
    x: Arithmetic,
    y: Arithmetic,
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    *,
    heading_bias: Arithmetic = 0.0,
    lever_x: Arithmetic = 0.0,
    lever_y: Arithmetic = 0.0,
    velocity_scale: Arithmetic = 1.0,
) -> Motion:
    """Motion as the instruments measure it, without noise.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        True position of the origin, heading. [m, m, rad]
    u, v, r : like x
        True velocity of the origin over ground in body axes, yaw rate. [m/s, m/s, rad/s]
    heading_bias, lever_x, lever_y, velocity_scale : like x
        As in `InstrumentParameters`. [rad, m, m, 1]

    Returns
    -------
    Motion
        Measured position of the antenna, heading, and velocity of the antenna resolved with the measured heading.

    Examples
    --------
    Ahead at 5 m/s with a compass that shows 90 deg too much, the ship seems to slip to port:

    >>> from math import pi
    >>> [round(value, 3) for value in readings(0.0, 0.0, 0.0, 5.0, 0.0, 0.0, heading_bias=pi / 2)]
    [0.0, 0.0, 1.571, 0.0, -5.0, 0.0]
    """
    # Position and velocity at the antenna, by its lever arm.
    north, east = to_ned(psi, lever_x, lever_y)
    u, v = velocity_at(lever_x, lever_y, u, v, r)
    # The log resolves the velocity with the measured heading: turned by its bias.
    u, v = to_body(heading_bias, velocity_scale * u, velocity_scale * v)
    return Motion(x + north, y + east, wrap(psi + heading_bias), u, v, r)


def true_motion(
    x: Arithmetic,
    y: Arithmetic,
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    *,
    heading_bias: Arithmetic = 0.0,
    lever_x: Arithmetic = 0.0,
    lever_y: Arithmetic = 0.0,
    velocity_scale: Arithmetic = 1.0,
) -> Motion:
    """True motion for a measured one, the inverse of `readings`: for runs from a logged state.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Logged position and heading. [m, m, rad]
    u, v, r : like x
        Logged velocity and yaw rate. [m/s, m/s, rad/s]
    heading_bias, lever_x, lever_y, velocity_scale : like x
        As in `InstrumentParameters`. [rad, m, m, 1]

    Returns
    -------
    Motion
        True position, heading and velocity of the origin.
    """
    # Undo the steps of `readings` in reverse order.
    psi = wrap(psi - heading_bias)
    u, v = to_ned(heading_bias, u / velocity_scale, v / velocity_scale)
    u, v = velocity_at(-lever_x, -lever_y, u, v, r)
    north, east = to_ned(psi, lever_x, lever_y)
    return Motion(x - north, y - east, psi, u, v, r)


def history_with(
    history: tuple[tuple[float, Motion], ...], t: float, values: Motion, since: float
) -> tuple[tuple[float, Motion], ...]:
    """History of a motion with a new entry, without entries older than needed.

    Parameters
    ----------
    history : tuple of (float, Motion)
        Times and motions, in the order of time. [s]
    t : float
        Time of the new entry. [s]
    values : Motion
        The new entry.
    since : float
        Earliest time that will still be asked for. [s]

    Returns
    -------
    tuple of (float, Motion)
        The new history. [s]
    """
    # Keep one entry before the earliest time, for the interpolation.
    first = next((number for number, (time, _) in enumerate(history) if time > since), len(history))
    return (*history[max(first - 1, 0) :], (t, values))


def motion_at(history: tuple[tuple[float, Motion], ...], t: float) -> Motion:
    """Motion at a time in its history: linear between entries, headings the shorter way.

    Before the first entry the motion is that of the first; after the last it is extrapolated from the last two, because
    an FMU that outputs values at the end of its step has inputs of its start.

    Parameters
    ----------
    history : tuple of (float, Motion)
        Times and motions, in the order of time, not empty. [s]
    t : float
        Time. [s]

    Returns
    -------
    Motion
        Motion at t.

    Examples
    --------
    >>> at_0, at_2 = Motion(0.0, 0.0, 3.1, 0.0, 0.0, 0.0), Motion(4.0, 0.0, -3.1, 0.0, 0.0, 0.0)
    >>> half_way = motion_at(((0.0, at_0), (2.0, at_2)), 1.0)
    >>> half_way.x, round(half_way.psi, 3)
    (2.0, -3.142)
    """
    # The first entry at or after t; beyond the last the last two extrapolate.
    later = next(
        (number for number, (time, _) in enumerate(history) if time >= t), len(history) - 1
    )
    (t_0, a) = history[max(later - 1, 0)]
    (t_1, b) = history[later]
    # A share below 0 (before the first entry) becomes 0.
    share = max((t - t_0) / (t_1 - t_0), 0.0) if t_1 > t_0 else 1.0
    between = [p + share * (q - p) for p, q in zip(a, b, strict=True)]
    # The heading interpolates along the shorter arc.
    between[2] = wrap(a.psi + share * wrap(b.psi - a.psi))
    return Motion(*between)
