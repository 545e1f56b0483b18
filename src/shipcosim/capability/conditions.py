"""The weather of the DP capability numbers, and the directions that it comes from.

They are those of DNV-ST-0111 (December 2021), table 2-1, from memory and as a public student repository has them.
"""

from dataclasses import dataclass

import numpy as np

PEAK_OVER_ZERO_CROSSING = 1.4049
"""Tp / Tz of a Pierson-Moskowitz sea."""

DYNAMIC_FACTOR = 1.25
"""Factor on the mean loads for everything that a static balance leaves out."""

BOW_SECTOR = np.pi / 6.0
"""A and C of the notation look at weather from within this angle of the bow. [rad]"""

DIRECTIONS = np.radians(np.arange(0.0, 360.0, 10.0))
"""Directions that the weather comes from, clockwise from the bow. [rad]"""


@dataclass(frozen=True)
class Condition:
    """The weather of a DP capability number; wind, waves and current come from the same direction.

    Attributes
    ----------
    number : int
        DP capability number.
    wind_speed, wave_height, wave_period, current_speed : float
        Mean wind, significant wave height Hs, peak period Tp, current. [m/s, m, s, m/s]
    """

    number: int
    wind_speed: float
    wave_height: float
    wave_period: float
    current_speed: float

    @property
    def zero_crossing_period(self) -> float:
        """Zero-up-crossing period Tz. [s]"""
        return self.wave_period / PEAK_OVER_ZERO_CROSSING


CONDITIONS = (
    Condition(1, 1.5, 0.1, 3.5, 0.25),
    Condition(2, 3.4, 0.4, 4.5, 0.5),
    Condition(3, 5.4, 0.8, 5.5, 0.75),
    Condition(4, 7.9, 1.3, 6.5, 0.75),
    Condition(5, 10.7, 2.1, 7.5, 0.75),
    Condition(6, 13.8, 3.1, 8.5, 0.75),
    Condition(7, 17.1, 4.2, 9.0, 0.75),
    Condition(8, 20.7, 5.7, 10.0, 0.75),
    Condition(9, 24.4, 7.4, 10.5, 0.75),
    Condition(10, 28.4, 9.5, 11.5, 0.75),
    Condition(11, 32.6, 12.1, 12.0, 0.75),
)
"""Conditions of the DP capability numbers 1 to 11, the lowest first."""
