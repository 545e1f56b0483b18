"""What surrounds the ship, and what is between her and her log: neutral unless a cause acts."""

from dataclasses import dataclass

from shipcosim.models.hull import HullParameters
from shipcosim.models.quantity import quantity

__all__ = ["Instruments", "Water", "drift_arm_of", "stern_of"]

_NEUTRAL = "neutral"
_STERN = -17.0  # m, of the lengthened Gunnerus
_DRIFT_ARM = -1.5  # m, of the same


def stern_of(length):
    """Where a line is made fast on a ship of some length, forward of the origin: the stern, assumed. [m]"""
    return _STERN if length == HullParameters().length else -0.5 * length


def drift_arm_of(length):
    """Yaw moment of the wave drift at quartering over the force on the beam, for a ship of some length. [m]"""
    return _DRIFT_ARM * length / HullParameters().length


@dataclass(frozen=True)
class Water:
    """What moves the water, and what else pulls at the ship from the earth."""

    current_north: float = quantity(0.0, "m/s", "current towards north", _NEUTRAL)
    current_east: float = quantity(0.0, "m/s", "current towards east", _NEUTRAL)
    north_start: float = quantity(0.0, "m/s", "varying current towards north, first row", _NEUTRAL)
    east_start: float = quantity(0.0, "m/s", "varying current towards east, first row", _NEUTRAL)
    north_end: float = quantity(0.0, "m/s", "varying current towards north, last row", _NEUTRAL)
    east_end: float = quantity(0.0, "m/s", "varying current towards east, last row", _NEUTRAL)
    trend_north: float = quantity(0.0, "m/s", "what a current towards north grows by from first to last row", _NEUTRAL)
    trend_east: float = quantity(0.0, "m/s", "what a current towards east grows by from first to last row", _NEUTRAL)
    drift_north: float = quantity(0.0, "N", "mean wave drift on the beam, towards north", _NEUTRAL)
    drift_east: float = quantity(0.0, "N", "mean wave drift on the beam, towards east", _NEUTRAL)
    drift_surge_share: float = quantity(
        1.0 / 3.0, "1", "wave drift in surge over that on the beam", "VERES, 33.9 m hull", tolerance=0.1
    )
    drift_yaw_arm: float = quantity(
        _DRIFT_ARM,
        "m",
        "yaw moment of the drift at quartering over the force on the beam",
        "VERES, 33.9 m hull",
        tolerance=0.5,
    )
    tow_north: float = quantity(0.0, "N", "pull of a line towards north", _NEUTRAL)
    tow_east: float = quantity(0.0, "N", "pull of a line towards east", _NEUTRAL)
    tow_x: float = quantity(_STERN, "m", "where the line is made fast", "the stern")


@dataclass(frozen=True)
class Instruments:
    """What is between the ship and her log."""

    heading_bias: float = quantity(0.0, "rad", "measured heading minus the true one", _NEUTRAL)
    lever_x: float = quantity(0.0, "m", "antenna forward of the origin", _NEUTRAL)
    lever_y: float = quantity(0.0, "m", "antenna to starboard of the origin", _NEUTRAL)
    velocity_scale: float = quantity(1.0, "1", "logged over true velocity", _NEUTRAL)
    navigation_lag: float = quantity(0.0, "s", "by how much the navigation's channels are late", _NEUTRAL)
    thruster_lag: float = quantity(0.0, "s", "by how much the thrusters' channels are late", _NEUTRAL)
    wind_lag: float = quantity(
        1.25, "s", "half the time over which the wind sensor averages", "2 to 3 s", tolerance=0.3
    )
