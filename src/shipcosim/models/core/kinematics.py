"""Kinematics in the horizontal plane: north-east-down and body frame (x forward, y starboard).

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 2.
"""

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, clip, sincos
from shipcosim.models.core.motion import Load, Triple, Vector


def to_ned(psi: Arithmetic, forward: Arithmetic, starboard: Arithmetic) -> Vector:
    """Components in north and east of a vector given in body axes, R(ψ) of the horizontal plane.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    forward, starboard : like psi
        Components in body axes. [any unit]

    Returns
    -------
    tuple of two, like psi
        North and east components. [the unit of forward]
    """
    s, c = sincos(psi)
    return c * forward - s * starboard, s * forward + c * starboard


def to_body(psi: Arithmetic, north: Arithmetic, east: Arithmetic) -> Vector:
    """Components in body axes of a vector given in north and east, R(ψ)ᵀ of the horizontal plane.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    north, east : like psi
        Components in the earth-fixed frame. [any unit]

    Returns
    -------
    tuple of two, like psi
        Components forward and to starboard. [the unit of north]

    Examples
    --------
    A current to the east pushes a ship that heads north to starboard:

    >>> to_body(0.0, 0.0, 0.5)
    (0.0, 0.5)
    """
    s, c = sincos(psi)
    return c * north + s * east, c * east - s * north


def eta_dot(psi: Arithmetic, u: Arithmetic, v: Arithmetic, r: Arithmetic) -> Triple:
    """Rate of position and heading, η̇ = R(ψ) ν.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    u, v, r : like psi
        Velocity in body axes. [m/s, m/s, rad/s]

    Returns
    -------
    tuple of three, like psi
        Rates of x, y, psi. [m/s, m/s, rad/s]

    Examples
    --------
    Heading east, surge moves the ship east:

    >>> import math
    >>> [round(rate, 3) for rate in eta_dot(math.pi / 2, 1.0, 0.0, 0.0)]
    [0.0, 1.0, 0.0]
    """
    x_dot, y_dot = to_ned(psi, u, v)
    return x_dot, y_dot, r


def velocity_at(
    x: Arithmetic, y: Arithmetic, u: Arithmetic, v: Arithmetic, r: Arithmetic
) -> Vector:
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


def load_at(x: Arithmetic, y: Arithmetic, X: Arithmetic, Y: Arithmetic) -> Load:
    """Load about the origin of a force that acts at a point fixed to the ship.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        The point, forward and to starboard of the origin. [m]
    X, Y : like x
        Force forward and to starboard. [N]

    Returns
    -------
    tuple of three, like x
        X, Y, N about the origin. [N, N, N.m]
    """
    return X, Y, x * Y - y * X


def moved(value: Arithmetic, wanted: Arithmetic, most: Arithmetic) -> Arithmetic:
    """Value after a step towards a wanted one.

    Parameters
    ----------
    value, wanted : float or (...) array or tensor
        Present and wanted value. [any unit]
    most : like value
        Largest step. [the unit of value]

    Returns
    -------
    like value
        [the unit of value]
    """
    return value + clip(wanted - value, -most, most)


def turned(angle: Arithmetic, wanted: Arithmetic, most: Arithmetic) -> Arithmetic:
    """Direction after turning towards a wanted one the shorter way.

    Parameters
    ----------
    angle, wanted : float or (...) array or tensor
        Present and wanted direction. [rad]
    most : like angle
        Largest turn. [rad]

    Returns
    -------
    like angle
        In [-π, π). [rad]

    References
    ----------
    Definition.

    Examples
    --------
    From 170 deg to -170 deg the way is 20 deg, not 340:

    >>> import math
    >>> round(math.degrees(turned(math.radians(170.0), math.radians(-170.0), math.radians(5.0))), 6)
    175.0
    """
    return wrap(angle + clip(wrap(wanted - angle), -most, most))
