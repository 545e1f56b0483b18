"""Slipstream of a thruster, which reduces the thrust of a neighbour in it."""

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, atan2, exp, pi, where


def slipstream_share(
    x: Arithmetic, y: Arithmetic, azimuth: Arithmetic, rpm: Arithmetic, *, width: Arithmetic
) -> Arithmetic:
    """Share of a thruster's slipstream at a point: exp(-(angle off its axis / width)²), at any distance.

    The slipstream goes opposite to the thrust: towards azimuth + π at positive shaft speed, towards azimuth at
    negative. A thruster whose shaft stands still has none.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        The point, forward and to starboard of the thruster. [m]
    azimuth, rpm : like x
        Direction of positive thrust, clockwise from the bow, and shaft speed. [rad, rpm]
    width : like x
        Angle off the axis at which 1/e is left. [rad]

    Returns
    -------
    like azimuth
        1 on the axis, towards 0 beside it. [1]

    References
    ----------
    The sector in which a slipstream meets a neighbour: DNV-ST-0111 and Dang and Laheij, Hydrodynamic aspects of
    steerable thrusters, Dynamic Positioning Conference 2004. That its edge is a Gaussian is assumed.

    Examples
    --------
    A unit that pushes to starboard throws its water at its neighbour to port, running astern it does not:

    >>> [slipstream_share(0.0, -4.0, pi / 2, rpm, width=0.35) for rpm in (100.0, 0.0)]
    [1.0, 0.0]
    >>> slipstream_share(0.0, -4.0, pi / 2, -100.0, width=0.35) < 1e-30
    True
    """
    # The water goes opposite to the thrust.
    towards = where(rpm > 0.0, azimuth + pi, azimuth)
    # Gaussian over the angle off the axis; a shaft at rest has no slipstream.
    angle = wrap(atan2(y, x) - towards) / width
    return where(rpm == 0.0, 0.0 * abs(angle), exp(-angle * angle))
