"""The card of a study of many runs."""

from __future__ import annotations

import numpy as np

from shipcosim.report.notebook.card import Card
from shipcosim.report.notebook.figures import distribution_svg
from shipcosim.report.study.page import page_of
from shipcosim.report.study.statistics import distribution
from shipcosim.report.study.tables import QUANTITY, StudyTables
from shipcosim.report.study.words import is_failed
from shipcosim.report.theme.numbers import finite
from shipcosim.report.theme.views import Block, Table

MOST_ROWS = 12


def sweep_card(tables: StudyTables) -> Card:
    """What the study says, its quantities and summary, failed runs, and the distribution of the first quantity."""
    page = page_of(tables)
    failed = [f"{error.count} runs: {error.text}" for error in page.errors[:MOST_ROWS]]
    shown = page.summary.rows[:MOST_ROWS]
    numbers = [
        (f"{name} [{unit}]" if unit else name, *some[1:4])
        for name, unit, *some in page.quantities.rows
    ]
    heading = (
        "Summary"
        if len(shown) == len(tables.summary)
        else f"Summary, {len(shown)} of {len(tables.summary)} rows"
    )
    return Card(
        title=page.title,
        facts=page.facts,
        outcome=page.outcome,
        blocks=(
            Block(
                "Over all runs that did not fail", Table(numbers, ("", "median", "90 %", "largest"))
            ),
            Block(heading, Table(shown, page.summary.head)),
            Block("Failed runs", lines=failed),
        ),
        draw=lambda: _picture(tables),
    )


def _picture(tables: StudyTables) -> str:
    """Share of runs up to each value of the first quantity that is a number, as SVG; empty where there is none."""
    runs = tables.runs.iloc[np.flatnonzero(~is_failed(tables))]
    columns = tables.columns(runs)
    # A quantity that is the same in all runs has no distribution.
    for quantity in columns.values():
        numbers = finite(quantity.values) if quantity.is_number else []
        if quantity.role == QUANTITY and len(numbers) and np.ptp(numbers):
            return distribution_svg(
                f"distribution of {quantity.name}",
                f"Share of runs up to each {quantity.titled}",
                *distribution(quantity.values),
            )
    return ""
