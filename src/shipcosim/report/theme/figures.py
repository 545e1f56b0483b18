"""Pieces of figures that several pages draw: lines, bands, axes; for plotly."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shipcosim.report.theme import palette
from shipcosim.report.theme.numbers import extent, finite
from shipcosim.report.theme.views import PlotlyDict

TIME: PlotlyDict = {"ticksuffix": " s", "showticksuffix": "first"}
"""Axis of time. [s]"""
MOST_POINTS = 3000
"""Points of a curve: five for each pixel of a figure's width."""


def rounded(values: ArrayLike, digits: int = 5) -> list[float | None]:
    """Numbers with few significant digits; None for missing ones.

    Examples
    --------
    >>> rounded([0.123456789, float("nan")], 3)
    [0.123, None]
    """
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, float)]


def thinned_curve(x: ArrayLike, y: ArrayLike, most: int = MOST_POINTS) -> tuple[NDArray, NDArray]:
    """Thin a curve for drawing: of each stretch its ends and its extremes on both axes.

    Parameters
    ----------
    x, y : (n,) array
        Points in their order; where one is not finite the curve is interrupted, and stays so.
    most : int
        Points that may be left, about.

    Returns
    -------
    (array, array)

    Examples
    --------
    >>> x, y = thinned_curve(np.arange(1000.0), np.arange(1000.0) == 500.0, 60)
    >>> len(x) <= 60, float(x[y == 1.0][0]), float(x[0]), float(x[-1])
    (True, 500.0, 0.0, 999.0)
    """
    x = np.asarray(x, float)
    y = np.asarray(y, float)
    if len(x) <= most:
        return x, y
    # Six points for each stretch: both ends, and least and largest on either axis.
    is_known = np.isfinite(x) & np.isfinite(y)
    kept = []
    for stretch in np.array_split(np.arange(len(x)), most // 6):
        rows = stretch[is_known[stretch]]
        if rows.size:
            kept += [
                rows[0],
                rows[-1],
                *(rows[of(values[rows])] for values in (x, y) for of in (np.argmin, np.argmax)),
            ]
    # Insert a gap wherever points that are not finite were left out.
    rows = np.unique(np.array(kept, int))
    breaks = np.flatnonzero(np.diff(np.cumsum(~is_known)[rows])) + 1
    return np.insert(x[rows], breaks, np.nan), np.insert(y[rows], breaks, np.nan)


def evenly(count: int, most: int) -> NDArray:
    """Rows to draw of so many, evenly fewer where there are more than `most`; first and last among them.

    Examples
    --------
    >>> evenly(9, 3).tolist(), evenly(2, 3).tolist()
    ([0, 4, 8], [0, 1])
    """
    return np.unique(np.linspace(0, count - 1, min(most, count)).astype(int))


def _told_apart(values: NDArray) -> list[float | None]:
    """Numbers with five significant digits, more where they differ by little, as late times."""
    # Additional digits as the size exceeds the span: 100000.1 and 100000.2 must differ.
    numbers = finite(values)
    span = extent(values)
    more = np.log10(np.abs(numbers).max() / span) if span > 0.0 else 0.0
    return rounded(values, 5 + int(np.clip(more, 0, 10)))


def line(
    name: str,
    x: ArrayLike,
    y: ArrayLike,
    colour: str,
    *,
    width: float = 1.5,
    dash: str = "solid",
    **more: Any,
) -> PlotlyDict:
    """A curve, thinned where it has more points than a figure shows; the colour is one of `palette`."""
    # Thinned to what a figure can show, so that pages stay small.
    x, y = thinned_curve(x, y)
    places = {"x": _told_apart(x), "y": _told_apart(y)}
    look = {"color": colour, "width": width, "dash": dash}
    return {"type": "scatter", "mode": "lines", "name": name, **places, "line": look} | more


def band(x: ArrayLike, low: ArrayLike, high: ArrayLike, colour: str) -> list[PlotlyDict]:
    """A shaded band between two curves, which no legend names."""
    edges = [
        line("", x, edge, colour, width=0, showlegend=False, hoverinfo="skip")
        for edge in (low, high)
    ]
    edges[1] |= {"fill": "tonexty", "fillcolor": palette.faded(colour, 0.15)}
    return edges


def polar_curve(
    name: str,
    degrees: ArrayLike,
    radius: ArrayLike,
    colour: str,
    *,
    width: float = 2,
    dash: str = "solid",
    fill: float | None = None,
    **more: Any,
) -> PlotlyDict:
    """A curve of a polar plot; `fill` is the opacity of the area within."""
    filled = {} if fill is None else {"fill": "toself", "fillcolor": palette.faded(colour, fill)}
    return {
        "type": "scatterpolar",
        "mode": "lines",
        "name": name,
        "theta": rounded(degrees),
        "r": rounded(radius),
        "hovertemplate": "%{r:.3~g} from %{theta}",
        "line": {"color": colour, "width": width, "dash": dash},
        **filled,
        **more,
    }


def polar_axes(**radial: Any) -> PlotlyDict:
    """Axes of a polar plot: bow up, clockwise, as on a nautical chart; `radial` says more of the radial axis."""
    look = {"gridcolor": palette.FAINT, "linecolor": palette.FAINT, "tickcolor": palette.FAINT}
    angular = {"rotation": 90, "direction": "clockwise", "dtick": 30, "ticksuffix": "°"}
    return {
        "bgcolor": "@card",
        "angularaxis": angular | look,
        "radialaxis": radial | {"angle": 45, "tickangle": 45} | look,
    }


def shade(
    colour: str, x: tuple[float, float] | None = None, y: tuple[float, float] | None = None
) -> PlotlyDict:
    """A shaded band behind the curves, from x to x or from y to y, all across the figure."""
    made: PlotlyDict = {"type": "rect"}
    for axis, ends in (("x", x), ("y", y)):
        low, high = ends or (0, 1)
        made |= {f"{axis}0": low, f"{axis}1": high}
        if ends is None:
            made[f"{axis}ref"] = "paper"
    return made | {"layer": "below", "fillcolor": colour, "line": {"width": 0}}
