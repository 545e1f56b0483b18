"""The page of a study: what it shows, and the function that writes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from shipcosim.report.study import figures, words
from shipcosim.report.study.frames import Lacking, narrowed
from shipcosim.report.study.tables import Column, Columns, StudyTables, signed
from shipcosim.report.study.tracks import TracksView, tracks_view
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import evenly
from shipcosim.report.theme.numbers import extent
from shipcosim.report.theme.packing import most_rows, packed_series
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Figure,
    Figures,
    JsonObject,
    Outcome,
    Page,
    Table,
)
from shipcosim.sweep.study_model import View

BYTES_FOR_RUNS = 800_000  # of a page that shall stay below 1.6 MB
EXACT = 1e9  # steps of the numbers of runs
VIEWS: Mapping[str, Callable[[StudyTables, View], Figure]] = {
    "polar": figures.polar,
    "curves": figures.curves,
    "bars": figures.bars,
    "pareto": figures.pareto,
    "scatter": figures.scatter,
}


class Choice(NamedTuple):
    """A column that readers filter by level: name, title, and each level with its text."""

    column: str
    title: str
    levels: Sequence[tuple[float, str]]


@dataclass(frozen=True)
class StudyPage(Page):
    """What the page of a study shows.

    Attributes
    ----------
    remarks : sequence of str
        What must not be overlooked, and views that cannot be drawn.
    tracks : sequence of TracksView
        Charts of recorded tracks.
    plots, figures : sequence of Figure
        Views, and all figures in the order of `data["figures"]`.
    quantities, summary : Table
    thinned : tuple of int, optional
        How many runs the page holds of how many, where it does not hold all.
    errors : sequence of (str, sequence of int)
        Messages, and the runs that have them.
    choices : sequence of Choice
        Columns that are filtered by level.
    text : str
        The study as it was read, its engine and versions.
    """

    remarks: Sequence[str]
    tracks: Sequence[TracksView]
    plots: Figures
    figures: Figures
    quantities: Table
    summary: Table
    thinned: tuple[int, int] | None
    errors: Sequence[tuple[str, Sequence[int]]]
    choices: Sequence[Choice]
    text: str


def render(tables: StudyTables) -> str:
    """The page of a study as HTML."""
    return render_template("study/templates/study.html.jinja", page_of(tables))


def outcome_of(tables: StudyTables) -> Outcome:
    """Result of a study in one sentence, without its views."""
    return words.outcome(tables, tables.columns(tables.runs), tables.columns(tables.summary))


def page_of(tables: StudyTables) -> StudyPage:
    """Contents of the page of a study."""
    # Columns with units and roles, as the study describes them.
    runs = tables.columns(tables.runs)
    summary = tables.columns(tables.summary)
    # Views first: a section without content is left out.
    tracks, plots, undrawn = _views(tables)
    drawn = (*plots, *(view.distance for view in tracks))
    # As many runs as the page has room for.
    rows = _kept_rows(tables, list(runs.values()))
    return StudyPage(
        title=str(tables.study.get("description") or tables.name),
        facts=words.facts(tables),
        outcome=words.outcome(tables, runs, summary),
        data=_data(tables, runs, rows, tracks, drawn),
        remarks=[*map(str, tables.about.get("remarks") or ()), *undrawn],
        tracks=tracks,
        plots=plots,
        figures=drawn,
        quantities=words.quantities_table(runs),
        summary=summary_table(summary),
        thinned=(len(rows), len(tables.runs)) if len(rows) < len(tables.runs) else None,
        errors=words.errors(tables)[: words.MOST_ERRORS],
        choices=_choices(runs),
        text=words.study_text(tables.about),
    )


def _views(
    tables: StudyTables,
) -> tuple[Sequence[TracksView], Figures, Sequence[str]]:
    """Views of the study; a view that cannot be drawn does not affect the others."""
    tracks = []
    plots = []
    undrawn = []
    for content in tables.study.get("view") or ():
        # Each view with its own rows; the reason stands in place of a missing one.
        try:
            view = View.model_validate(content)
            shown = narrowed(tables, view)
            if view.kind == "tracks":
                tracks.append(tracks_view(shown, view))
            else:
                plots.append(VIEWS[view.kind](shown, view))
        except (Lacking, ValidationError) as lack:
            undrawn.append(f"View '{content.get('kind')}' is not drawn. {lack}")
    return tracks, plots, undrawn


def _kept_rows(tables: StudyTables, columns: Sequence[Column]) -> NDArray:
    """Rows that fit on the page: failed ones, at most half of all, and evenly spaced others."""
    # Columns with levels need little space: only numbers count.
    varying = [column.values for column in columns if column.is_number and not column.levels]
    most = most_rows([*varying, np.arange(len(tables.runs))], BYTES_FOR_RUNS)
    if len(tables.runs) <= most:
        return np.arange(len(tables.runs))
    # Failed runs first: these are what readers look for.
    failed = words.is_failed(tables)
    parts = [np.flatnonzero(failed)[: most // 2]]
    # The others evenly spaced.
    others = np.flatnonzero(~failed)
    room = min(most - len(parts[0]), len(others))
    parts.append(others[evenly(len(others), room)])
    return np.sort(np.concatenate(parts))


def _data(
    tables: StudyTables,
    columns: Columns,
    rows: NDArray,
    tracks: Sequence[TracksView],
    drawn: Sequence[Figure],
) -> JsonObject:
    """Data for the scripts of the page."""
    # Error texts are stored once, each run refers to its text.
    failed = words.is_failed(tables)[rows]
    kept = tables.runs.iloc[rows]
    texts = [str(error) for error in kept["error"][failed]] if "error" in kept else []
    different = list(dict.fromkeys(texts))
    place = {text: k for k, text in enumerate(different)}
    # The column whose values colour the lines at first: what is true or false, else a factor of few levels.
    truths = [c.name for c in columns.values() if c.is_truth and len(c.levels) > 1]
    factors = [
        c.name
        for c in columns.values()
        if c.role == "factor" and 1 < len(c.levels) <= len(palette.CYCLE)
    ]
    coloured = next(iter([*truths, *factors]), "")
    return {
        "runs": packed_series(kept["run"].to_numpy(float), EXACT),
        "columns": [_packed(column, rows) for column in columns.values()],
        "failed": np.flatnonzero(failed).tolist(),
        "errors": different,
        "errorOf": [place[text] for text in texts],
        "pages": sorted(int(number) for number in tables.pages),
        "command": tables.command,
        "colour": coloured,
        "cycle": palette.CYCLE,
        "tracks": [view.data for view in tracks],
        "figures": [figure.drawn for figure in drawn],
    }


def _packed(column: Column, rows: NDArray) -> JsonObject:
    """A column for the script: levels by their places, numbers as they are."""
    # Description of the column, then its values.
    values = column.values[rows]
    made = {name: getattr(column, name) for name in ("name", "role", "description", "unit")}
    made |= {"labels": column.labels, "truth": column.is_truth}
    # Few levels: small integers instead of numbers.
    if column.levels and column.is_number:
        place = {level: k for k, level in enumerate(column.levels)}
        return made | {
            "levels": column.levels,
            "places": [place.get(v, -1) for v in values.tolist()],
        }
    if not column.is_number:
        return made | {"values": [int(v) if np.isfinite(v) else None for v in values]}
    # Decimals that tell a thousandth of a column's range apart.
    span = extent(column.values)
    digits = int(np.clip(3 - np.floor(np.log10(span)) - 1, 0, 9)) if span > 0.0 else 3
    return made | {"values": packed_series(values), "digits": digits}


def _choices(columns: Columns) -> Sequence[Choice]:
    chosen = [
        c for c in columns.values() if len(c.levels) > 1 and (c.role == "factor" or c.is_truth)
    ]
    choices = []
    for column in chosen:
        # Levels are written without their unit, which the column's title has.
        levels = [(level, _cell(column, level, 6)) for level in column.levels]
        choices.append(Choice(column.name, column.titled, levels))
    return choices


def summary_table(columns: Columns) -> Table:
    """Columns as texts in units to read, each interval in the cell of its value; at most the first rows."""
    # Ends of intervals are shown in the cell of their value.
    ends = {f"{name}_{end}" for name in columns for end in ("low", "high")}
    shown = [column for name, column in columns.items() if name not in ends]
    count = min(len(shown[0].values), MOST_SUMMARY) if shown else 0
    rows = tuple([_with_interval(columns, column, k) for column in shown] for k in range(count))
    return Table(rows, [column.titled for column in shown])


def _with_interval(columns: Columns, column: Column, row: int) -> str:
    """A cell of the summary, with its interval if it has one."""
    if column.ranges:
        return column.text_at(row)
    # Value first, then both ends in brackets.
    cell = _cell(column, column.values[row])
    limits = [columns.get(f"{column.name}_{end}") for end in ("low", "high")]
    ends = [limit.values[row] for limit in limits if limit is not None]
    if len(ends) < 2 or np.isnan(ends).all():
        return cell
    texts = [signed(end, 3) if np.isfinite(end) else column.text(end) for end in ends]
    return f"{cell} ({' to '.join(texts)})"


MOST_SUMMARY = 400
"""Rows of the summary on the page; summary.csv holds all."""


def _cell(column: Column, value: float, digits: int = 4) -> str:
    """A value without its unit and its name."""
    if column.labels or not np.isfinite(value):
        return column.text(value)
    if column.is_truth:
        return "yes" if value else "no"
    return signed(value, digits)
