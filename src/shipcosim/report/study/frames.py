"""Table of a view, its series, and values gathered over similar runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from shipcosim.report.study.tables import FACTOR, Column, Columns, StudyTables, label
from shipcosim.report.theme import palette
from shipcosim.report.theme.numbers import finite
from shipcosim.sweep.study_model import View
from shipcosim.sweep.summary import mean, wilson

if TYPE_CHECKING:
    from pandas import DataFrame

RUNS = "the runs"
MOST_SERIES = 8
"""Series of a figure: as many as there are colours."""


class Point(NamedTuple):
    """A value with its interval; NaN without one."""

    value: float
    low: float
    high: float


class Lacking(Exception):
    """A view cannot be drawn; its text says why."""


@dataclass(frozen=True)
class Frame:
    """A table of the study, by columns.

    Attributes
    ----------
    name : str
        As the page calls it: runs, summary, or the name of another table.
    columns : mapping of str to Column
    """

    name: str
    columns: Columns

    def column(self, name: str | None) -> Column:
        """A column; if missing, the error lists the columns."""
        if name is None or name not in self.columns:
            raise Lacking(
                f"There is no column '{name}' in {self.name}. There is: {', '.join(self.columns)}."
            )
        return self.columns[name]

    @cached_property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values())).values) if self.columns else 0


@dataclass(frozen=True)
class SeriesOfRows:
    """Rows that are drawn together: their label, colour and numbers."""

    label: str
    colour: str
    rows: NDArray


def narrowed(tables: StudyTables, view: View) -> StudyTables:
    """Tables with the rows of a view: all, or those with the values of its `only`.

    Raises
    ------
    Lacking
        If no table has such a column, or none such a value.
    """
    every = tables.every
    # A misspelt column or value must not give an empty figure.
    for name, values in view.only.items():
        having = {key: table for key, table in every.items() if name in table}
        if not having:
            raise Lacking(
                f"only: there is no column '{name}'. There is: {', '.join(map(str, tables.runs.columns))}."
            )
        # A single value counts as a list of one.
        wanted = {label(value) for value in (values if isinstance(values, list) else [values])}
        if missing := wanted - {label(value) for table in having.values() for value in table[name]}:
            raise Lacking(f"only: no row has {name} = {', '.join(sorted(missing))}.")
        # Every table that has the column is narrowed.
        for key, table in having.items():
            every[key] = cast("DataFrame", table[table[name].map(label).isin(list(wanted))])
    return replace(tables, runs=every.pop("runs"), summary=every.pop("summary"), tables=every)


def frame_of(tables: StudyTables, name: str | None, needed: Sequence[str | None]) -> Frame:
    """Table of a view: the one of a name, else the summary if it has all columns, else the runs.

    Raises
    ------
    Lacking
        If the table that it names is not there.
    """
    if name:
        every = tables.every
        if name not in every:
            raise Lacking(f"There is no table '{name}'. There is: {', '.join(every)}.")
        title = f"the table '{name}'" if name in tables.tables else f"the {name}"
        return Frame(title, tables.columns(every[name]))
    # The summary serves only if it has all needed columns.
    if not {*needed} <= {*map(str, tables.summary.columns)}:
        return Frame(RUNS, tables.columns(tables.runs))
    rows = tables.summary.dropna(
        subset=list(needed)
    )  # summaries over other factors have rows of their own
    return Frame("the summary", tables.columns(rows.dropna(axis="columns", how="all")))


def series_of(
    frame: Frame, factors: Sequence[str] | None, taken: Sequence[str]
) -> list[SeriesOfRows]:
    """Series of a view: levels of the named factors; else of unused factors, unless it shows runs.

    Parameters
    ----------
    frame : Frame
    factors : sequence of str, optional
        Names of the factors; empty for a single series.
    taken : sequence of str
        Columns that are axes of the view.

    Returns
    -------
    list of SeriesOfRows
        At most eight, in the order of their levels.
    """
    # Without a choice, all factors that are no axis; runs are then one series.
    if factors is None:
        free = [
            c.name
            for c in frame.columns.values()
            if c.role == FACTOR and c.name not in taken and c.levels
        ]
        factors = free if frame.name != RUNS else []
    # Series are the combinations of levels that occur.
    columns = [frame.column(name) for name in factors]
    keys = np.array([column.values for column in columns]).reshape(len(columns), frame.rows).T
    levels, place = keys[:1], np.zeros(frame.rows, int)
    if columns:
        levels, place = np.unique(keys, axis=0, return_inverse=True)
    # At most as many series as colours.
    series = []
    for k, key in enumerate(levels[:MOST_SERIES]):
        texts = [c.text(v, with_name=not c.labels) for c, v in zip(columns, key, strict=True)]
        rows = np.flatnonzero(place.ravel() == k)
        series.append(SeriesOfRows(", ".join(texts), palette.CYCLE[k], rows))
    return series


def left_out(frame: Frame, drawn: Sequence[SeriesOfRows]) -> str:
    """Sentence on rows that no series contains; empty if all are drawn."""
    missing = frame.rows - sum(len(group.rows) for group in drawn)
    return (
        f"{missing} of {frame.rows} rows are in further series, which are not drawn."
        if missing
        else ""
    )


def gathered(frame: Frame, column: Column, rows: NDArray) -> Point:
    """Value of similar rows: of a single row with its interval, else mean or share over them."""
    # A single row may have its interval in columns of its own.
    if len(rows) == 1:
        limits = [frame.columns.get(f"{column.name}_{end}") for end in ("low", "high")]
        ends = [np.nan if limit is None else float(limit.values[rows[0]]) for limit in limits]
        return Point(float(column.values[rows[0]]), *ends)
    # Several rows: share with Wilson's interval, or mean with Student's.
    numbers = finite(column.values[rows])
    if column.is_truth and len(numbers):
        return Point(*wilson(int(numbers.sum()), len(numbers)))
    return Point(*mean(numbers))


def how_gathered(frame: Frame, column: Column, groups: Sequence[NDArray]) -> str:
    """Sentence on what a value and its interval are; empty if neither needs one."""
    # Single rows: the interval of the table.
    if all(len(rows) <= 1 for rows in groups):
        has_interval = f"{column.name}_low" in frame.columns
        return f"Interval: as in {frame.name}, 95 %." if has_interval else ""
    # Otherwise tell how many runs a value is gathered from.
    counts = [len(rows) for rows in groups if len(rows)]
    of = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"
    if column.is_truth:
        return f"Share of {of} runs each; 95 % interval by Wilson's score."
    return f"Mean of {of} runs each; 95 % interval of the mean."
