"""A study in words: result, quantities, how it was made."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shipcosim.errors import capitalised
from shipcosim.report.study.statistics import explained
from shipcosim.report.study.tables import (
    FACTOR,
    QUANTITY,
    SAMPLE,
    SUMMARY,
    Column,
    Columns,
    StudyTables,
)
from shipcosim.report.theme.numbers import finite, percent, plain
from shipcosim.report.theme.views import Fact, Outcome, Table
from shipcosim.sweep.summary import wilson

MOST_ERRORS = 50
MATTERS = 0.05
"""Share of a variance from which a factor is named."""


def facts(tables: StudyTables) -> Sequence[Fact]:
    """Facts of a study: scenario, number of runs, seed, engine."""
    about = tables.about
    study = tables.study
    # Fewer runs than planned: show both numbers.
    runs = about.get("runs") or {}
    planned = runs.get("planned")
    texts = {
        "Study": tables.name,
        "Scenario": study.get("scenario"),
        "Runs": f"{len(tables.runs)} of {planned}"
        if planned and planned != len(tables.runs)
        else len(tables.runs),
        "Seed": study.get("seed", about.get("seed")),
        "Engine": about.get("engine"),
    }
    return [Fact(name, str(text)) for name, text in texts.items() if text not in (None, "")]


def outcome(tables: StudyTables, runs: Columns, summary: Columns) -> Outcome:
    """Result of the study in one sentence."""
    # The summary says most; else the first quantity over all runs.
    failed = int(is_failed(tables).sum())
    count = len(tables.runs)
    word = f"{count} runs" if count != 1 else "1 run"
    sentence = _of_summary(summary) or _of_runs(runs) or "No quantity has a value."
    if failed:
        sentence += f" {failed} of {count} runs failed."
    return Outcome(
        "failed" if failed == count else "partial" if failed else "named", word, sentence
    )


def _first(columns: Columns, role: str) -> Column | None:
    """The first column of a role that has a value."""
    having = (c for c in columns.values() if c.role == role and np.isfinite(c.values).any())
    return next(having, None)


def _of_summary(summary: Columns) -> str:
    """Range of the first summary, and where its ends lie."""
    column = _first(summary, SUMMARY)
    if column is None:
        return ""
    name = capitalised(column.description or column.name.replace("_", " "))
    # One row, one value everywhere, or a range with the factors of its ends.
    if len(column.values) == 1:
        return f"{name}: {column.text_at(0)}."
    low = int(np.nanargmin(column.values))
    high = int(np.nanargmax(column.values))
    if column.values[low] == column.values[high]:
        return f"{name}: {column.text_at(low)} everywhere."
    factors = [c for c in summary.values() if c.role in (FACTOR, SAMPLE)]
    ends = []
    for row in (low, high):
        where = ", ".join(c.text(c.values[row], with_name=not c.labels) for c in factors)
        ends.append(f"{column.text_at(row)} ({where or 'one row'})")
    return f"{name}: from {ends[0]} to {ends[1]}."


def _of_runs(runs: Columns) -> str:
    """First quantity over all runs."""
    column = _first(runs, QUANTITY)
    if column is None:
        return ""
    # Share with Wilson's interval for true or false, else median, 90 % and largest value.
    numbers = finite(column.values)
    name = capitalised(column.description or column.name)
    if column.is_truth:
        _, low, high = wilson(int(numbers.sum()), len(numbers))
        return f"{name}: {percent(numbers.mean())} of runs (95 % interval {percent(low)} to {percent(high)})."
    low, middle, high = np.quantile(numbers, [0.0, 0.5, 0.9])
    most = column.text(numbers.max())
    return f"{name}: {column.text(middle)} in the median, {column.text(high)} in nine of ten runs, {most} at most."


def quantities_table(runs: Columns) -> Table:
    """Each quantity over all runs, and the factors that explain most of its variance."""
    causes = [c for c in runs.values() if c.role in (FACTOR, SAMPLE)]
    rows = []
    # Runs without a value are counted: quantiles leave them out.
    for column in (c for c in runs.values() if c.role == QUANTITY):
        finite_values = finite(column.values)
        missing = (
            str(len(column.values) - len(finite_values))
            if len(finite_values) < len(column.values)
            else "–"
        )
        if column.is_truth or not len(finite_values):
            share = percent(finite_values.mean(), 1) if len(finite_values) else "–"
            numbers = ("", f"yes in {share}", "", "")
        else:
            numbers = [plain(v) for v in np.quantile(finite_values, [0.0, 0.5, 0.9, 1.0])]
        rows.append((column.name, column.unit, *numbers, missing, _varies_with(column, causes)))
    head = (
        "quantity",
        "unit",
        "least",
        "median",
        "90 %",
        "largest",
        "no value",
        "varies most with",
    )
    return Table(rows, head)


def _varies_with(column: Column, causes: Sequence[Column]) -> str:
    """Factors that explain most of a quantity's variance, each alone."""
    if column.labels:
        return "–"
    shares = {
        cause.name: explained(column.values, cause.values, bool(cause.levels)) for cause in causes
    }
    # Only factors with a share that matters, at most three.
    named = [
        name for name in sorted(shares, key=lambda name: -shares[name]) if shares[name] >= MATTERS
    ]
    return ", ".join(f"{name} ({percent(shares[name])})" for name in named[:3]) or "–"


def is_failed(tables: StudyTables) -> NDArray:
    """True for failed runs, (n,) of bool."""
    if "error" not in tables.runs:
        return np.zeros(len(tables.runs), bool)
    return np.array(
        [isinstance(error, str) and bool(error) for error in tables.runs["error"]], bool
    )


def errors(tables: StudyTables) -> Sequence[tuple[str, Sequence[int]]]:
    """Error messages with their runs, the most frequent first."""
    failed = tables.runs[is_failed(tables)]
    if failed.empty:
        return ()
    groups = failed.groupby("error", sort=False)["run"]
    by_runs = [(str(message), runs.tolist()) for message, runs in groups]
    return sorted(by_runs, key=lambda entry: -len(entry[1]))


def study_text(about: Mapping[str, Any]) -> str:
    """The study as read, with everything it inherits, and what ran it."""
    content = {name: about.get(name) for name in ("engine", "plan", "versions", "study")}
    return json.dumps(content, indent=2, ensure_ascii=False, default=str)
