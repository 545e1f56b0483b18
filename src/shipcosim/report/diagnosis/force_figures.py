"""Figures of the missing force: over time, against heading, against the wind."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from xarray import DataArray, Dataset

from shipcosim.diagnose.validation.missing_force import MissingForce
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line, rounded
from shipcosim.report.theme.views import Figure

FORCES = (
    (
        "Missing force, body frame",
        (("surge", "forward", palette.BLUE), ("sway", "to starboard", palette.ORANGE)),
    ),
    ("Missing moment", (("yaw", "clockwise", palette.PURPLE),)),
    (
        "Missing force, earth frame",
        (("north", "towards north", palette.BLUE), ("east", "towards east", palette.ORANGE)),
    ),
)
AGAINST = {
    "heading": ("heading", "Missing force against heading"),
    "wind_from": ("wind from, clockwise of the bow", "Missing force against the wind"),
}
MOST_POINTS = 1200


def force_figures(force: MissingForce) -> list[Figure]:
    """The missing force over time, against heading, and against wind direction."""
    # Body frame, moment and earth frame, then the frame of each thruster.
    groups = list(FORCES)
    for name in force.thrusters:
        along = (f"{name}_along", "along its positive thrust", palette.BLUE)
        pair = (along, (f"{name}_across", "across", palette.ORANGE))
        groups.append((f"Missing force, frame of {name}", pair))
    figures = [_over_time(force.plain, force.extended, title, lines) for title, lines in groups]
    return figures + [
        _against(sectors, *AGAINST[angle]) for angle, sectors in force.by_angle.items()
    ]


def _over_time(
    force: Dataset, left: Dataset | None, title: str, lines: Sequence[tuple[str, str, str]]
) -> Figure:
    # Averages, since the force of a single row is mostly noise.
    traces = []
    (middle, edges) = stretches(force["time"].values)
    # Before in full, after with the cause as dots.
    for name, label, colour in lines:
        if name in force:
            traces.append(line(label, middle, averaged(force[name], edges), colour))
            if left is not None:
                after = averaged(left[name], edges)
                traces.append(
                    line(f"{label}, cause in", middle, after, colour, dash="dot", width=1.2)
                )
    unit = "kN·m" if force[lines[0][0]].attrs["units"] == "N.m" else "kN"
    return Figure(title, unit, tuple(traces), {"xaxis": TIME, "yaxis": {"zeroline": True}})


def stretches(time: NDArray, most: int = MOST_POINTS) -> tuple[NDArray, NDArray]:
    """Middle times of averaged stretches, and their edges in rows."""
    # At most so many points, each the mean of its stretch.
    edges = np.unique(np.linspace(0, time.size, min(most, time.size) + 1).round().astype(int))
    return np.array([time[a:b].mean() for a, b in pairwise(edges)]), edges


def averaged(series: DataArray, edges: NDArray) -> NDArray:
    """Means over stretches of rows. [kN]"""
    values = 1e-3 * series.values
    pairs = pairwise(edges)
    return np.array([values[a:b].mean() for a, b in pairs])


def _against(sectors: Dataset, label: str, title: str) -> Figure:
    """Mean and scatter of the missing force in sectors of an angle."""
    traces = []
    middle = sectors["sector"].values
    # Surge and sway, with the scatter in the sector as error bars.
    for name, text, colour in FORCES[0][1]:
        mean, spread = (1e-3 * sectors[key].values for key in (name, f"{name}_std"))
        traces.append(
            {
                "type": "scatter",
                "mode": "lines+markers",
                "name": text,
                "x": rounded(middle),
                "y": rounded(mean),
                "error_y": {
                    "type": "data",
                    "array": rounded(spread),
                    "color": colour,
                    "thickness": 1,
                },
                "line": {"color": colour, "width": 1.5},
                "marker": {"color": colour, "size": 6},
            }
        )
    axis = {"title": {"text": label}, "ticksuffix": "°", "range": [0, 360], "dtick": 90}
    return Figure(
        title,
        "kN",
        tuple(traces),
        {"xaxis": axis},
        "Mean in sectors of 15°; bars are the standard deviation within.",
    )
