"""Pictures of a notebook, drawn by matplotlib: tracks on a chart, signals over time."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from importlib.util import find_spec
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.errors import imported
from shipcosim.report.run.track import hull_outline, outline_rows, placed, symbol_size
from shipcosim.report.theme import palette
from shipcosim.report.theme.display import thinned
from shipcosim.report.theme.figures import thinned_curve
from shipcosim.report.theme.views import JsonObject

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


WIDTH = 760  # px
CARD_WIDTH = 400  # px of a picture in a card
IN_CARD: ContextVar[bool] = ContextVar("in_card", default=False)
"""Whether what is drawn is shrunk to the width of a card, where its text must be as large as the card's."""
DPI = 96  # px per inch, as browsers have it
MOST_CURVES = 8  # of a panel
MOST_PANELS = 12
PANEL_HEIGHT = 170  # px
TRACK_HEIGHT = (320, 680)  # px, least and most
TRACK_POINTS = 1200
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
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # texts stay texts, so that they can be searched
    "svg.hashsalt": "shipcosim",  # the same identifiers in each run
    "path.simplify_threshold": 0.5,  # px that a point may lie off a line to be left out of it
    "text.parse_math": False,  # a name may hold a dollar sign
    "font.size": 8.25,  # pt: 11 px
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "axes.titlesize": "medium",
    "axes.titlecolor": INK,
    "axes.labelcolor": SOFT,
    "axes.edgecolor": GRID,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": GRID,
    "xtick.color": GRID,
    "xtick.labelcolor": SOFT,
    "ytick.color": GRID,
    "ytick.labelcolor": SOFT,
    "legend.frameon": False,
}


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
    colour : str
        Of `palette`.
    style : str
        Of the line, as matplotlib has it.
    """

    label: str
    x: NDArray
    y: NDArray
    psi: NDArray | None = None
    colour: str = palette.SHIP
    style: str = "-"


def can_draw() -> bool:
    """True if matplotlib is installed."""
    return find_spec("matplotlib") is not None


def figure_svg(name: str, width: float, height: float, draw: Callable[[Figure], None]) -> str:
    """Draw a figure and give it as SVG, the same text each time; `name` is its title, sizes are in px.

    Raises
    ------
    ShipcosimError
        If matplotlib is missing.
    """
    with imported(name, "Pictures are drawn by matplotlib, which is missing.", "notebook"):
        import matplotlib
        from matplotlib.figure import Figure
    # A figure without pyplot, which would keep it and choose a window for it.
    style = dict(STYLE)
    if IN_CARD.get():
        style["font.size"] *= width / CARD_WIDTH
    with matplotlib.rc_context(style):
        figure = Figure((width / DPI, height / DPI), layout="constrained")
        draw(figure)
        text = StringIO()
        about = {"Title": name, "Date": None, "Creator": None}
        figure.savefig(text, format="svg", metadata=about)
    # A hundredth of a point is enough: the places of matplotlib have a millionth, and make notebooks large.
    return re.sub(
        r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), text.getvalue()
    )


def track_svg(
    paths: Sequence[Path],
    name: str,
    size: tuple[float, float] | None = None,
    circles: Sequence[JsonObject] = (),
) -> str:
    """Ways on a chart: north up, one scale both ways, the ship drawn to scale where her size is known.

    Parameters
    ----------
    paths : sequence of Path
        The ship's own last.
    name : str
        What is drawn.
    size : (float, float), optional
        Length and breadth of the ship; a small symbol shows where she was without. [m, m]
    circles : sequence of dict
        Of expectations, as `expected_circles` gives them.

    Returns
    -------
    str
        SVG.
    """

    def draw(figure: Figure) -> None:
        from matplotlib.patches import Circle

        axes = figure.subplots()
        axes.set(xlabel="east [m]", ylabel="north [m]")
        # Where she was to be lies below her way, and her outlines below the line.
        for circle in circles:
            north, east = circle["centre"]
            colour = COLOURS[palette.PASSED if circle["passed"] else palette.FAILED]
            axes.add_patch(Circle((east, north), circle["radius"], fill=False, edgecolor=colour))
        for path in paths:
            _draw_outlines(axes, path, size)
            east, north = thinned_curve(path.y, path.x, TRACK_POINTS)
            axes.plot(east, north, path.style, color=COLOURS[path.colour], label=path.label)
        if circles:
            axes.plot([], [], color=COLOURS[palette.PASSED], label="expected within")
        # The sheet is as tall as the track needs; the rest of it goes to the wider axis.
        shape = np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim())
        figure.set_figheight(float(np.clip(WIDTH * shape, *TRACK_HEIGHT)) / DPI)
        axes.set_aspect("equal", adjustable="datalim")
        figure.legend(loc="outside upper left", ncols=1 if IN_CARD.get() else 3)

    return figure_svg(name, WIDTH, TRACK_HEIGHT[1], draw)


def _draw_outlines(axes: Axes, path: Path, size: tuple[float, float] | None) -> None:
    """The ship on her way."""
    if path.psi is None:
        return
    is_known = np.isfinite(path.x) & np.isfinite(path.y) & np.isfinite(path.psi)
    if not is_known.any():
        return
    x, y, psi = (values[is_known] for values in (path.x, path.y, path.psi))
    length, breadth = size or symbol_size(x, y)
    hull = hull_outline(length, breadth)
    rows = outline_rows(x, y, psi, length)
    for k in rows:
        # Her last outline is filled.
        colour = COLOURS[path.colour]
        filled = (colour, 0.15 if k == rows[-1] else 0.0)
        axes.fill(*placed(hull, x[k], y[k], psi[k]), fc=filled, ec=colour, linewidth=0.6)


def panels_svg(
    shown: Dataset, signals: Sequence[str], name: str, events: Sequence[float] = ()
) -> str:
    """Signals over one axis of time, panel below panel: those of one unit together.

    Parameters
    ----------
    shown : xarray.Dataset
        In the units of the page, as `report.theme.display.display_table` gives it.
    signals : sequence of str
        That are to be drawn, in their order: eight a panel. Panels beyond the twelfth are only counted, in a line at
        the end.
    name : str
        What is drawn.
    events : sequence of float
        Marked in every panel. [s]

    Returns
    -------
    str
        SVG.
    """
    by_unit: dict[str, list[str]] = {}
    for signal in signals:
        by_unit.setdefault(shown[signal].attrs["units"], []).append(signal)
    panels = [
        (unit, group[k : k + MOST_CURVES])
        for unit, group in by_unit.items()
        for k in range(0, len(group), MOST_CURVES)
    ]
    drawn = panels[:MOST_PANELS]
    more = len(panels) - len(drawn)
    time = shown["time"].values
    marked = [at for at in events if np.nanmin(time) < at < np.nanmax(time)]

    def draw(figure: Figure) -> None:
        rows = figure.subplots(len(drawn), sharex=True, squeeze=False)[:, 0]
        for axes, (unit, group) in zip(rows, drawn, strict=True):
            axes.margins(x=0.0)
            _draw_panel(axes, shown, unit, group)
            for at in marked:
                axes.axvline(at, color=COLOURS[palette.FAINT], linestyle="--", linewidth=0.8)
        rows[-1].set_xlabel("time [s]")
        if more:
            panels_word = "panels are" if more > 1 else "panel is"
            figure.supxlabel(f"{more} more {panels_word} not drawn: name fewer signals.")

    return figure_svg(name, WIDTH, PANEL_HEIGHT * len(drawn) + 30, draw)


def _draw_panel(axes: Axes, shown: Dataset, unit: str, signals: Sequence[str]) -> None:
    """Curves of one unit, with what their names have in common as title."""
    components = {signal.rpartition(".")[0] for signal in signals}
    connectors = {signal.rpartition(".")[2] for signal in signals}
    common = components.pop() if len(components) == 1 else ""
    title = common or (connectors.pop() if len(connectors) == 1 else "")
    axes.set_title(f"{title} [{unit}]".strip() if unit else title or "without unit")
    # An extreme up and one down for each two pixels: more cannot be seen.
    drawn, _ = thinned(shown[list(signals)], WIDTH)
    for signal, colour in zip(signals, palette.CYCLE, strict=False):
        values = np.where(np.isfinite(drawn[signal].values), drawn[signal].values, np.nan)
        label = signal.removeprefix(f"{common}.")
        axes.plot(drawn["time"].values, values, color=COLOURS[colour], label=label)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
