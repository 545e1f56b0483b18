"""Unstated units and frames: from relations between channels, or left as guesses."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from shipcosim.diagnose.log.degree_size import local_plane
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.long_format import brought_together
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.evidence import (
    frame_of_angle,
    frame_of_velocity,
    unit_of_rate,
    unit_of_speed,
)
from shipcosim.diagnose.log.names.guesses import EXACT, GUESS, SURE, Guess
from shipcosim.diagnose.log.names.units import unit_for
from shipcosim.diagnose.log.names.vocabulary import words_of
from shipcosim.diagnose.log.roles import ROLES
from shipcosim.diagnose.log.values import LARGEST, TEN_MILLIONTHS, values_of
from shipcosim.diagnose.numerics import finite
from shipcosim.errors import ShipcosimError

_DEGREES = 1.02 * 2.0 * np.pi  # no angle in radians is larger
_RAD_OR_DEG = "no unit is stated, and no value is beyond 2 pi: rad or deg"
_TO_PORT = "psi and y may be counted to port: no compass and no north is named"
_TURNS = 1080.0  # deg; where turns are counted on, a log hardly goes beyond. Assumed.
_VELOCITIES = (("surge", "sway"), ("north_velocity", "east_velocity"))
_SPEED_ROLES = ("surge", "sway", "speed_over_ground", "north_velocity", "east_velocity")
_PLACES = ("north", "east", "latitude", "longitude")
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
    time, log = _aligned(chosen, log, _values(chosen, "time", log, form))
    motion = _motion(chosen, log, form, time)
    _settle_heading(chosen, log, form, motion)
    _settle_velocity(chosen, log, form, motion)
    _settle_time(chosen, log, motion)
    for role in _SPEED_ROLES:
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


def _aligned(chosen, log, time):
    """Times and a log for comparisons: where rows hold one sensor each, all columns at the times of one of them."""
    roles = {name: role for role, guess in chosen.items() for name in guess.channel.columns}
    roles = {name: role for name, role in roles.items() if role != "time"}
    if time is None or any(log.values[name].dtype.kind != "f" for name in roles):
        return time, log
    columns = {n: (log.values[n], ROLES[r].unit if r in ROLES else "") for n, r in roles.items()}
    clock, columns, remarks = brought_together(time, columns, log.joined)
    if not remarks:
        return time, log
    return clock, replace(
        log, values=log.values | {n: values for n, (values, _) in columns.items()}
    )


def _motion(chosen, log, form, time) -> Any:
    """Times and positions of the log [s, m, m], or None."""
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
    """Unit and frame of a heading, and which of x and y is north, by the course."""
    raw = _values(chosen, "heading", log, form)
    if raw is None or not len(_finite(raw)):
        return
    guess = chosen["heading"]
    is_exact = guess.rank == EXACT
    has_open_axes = are_axes_open(chosen)
    # Seen in a mirror x, y and psi fit as well: y and psi to port, as basins and simulators count them.
    if has_open_axes and "psi" in words_of(guess.column):
        chosen["heading"] = replace(guess, rank=GUESS, why=_TO_PORT)
        return
    if is_exact and not has_open_axes:
        return
    # Candidates: degrees, or radians unless values are too large; anticlockwise from east for a yaw; x or y north,
    # where exchanged axes make a heading look counted from east.
    is_small = _is_within_a_turn(raw) if is_exact else np.abs(_finite(raw)).max() <= _DEGREES
    is_open = guess.channel.quaternion is None and not guess.unit and is_small
    units = {"deg": 1.0, "rad": 180.0 / np.pi} if is_open else {"deg": 1.0}
    readings = {(unit, "NED", False): size * raw for unit, size in units.items()}
    if guess.why.startswith(("yaw", "of a quaternion")):
        readings |= {(unit, "ENU", False): 90.0 - size * raw for unit, size in units.items()}
    if has_open_axes:
        readings |= {(*kind, True): 90.0 - angle for (*kind, _), angle in readings.items()}
    if len(readings) == 1:
        return
    # Compare with the course, given positions and, if known, the drift angle.
    result = None
    is_placed = all(chosen[role].rank < GUESS for role in _PLACES if role in chosen)
    if motion is not None and motion[1] is not None and (is_placed or has_open_axes):
        body: list[Any] = [_values(chosen, role, log, form) for role in ("surge", "sway")]
        is_known = (
            all(v is not None for v in body)
            and max(chosen[r].rank for r in ("surge", "sway")) < GUESS
        )
        drift = np.arctan2(body[1], body[0]) if is_known else None
        time, north, east = motion
        result = frame_of_angle(time, north, east, readings, drift)
    if result is None:
        if is_open and not is_exact:
            _guess(chosen, "heading", "rad", _RAD_OR_DEG)
        return
    # Write the reading into the channel: unit, frame of the quaternion, or sign and offset; and into the axes.
    unit, frame, is_exchanged = result
    counted = "clockwise from north" if frame == "NED" else "anticlockwise from east"
    message = f"{f'in {unit} and ' if is_open else ''}{counted}, as the course says"
    update = {"unit": unit} if is_open else {}
    if guess.channel.quaternion is not None:
        update = {"frame": frame}
        message = f"the quaternion is of {frame}, as the course says"
    elif frame == "ENU":
        update |= {"sign": -1, "offset": 90.0 if unit == "deg" else np.pi / 2}
    if len({kind[:2] for kind in readings}) > 1:
        _with_doubt(chosen, "heading", message, **update)
    if is_exchanged:
        exchange_axes(chosen)
    for role in ("north", "east") if has_open_axes else ():
        axis = f"'{chosen[role].column}' is {role}, as the heading says"
        _with_doubt(chosen, role, axis)


def are_axes_open(chosen: Mapping[str, Guess]) -> bool:
    """Whether x and y of a log are read as north and east, or as east and north, and may be the other way round."""
    pair = [chosen[role] for role in ("north", "east") if role in chosen]
    return len(pair) == 2 and all(guess.why.startswith("x ") for guess in pair)


def exchange_axes(chosen: dict[str, Guess]) -> None:
    """Exchange the columns of north and east, in place."""
    north = chosen["north"]
    east = chosen["east"]
    chosen["north"] = replace(north, column=east.column, channel=east.channel)
    chosen["east"] = replace(east, column=north.column, channel=north.channel)


def _settle_velocity(chosen, log, form, motion):
    """Frame of two components of a velocity whose names do not state it, by the positions and the heading."""
    pair = next((p for p in _VELOCITIES if all(role in chosen for role in p)), None)
    is_sure = [chosen[r].rank < GUESS for r in ("heading", *_PLACES) if r in chosen]
    if pair is None or len(is_sure) < 3 or not all(is_sure) or motion is None or motion[1] is None:
        return
    guesses = [chosen[role] for role in pair]
    parts = [log.values[guess.column] for guess in guesses]
    heading = _values(chosen, "heading", log, form)
    is_open = all(guess.rank == GUESS for guess in guesses)
    if not is_open or heading is None or any(part.dtype.kind != "f" for part in parts):
        return
    # Along and across the ship, positive to starboard or to port, or over the earth.
    bow = np.exp(1j * np.radians(heading))
    time, north, east = motion
    first, second = parts
    readings = {
        ("surge", "sway", 1): (first + 1j * second) * bow,
        ("surge", "sway", -1): (first - 1j * second) * bow,
        ("north_velocity", "east_velocity", 1): first + 1j * second,
        ("east_velocity", "north_velocity", 1): second + 1j * first,
    }
    roles = frame_of_velocity(time, north + 1j * east, readings)
    if roles is None:
        return
    for role in pair:
        del chosen[role]
    for guess, role, sign in zip(guesses, roles[:2], (1, roles[2]), strict=True):
        chosen[role] = replace(guess, role=role)
        _with_doubt(chosen, role, f"{role.replace('_', ' ')}, as positions say", sign=sign)


def _settle_time(chosen, log, motion):
    """Whether the unit chosen for the times is the one in which positions move as fast as a speed of the log."""
    if "time" not in chosen or chosen["time"].rank < GUESS or not chosen["time"].channel.unit:
        return
    for role in _SPEED_ROLES:
        # Units of time differ by a thousand, those of a ship's speed by less than four.
        if role in chosen and _unit_of(chosen, role, log, motion) in ("m/s", "kn", "km/h"):
            unit = chosen["time"].channel.unit
            why = f"in {unit}, as positions and '{chosen[role].column}' say"
            return _with_doubt(chosen, "time", why)


def _unit_of(chosen, role, log, motion):
    """Unit of a speed by the positions, from both components if these are open; None where they do not tell it."""
    speed = log.values[chosen[role].column]
    if motion is None or motion[1] is None or speed.dtype.kind != "f":
        return None
    other = next((b for pair in _VELOCITIES for a, b in (pair, pair[::-1]) if a == role), "")
    if other and _is_open(chosen, other) and log.values[chosen[other].column].dtype.kind == "f":
        speed = np.hypot(speed, log.values[chosen[other].column])
    time, north, east = motion
    return unit_of_speed(time, north, east, np.abs(speed) if other else speed)


def _settle_speed(chosen, role, log, motion):
    """Unit of a speed by the positions."""
    if unit := _unit_of(chosen, role, log, motion):
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
