"""A sheet of SVG: shapes and texts by their places in pixels, ticks of an axis, legends."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from shipcosim.report.theme import palette

WIDTH = 760  # px
INK = "#1f2933"
SOFT = "#52606d"
GRID = "#e4e7eb"
COLOURS = {
    palette.BLUE: "#0072b2",
    palette.VERMILLION: "#d55e00",
    palette.GREEN: "#009e73",
    palette.ORANGE: "#e69f00",
    palette.SKY: "#56b4e9",
    palette.PURPLE: "#b0558a",
    palette.OLIVE: "#8a7f00",
    palette.INK: INK,
    palette.FAINT: "#b4c0cb",
}
"""The light ones of `theme.css`: a picture in a notebook stands on white, whatever the notebook's own colours."""
_FONT = "system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
_APART = 0.7  # px, points of a curve
_LETTER = 6.3  # px, mean width at 11 px


class Sheet:
    """A white sheet.

    Parameters
    ----------
    width, height : float
        [px]
    name : str
        What is drawn, for those who cannot see it.
    """

    def __init__(self, width: float, height: float, name: str):
        self.root = ElementTree.Element(
            "svg",
            {
                "xmlns": "http://www.w3.org/2000/svg",
                "viewBox": f"0 0 {width:g} {height:g}",
                "width": f"{width:g}",
                "height": f"{height:g}",
                "style": "max-width:100%;height:auto",
                "role": "img",
                "font-family": _FONT,
                "font-size": "11",
            },
        )
        ElementTree.SubElement(self.root, "title").text = name
        self.draw("rect", width=width, height=height, fill="#ffffff")

    def draw(self, shape: str, **attributes: str | float) -> ElementTree.Element:
        """A shape of SVG; ``stroke_width`` stands for stroke-width."""
        given = {name.replace("_", "-"): _text(value) for name, value in attributes.items()}
        return ElementTree.SubElement(self.root, shape, given)

    def write(self, text: str, x: float, y: float, **attributes: str | float) -> None:
        """A text whose anchor is at a place."""
        self.draw("text", **({"x": x, "y": y, "fill": SOFT} | attributes)).text = text

    def curve(
        self, x: NDArray, y: NDArray, colour: str, dash: str = "", width: float = 1.5
    ) -> None:
        """A line through points, with gaps where one is no number."""
        dashes: dict[str, str | float] = {"stroke_dasharray": dash} if dash else {}
        for points in _runs(x, y):
            shown = {
                "stroke": colour,
                "stroke_width": width,
                "stroke_linejoin": "round",
                "fill": "none",
            }
            self.draw("polyline", points=points, **shown, **dashes)

    def legend(self, entries: Sequence[tuple[str, str, str]], x: float, y: float) -> None:
        """Entries of (label, colour, dash), row by row, where `legend_rows` breaks them."""
        for row, part in enumerate(legend_rows([label for label, _, _ in entries])):
            at = x
            for k in part:
                label, colour, dash = entries[k]
                self.curve(
                    np.array([at, at + 16.0]), np.full(2, y + 15.0 * row - 4.0), colour, dash, 2.0
                )
                self.write(label, at + 21.0, y + 15.0 * row)
                at += _width(label)

    def __str__(self) -> str:
        return ElementTree.tostring(self.root, encoding="unicode")


def legend_rows(labels: Iterable[str]) -> list[list[int]]:
    """Which labels stand in which row of a legend.

    Examples
    --------
    >>> legend_rows(["port", "starboard", "x" * 100])
    [[0, 1], [2]]
    """
    rows: list[list[int]] = [[]]
    used = 0.0
    for k, label in enumerate(labels):
        if rows[-1] and used + _width(label) > WIDTH - 90.0:
            rows.append([])
            used = 0.0
        rows[-1].append(k)
        used += _width(label)
    return rows


def ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Round numbers within a range, at most so many.

    Examples
    --------
    >>> ticks(-3.0, 21.0)
    [0.0, 5.0, 10.0, 15.0, 20.0]
    """
    span = high - low
    if not (math.isfinite(span) and span > 0.0):
        return [low] if math.isfinite(low) else []
    power = 10.0 ** math.floor(math.log10(span / most))
    step = next(power * m for m in (1.0, 2.0, 5.0, 10.0, 20.0) if span / (power * m) <= most)
    return [
        round(k * step, 12)
        for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    ]


def tick_text(value: float) -> str:
    """A tick as people write it, with a true minus.

    Examples
    --------
    >>> tick_text(-2.5), tick_text(100000.0)
    ('−2.5', '100000')
    """
    return f"{value:.6g}".replace("-", "−")


def _width(label: str) -> float:
    return 21.0 + _LETTER * len(label) + 14.0


def _text(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.1f}".removesuffix(".0")


def _runs(x: NDArray, y: NDArray) -> Iterable[str]:
    """Points between gaps, as SVG writes them, without those that lie on the one before."""
    known = np.isfinite(x) & np.isfinite(y)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        yield " ".join(
            f"{a:.1f},{b:.1f}"
            for a, b in _apart(list(zip(x[first:last], y[first:last], strict=True)))
        )


def _apart(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Points of which each is apart from the one before; the last one stays."""
    kept = points[:1]
    for point in points[1:-1]:
        if max(abs(point[0] - kept[-1][0]), abs(point[1] - kept[-1][1])) >= _APART:
            kept.append(point)
    return kept + points[1:][-1:]
