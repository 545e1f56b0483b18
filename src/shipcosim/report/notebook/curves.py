"""Signals over time, panel below panel: those of one unit together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.report.notebook.sheet import (
    COLOURS,
    GRID,
    INK,
    WIDTH,
    Sheet,
    legend_rows,
    tick_text,
    ticks,
)
from shipcosim.report.theme import palette
from shipcosim.report.theme.display import is_constant, thinned

MOST_CURVES = 8
MOST_PANELS = 12
_LEFT = 64.0  # px
_RIGHT = 14.0
_PLOT = 120.0
_BELOW = 16.0
_ROWS = WIDTH - 80  # rows drawn: an extreme up and one down for each two pixels


@dataclass(frozen=True)
class Curve:
    """One signal of a panel; `dash` as SVG has it."""

    label: str
    time: NDArray
    values: NDArray
    colour: str
    dash: str = ""


@dataclass(frozen=True)
class Panel:
    """Curves of one unit."""

    title: str
    unit: str
    curves: tuple[Curve, ...]


def panels_of(shown: Dataset, names: Sequence[str]) -> list[Panel]:
    """Panels of some signals of a table, one for each unit, with at most eight curves each.

    Parameters
    ----------
    shown : xarray.Dataset
        In the units of the page, as `report.theme.display.display_table` gives it.
    names : sequence of str
        Signals that are to be drawn, in their order.

    Returns
    -------
    list of Panel
    """
    by_unit: dict[str, list[str]] = {}
    for name in names:
        by_unit.setdefault(shown[name].attrs["units"], []).append(name)
    parts = [
        (unit, group[k : k + MOST_CURVES])
        for unit, group in by_unit.items()
        for k in range(0, len(group), MOST_CURVES)
    ]
    return [_panel(shown, unit, part) for unit, part in parts]


def _panel(shown: Dataset, unit: str, names: Sequence[str]) -> Panel:
    components, connectors = ({name.rpartition(".")[k] for name in names} for k in (0, 2))
    common = components.pop() if len(components) == 1 else ""
    title = common or (connectors.pop() if len(connectors) == 1 else "")
    drawn, _ = thinned(shown[list(names)], int(_ROWS * (len(names) * 4 * 4 / 3 + 16)))
    time = drawn["time"].values
    curves = [
        Curve(
            name.removeprefix(f"{common}."),
            *_ends_if_constant(time, drawn[name].values),
            palette.CYCLE[k],
        )
        for k, name in enumerate(names)
    ]
    return Panel(title, unit, tuple(curves))


def _ends_if_constant(time: NDArray, values: NDArray) -> tuple[NDArray, NDArray]:
    return (time[[0, -1]], values[[0, -1]]) if is_constant(values) else (time, values)


def panels_svg(panels: Sequence[Panel], name: str, events: Sequence[float] = ()) -> str:
    """Panels below each other over one axis of time.

    Parameters
    ----------
    panels : sequence of Panel
        Those beyond the twelfth are only counted, in a line at the end.
    name : str
        What is drawn.
    events : sequence of float
        Marked in every panel. [s]

    Returns
    -------
    str
        SVG.
    """
    drawn = panels[:MOST_PANELS]
    more = len(panels) - MOST_PANELS
    span = _range([curve.time for panel in drawn for curve in panel.curves], 0.0)
    heads = [
        20.0 + 15.0 * len(legend_rows([curve.label for curve in panel.curves])) for panel in drawn
    ]
    height = sum(heads) + len(drawn) * (_PLOT + _BELOW) + 24.0 + 18.0 * (more > 0)
    sheet = Sheet(WIDTH, height, name)
    top = 0.0
    for panel, head in zip(drawn, heads, strict=True):
        _draw(sheet, panel, span, top, head, [t for t in events if span[0] < t < span[1]])
        top += head + _PLOT + _BELOW
    for at in ticks(*span, most=10):
        sheet.write(tick_text(at), _across(at, span), top - 2.0, text_anchor="middle")
    sheet.write("time [s]", (_LEFT + WIDTH - _RIGHT) / 2, top + 14.0, text_anchor="middle")
    if more > 0:
        panels_word = "panels are" if more > 1 else "panel is"
        sheet.write(
            f"{more} more {panels_word} not drawn: name fewer signals.", _LEFT, top + 32.0, fill=INK
        )
    return str(sheet)


def _draw(
    sheet: Sheet,
    panel: Panel,
    span: tuple[float, float],
    top: float,
    head: float,
    events: Sequence[float],
):
    """One panel with its title, legend, grid, marks of events and curves."""
    low, high = _range([curve.values for curve in panel.curves], 0.06)
    bottom = top + head + _PLOT

    def down(values):
        return bottom - (values - low) / (high - low) * _PLOT

    unit = f" [{panel.unit}]" if panel.unit else ""
    sheet.write(
        f"{panel.title}{unit}".strip() or "without unit",
        _LEFT,
        top + 14.0,
        fill=INK,
        font_weight="600",
    )
    sheet.legend(
        [(c.label, COLOURS.get(c.colour, c.colour), c.dash) for c in panel.curves],
        _LEFT,
        top + 30.0,
    )
    _draw_grid(sheet, (low, high), down, span, bottom)
    for at in events:
        x = _across(at, span)
        sheet.draw(
            "line",
            x1=x,
            x2=x,
            y1=bottom - _PLOT,
            y2=bottom,
            stroke="#b4c0cb",
            stroke_dasharray="3 3",
        )
    for curve in panel.curves:
        x = _across(np.asarray(curve.time, float), span)
        sheet.curve(
            x,
            down(np.asarray(curve.values, float)),
            COLOURS.get(curve.colour, curve.colour),
            curve.dash,
        )


def _draw_grid(sheet, limits, down, span, bottom):
    """Lines and numbers at round values and times."""
    low, high = limits
    for at in ticks(low, high, most=5):
        sheet.draw("line", x1=_LEFT, x2=WIDTH - _RIGHT, y1=down(at), y2=down(at), stroke=GRID)
        sheet.write(tick_text(at), _LEFT - 6.0, down(at) + 4.0, text_anchor="end")
    for at in ticks(*span, most=10):
        sheet.draw(
            "line",
            x1=_across(at, span),
            x2=_across(at, span),
            y1=bottom - _PLOT,
            y2=bottom,
            stroke=GRID,
        )


def _across(time, span):
    """Place of a time. [px]"""
    return _LEFT + (time - span[0]) / (span[1] - span[0]) * (WIDTH - _LEFT - _RIGHT)


def _range(series: Sequence[NDArray], margin: float) -> tuple[float, float]:
    """Least and largest finite value, apart, with a margin as a share of what is between them."""
    finite = [values[np.isfinite(values)] for values in (np.asarray(one, float) for one in series)]
    known = np.concatenate([*finite, []])
    if not len(known):
        return 0.0, 1.0
    low = float(known.min())
    high = float(known.max())
    if high - low <= 1e-12 * max(abs(low), abs(high), 1e-6):
        room = 0.5 * abs(low) or 0.5
        return low - room, high + room
    return low - margin * (high - low), high + margin * (high - low)
