"""Unstated units and frames: from relations between channels, or left as guesses."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.log.degree_size import local_plane
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.long_format import brought_together
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.evidence import (
    frame_of_angle,
    frame_of_velocity,
    unit_and_sign_of_rate,
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


@dataclass(frozen=True)
class _Channels:
    """Channels as they are chosen so far, and the motion that they tell.

    Attributes
    ----------
    chosen : dict of str to Guess
        By role; what is settled changes it in place.
    log : LogColumns
        Their columns.
    form : FileLayout
        What a channel file says of the form of the log.
    time : (n,) array or None
        [s]
    way : (n,) complex array or None
        Position, north + i east, in rows that can be compared with the one before. [m]
    """

    chosen: dict[str, Guess]
    log: LogColumns
    form: FileLayout
    time: np.ndarray | None = None
    way: np.ndarray | None = None

    def values(self, role):
        """Values of a role; None where there are none."""
        if role not in self.chosen:
            return None
        try:
            return values_of(self.chosen[role].channel, role, self.log, self.form)[0]
        except ShipcosimError:
            return None  # reading it says what is wrong

    def plane(self, first, second):
        """Values of two roles as a complex number; None where one of them has none."""
        ahead = self.values(first)
        aside = self.values(second)
        return None if ahead is None or aside is None else ahead + 1j * aside

    def plane_of(self, role):
        """Directions of a role as complex numbers; None where there are none."""
        angle = self.values(role)
        return None if angle is None else np.exp(1j * np.radians(angle))

    def column(self, role):
        """Numbers as they stand in the file, NaN where there are none."""
        cells = self.log.values[self.chosen[role].column]
        return cells if cells.dtype.kind == "f" else np.full(len(cells), np.nan)

    def is_open(self, role):
        """Whether a channel's unit is stated nowhere, and its column is not named by its role."""
        guess = self.chosen.get(role)
        return bool(
            guess and guess.rank != EXACT and not guess.unit and guess.channel.quaternion is None
        )

    def are_sure(self, *roles):
        """Whether none of those of some roles that are there is a guess."""
        return all(self.chosen[role].rank < GUESS for role in roles if role in self.chosen)

    def guess(self, role, unit, why):
        """Take a unit that has to be confirmed."""
        guess = self.chosen[role]
        why = "; ".join(filter(None, (guess.why, why)))
        self.chosen[role] = guess.read_as({"unit": unit}, rank=GUESS, why=why)

    def note(self, role, note, settings, **more):
        """Take settings of a channel that the log itself shows."""
        guess = self.chosen[role]
        self.chosen[role] = guess.read_as(settings, notes=(*guess.notes, note), **more)

    def settle(self, role, note, **settings):
        """Take settings of a channel that the log itself shows, after which it is no guess."""
        self.note(role, note, settings, rank=SURE, why="")


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
    channels = _Channels(chosen, log, form)
    _settle_degrees(channels)
    channels = _with_motion(channels)
    _settle_heading(channels)
    _settle_velocity(channels)
    _settle_course(channels)
    _settle_time(channels)
    for role in _SPEED_ROLES:
        if channels.is_open(role):
            _settle_speed(channels, role)
    if "yaw_rate" in chosen:
        _settle_rate(channels)
    over_ground = chosen.get("speed_over_ground")
    stated = over_ground and (over_ground.channel.unit or over_ground.unit)
    is_in_knots = bool(stated) and unit_for(stated, "m/s") == "kn"
    for role in ("wind_speed", "true_wind_speed"):
        # The unit of a wind speed beside knots, or with a sailor's short name, is mostly knots.
        if channels.is_open(role) and (is_in_knots or len(chosen[role].column.strip()) <= 4):
            channels.guess(role, "kn", "no unit is stated: kn or m/s")
    for role in list(chosen):
        _settle_angle(channels, role)


def _settle_angle(channels, role):
    """Small angles may be radians: directions within a turn, azimuths within half a turn, as many stay within degrees."""
    guess = channels.chosen[role]
    is_open = channels.is_open(role)
    is_direction = role in ("wind_from", "true_wind_from", "course_over_ground", "heading")
    numbers = finite(channels.column(role))
    largest = np.abs(numbers).max(initial=0.0)
    is_whole = _TURNS < numbers.max(initial=0.0) <= 36000.0 and (numbers % 1.0 == 0.0).all()
    if is_whole and is_direction and is_open:
        # Autopilots write hundredths of a degree, also as whole numbers.
        settings = {"map": ((0.0, 0.0), (36000.0, 360.0))}
        why = "whole numbers to 36000: hundredths of a degree, as autopilots write"
        channels.chosen[role] = guess.read_as(settings, rank=GUESS, why=why)
    elif is_open and role != "heading" and (is_direction or role.endswith("_azimuth")):
        if 0.0 < largest <= (_DEGREES if is_direction else np.pi + 0.01):
            channels.guess(role, "rad", "no unit is stated: rad or deg")
    elif guess.rank == EXACT and not guess.unit and is_direction and _is_within_a_turn(numbers):
        # The name of a role stands for degrees, but a log in radians may have it too.
        channels.guess(role, "rad", _RAD_OR_DEG)


def _is_within_a_turn(numbers):
    """Whether numbers can be directions in radians: they change, are hardly whole, and none is beyond 2 pi."""
    is_small = 0.0 < np.abs(numbers).max(initial=0.0) <= _DEGREES
    return is_small and np.ptp(numbers) > 0.0 and np.mean(numbers == np.round(numbers)) < 0.5


def _settle_degrees(channels):
    """Whole numbers beyond all degrees as ten millionths of them, as autopilots write."""
    sizes = {
        role: np.abs(finite(channels.column(role)))
        for role in LARGEST
        if role in channels.chosen and not channels.chosen[role].unit
    }
    # Integers far beyond any degrees; latitude and longitude share the unit.
    is_beyond = {
        role: len(size)
        and np.median(size) > 1e4 * LARGEST[role]
        and size.max() <= 1e7 * LARGEST[role]
        for role, size in sizes.items()
    }
    for role, size in sizes.items():
        if any(is_beyond.values()) and len(size) and (size == np.floor(size)).all():
            why = (
                f"whole numbers beyond {LARGEST[role]:g}: in {TEN_MILLIONTHS}, as autopilots write"
            )
            channels.guess(role, TEN_MILLIONTHS, why)
    # A position in radians looks like one in the Gulf of Guinea.
    limits = {"latitude": np.pi / 2.0, "longitude": np.pi}
    if len(sizes) == 2 and all(
        0.0 < sizes[role].max(initial=0.0) <= most for role, most in limits.items()
    ):
        for role in LARGEST:
            channels.guess(role, "rad", "no unit is stated, and no value is beyond pi: rad or deg")


def _with_motion(channels):
    """The same with times and positions; where rows hold one sensor each, all columns at the times of one of them."""
    time = channels.values("time")
    if time is None:
        return channels
    roles = {
        name: role for role, guess in channels.chosen.items() for name in guess.channel.columns
    }
    roles = {name: role for name, role in roles.items() if role != "time"}
    log = channels.log
    if all(log.values[name].dtype.kind == "f" for name in roles):
        columns = {
            n: (log.values[n], ROLES[r].unit if r in ROLES else "") for n, r in roles.items()
        }
        time, columns, remarks = brought_together(time, columns, log.joined)
        if remarks:
            values = log.values | {name: values for name, (values, _) in columns.items()}
            channels = replace(channels, log=replace(log, values=values))
    # North and east, or a local plane of latitude and longitude.
    way = channels.plane("north", "east")
    if way is None and (fixes := channels.plane("latitude", "longitude")) is not None:
        latitude = np.where(np.abs(fixes.real) < 90.0, fixes.real, np.nan)
        north, east, _ = local_plane(latitude, fixes.imag)
        way = north + 1j * east
    if way is not None:
        # Only rows with increasing times can be compared.
        way = np.where(np.diff(time, prepend=-np.inf) > 0.0, way, np.nan)
    return replace(channels, time=time, way=way)


def _settle_heading(channels):
    """Unit and frame of a heading, and which of x and y is north, by the course."""
    chosen = channels.chosen
    raw = channels.values("heading")
    if raw is None or not len(finite(raw)):
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
    is_small = _is_within_a_turn(raw) if is_exact else np.abs(finite(raw)).max() <= _DEGREES
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
    if channels.way is not None and (has_open_axes or channels.are_sure(*_PLACES)):
        body = channels.plane("surge", "sway") if channels.are_sure("surge", "sway") else None
        drift = 0.0 if body is None else np.angle(body)
        result = frame_of_angle(channels.way, readings, drift)
    if result is None:
        if is_open and not is_exact:
            channels.guess("heading", "rad", _RAD_OR_DEG)
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
        channels.settle("heading", message, **update)
    if is_exchanged:
        exchange_axes(chosen)
    for role in ("north", "east") if has_open_axes else ():
        channels.settle(role, f"'{chosen[role].column}' is {role}, as the heading says")


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


def _settle_velocity(channels):
    """Frame of two components of a velocity whose names do not state it, by the positions and the heading."""
    chosen = channels.chosen
    pair = next((p for p in _VELOCITIES if all(role in chosen for role in p)), None)
    bow = channels.plane_of("heading")
    way = channels.way
    if pair is None or bow is None or way is None:
        return
    guesses = [chosen[role] for role in pair]
    if channels.are_sure(*pair):
        return
    # Along and across the ship, positive to starboard or to port, or over the earth.
    first, second = map(channels.column, pair)
    readings = {
        ("surge", "sway", 1): (first + 1j * second) * bow,
        ("surge", "sway", -1): (first - 1j * second) * bow,
        ("north_velocity", "east_velocity", 1): first + 1j * second,
        ("east_velocity", "north_velocity", 1): second + 1j * first,
    }
    if not all(guess.is_guess for guess in guesses):
        readings = {roles: velocity for roles, velocity in readings.items() if roles[:2] == pair}
    roles = frame_of_velocity(channels.time, way, readings) if len(readings) > 1 else None
    if roles is None:
        return
    for role in pair:
        del chosen[role]
    is_sure = channels.are_sure("heading", *_PLACES)
    for guess, role, sign in zip(guesses, roles[:2], (1, roles[2]), strict=True):
        chosen[role] = replace(guess, role=role)
        note = f"{role.replace('_', ' ')}, as positions say"
        if is_sure:
            channels.settle(role, note, sign=sign)
        elif guess.is_guess:
            channels.note(role, note, {"sign": sign}, why="positions and heading are not sure")


def _settle_course(channels):
    """What a speed and courses are whose names may mean several: the velocity must be that of the positions."""
    bow = channels.plane_of("heading")
    way = channels.way
    if bow is None or way is None or not channels.are_sure(*_PLACES):
        return
    # A course is the heading where the ship goes beside it, as her own velocity says, and over ground where not.
    body = channels.plane("surge", "sway")
    guess = channels.chosen["heading"]
    if body is not None and channels.are_sure("surge", "sway") and "over ground" in guess.why:
        readings = {"the heading": body * bow, "over ground": np.abs(body) * bow}
        if frame_of_velocity(channels.time, way, readings) == "the heading":
            channels.settle("heading", "the heading, as positions and velocities say")
    course = channels.plane_of("course_over_ground")
    speed = channels.values("speed_over_ground")
    pair = ("speed_over_ground", "course_over_ground")
    if course is None or speed is None or channels.are_sure(*pair):
        return
    readings = {"over ground": speed * course, "ahead": speed * bow}
    if (
        channels.are_sure("heading")
        and frame_of_velocity(channels.time, way, readings) == "over ground"
    ):
        for role in pair:
            channels.settle(role, "over ground, as positions say")


def _settle_time(channels):
    """Whether the unit chosen for the times is the one in which positions move as fast as a speed of the log."""
    guess = channels.chosen.get("time")
    if guess is None or guess.rank < GUESS or not guess.channel.unit:
        return
    for role in _SPEED_ROLES:
        # Units of time differ by a thousand, those of a ship's speed by less than four.
        if role in channels.chosen and _unit_of(channels, role) in ("m/s", "kn", "km/h"):
            column = channels.chosen[role].column
            note = f"in {guess.channel.unit}, as positions and '{column}' say"
            return channels.settle("time", note)


def _unit_of(channels, role):
    """Unit of a speed by the positions, from both components if these are open; None where they do not tell it."""
    if channels.way is None:
        return None
    speed = channels.column(role)
    other = next((b for pair in _VELOCITIES for a, b in (pair, pair[::-1]) if a == role), "")
    if other and channels.is_open(other):
        speed = np.hypot(speed, channels.column(other))
    return unit_of_speed(channels.time, channels.way, np.abs(speed) if other else speed)


def _settle_speed(channels, role):
    """Unit of a speed by the positions."""
    if unit := _unit_of(channels, role):
        # The role's own unit needs no entry in the channel.
        settings = {} if unit == "m/s" else {"unit": unit}
        channels.note(role, f"in {unit}, as positions say", settings)
    elif role in _IN_KNOTS:
        channels.guess(role, "kn", "no unit is stated: kn or m/s")


def _settle_rate(channels):
    """Unit of a yaw rate, and to which side it is counted, by the heading."""
    heading = channels.values("heading")
    unit = None
    sign = 0
    # Compare with the change of heading.
    if heading is not None and channels.time is not None:
        unit, sign = unit_and_sign_of_rate(channels.time, heading, channels.column("yaw_rate"))
    guess = channels.chosen["yaw_rate"]
    if sign and guess.is_guess and channels.are_sure("heading"):
        side = "starboard" if sign > 0 else "port"
        channels.settle("yaw_rate", f"positive to {side}, as the heading says", sign=sign)
        guess = channels.chosen["yaw_rate"]
    if guess.unit:
        return
    if guess.rank == EXACT:
        if unit not in (None, "deg/s"):
            doubt = f"in deg/s, as its name stands for; by the heading it may be in {unit}"
            channels.note("yaw_rate", doubt, {"unit": unit})
    elif unit is not None:
        channels.note("yaw_rate", f"in {unit}, as the heading says", {"unit": unit})
    else:
        name = guess.column.strip().lower()
        is_rot = name in ("rot", "rateofturn", "rate of turn", "rate_of_turn")
        # ROS has rad/s throughout (REP 103).
        usual = "deg/min" if is_rot else "rad/s" if "angular" in name else "deg/s"
        channels.guess("yaw_rate", usual, "no unit is stated")
