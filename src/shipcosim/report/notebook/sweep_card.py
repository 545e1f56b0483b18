"""The card of a study of many runs."""

from __future__ import annotations

import numpy as np

from shipcosim.report.notebook.card import Block, Card
from shipcosim.report.notebook.sheet import COLOURS, GRID, INK, Sheet, tick_text, ticks
from shipcosim.report.study.page import page_of
from shipcosim.report.study.statistics import distribution
from shipcosim.report.study.tables import QUANTITY, Column, StudyTables, columns_of
from shipcosim.report.study.words import is_failed
from shipcosim.report.theme import palette
from shipcosim.report.theme.views import Table

MOST_ROWS = 12
_WIDE = 400.0  # px
_TALL = 300.0
_LEFT = 46.0
_TOP = 30.0
_BELOW = 38.0


def sweep_card(tables: StudyTables) -> Card:
    """What the study says, its quantities and summary, failed runs, and the distribution of the first quantity."""
    page = page_of(tables)
    failed = tuple(f"{one.count} runs: {one.text}" for one in page.errors[:MOST_ROWS])
    shown = page.summary.rows[:MOST_ROWS]
    numbers = tuple(
        (f"{name} [{unit}]" if unit else name, *some[1:4])
        for name, unit, *some in page.quantities.rows
    )
    heading = (
        "Summary"
        if len(shown) == len(tables.summary)
        else f"Summary, {len(shown)} of {len(tables.summary)} rows"
    )
    return Card(
        title=page.title,
        facts=page.facts,
        outcome=page.outcome,
        links=(),
        data=(),
        blocks=(
            Block(
                "Over all runs that did not fail", Table(numbers, ("", "median", "90 %", "largest"))
            ),
            Block(heading, Table(shown, page.summary.head)),
            Block("Failed runs", lines=failed),
        ),
        picture=_picture(tables),
    )


def _picture(tables: StudyTables) -> str:
    """Share of runs up to each value of the first quantity that is a number, as SVG; empty where there is none."""
    runs = tables.runs.iloc[np.flatnonzero(~is_failed(tables))]
    columns = columns_of(runs, tables.about.get("columns", ()))
    numbers = (c for c in columns.values() if c.role == QUANTITY and c.is_number)
    quantity = next(
        (c for c in numbers if np.ptp(c.values[np.isfinite(c.values)] if c.values.size else [0.0])),
        None,
    )
    if quantity is None:
        return ""
    sheet = Sheet(_WIDE, _TALL, f"distribution of {quantity.name}")
    reached, share, half = distribution(quantity.values)
    low = float(reached[0])
    high = float(reached[-1])

    def across(value):
        return _LEFT + (value - low) / (high - low) * (_WIDE - _LEFT - 14.0)

    def down(share):
        return _TOP + (1.0 - share) * (_TALL - _TOP - _BELOW)

    _frame(
        sheet,
        quantity,
        [(at, across(at)) for at in ticks(low, high)],
        [(at, down(at)) for at in ticks(0.0, 1.0)],
    )
    # A curve that stays until the next value.
    x = np.repeat(across(reached), 2)[1:]
    y = np.repeat(share, 2)[:-1]
    colour = COLOURS[palette.BLUE]
    for edge in (-half, half):
        sheet.curve(x, down(np.clip(y + edge, 0.0, 1.0)), colour, "2 3", 0.8)
    sheet.curve(x, down(y), colour, width=2.0)
    return str(sheet)


def _frame(
    sheet: Sheet,
    quantity: Column,
    columns: list[tuple[float, float]],
    rows: list[tuple[float, float]],
) -> None:
    """Title, grid and the numbers of both axes."""
    sheet.write(
        f"Share of runs up to each {quantity.titled}", 8.0, 16.0, fill=INK, font_weight="600"
    )
    for at, x in columns:
        sheet.draw("line", x1=x, x2=x, y1=_TOP, y2=_TALL - _BELOW, stroke=GRID)
        sheet.write(tick_text(at), x, _TALL - _BELOW + 15.0, text_anchor="middle")
    for at, y in rows:
        sheet.draw("line", x1=_LEFT, x2=_WIDE - 14.0, y1=y, y2=y, stroke=GRID)
        sheet.write(tick_text(at), _LEFT - 6.0, y + 4.0, text_anchor="end")
    sheet.write("dotted: 95 % band (Dvoretzky-Kiefer-Wolfowitz)", _LEFT, _TALL - 6.0)
