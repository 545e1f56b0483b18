"""A track on a chart: north up, one scale both ways, the ship drawn to scale where her size is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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
from shipcosim.report.run.track import SLENDERNESS, SYMBOL, hull_outline, outline_rows, placed
from shipcosim.report.theme import palette

_LEFT = 64.0  # px
_RIGHT = 14.0
_BELOW = 40.0
_LEAST = 240.0
_MOST = 560.0
_ROWS = 1500  # of a path, drawn


@dataclass(frozen=True)
class Path:
    """A way over ground.

    Attributes
    ----------
    label : str
    x, y : (n,) array
        North and east. [m]
    psi : (n,) array, optional
        Heading: outlines of the ship stand on the way where it is known. [deg]
    colour, dash : str
    """

    label: str
    x: NDArray
    y: NDArray
    psi: NDArray | None = None
    colour: str = palette.SHIP
    dash: str = ""


@dataclass(frozen=True)
class Circle:
    """Where the ship is expected: centre north and east, radius, and whether she was there. [m]"""

    x: float
    y: float
    radius: float
    passed: bool


@dataclass(frozen=True)
class _Scale:
    """From metres to pixels."""

    west: float
    north: float
    pixels: float
    top: float

    def place(self, east, north):
        return _LEFT + (east - self.west) * self.pixels, self.top + (
            self.north - north
        ) * self.pixels


@dataclass
class _Extent:
    """What lies on the chart. [m]"""

    east: list[float] = field(default_factory=list)
    north: list[float] = field(default_factory=list)

    def add(self, east: NDArray, north: NDArray) -> None:
        known = np.isfinite(east) & np.isfinite(north)
        self.east += [float(value) for value in east[known]]
        self.north += [float(value) for value in north[known]]


def chart_svg(
    paths: Sequence[Path],
    name: str,
    size: tuple[float, float] | None = None,
    circles: Sequence[Circle] = (),
) -> str:
    """Ways on a chart.

    Parameters
    ----------
    paths : sequence of Path
        The ship's own last.
    name : str
        What is drawn.
    size : (float, float), optional
        Length and breadth of the ship; a small symbol shows where she was without. [m, m]
    circles : sequence of Circle
        Of expectations.

    Returns
    -------
    str
        SVG.
    """
    outlines = {id(path): _outlines(path, size) for path in paths if path.psi is not None}
    east, north = _ranges(paths, outlines.values(), circles)
    entries = [(path.label, COLOURS[path.colour], path.dash) for path in paths]
    entries += [("expected within", COLOURS[palette.PASSED], "")] if circles else []
    head = 15.0 * len(legend_rows([label for label, _, _ in entries])) + 12.0
    pixels = min((WIDTH - _LEFT - _RIGHT) / (east[1] - east[0]), _MOST / (north[1] - north[0]))
    tall = max((north[1] - north[0]) * pixels, _LEAST)
    wide = WIDTH - _LEFT - _RIGHT
    west = sum(east) / 2 - wide / pixels / 2
    top = sum(north) / 2 + tall / pixels / 2
    sheet = Sheet(WIDTH, head + tall + _BELOW, name)
    scale = _Scale(west, top, pixels, head)
    sheet.legend(entries, _LEFT, 18.0)
    _grid(sheet, scale, tall)
    for circle in circles:
        x, y = scale.place(circle.y, circle.x)
        colour = COLOURS[palette.PASSED if circle.passed else palette.FAILED]
        sheet.draw(
            "circle", cx=x, cy=y, r=max(circle.radius * pixels, 2.0), fill="none", stroke=colour
        )
    for path in paths:
        _draw(sheet, scale, path, outlines.get(id(path), []))
    return str(sheet)


def _draw(
    sheet: Sheet, scale: _Scale, path: Path, outlines: Sequence[tuple[NDArray, NDArray]]
) -> None:
    """A way over the ship on it; her start dashed, her end filled."""
    colour = COLOURS[path.colour]
    rows = np.unique(np.linspace(0, len(path.x) - 1, _ROWS).astype(int))
    for k, corners in enumerate(outlines):
        x, y = scale.place(*corners)
        first = k == 0
        last = k == len(outlines) - 1
        look = {
            "stroke": INK if first or last else colour,
            "stroke_width": 1.5 if first or last else 0.7,
        }
        look |= {"fill": colour, "fill_opacity": "0.15" if last else "0.04"}
        if first and not last:
            look["stroke_dasharray"] = "4 3"
        sheet.draw(
            "polygon",
            points=" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True)),
            **look,
        )
    sheet.curve(*scale.place(path.y[rows], path.x[rows]), colour, path.dash, 1.8)


def _grid(sheet: Sheet, scale: _Scale, tall: float) -> None:
    wide = WIDTH - _LEFT - _RIGHT
    for at in ticks(scale.west, scale.west + wide / scale.pixels, most=9):
        x, _ = scale.place(at, 0.0)
        sheet.draw("line", x1=x, x2=x, y1=scale.top, y2=scale.top + tall, stroke=GRID)
        sheet.write(tick_text(at), x, scale.top + tall + 15.0, text_anchor="middle")
    for at in ticks(scale.north - tall / scale.pixels, scale.north, most=7):
        _, y = scale.place(0.0, at)
        sheet.draw("line", x1=_LEFT, x2=_LEFT + wide, y1=y, y2=y, stroke=GRID)
        sheet.write(tick_text(at), _LEFT - 6.0, y + 4.0, text_anchor="end")
    sheet.write("east [m]", _LEFT + wide / 2, scale.top + tall + 32.0, text_anchor="middle")
    sheet.write(
        "north [m]",
        14.0,
        scale.top + tall / 2,
        text_anchor="middle",
        transform=f"rotate(-90 14 {(scale.top + tall / 2):.1f})",
    )


def _outlines(path: Path, size: tuple[float, float] | None) -> list[tuple[NDArray, NDArray]]:
    """The ship on her way: east and north of her corners. [m, m]"""
    psi = np.asarray(path.psi, float)
    known = np.isfinite(path.x) & np.isfinite(path.y) & np.isfinite(psi)
    if not known.any():
        return []
    x = path.x[known]
    y = path.y[known]
    psi = psi[known]
    length, breadth = size or _symbol(x, y)
    hull = hull_outline(length, breadth)
    return [placed(hull, x[k], y[k], psi[k]) for k in outline_rows(x, y, psi, length)]


def _symbol(x: NDArray, y: NDArray) -> tuple[float, float]:
    """Length and breadth of an outline of a ship of unknown size. [m, m]"""
    length = max(SYMBOL * max(float(np.ptp(x)), float(np.ptp(y))), 1.0)
    return length, length / SLENDERNESS


def _ranges(paths, outlines, circles) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ranges east and north with a margin. [m, m]"""
    extent = _Extent()
    for path in paths:
        extent.add(np.asarray(path.y, float), np.asarray(path.x, float))
    for corners in (one for some in outlines for one in some):
        extent.add(*corners)
    for circle in circles:
        around = np.array([-circle.radius, circle.radius])
        extent.add(circle.y + around, circle.x + around)
    if not extent.east:
        return (-1.0, 1.0), (-1.0, 1.0)
    least = 0.5
    return tuple(  # type: ignore[return-value]
        (min(values) - margin, max(values) + margin)
        for values in (extent.east, extent.north)
        for margin in [0.04 * (max(values) - min(values)) + least]
    )
