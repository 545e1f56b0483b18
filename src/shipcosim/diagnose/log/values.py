"""Values of a channel: what its columns hold, in the unit of its role."""

from __future__ import annotations

import re

import numpy as np

from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.positions import (
    MINUTES,
    degrees_of_minutes,
    degrees_of_texts,
    hemisphere_signs,
    is_minutes,
)
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.files.times import (
    DAY,
    EPOCHS,
    epoch_unit,
    is_clock_number,
    seconds_of,
    seconds_of_clock,
)
from shipcosim.diagnose.log.names.units import name_and_unit, unit_for
from shipcosim.diagnose.log.names.vocabulary import meaning_of, words_of
from shipcosim.diagnose.log.roles import role_of
from shipcosim.diagnose.log.thresholds import SHORTEST_STEP
from shipcosim.diagnose.numerics import finite, usual_rise
from shipcosim.errors import Problem, ShipcosimError, error_at, suggestion
from shipcosim.series import conversion

CLOCK_NUMBER = "hhmmss"
"""Spelling of the unit of clock times as numbers: 123519.5 is 12:35:19.5."""
TEN_MILLIONTHS = "1e-7 deg"
"""Spelling of the unit of latitudes and longitudes that autopilots write as whole numbers."""
LARGEST = {"latitude": 90.0, "longitude": 180.0}
NOT_AVAILABLE = {"latitude": 91.0, "longitude": 181.0, "heading": 511.0, "speed_over_ground": 102.3}
"""Numbers by which AIS marks a missing value. ITU-R M.1371-5, table 48. [deg, deg, deg, kn]"""
_STEPS = (
    SHORTEST_STEP,
    90.0,
)  # s between rows, beyond which numbers without a unit are hardly seconds. Assumed.
_SIZES = {"d": DAY} | {unit: 1.0 / count for unit, count in EPOCHS.items()}  # s
_NAMES = {
    "d": "days",
    "s": "seconds",
    "ms": "milliseconds",
    "us": "microseconds",
    "ns": "nanoseconds",
}
_MOST_TURNED = 1080.0  # deg; where turns are counted on a log begins within it. Assumed.
_FEW_IMPOSSIBLE = 0.1  # share of impossible directions, above which the unit is wrong. Assumed.
_USUALLY_TURNED = 4.0  # times the median of a direction; a number above is none. Assumed.
_HOUR = 3600.0  # s
_SUNDAY = 6
_PUT_ON = r"(?<![\d+-])0?[23]:00(:\d\d([.,]\d+)?)?(\s*[aA][mM])?$"  # hours to which clocks are put on, no zone behind
_PERIODS = {86400.0: "day", 604800.0: "week"}  # s; after which clocks start anew
_LENGTHS = ("länge", "laenge", "lengte")
_NEAR_END = 300.0  # s; within which of its end one was, and of its start it is. Assumed.


def values_of(
    channel: Channel, name: str, log: LogColumns, form: FileLayout
) -> tuple[np.ndarray, str, list[str]]:
    """Values of a channel, their unit, and remarks on them.

    Parameters
    ----------
    channel : Channel
        Where it comes from.
    name : str
        Its role, or a connector, which keeps its unit.
    log : LogColumns
        Columns of the file.
    form : FileLayout
        What the file states of itself.

    Raises
    ------
    ShipcosimError
        A column that is missing, holds texts, or is in a unit of something else.
    """
    # An attitude as a quaternion has four columns and needs no unit.
    if channel.quaternion is not None:
        parts = [_numbers(log, _content_of(log, column)) for column in channel.quaternion]
        return heading_of_quaternion(np.array(parts), channel.frame), "deg", []
    column = _content_of(log, channel.column)
    stated = channel.unit or log.units[column]
    if name == "time":
        values, remarks = _time(channel, column, stated, log, form)
        return channel.sign * values + (channel.offset or -0.0), "s", remarks
    # Positions as text, in minutes or with a hemisphere.
    if name in LARGEST and (message := _position(channel, column, stated, name, log)) is not None:
        return message[0], "deg", message[1]
    # Plain numbers: a map replaces unit and factor;
    # otherwise convert from the stated unit to the role's.
    values = _numbers(log, column)
    if channel.map is not None:
        role = role_of(name)
        return _mapped(values, channel, column), role.unit if role else channel.unit or "", []
    role = role_of(name)
    unit = stated or (role.unit if role else "")
    target = role.unit if role else unit
    try:
        factor, zero = conversion(unit_for(unit, target) if role else unit, target)
    except ShipcosimError as error:
        message = f"its unit '{unit}' is none that converts to {target}."
        raise WrongUnit(Problem("", message, "Correct it, or say it in a channel file.")) from error
    values, remarks = _without_placeholders(values, name, column)
    if channel.hemisphere is not None:
        values = np.abs(values) * _signs(channel, name, log)
    # -0.0 + 0.0 is 0.0, and the sign of a zero is all that is left of a rate in too large a unit
    values = factor * (channel.sign * values + (channel.offset or -0.0)) + (zero or -0.0)
    if role and role.is_angle and name not in LARGEST:
        values, more = _without_leaps(values, column)
        remarks += more
    return values, target, remarks


def _without_leaps(values, column):
    """Directions without numbers that none is, and remarks; raises ShipcosimError where most are such.

    A direction lies within a turn or, where turns are counted on, goes on from there without a leap.
    """
    size = np.abs(values)
    far = np.flatnonzero(size > _MOST_TURNED)
    if not len(far):
        return values, []
    rows = size > max(_MOST_TURNED, _USUALLY_TURNED * np.median(finite(size)))
    left = np.where(rows, np.nan, values)
    directions = finite(left)
    is_leaping = rows.sum() < len(far) and np.abs(np.diff(directions)).max() > 360.0
    if is_leaping or rows.mean() > _FEW_IMPOSSIBLE or abs(directions[0]) > _MOST_TURNED:
        row = far[0]
        message = f"column '{column}' is {size[row]:g} deg in row {row + 2}, which is no direction: is the unit right?"
        remedy = (
            "In a channel file map = [[0, 0], [36000, 360]] reads hundredths of a degree, "
            "and offset = -3600 takes off ten turns."
        )
        raise error_at("", message, remedy)
    remark = f"'{column}' is {size[far[0]]:g} deg in row {far[0] + 2} or more, which is no direction: left out."
    return left, [remark] if rows.any() else []


def _without_placeholders(values, name, column):
    """The values without numbers that stand for none, and remarks on them."""
    rows = values == NOT_AVAILABLE.get(name)
    if not rows.any():
        return values, []
    count = int(rows.sum())
    number = f"{NOT_AVAILABLE[name]:g}"
    message = f"'{column}' is {number} in {count} of its rows, by which AIS says that there is none: left out."
    return np.where(rows, np.nan, values), [message]


class WrongUnit(ShipcosimError):
    """A column's unit is none of what the column holds."""


def heading_of_quaternion(parts: np.ndarray, frame: str) -> np.ndarray:
    """Heading of an attitude. [deg]

    Parameters
    ----------
    parts : (4, n) array
        w, x, y, z of the turn from the frame to the body, of any length.
    frame : str
        ``"NED"``, body forward-right-down, or ``"ENU"``, body forward-left-up.

    Examples
    --------
    >>> quarter = np.array([[0.5**0.5], [0.0], [0.0], [0.5**0.5]])
    >>> heading_of_quaternion(quarter, "NED").round(9).tolist(), heading_of_quaternion(quarter, "ENU").round(9).tolist()
    ([90.0], [0.0])
    """
    # Yaw from the quaternion, normalised by the arctangent of two sums; NaN where its length is 0.
    w, x, y, z = parts
    size = w * w + x * x + y * y + z * z
    with np.errstate(all="ignore"):
        yaw = np.degrees(np.arctan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))
    # In ENU the yaw is counted counter-clockwise from east.
    yaw = np.where(size > 0.0, yaw, np.nan)
    return np.mod(yaw if frame == "NED" else 90.0 - yaw, 360.0)


def _content_of(log: LogColumns, name: str) -> str:
    """Name of a column in the log, also if it was written with a unit."""
    if name in log.values:
        return name
    plain = name_and_unit(name)[0]
    if plain in log.values:
        return plain
    raise error_at("", f"there is no column '{name}'.", suggestion(name, log.values))


def _numbers(log: LogColumns, column: str) -> np.ndarray:
    values = log.values[column]
    if values.dtype.kind in "iub":
        return values.astype(float)
    if values.dtype.kind != "f":
        row = next(
            (i for i, value in enumerate(values) if value is not None and not _is_number(value)), 0
        )
        message = f"column '{column}' holds '{values[row]}' in row {row + 2}, not only numbers."
        raise error_at("", message, "A missing value is an empty field or nan.")
    return values


def _is_number(text):
    try:
        return float(text) is not None
    except (TypeError, ValueError):
        return False


def _time(channel, column, stated, log, form):
    """Times in seconds and remarks."""
    values = log.values[column]
    # Texts and time stamps: read dates and clock times,
    # with the date from its own column if there is one.
    if values.dtype.kind == "M":
        values = np.array([None if np.isnat(v) else str(v) for v in values], object)
    if values.dtype.kind == "O":
        if channel.date is not None:
            values = _joined(log, _content_of(log, channel.date), values)
        read = seconds_of(values, form.dates, stated)
        if read is not None:
            times, remarks = _without_summer_time(read[0], values)
            if channel.milliseconds is not None:
                times = times + 1e-3 * _numbers(log, _content_of(log, channel.milliseconds))
            return times, [*read[1], *remarks]
    # Numbers: clock times as hhmmss, seconds with nanoseconds, counts since 1970, or a plain unit.
    numbers = _numbers(log, column)
    if stated.lower() == CLOCK_NUMBER:
        return seconds_of_clock(_of_clock(numbers))
    if channel.nanoseconds is not None:
        return numbers + 1e-9 * _numbers(log, _content_of(log, channel.nanoseconds)), []
    unit = unit_for(stated, "s") if stated else ""
    finite_numbers = finite(numbers)
    # Seconds of some minutes come by 60 to 99, which no clock shows.
    is_long = (
        len(finite_numbers)
        and np.ptp(finite_numbers) > 200.0
        and usual_rise(finite_numbers, 1e9) < 40.0
    )
    if not unit and is_long and is_clock_number(finite_numbers):
        times, remarks = seconds_of_clock(_of_clock(numbers))
        return times, [*remarks, f"Numbers in '{column}' are clock times: 123519 is 12:35:19."]
    if unit in ("", "date") and (epoch := epoch_unit(numbers)) is not None:
        remarks = [f"Times in '{column}' are {epoch} since 1970."] if epoch != "s" or unit else []
        return numbers / EPOCHS[epoch], remarks
    factor, zero = conversion(unit or "s", "s")
    times = factor * numbers + (zero or -0.0)
    # A guessed unit is checked by the distance of rows, and one of days or longer;
    # then midnight or the end of a week is passed.
    if not unit or factor >= _SIZES["d"]:
        _check_steps(column, times, factor, unit)
    return _past_the_end(times)


def _check_steps(column, times, factor, stated):
    """Raise ShipcosimError where rows would be so close or far apart that the unit can hardly be right."""
    # Median of the positive steps: repeated times and steps back say nothing of the unit.
    step = usual_rise(finite(times), 1.0)
    if _STEPS[0] <= step <= _STEPS[1]:
        return
    # Of the units in which the rows are plausibly far apart, the longest.
    steps = {unit: size * step / factor for unit, size in _SIZES.items()}
    plausible = [unit for unit, span in steps.items() if _STEPS[0] <= span <= _STEPS[1]]
    unit = plausible[0] if plausible else "d" if step < _STEPS[0] else "ns"
    name = _NAMES[unit]
    question = "is the unit right" if stated else f"are these {name}"
    message = f"its rows are {step:.2g} s apart: {question}? As {name} they are {steps[unit]:.3g} s apart."
    remedy = f'Say the unit: time = {{column = "{column}", unit = "{unit}"}}'
    raise error_at("", message, f"{remedy}." if stated else f'{remedy}, or "s".')


def _without_summer_time(times, texts):
    """Stamps of a clock that is once put back or on by an hour, which go on, and remarks."""
    # One step back of nearly an hour, and no other, is the end of summer time.
    stamped = np.flatnonzero(np.isfinite(times))
    steps = np.diff(times[stamped])
    falls = np.flatnonzero(steps < 0.0)
    turns = falls if len(falls) else np.flatnonzero(steps > _HOUR)
    if len(turns) != 1:
        return times, []
    hour = float(np.copysign(_HOUR, steps[turns[0]]))
    row = int(stamped[turns[0] + 1])
    usual = usual_rise(times[stamped], 0.0)
    # An hour that is left out may be lost, unless it is the one that summer time leaves out.
    if not 0.0 <= steps[turns[0]] - hour <= 3.0 * usual or (
        hour > 0.0 and not _begins_summer(str(texts[row]))
    ):
        return times, []
    turned, when = ("on", "begins") if hour > 0.0 else ("back", "ends")
    return np.where(np.arange(len(times)) >= row, times - hour, times), [
        f"The clock is put {turned} by an hour before row {row + 2}, as where summer time {when}: the times go on."
    ]


def _begins_summer(text):
    """Whether a stamp without a zone is 2 or 3 o'clock on a Sunday."""
    import pandas

    is_day_first = not text[:4].isdigit()
    day = pandas.to_datetime(text, dayfirst=is_day_first, errors="coerce").weekday()
    return day == _SUNDAY and re.search(_PUT_ON, text) is not None


def _past_the_end(times):
    """Seconds of the day, or of the week of GPS, that go on past its end, and remarks."""
    # The clock must fall by nearly a whole period, from
    # near its end to near its start, at each fall.
    seconds = finite(times)
    for period, name in _PERIODS.items():
        falls = np.flatnonzero(np.diff(seconds) < -0.9 * period)
        if not len(falls) or seconds.min() < 0.0 or seconds.max() >= period:
            continue
        if (seconds[falls] > period - _NEAR_END).all() and (seconds[falls + 1] < _NEAR_END).all():
            return seconds_of_clock(times, period)[0], [
                f"Seconds of the {name} pass its end: they go on."
            ]
    return times, []


def _joined(log, date, clocks):
    """Stamps of a column of dates and one of clock times."""
    dates = log.values[date]
    # Dates as numbers lose leading zeros: restore yyyymmdd or yymmdd.
    if dates.dtype.kind == "f":
        width = 8 if np.nanmax(dates) > 999999 else 6
        dates = [None if not np.isfinite(d) else f"{int(d):0{width}d}" for d in dates]
    return np.array(
        [f"{_day(d)} {c}" if d and c else None for d, c in zip(dates, clocks, strict=True)], object
    )


def _day(text):
    """A date without the midnight that workbooks write after it."""
    return str(text).removesuffix(" 00:00:00").removesuffix("T00:00:00")


def _of_clock(numbers):
    hours = numbers // 10000
    minutes = numbers // 100 % 100
    seconds = numbers % 100
    return 3600.0 * hours + 60.0 * minutes + seconds


def _position(channel, column, stated, name, log):
    """Degrees of latitude or longitude that are not plain numbers; None for those."""
    # Formats by precedence: texts, whole numbers of autopilots,
    # degrees and minutes, plain degrees with a hemisphere.
    values = log.values[column]
    remarks = []
    if values.dtype.kind == "O":
        # O is east in German and Dutch, and west in the languages of the south.
        if column.lower().startswith(_LENGTHS):
            values = np.array([cell and str(cell).replace("O", "E") for cell in values], object)
        degrees = degrees_of_texts(values, LARGEST[name])
        if degrees is None:
            return None
    elif stated.replace(" ", "").lower() == TEN_MILLIONTHS.replace(" ", ""):
        degrees = 1e-7 * values
    elif unit_for(stated, "deg") == MINUTES or (not stated and _in_minutes(values, name, log)):
        degrees = degrees_of_minutes(values)
        remarks = (
            []
            if stated
            else [
                f"'{column}' is {name} in {MINUTES}, as positions of the log are beyond all degrees."
            ]
        )
    elif channel.hemisphere is None:
        return None
    else:
        unit = unit_for(stated or "deg", "deg")
        degrees = conversion(unit, "deg")[0] * values
    # The hemisphere gives the sign; a sign in the numbers would count twice.
    if channel.hemisphere is not None:
        degrees = np.abs(degrees) * _signs(channel, name, log)
    return channel.sign * degrees + channel.offset, remarks


def _signs(channel, name, log):
    """Signs by the column of sides of a channel."""
    hemisphere = _content_of(log, channel.hemisphere)
    signs = hemisphere_signs(log.values[hemisphere], name)
    if signs is None:
        message = f"column '{hemisphere}' does not hold hemispheres or sides of {name}."
        raise error_at("", message, "It should hold N and S, E and W, or S and P.")
    return signs


def _in_minutes(values, name, log):
    """Whether numbers are degrees and minutes; a latitude is where a longitude is and the other way round, if small."""
    other = "longitude" if name == "latitude" else "latitude"
    beside = [
        cells
        for column, cells in log.values.items()
        if meaning_of(words_of(column)).role == other and cells.dtype.kind == "f"
    ]
    # Degrees of a longitude may be counted on to 360 beside a latitude.
    largest = {"latitude": 90.0, "longitude": 360.0 if beside else 180.0}
    if any(is_minutes(cells, largest[other]) for cells in beside):
        return True
    return is_minutes(values, largest[name])


def _mapped(values, channel, column):
    """Values by a map, straight between its pairs."""
    given, wanted = np.array(channel.map).T
    # Outside its first and last pair a map is not extrapolated.
    has_value = np.isfinite(values)
    if (beyond := has_value & ((values < given[0]) | (values > given[-1]))).any():
        row = int(np.flatnonzero(beyond)[0])
        message = f"column '{column}' holds {values[row]:g} in row {row + 2}, beyond its map."
        raise error_at("", message, f"The map goes from {given[0]:g} to {given[-1]:g}.")
    return (
        channel.sign * np.interp(values, given, wanted, left=np.nan, right=np.nan) + channel.offset
    )
