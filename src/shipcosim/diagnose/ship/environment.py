"""Current, wave drift and line that act on the ship: neutral unless a cause acts."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.parameters import quantity, required

_NEUTRAL = "neutral"
_SWELLS = 8
_DRIFT_ARM = -1.5  # m, of a research vessel by VERES
_OF_LENGTH = 33.9


def _swell(k: int) -> Any:
    """What wave drift swells by about one of some places in the log, evenly spaced from its first to its last row."""
    means = f"by what share the drift swells at place {k} of {_SWELLS} along the log"
    return quantity(0.0, "1", means, "groups of waves over minutes, assumed", tolerance=0.15)


@dataclass(frozen=True, kw_only=True)
class Water:
    """What moves the water, and what else pulls at the ship from the earth."""

    current_north: float = quantity(0.0, "m/s", "current towards north", _NEUTRAL)
    current_east: float = quantity(0.0, "m/s", "current towards east", _NEUTRAL)
    north_start: float = quantity(0.0, "m/s", "varying current towards north, first row", _NEUTRAL)
    east_start: float = quantity(0.0, "m/s", "varying current towards east, first row", _NEUTRAL)
    north_end: float = quantity(0.0, "m/s", "varying current towards north, last row", _NEUTRAL)
    east_end: float = quantity(0.0, "m/s", "varying current towards east, last row", _NEUTRAL)
    trend_north: float = quantity(
        0.0, "m/s", "what a current towards north grows by from first to last row", _NEUTRAL
    )
    trend_east: float = quantity(
        0.0, "m/s", "what a current towards east grows by from first to last row", _NEUTRAL
    )
    drift_north: float = quantity(0.0, "N", "mean wave drift on the beam, towards north", _NEUTRAL)
    drift_east: float = quantity(0.0, "N", "mean wave drift on the beam, towards east", _NEUTRAL)
    drift_surge_share: float = quantity(
        1.0 / 3.0,
        "1",
        "wave drift in surge over that on the beam",
        "VERES, 33.9 m hull",
        tolerance=0.1,
    )
    drift_sway_power: float = quantity(
        2.0,
        "1",
        "power of the sine in the sway of the drift",
        "short waves; VERES, 33.9 m hull: 1.7",
        tolerance=0.6,
    )
    drift_yaw_arm: float = required(
        "m", "yaw moment of the drift at quartering over the force on the beam", share=1.0 / 3.0
    )
    drift_swell_1: float = _swell(1)
    drift_swell_2: float = _swell(2)
    drift_swell_3: float = _swell(3)
    drift_swell_4: float = _swell(4)
    drift_swell_5: float = _swell(5)
    drift_swell_6: float = _swell(6)
    drift_swell_7: float = _swell(7)
    drift_swell_8: float = _swell(8)
    tow_north: float = quantity(0.0, "N", "pull of a line towards north", _NEUTRAL)
    tow_east: float = quantity(0.0, "N", "pull of a line towards east", _NEUTRAL)
    tow_x: float = required("m", "where the line is made fast")


def water_of(length: float) -> Water:
    """What surrounds a ship of some length [m] while nothing acts.

    A line would be made fast at her stern, assumed, to half a metre.
    """
    return Water(
        tow_x=-0.5 * (round(length) or length), drift_yaw_arm=_DRIFT_ARM * length / _OF_LENGTH
    )


def share_of(time: Arithmetic, span: tuple[float, float]) -> Arithmetic:
    """How much of a log has passed at some times: 0 before its first row, 1 after its last."""
    first, last = span
    return np.clip((time - first) / (last - first), 0.0, 1.0)


def piecewise_linear_basis(share: Arithmetic, count: int) -> np.ndarray:
    """Piecewise linear basis functions of the share of a log that has passed: (count, ...) array.

    Each is 1 at its own of evenly spaced places and 0 at the others.
    """
    places = np.arange(count).reshape(-1, *[1] * np.ndim(share))
    return np.clip(1.0 - np.abs(np.asarray(share) * (count - 1) - places), 0.0, None)


def swell_of(time: Arithmetic, span: tuple[float, float], water: Water) -> Arithmetic:
    """The drift over its mean, piecewise linear between the places where it swells.

    Parameters
    ----------
    time : array
        [s]
    span : (float, float)
        First and last row of the log. [s]
    water : Water

    Returns
    -------
    array or float
        1 where nothing swells.
    """
    # Mean plus piecewise linear deviations; without any the factor is 1.
    swells = [getattr(water, f"drift_swell_{k}") for k in range(1, _SWELLS + 1)]
    if not np.any(swells):
        return 1.0
    return 1.0 + sum(
        swell * hat
        for swell, hat in zip(
            swells, piecewise_linear_basis(share_of(time, span), _SWELLS), strict=True
        )
    )
