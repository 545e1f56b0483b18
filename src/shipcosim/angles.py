"""Angles between half a turn to either side: of models in rad, and of measured series in any unit of angle."""

from math import floor, pi
from typing import Any

import numpy as np

TURN = 2.0 * pi
"""A full turn. [rad]"""


def wrap(angle: Any) -> Any:
    """Wrap an angle into [-π, π); an angle that lies there already comes back unchanged.

    Parameters
    ----------
    angle : float or (...) array or tensor
        Angle. [rad]

    Returns
    -------
    like angle
        In [-π, π). [rad]

    References
    ----------
    Definition: the smallest signed angle, ssa, of Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control,
    2nd ed., Wiley, 2021.

    Examples
    --------
    >>> round(wrap(-pi / 2.0), 6), round(wrap(1.5 * pi), 6), wrap(pi) == -pi
    (-1.570796, -1.570796, True)
    """
    if isinstance(angle, float):
        if -pi <= angle < pi:
            return angle
        return angle - TURN * float(floor((angle + pi) / TURN))
    turns = (angle + pi) / TURN
    return angle - TURN * (turns.floor() if hasattr(turns, "floor") else np.floor(turns))


def wrap_series(angle: Any, turn: float = 360.0) -> Any:
    """Wrap angles into [-turn/2, turn/2), by NumPy's remainder.

    `wrap` leaves an angle within its range as it is; here every angle is rounded by the remainder alike.

    Parameters
    ----------
    angle : float or (...) array
        Angle. [deg, or the unit of turn]
    turn : float
        A full turn. [deg, or the unit of angle]

    Returns
    -------
    like angle
        In [-turn/2, turn/2). [deg, or the unit of turn]

    References
    ----------
    Definition.

    Examples
    --------
    >>> float(wrap_series(270.0)), float(wrap_series(-180.0))
    (-90.0, -180.0)
    """
    half = 0.5 * turn
    return np.mod(angle + half, turn) - half


def unwrap_series(angle: np.ndarray) -> np.ndarray:
    """Angles without jumps of a full turn from one known sample to the next.

    Parameters
    ----------
    angle : (n,) array
        Angle, NaN where it is not known. [rad]

    Returns
    -------
    (n,) array
        Angle, NaN as before. [rad]

    References
    ----------
    Definition.

    Examples
    --------
    >>> unwrap_series(np.array([3.0, np.nan, -3.0])).round(2).tolist()
    [3.0, nan, 3.28]
    """
    unwrapped = np.array(angle, float)
    is_finite = np.isfinite(angle)
    unwrapped[is_finite] = np.unwrap(unwrapped[is_finite])
    return unwrapped


def compass(degrees: float) -> str:
    """A direction as it is read off a compass: three digits from 000 to 359, with a decimal where there is one.

    Parameters
    ----------
    degrees : float
        Direction, clockwise from north. [deg]

    Returns
    -------
    str
        In deg.

    References
    ----------
    Three-figure notation of courses and bearings: Bowditch, The American Practical Navigator, NGA, 2019.

    Examples
    --------
    >>> compass(45.0), compass(-90.0), compass(359.97), compass(7.25)
    ('045', '270', '000', '007.2')
    """
    text = f"{round(degrees % 360.0, 1) % 360.0:05.1f}"
    return text.removesuffix(".0")
