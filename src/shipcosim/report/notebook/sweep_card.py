"""The card of a study of many runs."""

from __future__ import annotations

from shipcosim.report.notebook.card import Card
from shipcosim.report.study.page import page_of
from shipcosim.report.study.tables import StudyTables
from shipcosim.report.theme.views import Block, Table

MOST_ROWS = 12


def sweep_card(tables: StudyTables) -> Card:
    """What the study says, its quantities and summary, and failed runs."""
    page = page_of(tables)
    failed = [f"{len(runs)} runs: {text}" for text, runs in page.errors[:MOST_ROWS]]
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
    )
