"""Several tables of one log, such as exported topics, below each other in one table, to be joined by their times."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.files.times import epoch_unit
from shipcosim.diagnose.log.names.vocabulary import vocabulary, words_of
from shipcosim.diagnose.numerics import finite, usual_rise
from shipcosim.errors import error_at

_TABLES = (".csv", ".txt", ".tsv", ".dat", ".csv.gz", ".xlsx", ".parquet")
_ROWS_BEFORE = 20  # steps by which a clock is ahead that did not start with its table. Assumed.
_TOGETHER = 0.95  # share of the time that tables of one log have in common. Assumed.


def tables_in(path: Path) -> dict[str, Path]:
    """Files of tables in a folder, by their names; empty for other paths."""
    files = sorted(path.iterdir()) if path.is_dir() else []
    tables = [file for file in files if file.is_file() and file.name.lower().endswith(_TABLES)]
    names = [_without_ending(file.name) for file in tables]
    # Two files that differ in their ending alone keep it.
    return {
        file.name if names.count(name) > 1 else name: file
        for file, name in zip(tables, names, strict=True)
    }


def _without_ending(name: str) -> str:
    return name[: -len(next(ending for ending in _TABLES if name.lower().endswith(ending)))]


def joined(
    path: Path, tables: Mapping[str, LogColumns], times: Mapping[str, Channel | None]
) -> LogColumns:
    """Rows of several tables in one, with the columns of time in common.

    Parameters
    ----------
    path : Path
        The folder or file, for messages.
    tables : mapping of str to LogColumns
        By name of the file or topic.
    times : mapping of str to Channel or None
        Time of each table.

    Raises
    ------
    ShipcosimError
        If a table has no time, times are of several kinds, or may count from different starts.
    """
    first = next(iter(tables))
    if None in times.values():
        message = f"table '{next(name for name in times if times[name] is None)}' has no time."
        raise error_at(str(path), message, "Take it out of the folder, or name its time 'time'.")
    clocks = {name: channel.columns for name, channel in times.items() if channel}
    # All clocks must be of one kind, and count from a common start: a date or the time of day.
    kinds = {name: _kind(table, times[name]) for name, table in tables.items()}
    other = next((name for name in tables if kinds[name] != kinds[first]), None)
    if other is not None:
        message = f"the times of '{first}' and '{other}' are written in different ways."
        raise error_at(str(path), message, "Write the same kind of time in all tables.")
    values = tables[first].values[clocks[first][0]]
    counts = [table.values[clocks[name][0]] for name, table in tables.items()]
    is_count = values.dtype.kind == "f" and epoch_unit(values) is None
    if is_count and not _have_one_clock(list(map(finite, counts))):
        message = f"the times of '{first}' and the other tables may count from different starts."
        raise error_at(str(path), message, "Write times since 1970, or one table with one time.")
    return _below_each_other(path, tables, clocks)


def _have_one_clock(counts):
    """Whether tables of times that count from no date share a start, as those of a computer that was on before."""
    if len(counts) < 2:
        return True
    if not all(map(len, counts)):
        return False
    starts = [float(times.min()) for times in counts]
    ends = [float(times.max()) for times in counts]
    is_later = min(starts) > _ROWS_BEFORE * usual_rise(counts[0], np.inf)
    is_one = min(ends) - max(starts) > _TOGETHER * (max(ends) - min(starts))
    return is_later and is_one


def _kind(table, channel):
    """Types and units of the columns of a time."""
    columns = [(table.values[name].dtype.kind, table.units[name]) for name in channel.columns]
    epoch = epoch_unit(table.values[channel.column]) if columns[0][0] == "f" else None
    return channel.unit, tuple(columns), epoch


def _below_each_other(path, tables, clocks):
    import pandas

    common = clocks[next(iter(tables))]
    units = {}
    frames = []
    names = [column for table in tables.values() for column in table.values]
    for name, table in tables.items():
        # The columns of time stand in all rows; any other one in the rows of its table, and is empty elsewhere.
        labels = dict(zip(clocks[name], common, strict=True))
        for column in table.values.keys() - labels.keys():
            labels[column] = f"{name}.{column}" if _needs_table(name, column, names) else column
            if len(table.values) == 2 and column.lower() == "value":
                labels[column] = name  # a file for each signal
        frames.append(pandas.DataFrame(table.values).rename(columns=labels))
        units = {labels[column]: unit for column, unit in table.units.items()} | units
    whole = pandas.concat(frames, ignore_index=True)
    order = [*common, *(column for column in whole if column not in common)]
    values = {column: _cells(whole[column]) for column in order}
    remarks = [f"Tables joined by time: {', '.join(tables)}."]
    remarks += [f"{name}: {remark}" for name, table in tables.items() for remark in table.remarks]
    doubled = tuple(column for table in tables.values() for column in table.doubled)
    return LogColumns(str(path), values, units, tuple(remarks), doubled, joined=True)


def _cells(column):
    """A column of pandas as an array: None for texts that are not there."""
    if column.dtype.kind != "O":
        return column.to_numpy(float if column.dtype.kind in "fiub" else None)
    return column.where(column.notna(), None).to_numpy(object)


def _needs_table(name, column, names):
    """Whether a column needs its table's name: its own name is not clear, or the table has set points."""
    words = vocabulary()["words"]
    fillers = set(words["filler"])
    says_little = all(word in fillers or len(word) == 1 for word in words_of(column))
    of_others = {*words["command"], *words["other"]} & set(words_of(name))
    return names.count(column) > 1 or says_little or bool(of_others)
