"""Figures of the force that the ship model lacks: over time, against heading, against the wind."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from xarray import DataArray, Dataset

from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line, rounded
from shipcosim.report.theme.views import Figure

FORCES = (
    ("Missing force, body frame", (("surge", "forward", palette.BLUE), ("sway", "to starboard", palette.ORANGE))),
    ("Missing moment", (("yaw", "clockwise", palette.PURPLE),)),
    (
        "Missing force, earth frame",
        (("north", "towards north", palette.BLUE), ("east", "towards east", palette.ORANGE)),
    ),
)
BINS = 24
MOST_POINTS = 1200


def force_figures(force: Dataset, left: Dataset | None, thrusters: Iterable[str]) -> list[Figure]:
    """The missing force over time, against heading, and against the direction of the wind.

    Parameters
    ----------
    force : xarray.Dataset
        What the plain model lacks, of `missing_force`.
    left : xarray.Dataset, optional
        What the causes leave of it.
    thrusters : iterable of str

    Returns
    -------
    list of Figure
    """
    groups = list(FORCES)
    for name in thrusters:
        along = (f"{name}_along", "along its positive thrust", palette.BLUE)
        pair = (along, (f"{name}_across", "across", palette.ORANGE))
        groups.append((f"Missing force, frame of {name}", pair))
    figures = [_over_time(force, left, title, lines) for title, lines in groups]
    figures += [_against(force, "heading", "heading", "Missing force against heading")]
    if "wind_from" in force:
        figures.append(
            _against(force, "wind_from", "wind from, clockwise of the bow", "Missing force against the wind")
        )
    return figures


def _over_time(force: Dataset, left: Dataset | None, title: str, lines: Sequence[tuple[str, str, str]]) -> Figure:
    traces, (middle, edges) = [], _stretches(force["time"].values)
    for name, label, colour in lines:
        if name in force:
            traces.append(line(label, middle, _averaged(force[name], edges), colour))
            if left is not None:
                after = _averaged(left[name], edges)
                traces.append(line(f"{label}, cause in", middle, after, colour, dash="dot", width=1.2))
    unit = "kN·m" if force[lines[0][0]].attrs["units"] == "N.m" else "kN"
    return Figure(title, unit, tuple(traces), {"xaxis": TIME, "yaxis": {"zeroline": True}})


def _stretches(time: NDArray, most: int = MOST_POINTS) -> tuple[NDArray, NDArray]:
    """Middle times of stretches that are averaged, and their edges in rows."""
    edges = np.unique(np.linspace(0, time.size, min(most, time.size) + 1).round().astype(int))
    return np.array([time[a:b].mean() for a, b in zip(edges[:-1], edges[1:], strict=True)]), edges


def _averaged(series: DataArray, edges: NDArray) -> NDArray:
    """Averages over stretches of rows. [kN]"""
    values, pairs = 1e-3 * series.values, zip(edges[:-1], edges[1:], strict=True)
    return np.array([values[a:b].mean() for a, b in pairs])


def _against(force: Dataset, angle: str, label: str, title: str) -> Figure:
    """Mean and scatter of the missing force in sectors of an angle."""
    at, traces = force[angle].values % 360.0, []
    sector = np.minimum((at / (360.0 / BINS)).astype(int), BINS - 1)
    middle = (np.arange(BINS) + 0.5) * 360.0 / BINS
    for name, text, colour in FORCES[0][1]:
        values = 1e-3 * force[name].values
        groups = [values[(sector == k) & np.isfinite(values)] for k in range(BINS)]
        mean = np.array([g.mean() if g.size > 4 else np.nan for g in groups])
        spread = np.array([g.std() if g.size > 4 else 0.0 for g in groups])
        traces.append(
            {
                **{"type": "scatter", "mode": "lines+markers", "name": text, "x": rounded(middle), "y": rounded(mean)},
                "error_y": {"type": "data", "array": rounded(spread), "color": colour, "thickness": 1},
                **{"line": {"color": colour, "width": 1.5}, "marker": {"color": colour, "size": 6}},
            }
        )
    axis = {"title": {"text": label}, "ticksuffix": "°", "range": [0, 360], "dtick": 90}
    note = "Mean in sectors of 15°; bars are the standard deviation within."
    return Figure(title, "kN", tuple(traces), {"xaxis": axis}, note)
