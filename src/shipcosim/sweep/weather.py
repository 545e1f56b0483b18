"""Weather of the static capability as levels: directions around the ship, numbered conditions."""

from __future__ import annotations

import math
from collections.abc import Iterable

from shipcosim.capability.conditions import CONDITIONS

COMPONENT = "environment"
"""Whose wind, waves and current are set."""
NUMBERS = tuple(condition.number for condition in CONDITIONS)

StartValues = dict[str, float]


def directions(count: int) -> dict[float, StartValues]:
    """Start values by the direction that wind, waves and current come from, clockwise from north. [deg]

    Parameters
    ----------
    count : int
        Evenly spaced, the first from north.

    Examples
    --------
    >>> list(directions(4))
    [0.0, 90.0, 180.0, 270.0]
    """
    angles = [360.0 * k / count for k in range(count)]
    return {angle: _from(math.radians(angle)) for angle in angles}


def _from(angle: float) -> StartValues:
    # A current is given by where it flows to, wind and waves by where they come from.
    towards = (angle + math.pi) % (2.0 * math.pi)
    return {
        f"{COMPONENT}.wind_from": angle,
        f"{COMPONENT}.waves_from": angle,
        f"{COMPONENT}.current_to": towards,
    }


def conditions(numbers: Iterable[int]) -> dict[int, StartValues]:
    """Start values by the DP capability number whose wind, waves and current they are.

    Parameters
    ----------
    numbers : iterable of int
        Of `NUMBERS`.

    Examples
    --------
    >>> conditions([4])[4]["environment.significant_wave_height"]
    1.3
    """
    known = {condition.number: condition for condition in CONDITIONS}
    found = {}
    for number in numbers:
        weather = known[number]
        found[number] = {
            f"{COMPONENT}.wind_speed": weather.wind_speed,
            f"{COMPONENT}.significant_wave_height": weather.wave_height,
            f"{COMPONENT}.peak_period": weather.wave_period,
            f"{COMPONENT}.current_speed": weather.current_speed,
        }
    return found
