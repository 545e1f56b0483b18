"""FMU of the ship: hull, wind and waves under the loads of whatever is connected."""

from shipcosim.interfaces import Ship


class Vessel(Ship):
    """Ship in surge, sway and yaw, in current, wind and waves."""
