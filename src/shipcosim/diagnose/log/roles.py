"""Roles: what a channel of a measured log means, and its unit."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Role:
    """What a channel means.

    Attributes
    ----------
    unit : str
        Unit in a log that was read, and in a file that states none.
    meaning : str
        One line for readers.
    """

    unit: str
    meaning: str

    @property
    def is_angle(self) -> bool:
        """Whether the values turn round the circle."""
        return self.unit == "deg"


ROLES = {
    "time": Role("s", "time"),
    "north": Role("m", "position of the antenna northwards, local frame"),
    "east": Role("m", "position of the antenna eastwards, local frame"),
    "latitude": Role("deg", "latitude of the antenna (WGS 84)"),
    "longitude": Role("deg", "longitude of the antenna (WGS 84)"),
    "heading": Role("deg", "heading, clockwise from true north"),
    "surge": Role("m/s", "velocity of the antenna over ground, forward"),
    "sway": Role("m/s", "velocity of the antenna over ground, to starboard"),
    "yaw_rate": Role("deg/s", "rate of the heading"),
    "wind_speed": Role("m/s", "apparent wind speed at the mast"),
    "wind_from": Role("deg", "direction the apparent wind comes from, clockwise from the bow"),
    "true_wind_speed": Role("m/s", "wind speed over ground"),
    "true_wind_from": Role(
        "deg", "direction the wind over ground comes from, clockwise from true north"
    ),
    "speed_over_ground": Role("m/s", "speed of the antenna over ground"),
    "course_over_ground": Role("deg", "direction the antenna moves, clockwise from true north"),
    "north_velocity": Role("m/s", "velocity of the antenna northwards"),
    "east_velocity": Role("m/s", "velocity of the antenna eastwards"),
}
OVER_EARTH = {"speed_over_ground", "course_over_ground", "north_velocity", "east_velocity"}
"""Roles that give surge and sway with the heading, and are none of the log that is read."""
NAVIGATION = ("north", "east", "heading", "surge", "sway", "yaw_rate")
POSITION = ("north", "east")
VELOCITY = ("surge", "sway")

THRUSTER_ROLES = {
    "rpm": Role("rpm", "shaft speed"),
    "azimuth": Role("deg", "direction of positive thrust, clockwise from the bow"),
    "thrust": Role("N", "thrust along the unit's axis"),
}
"""Roles of a thruster's channels, by what follows its name and a ``_``."""


def role_of(name: str) -> Role | None:
    """Role of a name, or None.

    Examples
    --------
    >>> role_of("surge").unit
    'm/s'
    >>> role_of("bow_azimuth").meaning
    'direction of positive thrust, clockwise from the bow'
    """
    if name in ROLES:
        return ROLES[name]
    thruster, _, quantity = name.rpartition("_")
    return THRUSTER_ROLES.get(quantity) if thruster else None
