"""Pieces of figures that several pages draw: lines, bars, limits, axes; for plotly."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from shipcosim.report.theme import palette

TIME: dict[str, Any] = {"ticksuffix": " s", "showticksuffix": "first"}
"""Axis of time. [s]"""


def rounded(values: ArrayLike, digits: int = 5) -> list[float | None]:
    """Numbers with few significant digits, None where there is none.

    Examples
    --------
    >>> rounded([0.123456789, float("nan")], 3)
    [0.123, None]
    """
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, float)]


def line(
    name: str, x: ArrayLike, y: ArrayLike, colour: str, *, width: float = 1.5, dash: str = "solid", **more: Any
) -> dict[str, Any]:
    """A curve; the colour is one of `palette`."""
    look = {"color": colour, "width": width, "dash": dash}
    return {"type": "scatter", "mode": "lines", "name": name, "x": rounded(x), "y": rounded(y), "line": look} | more


def bars(name: str, categories: Sequence[str], sizes: ArrayLike, colour: str, unit: str) -> dict[str, Any]:
    """Upright bars, one for each category."""
    return {
        **{"type": "bar", "name": name, "x": list(categories), "y": rounded(sizes, 3), "marker": {"color": colour}},
        "hovertemplate": f"%{{y:.3~g}} {unit}",
    }


def limit(x: float) -> dict[str, Any]:
    """A dotted upright line across the figure."""
    look = {"color": palette.VERMILLION, "dash": "dot", "width": 1.5}
    return {"type": "line", "x0": x, "x1": x, "y0": 0, "y1": 1, "yref": "paper", "line": look}
