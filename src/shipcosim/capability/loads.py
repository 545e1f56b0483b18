"""Loads of DNV-ST-0111 Level 1 on a ship at rest: wind, current, wave drift; y to starboard.

The standard's axes have y to port and z up; weather from starboard (90 deg) pushes to port, so Y is negative here.
Moments are about the ship's origin. No dynamic factor is in them.
"""

import numpy as np
from numpy.typing import NDArray

from shipcosim.capability.conditions import Condition
from shipcosim.capability.particulars import Hull
from shipcosim.models.core.constants import GRAVITY

AIR_DENSITY = 1.226  # kg/m3, kg/m3; the standard does not say its g, 9.81 m/s2 is taken
WATER_DENSITY = 1026.0


def level_1_parts(hull: Hull, condition: Condition, weather_from: NDArray) -> dict[str, NDArray]:
    """Mean loads X, Y, N by source, ``"wind"``, ``"current"``, ``"waves"``; weather clockwise from the bow in rad."""
    return {
        "wind": wind(hull, condition.wind_speed, weather_from),
        "current": current(hull, condition.current_speed, weather_from),
        "waves": waves(hull, condition, weather_from),
    }


def wind(hull: Hull, speed: float, wind_from: NDArray) -> NDArray:
    """Load of the wind, 10 m above the sea.

    Parameters
    ----------
    hull : Hull
    speed : float
        [m/s]
    wind_from : (n,) array
        Clockwise from the bow. [rad]

    Returns
    -------
    (n, 3) array
        X, Y, N. [N, N, N.m]
    """
    # Dynamic pressure, q = ρ V² / 2.
    q = 0.5 * AIR_DENSITY * speed**2
    # The side force acts ahead of the side area's centre in head wind, behind it in following wind:
    # the moment follows from this lever.
    lever = hull.wind_centre_x + 0.3 * _ahead(wind_from) * hull.length
    # X = -0.7 q A_front cos, Y = 0.9 q A_side sin (to port in the standard's axes).
    across = q * hull.wind_area_side * 0.9 * np.sin(wind_from)
    return _load(hull, -0.7 * q * hull.wind_area_front * np.cos(wind_from), across, lever)


def current(hull: Hull, speed: float, current_from: NDArray) -> NDArray:
    """Load of the current. Parameters and returns as `wind`."""
    # As the wind: q with the density of water, and the lever limited to -0.2 L … 0.25 L.
    q = 0.5 * WATER_DENSITY * speed**2
    lever = hull.current_centre_x + np.clip(0.4 * _ahead(current_from), -0.2, 0.25) * hull.length
    # X = -0.07 q B T cos (a slender hull), Y = 0.6 q A_side sin.
    across = q * hull.current_area_side * 0.6 * np.sin(current_from)
    return _load(
        hull, -0.07 * q * hull.breadth * hull.draught * np.cos(current_from), across, lever
    )


def waves(hull: Hull, condition: Condition, waves_from: NDArray) -> NDArray:
    """Mean wave drift load.

    Parameters
    ----------
    hull : Hull
    condition : Condition
        With Hs and Tp.
    waves_from : (n,) array
        Clockwise from the bow. [rad]

    Returns
    -------
    (n, 3) array
        X, Y, N. [N, N, N.m]
    """
    # Drift force grows with Hs²: a second-order load.
    q = 0.5 * WATER_DENSITY * GRAVITY * condition.wave_height**2 * 0.09
    # The angle from the bow, the same on both sides, since the hull is symmetric.
    turned = _turned(waves_from)
    period = condition.zero_crossing_period
    # The blunter the end that meets the waves, the more it reflects. From bow to stern the
    # coefficient is linear in the angle.
    bow = 0.8 * hull.bow_angle**0.45
    stern = 0.7 * np.clip(hull.waterplane_aft, 0.85, 1.15) ** 2
    shape = bow + turned / np.pi * (stern - bow)
    # Along-ship factor of the direction: -1 about head seas, +1 about following seas.
    course = 0.05 + 0.95 * np.arctan(1.45 * (turned - 1.75))
    # Waves much longer than the ship lift her without drift: the factor depends on period over ship
    # size.
    along = q * hull.breadth * shape * course * _short(period / (0.9 * hull.length**0.33))
    across = (
        q
        * hull.submerged_length
        * np.sin(waves_from)
        * _short(period / (0.75 * np.sqrt(hull.breadth)))
    )
    # The side force moves aft as the waves come from further aft.
    lever = hull.submerged_centre_x + (0.05 - 0.14 * turned / np.pi) * hull.submerged_length
    return _load(hull, along, across, lever)


def _turned(angle: NDArray) -> NDArray:
    """The standard's `dir`: from the bow, 0 to π on both sides."""
    # Fold the full circle onto 0 to π.
    angle = angle % (2.0 * np.pi)
    return np.minimum(angle, 2.0 * np.pi - angle)


def _ahead(angle: NDArray) -> NDArray:
    """Linear factor of the direction: 1 from ahead, -1 from astern."""
    return 1.0 - 2.0 * _turned(angle) / np.pi


def _short(period: float) -> float:
    """Share of the drift force in waves of a period over that of the ship: long waves carry her."""
    return 1.0 if period < 1.0 else period**-3.0 * np.exp(1.0 - period**-3.0)


def _load(hull: Hull, along: NDArray, to_port: NDArray, lever: NDArray) -> NDArray:
    """Load of a force ahead and one to port that acts `lever` ahead of midship."""
    # From the standard's axes (y to port) to ours (y to starboard); the moment is about the ship's
    # origin.
    return np.stack([along, -to_port, -(hull.midship_x + lever) * to_port], axis=-1)
