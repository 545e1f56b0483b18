"""The time column among the possible ones, and its unit."""

import re
from dataclasses import replace

import numpy as np

from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.files.times import DAY, EPOCHS, epoch_unit, is_clock_number, seconds_of
from shipcosim.diagnose.log.names.guesses import EXACT, GUESS, SURE, Guess
from shipcosim.diagnose.log.names.vocabulary import words_of
from shipcosim.diagnose.log.values import CLOCK_NUMBER
from shipcosim.diagnose.numerics import finite, usual_rise
from shipcosim.errors import ShipcosimError

_STEPS = (0.002, 30.0)  # s between rows of a log that a unit is chosen by. Assumed.
_SHORTEST = 4e-4  # s between rows of any log of a ship; 35 s are as many days. Assumed.
_CLOCK = re.compile(r"\s*\d?\d(:|\.\d\d\.\d\d(?!\d))")
_UNITS = {unit: 1.0 / count for unit, count in EPOCHS.items()} | {"min": 60.0, "d": DAY}


def time_of(
    guesses: list[Guess], log: LogColumns, form: FileLayout
) -> tuple[Guess | None, list[Guess]]:
    """The guess that is the time, and the others with why they are not.

    Parameters
    ----------
    guesses : list of Guess
        Columns that may be it by their names.
    log : LogColumns
        The file.
    form : FileLayout
        What a channel file says of the form of the log.

    Raises
    ------
    ShipcosimError
        If day and month of stamps can be exchanged.
    """
    # A stamp in two columns is the most precise. Otherwise take the
    # best usable guess, or any column of texts that are stamps.
    if pair := _seconds_and_nanoseconds(log):
        return pair, [guess.refused(f"'{pair.column}' is the time") for guess in guesses]
    usable = [clock for guess in guesses if (clock := _usable(guess, log, form))]
    if not usable:
        usable = [clock for name in log.values if (clock := _stamps(name, log, form))]
    # Exact names first, UTC before local time, and clock times before dates.
    usable.sort(
        key=lambda g: (
            g.rank,
            log.values[g.column].dtype.kind == "O" and _is_date(g.column),
            "local" in words_of(g.column),
        )
    )
    best = usable[0] if usable else None
    rest = [g for g in guesses if best is None or g.column not in best.channel.columns]
    why = f"'{best.column}' is the time" if best else "it cannot be read as times"
    return best, [guess.refused(why) for guess in rest]


def _seconds_and_nanoseconds(log):
    """Two columns of a stamp of ROS."""
    for name, values in log.values.items():
        words = words_of(name)
        if words[-1:] != ("nanoseconds",) or values.dtype.kind != "f":
            continue
        for other in log.values:
            if words_of(other) == (*words[:-1], "seconds") and _all_between(values, 0.0, 1e9):
                channel = Channel(column=other, nanoseconds=name)
                return Guess(other, "time", channel, SURE, unit="s")
    return None


def _all_between(values, least, most):
    numbers = finite(values)
    return bool(len(numbers)) and numbers.min() >= least and numbers.max() < most


def _usable(guess: Guess, log: LogColumns, form: FileLayout) -> Guess | None:
    """A guess with the unit of its numbers, or with the date for its clock time; None if it is not a time."""
    # Texts and stamps are read as they are; so are numbers with a stated unit.
    values = log.values[guess.column]
    if values.dtype.kind == "O":
        return _stamps(guess.column, log, form, guess)
    if (
        values.dtype.kind == "M"
        or guess.unit
        and guess.unit.lower() not in ("utc", "local", "date")
    ):
        return guess
    if guess.channel.nanoseconds:
        return guess
    # A constant column is no time, unless its name is exactly that.
    numbers = finite(values)
    if len(np.unique(numbers[:1000])) < 2 and len(np.unique(numbers)) < 2:
        return None if guess.rank > EXACT else guess
    # Counts since 1970 are recognised by their size, whatever the name.
    if epoch_unit(values):
        return replace(guess, rank=min(guess.rank, SURE), why="")
    if guess.rank == EXACT:
        return guess
    # Clock times as numbers need a name that suggests a clock.
    if is_clock_number(numbers) and set(words_of(guess.column)) & {
        "utc",
        "hhmmss",
        "clock",
        "gps",
        "day",
    }:
        why = "123519 is taken for 12:35:19"
        unit = CLOCK_NUMBER
        return guess.read_as({"unit": unit}, rank=GUESS, why=why, unit=unit)
    if _is_date(guess.column):
        return None
    # Without a stated unit, choose one in which the rows are a usual step apart.
    step = usual_rise(numbers, 0.0)
    if step == 0.0 or _STEPS[0] <= step <= _STEPS[1]:
        return guess
    unit = next((u for u, size in _UNITS.items() if _STEPS[0] <= step * size <= _STEPS[1]), None)
    if unit is None:
        return guess
    # Days of a spreadsheet, of MATLAB or of a year: in seconds no log of a ship has so many rows.
    if unit == "d" and step < _SHORTEST:
        return guess.read_as({"unit": unit}, rank=SURE, why="", unit=unit)
    why = f"no unit is stated: rows are {step * _UNITS[unit]:g} s apart in {unit}, and {step:g} s in s"
    return guess.read_as({"unit": unit}, rank=GUESS, why=why, unit=unit)


def _is_date(name):
    return "date" in words_of(name) and "time" not in words_of(name)


def _stamps(
    name: str, log: LogColumns, form: FileLayout, guess: Guess | None = None
) -> Guess | None:
    """A column of texts that are stamps, with the column of dates beside it where they are clock times."""
    # Try the first, middle and last text before reading all of them.
    values = log.values[name]
    filled = [value for value in values if value is not None] if values.dtype.kind == "O" else []
    is_clock = bool(filled) and _CLOCK.match(str(filled[0])) is not None
    if not filled or not any(char.isdigit() for char in str(filled[0])):
        return None
    # Dots between three numbers are a date in a column named so.
    if is_clock and _is_date(name) and ":" not in str(filled[0]):
        return None
    sample = np.array([filled[0], filled[len(filled) // 2], filled[-1]], object)
    try:
        if seconds_of(sample, form.dates) is None:
            return None
    except ShipcosimError:
        pass  # reading says how it can be read
    guess = guess or Guess(name, "time", Channel(column=name), SURE)
    # Stamps of whole seconds take the milliseconds from a column of their own.
    for other, rest in log.values.items():
        is_rest = words_of(other) in (("ms",), ("milliseconds",)) and rest.dtype.kind == "f"
        if (
            is_rest
            and "." not in str(filled[0]).rpartition(":")[2]
            and _all_between(rest, 0.0, 1e3)
        ):
            guess = guess.read_as({"milliseconds": other})
    # Clock times without a date take the date from a column beside it.
    dates = [other for other in log.values if _is_date(other) and other != name]
    if is_clock and dates:
        guess = guess.read_as({"date": dates[0]})
    # A constant date without a clock time is no time.
    elif ":" not in str(filled[0]) and len(set(map(str, sample))) < 2:
        return None
    return replace(guess, rank=min(guess.rank, SURE), why="")
