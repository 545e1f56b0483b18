"""Unstated units and frames: from relations between channels, or left as guesses."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from shipcosim.diagnose.log.degree_size import local_plane
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.evidence import frame_of_angle, unit_of_rate, unit_of_speed
from shipcosim.diagnose.log.names.guesses import EXACT, GUESS, SURE, Guess
from shipcosim.diagnose.log.names.units import unit_for
from shipcosim.diagnose.log.roles import ROLES
from shipcosim.diagnose.log.values import LARGEST, TEN_MILLIONTHS, values_of
from shipcosim.diagnose.numerics import finite
from shipcosim.errors import ShipcosimError

_DEGREES = 1.02 * 2.0 * np.pi  # no angle in radians is larger
_RAD_OR_DEG = "no unit is stated, and no value is beyond 2 pi: rad or deg"
_TURNS = 1080.0  # deg; where turns are counted on, a log hardly goes beyond. Assumed.
_IN_KNOTS = ("speed_over_ground", "wind_speed", "true_wind_speed")


def settled(chosen: dict[str, Guess], log: LogColumns, form: FileLayout) -> None:
    """Settle what names leave open, in place: units and frames.

    Parameters
    ----------
    chosen : dict of str to Guess
        By role.
    log : LogColumns
        The file.
    form : FileLayout
        What a channel file says of the form of the log.
    """
    # Positions first, as heading, axes and speeds are judged by them.
    _settle_degrees(chosen, log)
    motion = _motion(chosen, log, form)
    _settle_heading(chosen, log, form, motion)
    _settle_axes(chosen, log, form, motion)
    for role in ("surge", "sway", "speed_over_ground", "north_velocity", "east_velocity"):
        if _is_open(chosen, role):
            _settle_speed(chosen, role, log, motion)
    if "yaw_rate" in chosen and not chosen["yaw_rate"].unit:
        _settle_rate(chosen, log, form, motion)
    over_ground = chosen.get("speed_over_ground")
    stated = over_ground and (over_ground.channel.unit or over_ground.unit)
    is_in_knots = bool(stated) and unit_for(stated, "m/s") == "kn"
    for role in ("wind_speed", "true_wind_speed"):
        # The unit of a wind speed beside knots, or with a sailor's short name, is mostly knots.
        if _is_open(chosen, role) and (is_in_knots or len(chosen[role].column.strip()) <= 4):
            _guess(chosen, role, "kn", "no unit is stated: kn or m/s")
    # Small angles may be radians: directions within a turn, azimuths within half a turn, as many
    # azimuths stay within some degrees.
    for role, guess in list(chosen.items()):
        is_direction = role in ("wind_from", "true_wind_from", "course_over_ground")
        numbers = _finite(log.values.get(guess.column, np.empty(0)))
        is_whole = _TURNS < numbers.max(initial=0.0) <= 36000.0 and (numbers % 1.0 == 0.0).all()
        if is_whole and (is_direction or role == "heading") and _is_open(chosen, role):
            # Autopilots write hundredths of a degree, also as whole numbers.
            settings = {"map": ((0.0, 0.0), (36000.0, 360.0))}
            why = "whole numbers to 36000: hundredths of a degree, as autopilots write"
            chosen[role] = guess.read_as(settings, rank=GUESS, why=why)
        elif (is_direction or role.endswith("_azimuth")) and _is_open(chosen, role):
            most = _DEGREES if is_direction else np.pi + 0.01
            if 0.0 < np.abs(numbers).max(initial=0.0) <= most:
                _guess(chosen, role, "rad", "no unit is stated: rad or deg")
        elif guess.rank == EXACT and not guess.unit and (is_direction or role == "heading"):
            # The name of a role stands for degrees, but a log in radians may have it too.
            if _is_within_a_turn(numbers):
                _guess(chosen, role, "rad", _RAD_OR_DEG)


def _is_within_a_turn(numbers):
    """Whether numbers can be directions in radians: they change, are hardly whole, and none is beyond 2 pi."""
    is_small = 0.0 < np.abs(numbers).max(initial=0.0) <= _DEGREES
    return is_small and np.ptp(numbers) > 0.0 and np.mean(numbers == np.round(numbers)) < 0.5


def _settle_degrees(chosen, log):
    """Whole numbers beyond all degrees as ten millionths of them, as autopilots write."""
    for role, largest in LARGEST.items():
        guess = chosen.get(role)
        sizes = (
            np.abs(_finite(log.values[guess.column])) if guess and not guess.unit else np.empty(0)
        )
        # Integers far beyond any degrees; latitude and longitude share the unit.
        beyond = len(sizes) and np.median(sizes) > 1e4 * largest and sizes.max() <= 1e7 * largest
        other = chosen.get("longitude" if role == "latitude" else "latitude")
        follows = len(sizes) and other is not None and other.channel.unit == TEN_MILLIONTHS
        if (beyond or follows) and (sizes == np.floor(sizes)).all():
            _guess(
                chosen,
                role,
                TEN_MILLIONTHS,
                f"whole numbers beyond {largest:g}: in {TEN_MILLIONTHS}, as autopilots write",
            )
    # A position in radians looks like one in the Gulf of Guinea.
    is_small = [
        role in chosen
        and not chosen[role].unit
        and 0.0 < np.abs(_finite(log.values[chosen[role].column])).max(initial=0.0) <= most
        for role, most in {"latitude": np.pi / 2.0, "longitude": np.pi}.items()
    ]
    for role in LARGEST if all(is_small) else ():
        _guess(chosen, role, "rad", "no unit is stated, and no value is beyond pi: rad or deg")


def _is_open(chosen, role):
    """Whether a channel's unit is stated nowhere, and its column is not named by its role."""
    guess = chosen.get(role)
    return bool(
        guess and guess.rank != EXACT and not guess.unit and guess.channel.quaternion is None
    )


def _finite(values):
    return finite(values) if values.dtype.kind == "f" else np.empty(0)


def _guess(chosen, role, unit, why):
    guess = chosen[role]
    why = "; ".join(filter(None, (guess.why, why)))
    chosen[role] = guess.read_as({"unit": unit}, rank=GUESS, why=why)


def _with_doubt(chosen, role, why, **update):
    """Settled by the log itself."""
    guess = chosen[role]
    chosen[role] = guess.read_as(update, rank=SURE, why="", notes=(*guess.notes, why))


def _values(chosen, role, log, form) -> Any:
    if role not in chosen:
        return None
    try:
        return values_of(chosen[role].channel, role, log, form)[0]
    except ShipcosimError:
        return None  # reading it says what is wrong


def _motion(chosen, log, form) -> Any:
    """Times and positions of the log [s, m, m], or None."""
    time = _values(chosen, "time", log, form)
    if time is None:
        return None
    # North and east, or a local plane of latitude and longitude.
    position = [_values(chosen, role, log, form) for role in ("north", "east")]
    if any(values is None for values in position):
        latitude, longitude = (
            _values(chosen, role, log, form) for role in ("latitude", "longitude")
        )
        if latitude is None or longitude is None:
            return time, None, None
        position = local_plane(np.where(np.abs(latitude) < 90.0, latitude, np.nan), longitude)[:2]
        if np.isnan(position).any(axis=0).all():
            return time, None, None
    # Only rows with increasing times can be compared.
    rows = np.concatenate(([True], np.diff(time) > 0.0))
    return time, *(np.where(rows, values, np.nan) for values in position)


def _settle_heading(chosen, log, form, motion):
    """Unit of a heading without one, and whether a yaw is clockwise from north."""
    if "heading" not in chosen or chosen["heading"].rank == EXACT:
        return
    guess = chosen["heading"]
    is_open = _is_open(chosen, "heading")
    is_yaw = guess.why.startswith(("yaw", "of a quaternion"))
    if not is_open and not is_yaw:
        return
    raw = _values(chosen, "heading", log, form)
    if raw is None or not len(_finite(raw)):
        return
    # Candidates: degrees, radians unless values are too
    # large, and angles anticlockwise from east for a yaw.
    units = {"deg": 1.0, "rad": 180.0 / np.pi}
    if not is_open or np.abs(_finite(raw)).max() > _DEGREES:
        units = {"deg": 1.0}
    readings = {(unit, "NED"): size * raw for unit, size in units.items()}
    if is_yaw:
        readings |= {(unit, "ENU"): 90.0 - size * raw for unit, size in units.items()}
    if len(readings) == 1:
        return
    # Compare with the course, given positions and, if known, the drift angle.
    result = None
    is_placed = all(
        chosen[role].rank < GUESS
        for role in ("north", "east", "latitude", "longitude")
        if role in chosen
    )
    if motion is not None and motion[1] is not None and is_placed:
        body: list[Any] = [_values(chosen, role, log, form) for role in ("surge", "sway")]
        is_known = (
            all(v is not None for v in body)
            and max(chosen[r].rank for r in ("surge", "sway")) < GUESS
        )
        result = frame_of_angle(
            motion[0],
            motion[1],
            motion[2],
            readings,
            np.arctan2(body[1], body[0]) if is_known else None,
        )
    if result is None:
        if is_open and len(units) == 2:
            _guess(chosen, "heading", "rad", _RAD_OR_DEG)
        return
    # Write the reading into the channel: unit, frame of the quaternion, or sign and offset.
    unit, frame = result
    counted = "clockwise from north" if frame == "NED" else "anticlockwise from east"
    message = f"{f'in {unit} and ' if is_open else ''}{counted}, as the course says"
    update = {} if not is_open else {"unit": unit}
    if guess.channel.quaternion is not None:
        update = {"frame": frame}
        message = f"the quaternion is of {frame}, as the course says"
    elif frame == "ENU":
        update |= {"sign": -1, "offset": 90.0 if unit == "deg" else np.pi / 2}
    _with_doubt(chosen, "heading", message, **update)


def are_axes_open(chosen: Mapping[str, Guess]) -> bool:
    """Whether x and y of a log are read as north and east, and may be the other way round."""
    pair = [chosen[role] for role in ("north", "east") if role in chosen]
    return len(pair) == 2 and all(guess.why.startswith("x north") for guess in pair)


def exchange_axes(chosen: dict[str, Guess]) -> None:
    """Exchange the columns of north and east, in place."""
    north = chosen["north"]
    east = chosen["east"]
    chosen["north"] = replace(north, column=east.column, channel=east.channel)
    chosen["east"] = replace(east, column=north.column, channel=north.channel)


def _settle_axes(chosen, log, form, motion):
    """Whether x is north and y east, or the other way round, by the heading."""
    if motion is None or motion[1] is None or "heading" not in chosen:
        return
    if not are_axes_open(chosen) or chosen["heading"].rank == GUESS:
        return
    # The heading tells which axis is north: with exchanged axes it looks counted from east.
    heading = _values(chosen, "heading", log, form)
    time, x, y = motion
    readings = {"NED": heading, "ENU": 90.0 - heading}
    frame = frame_of_angle(time, x, y, readings)
    if frame == "NED":
        for role in ("north", "east"):
            _with_doubt(chosen, role, "x is north and y east, as the heading says")
    elif frame == "ENU":
        exchange_axes(chosen)
        for role in ("north", "east"):
            _with_doubt(chosen, role, "x is east and y north, as the heading says")


def _settle_speed(chosen, role, log, motion):
    """Unit of a speed by the positions."""
    raw = log.values[chosen[role].column]
    unit = None
    # Compare the speed, from both components if these
    # are open, with the distance between positions.
    if motion is not None and motion[1] is not None and raw.dtype.kind == "f":
        speed = raw
        if role in ("surge", "sway", "north_velocity", "east_velocity"):
            other = {"surge": "sway", "sway": "surge", "north_velocity": "east_velocity"}.get(
                role, "north_velocity"
            )
            other_speed = (
                log.values[chosen[other].column] if _is_open(chosen, other) else np.zeros_like(raw)
            )
            speed = np.hypot(raw, other_speed) if other_speed.dtype.kind == "f" else np.abs(raw)
        unit = unit_of_speed(motion[0], motion[1], motion[2], speed)
    if unit is not None:
        guess = chosen[role]
        # The role's own unit needs no entry in the channel.
        settings = {} if unit == "m/s" else {"unit": unit}
        chosen[role] = guess.read_as(settings, notes=(*guess.notes, f"in {unit}, as positions say"))
    elif role in _IN_KNOTS:
        _guess(chosen, role, "kn", "no unit is stated: kn or m/s")


def _settle_rate(chosen, log, form, motion):
    """Unit of a yaw rate by the heading."""
    heading = _values(chosen, "heading", log, form)
    raw = log.values[chosen["yaw_rate"].column]
    unit = None
    # Compare with the change of heading.
    if heading is not None and motion is not None and raw.dtype.kind == "f":
        unit = unit_of_rate(motion[0], heading, raw)
    guess = chosen["yaw_rate"]
    if guess.rank == EXACT:
        if unit not in (None, "deg/s"):
            doubt = f"in deg/s, as its name stands for; by the heading it may be in {unit}"
            chosen["yaw_rate"] = guess.read_as({"unit": unit}, notes=(*guess.notes, doubt))
        return
    if unit is None:
        is_rot = guess.column.strip().lower() in (
            "rot",
            "rateofturn",
            "rate of turn",
            "rate_of_turn",
        )
        # ROS has rad/s throughout (REP 103).
        is_ros = "angular" in guess.column.lower()
        usual = "deg/min" if is_rot else "rad/s" if is_ros else ROLES["yaw_rate"].unit
        _guess(chosen, "yaw_rate", usual, "no unit is stated")
        return
    notes = (*guess.notes, f"in {unit}, as the heading says")
    chosen["yaw_rate"] = guess.read_as({"unit": unit}, notes=notes)
