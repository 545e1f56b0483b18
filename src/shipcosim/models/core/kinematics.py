"""Frames: north-east-down and body (x forward, y to starboard), in the horizontal plane."""

from shipcosim.models.core.maths import sincos


def to_ned(psi, forward, starboard):
    """A vector given in body axes, in north and east.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    forward, starboard : like psi
        Components in body axes. [any unit]

    Returns
    -------
    tuple of two, like psi
        North and east components. [same unit]
    """
    s, c = sincos(psi)
    return c * forward - s * starboard, s * forward + c * starboard


def to_body(psi, north, east):
    """A vector given in north and east, in body axes.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    north, east : like psi
        Components in the earth-fixed frame. [any unit]

    Returns
    -------
    tuple of two, like psi
        Components forward and to starboard. [same unit]

    Examples
    --------
    A current to the east pushes a ship that heads north to starboard:

    >>> to_body(0.0, 0.0, 0.5)
    (0.0, 0.5)
    """
    s, c = sincos(psi)
    return c * north + s * east, c * east - s * north


def eta_dot(psi, u, v, r):
    """Rate of position and heading, η̇ = R(ψ) ν.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    u, v, r : like psi
        Body velocity. [m/s, m/s, rad/s]

    Returns
    -------
    tuple of three, like psi
        Rates of x, y, psi. [m/s, m/s, rad/s]

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control,
    2nd ed., Wiley, 2021, ch. 2.

    Examples
    --------
    Heading east, surge moves the ship east:

    >>> import math
    >>> [round(rate, 3) for rate in eta_dot(math.pi / 2, 1.0, 0.0, 0.0)]
    [0.0, 1.0, 0.0]
    """
    x_dot, y_dot = to_ned(psi, u, v)
    return x_dot, y_dot, r


def velocity_at(x, y, u, v, r):
    """Velocity of a point fixed to the ship.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        The point, forward and to starboard of the origin. [m]
    u, v, r : like x
        Velocity of the origin and yaw rate. [m/s, m/s, rad/s]

    Returns
    -------
    tuple of two, like x
        Components forward and to starboard. [m/s]
    """
    return u - y * r, v + x * r


def load_at(x, y, X, Y):
    """A force at a point fixed to the ship as load about the origin.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        The point, forward and to starboard of the origin. [m]
    X, Y : like x
        Force forward and to starboard. [N]

    Returns
    -------
    tuple of three, like x
        Load about the origin. [N, N, N.m]
    """
    return X, Y, x * Y - y * X
