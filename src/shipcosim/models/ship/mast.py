"""Wind at an anemometer on a mast, and the wind on the ship that it implies.

References
----------
Definition; power law of the wind's profile as in DNV-RP-C205, section 2.3.
"""

from dataclasses import dataclass
from functools import cached_property

from shipcosim.models.core.maths import Arithmetic, atan2, cos, hypot, sin
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity, required

REFERENCE_HEIGHT = 10.0
"""Height above the water to which wind speeds and wind loads refer. [m]"""


@dataclass(frozen=True, kw_only=True)
class MastParameters:
    """Place of the anemometer."""

    mast_x: float = required("m", "anemometer forward of the origin")
    mast_y: float = required("m", "anemometer to starboard of the origin")
    mast_height: float = required("m", "anemometer above the water", minimum=1.0)
    wind_exponent: float = quantity(
        0.12,
        "1",
        "exponent of the wind's profile over height",
        "DNV-RP-C205, open sea, from memory",
        minimum=0.0,
    )

    @cached_property
    def gain(self):
        """Wind speed at the anemometer over that at 10 m."""
        return (self.mast_height / REFERENCE_HEIGHT) ** self.wind_exponent


def wind_at_mast(
    speed: Arithmetic,
    wind_from: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    *,
    mast: MastParameters,
) -> Vector:
    """Apparent wind components at the anemometer, for an apparent wind at 10 m above the origin.

    Parameters
    ----------
    speed : float or (...) array or tensor
        Apparent wind speed at 10 m above the origin. [m/s]
    wind_from : like speed
        Direction it comes from, clockwise from the bow. [rad]
    u, v, r : like speed
        Velocity over ground in body axes. [m/s, m/s, rad/s]
    mast : MastParameters
        Where the anemometer stands.

    Returns
    -------
    tuple of two, like speed
        From ahead and from starboard. [m/s, m/s]

    Examples
    --------
    A ship that turns to starboard in calm air has wind from starboard at a mast before her origin:

    >>> mast = MastParameters(mast_x=4.0, mast_y=0.0, mast_height=10.0)
    >>> wind_at_mast(0.0, 0.0, 0.0, 0.0, 0.1, mast=mast)
    (0.0, 0.4)
    """
    # Power law of the profile: true wind grows by the gain, but not the part that is the ship's own
    # velocity.
    gain = mast.gain
    more = gain - 1.0
    # Components of where the wind comes from; yaw moves the mast through the air.
    return (
        gain * speed * cos(wind_from) - more * u - r * mast.mast_y,
        gain * speed * sin(wind_from) - more * v + r * mast.mast_x,
    )


def wind_from_mast(
    speed: Arithmetic,
    wind_from: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    *,
    mast: MastParameters,
) -> Vector:
    """Apparent wind at 10 m above the origin, for an apparent wind at the anemometer.

    The inverse of `wind_at_mast`.

    Parameters
    ----------
    speed : float or (...) array or tensor
        Apparent wind speed at the anemometer. [m/s]
    wind_from : like speed
        Direction it comes from, clockwise from the bow. [rad]
    u, v, r : like speed
        Velocity over ground in body axes. [m/s, m/s, rad/s]
    mast : MastParameters
        Where the anemometer stands.

    Returns
    -------
    tuple of two, like speed
        Speed and direction at 10 m above the origin. [m/s, rad in [-π, π]]
    """
    # `wind_at_mast` solved for the wind at 10 m.
    gain = mast.gain
    more = gain - 1.0
    share = 1.0 / gain
    ahead = share * (speed * cos(wind_from) + more * u + r * mast.mast_y)
    starboard = share * (speed * sin(wind_from) + more * v - r * mast.mast_x)
    return hypot(ahead, starboard), atan2(starboard, ahead)
