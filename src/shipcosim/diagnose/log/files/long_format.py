"""Logs with one value a row, or one sensor's values a row, as one table."""

from __future__ import annotations

from typing import Any

import numpy as np

from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.interpolation import at_times
from shipcosim.diagnose.log.files.missing import FLAGS, bad_rows
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.vocabulary import meaning_of, words_of
from shipcosim.diagnose.log.rows import usable_rows
from shipcosim.diagnose.numerics import finite
from shipcosim.errors import error_at, suggestion

_NAMES = "name topic signal channel variable var metric tag key parameter quantity item field sensor message msg".split()
_NAMES += "label source id measurement type path kanal kanalname navn kanavn variabel canal bezeichnung description".split()
_VALUES = "value varvalue val reading data measurement number v y wert verdi valeur valor valore payload".split()
_UNITS = "unit units einheit enhet unité unidad".split()
_MOST_NAMES = 500
_ALONE = 0.1  # share of rows with most channels, below which rows are messages of single sensors. Assumed.


def spread(log: LogColumns, form: FileLayout) -> LogColumns:
    """Turn a log with one value a row into one with a column for each name; leave others unchanged.

    Parameters
    ----------
    log : LogColumns
        As it stands in the file.
    form : FileLayout
        May say which columns hold names and values.

    Raises
    ------
    ShipcosimError
        If the columns that it says are not there.
    """
    for name in filter(None, (form.name, form.value)):
        if name not in log.values:
            message = f"there is no column '{name}'."
            raise error_at(log.source, message, suggestion(name, log.values))
    names, value = _long(log, form)
    if not names or value is None:
        return log
    # Among the other columns find one of units, and one of times.
    rest = [column for column in log.values if column not in (*names, value)]
    # A column with a role of its own beside them: the row is of all channels, and the text a label of it.
    is_wide = any(meaning_of(words_of(column)).role not in (None, "time") for column in rest)
    if is_wide and form.name is None:
        return log
    unit = next((column for column in rest if column.strip().lower() in _UNITS), None)
    clocks = [column for column in rest if column != unit and _is_clock(log.values[column])]
    if not clocks:
        return log
    clock = next(
        (c for c in clocks if "time" in c.lower() or c.lower() in ("t", "stamp", "timestamp")),
        clocks[0],
    )
    return _wide(log, names, value, clock, unit)


def _long(log, form):
    """Columns with the names of values, and the column with the values; empty and None for a log of another kind."""
    if form.name is not None and form.value is not None:
        return [form.name], form.value
    # Usual names of such columns, where the values look like names.
    lower = {_plain(column): column for column in log.values}
    value = next((lower[word] for word in _VALUES if word in lower), None)
    names = [
        lower[word] for word in _NAMES if word in lower and _is_of_names(log.values[lower[word]])
    ]
    if form.name is not None:
        names = [form.name]
    # The device comes before its quantity, as in other names.
    return [name for name in reversed(names) if name != value], form.value or value


def _plain(column):
    """Name of a column as the lists have it: databases write ``_field`` and ``parameter_id``."""
    name = column.strip().lower().strip("_")
    return name.removesuffix("_id").removesuffix("name").rstrip("_ ") or name


def _is_of_names(values):
    if values.dtype.kind != "O":
        return False
    names = {value for value in values if value is not None}
    return 2 <= len(names) <= min(_MOST_NAMES, len(values) // 2)


def _is_clock(values):
    if values.dtype.kind == "O":
        first = next((str(value) for value in values if value is not None), "")
        return sum(char.isdigit() for char in first) >= 4
    return values.dtype.kind in "fM" and len(np.unique(finite(values))) > 1


def _wide(log, names, value, clock, unit):
    import pandas

    # Rows with a name and a time; several columns of names are joined.
    frame: Any = pandas.DataFrame({column: log.values[column] for column in log.values})
    complete = frame[names].notna().all(axis=1) & frame[clock].notna()
    bad = np.zeros(len(frame), bool)
    for flag in log.values:
        if FLAGS >= set(words_of(flag)):
            bad |= bad_rows(words_of(flag), log.values[flag])
    complete &= ~bad
    frame = frame[complete]
    key = frame[names[0]].astype("str")
    for more in names[1:]:
        key = key + "." + frame[more].astype("str")
    # One row for each time and one column for each name, in the order of the file; the first value is kept.
    cells = pandas.DataFrame({"name": key, "time": frame[clock], "value": frame[value]})
    first = cells.drop_duplicates(["name", "time"])
    again = len(cells) - len(first)
    times = first["time"].unique()
    wide: Any = first.pivot(index="time", columns="name", values="value").reindex(times)
    values: dict[str, np.ndarray] = {clock: np.asarray(times)}
    units = {clock: log.units[clock]}
    for name in first["name"].unique():
        there = wide[name].notna()
        numbers: Any = pandas.to_numeric(wide[name], errors="coerce")
        is_text = numbers.notna().sum() < 0.5 * there.sum()
        texts = wide[name].astype(object).where(there, None)
        values[name] = texts.to_numpy(object) if is_text else numbers.to_numpy(float)
        stated = frame[unit][key == name].dropna().unique() if unit else ()
        units[name] = str(stated[0]) if len(stated) == 1 else ""
    remarks = [
        f"One value a row: '{' and '.join(names)}' names {len(values) - 1} channels, '{value}' holds them."
    ]
    if bad.any():
        remarks.append(f"{bad.sum()} values that are called bad left out.")
    if again:
        remarks.append(
            f"{again} values of a channel at a time that it has one for already: the first is kept."
        )
    return LogColumns(log.source, values, units, (*log.remarks, *remarks))


def brought_together(
    time: np.ndarray, signals: dict[str, tuple[np.ndarray, str]], joined: bool = False
) -> tuple[np.ndarray, dict[str, tuple[np.ndarray, str]], list[str]]:
    """Interpolate channels that never share a row to the times of one of them; leave other logs unchanged.

    Parameters
    ----------
    time : (n,) array
        [s]
    signals : dict of str to ((n,) array, str)
        Values, NaN in rows of other sensors, and units by role.
    joined : bool
        Whether the rows are those of several tables.

    Returns
    -------
    time, signals and list of str
        Interpolated between a channel's own times, angles the short way round, not across holes; remarks.
    """
    is_finite = {name: np.isfinite(values) for name, (values, _) in signals.items()}
    there = {name: rows for name, rows in is_finite.items() if rows.sum() > 1}
    if not there:
        return time, signals, []
    # Times of one channel, preferably the heading, are the common clock.
    base = next(
        (n for n in ("heading", "latitude", "north", "surge") if n in there), next(iter(there))
    )
    # If more than a few rows hold most of the channels, and each channel shares some with the clock's, the log needs
    # no interpolation.
    counts = np.sum(list(there.values()), axis=0)
    together = len(there) < 3 or (counts > 0.5 * len(there)).mean() > _ALONE
    apart = any((rows & there[base]).sum() <= _ALONE * rows.sum() for rows in there.values())
    if not joined and together and not apart:
        return time, signals, []
    clock = np.unique(time[there[base] & np.isfinite(time)])
    interpolated = {}
    # Interpolate each channel from its own rows, in order of time and without repeated times.
    for name, (values, unit) in signals.items():
        rows = usable_rows(np.where(is_finite[name], time, np.nan))
        interpolated[name] = at_times(clock, time[rows], values[rows], unit), unit
    message = f"Rows hold one sensor each: all channels are interpolated to the {len(clock)} times of {base}."
    return clock, interpolated, [message]
