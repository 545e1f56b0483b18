"""What a log's own channels say of a unit or a frame that nobody stated: the motion they tell must be the same one."""

from typing import Any

import numpy as np

from shipcosim.diagnose.numerics import running_sums

_SPEEDS = {"m/s": 1.0, "kn": 1852.0 / 3600.0, "km/h": 1.0 / 3.6, "cm/s": 0.01, "mm/s": 1e-3}
_RATES = {"deg/s": 1.0, "rad/s": 180.0 / np.pi, "deg/min": 1.0 / 60.0}
_FAR = 0.15  # by which a ratio may be off a unit's, as a logarithm: units of speed differ by 1.85
_ALIKE = 0.9  # correlation of two ways to tell a motion, from which on they are compared. Assumed.
_SPANS = (3, 10, 30, 100)  # rows
_LEAP = 3.0  # times what nine in ten changes stay below, from which on one is no motion. Assumed.
_CLEAR = (
    0.85  # length of the mean direction between course and bow that holds, that does not. Assumed.
)
_UNCLEAR = 0.6
_LEFT = 0.02  # share of the way that a velocity in its frame may leave unexplained. Assumed.
_CLEARER = 4.0  # times that of the best, which another frame leaves. Assumed.
_BESIDE = 60.0  # deg, by which a course may be off the bow throughout


def unit_of_speed(time: np.ndarray, way: np.ndarray, speed: np.ndarray) -> str | None:
    """Unit of a speed, from the distance between positions; None if they do not determine it.

    Parameters
    ----------
    time : (n,) array
        [s]
    way : (n,) complex array
        Position, north + i east. [m]
    speed : (n,) array
        In the unknown unit.
    """
    # Rows in which all channels have values; the distance made in k rows is the reference.
    rows = _all_known(time, way, speed)
    way = way[rows]
    unit, _ = _unit_by(time[rows], speed[rows], lambda k: np.abs(way[k:] - way[:-k]), _SPEEDS)
    return unit


def unit_and_sign_of_rate(
    time: np.ndarray, heading: np.ndarray, rate: np.ndarray
) -> tuple[str | None, int]:
    """Unit of a yaw rate, from the heading in degrees, and its sign; None and 0 if it does not determine them.

    Examples
    --------
    >>> t = np.arange(200.0)
    >>> unit_and_sign_of_rate(t, 30.0 * np.sin(t / 20), -np.radians(1.5 * np.cos(t / 20)))
    ('rad/s', -1)
    """
    rows = _all_known(time, heading, rate)
    if rows.sum() < 4 * _SPANS[0]:
        return None, 0
    # Unwrapped heading: its change over k rows is the reference.
    turned = np.unwrap(heading[rows], period=360.0)
    return _unit_by(time[rows], rate[rows], lambda k: turned[k:] - turned[:-k], _RATES)


def _all_known(*series):
    """Rows in which all of some series have a value."""
    return np.isfinite(series).all(axis=0)


def _unit_by(time, rate, change, units):
    """Unit in which the integral of a rate is the change over spans of some rows, and its sign; else None and 0."""
    steps = np.diff(time)
    if len(time) < 4 * _SPANS[0] or not (steps > 0.0).all():
        return None, 0
    # Integral of the reported rate by the trapezium rule.
    integral = running_sums(0.5 * (rate[1:] + rate[:-1]) * steps)
    best = 0.0
    ratio = sign = 0.0
    # Compare changes over several spans: short ones drown in noise,
    # long ones in drift. Keep the span of highest correlation.
    for k in _SPANS:
        if len(time) < 4 * k:
            break
        x, y = _without_leaps(integral[k:] - integral[:-k], change(k))
        norm = float(np.sqrt((x @ x) * (y @ y)))
        # The unit is the same where a rate is counted the other way.
        agreement = abs(x @ y)
        if norm > 0.0 and agreement / norm > max(best, _ALIKE):
            best = agreement / norm
            # Ratio of the energy to the cross product: slope of the inverse regression.
            ratio = (y @ y) / agreement
            sign = np.sign(x @ y)
    if not ratio:
        return None, 0
    # Nearest unit on a logarithmic scale; none if the ratio fits none of them.
    unit = min(units, key=lambda name: abs(np.log(ratio / units[name])))
    return (unit, int(sign)) if abs(np.log(ratio / units[unit])) < _FAR else (None, 0)


def _without_leaps(x, y):
    """Two kinds of changes without those that are far larger than most: start-up rows, and rows that were lost."""
    # Limits from a quantile, so that the leaps themselves do not set them.
    usual = [np.quantile(np.abs(values), 0.9) for values in (x, y)]
    kept = (np.abs(x) <= _LEAP * usual[0]) & (np.abs(y) <= _LEAP * usual[1])
    return x[kept], y[kept]


def frame_of_angle(
    position: np.ndarray, readings: dict[Any, np.ndarray], drift: np.ndarray | float = 0.0
) -> Any:
    """The only reading of a heading that agrees with the course; None if there are none or several.

    Parameters
    ----------
    position : (n,) complex array
        North + i east. [m]
    readings : dict of (n,) array
        Headings, by what they are called. [deg]
    drift : (n,) array or float
        Direction of the velocity against the bow. [rad]

    Examples
    --------
    >>> t = np.arange(300.0)
    >>> heading = 90 * np.sin(t / 40)
    >>> way = np.cumsum(np.exp(1j * np.radians(heading)))
    >>> frame_of_angle(way, {"NED": heading, "ENU": 90 - heading})
    'NED'
    """
    clear = []
    unclear = []
    for name, heading in readings.items():
        # Direction in which the craft should go under this reading.
        course = np.radians(heading) + drift
        rows = _all_known(position, course)
        way = position[rows]
        bow = np.exp(1j * course[rows])
        best = 0.0j
        # Mean direction of the way made against it, weighted by distance.
        # Its length is near 1 if the reading follows the course.
        for k in _SPANS:
            if len(way) < 4 * k:
                break
            moved = way[k:] - way[:-k]
            middle = bow[k // 2 : len(bow) - k + k // 2]
            total = np.abs(moved).sum()
            mean = (moved * np.conj(middle)).sum() / total if total > 0.0 else 0.0
            best = max(best, complex(mean), key=abs)
        # The angle must be small too, apart from drift.
        is_beside = abs(np.degrees(np.angle(best))) >= _BESIDE
        if abs(best) > _CLEAR and not is_beside:
            clear.append(name)
        elif abs(best) >= _UNCLEAR and not is_beside:
            unclear.append(name)
    # Accept a reading only if it alone is clear, and all others clearly fail.
    return clear[0] if len(clear) == 1 and not unclear else None


def frame_of_velocity(time: np.ndarray, way: np.ndarray, readings: dict[Any, np.ndarray]) -> Any:
    """The only reading of a velocity that moves as the positions do; None if there are none or several.

    Parameters
    ----------
    time : (n,) array
        [s]
    way : (n,) complex array
        Position, north + i east. [m]
    readings : dict of (n,) complex array
        Velocities over the earth in one unit, by what they are called.

    Examples
    --------
    >>> t = np.arange(300.0)
    >>> velocity = np.exp(1j * np.sin(t / 40))
    >>> readings = {"NED": velocity, "ENU": velocity.imag + 1j * velocity.real}
    >>> frame_of_velocity(t, np.cumsum(velocity), readings)
    'NED'
    """
    rows = _all_known(time, way, *readings.values())
    k = _SPANS[1]
    if rows.sum() < 4 * k or not (np.diff(time[rows]) > 0.0).all():
        return None
    moved = way[rows][k:] - way[rows][:-k]
    # What a reading does not explain of the way made in some rows, whatever its unit.
    rest = {}
    for name, velocity in readings.items():
        path = velocity[rows]
        steps = 0.5 * (path[1:] + path[:-1]) * np.diff(time[rows])
        path = np.concatenate(([0.0], np.cumsum(steps)))
        made = path[k:] - path[:-k]
        size = np.linalg.norm(moved) * np.linalg.norm(made)
        rest[name] = 1.0 - np.vdot(made, moved).real / size if size > 0.0 else 1.0
    best, second = sorted(rest, key=rest.__getitem__)[:2]
    is_clear = rest[best] < _LEFT and rest[second] > _CLEARER * rest[best]
    return best if is_clear else None
