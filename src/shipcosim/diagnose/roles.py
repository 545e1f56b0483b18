"""Roles: what a channel of a measured log means, and the unit it has where its file states none."""

from dataclasses import dataclass

__all__ = ["NAVIGATION", "ROLES", "Role", "role_of"]


@dataclass(frozen=True)
class Role:
    """What a channel means.

    Parameters
    ----------
    unit : str
        Unit where the file states none.
    internal : str
        Unit in a table that was read: SI and rad; shaft speeds stay in rpm.
    meaning : str
        One line for readers.
    """

    unit: str
    internal: str
    meaning: str


ROLES = {
    "time": Role("s", "s", "time"),
    "north": Role("m", "m", "position of the antenna, local frame, northwards"),
    "east": Role("m", "m", "position of the antenna, local frame, eastwards"),
    "latitude": Role("deg", "rad", "latitude of the antenna (WGS 84)"),
    "longitude": Role("deg", "rad", "longitude of the antenna (WGS 84)"),
    "heading": Role("deg", "rad", "heading, clockwise from true north"),
    "surge": Role("m/s", "m/s", "velocity over ground of the antenna, forward"),
    "sway": Role("m/s", "m/s", "velocity over ground of the antenna, to starboard"),
    "yaw_rate": Role("deg/s", "rad/s", "rate of the heading"),
    "wind_speed": Role("m/s", "m/s", "apparent wind speed at the mast"),
    "wind_from": Role("deg", "rad", "direction the apparent wind comes from, clockwise from the bow"),
    "true_wind_speed": Role("m/s", "m/s", "wind speed over ground"),
    "true_wind_from": Role("deg", "rad", "direction the wind over ground comes from, clockwise from north"),
}
NAVIGATION = ("north", "east", "heading", "surge", "sway", "yaw_rate")

_THRUSTER = {
    "rpm": Role("rpm", "rpm", "shaft speed"),
    "azimuth": Role("deg", "rad", "direction of positive thrust, clockwise from the bow"),
    "thrust": Role("N", "N", "thrust along the unit's axis"),
}


def role_of(name: str) -> Role | None:
    """Role of that name, None where there is none.

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
    return _THRUSTER.get(quantity) if thruster else None
