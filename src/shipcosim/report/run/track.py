"""The track on a chart: north up, one scale both ways, the ship drawn to scale where her size is known."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from xarray import Dataset

from shipcosim.report.run.derived import desired
from shipcosim.report.run.roles import Roles, join
from shipcosim.report.theme import palette
from shipcosim.scenario import Verdict

HULL = (  # outline over length and breadth from amidships, starboard side from stern to bow; drawn, not measured
    (-0.5, 0.44),
    (-0.46, 0.5),
    (0.18, 0.5),
    (0.34, 0.37),
    (0.45, 0.17),
    (0.5, 0.0),
)
LEAST_ASPECT = 0.7  # of the chart's shorter side to its longer
SPACING, TURN, MOST = 0.3, 20.0, 40  # outlines: apart in lengths, turned in deg, at most so many
SYMBOL = 0.08  # length of the outline of a ship of unknown size, over the extent of the track
SLENDERNESS = 3.5  # length over breadth of that outline


@dataclass(frozen=True)
class Track:
    """The chart as the script of the page draws it.

    Attributes
    ----------
    traces : list of dict
        For plotly.
    x, y : (float, float)
        Ranges east and north. [m]
    pose : list of str
        Signals x, y and psi of the ship.
    outline : list of list of float
        Her outline in body axes, forward and to starboard. [m]
    """

    traces: list[dict[str, Any]]
    x: tuple[float, float]
    y: tuple[float, float]
    pose: list[str]
    outline: list[list[float]]


def ship_size(table: Dataset, roles: Roles) -> tuple[float, float] | None:
    """Length and breadth of the ship, where the start values in the table's attributes have both. [m, m]"""
    known = json.loads(table.attrs.get("start_values", "{}"))
    length, breadth = (known.get(join(roles.ship or "", name)) for name in ("length", "breadth"))
    return None if length is None or breadth is None else (float(length), float(breadth))


def hull_outline(length: float, breadth: float) -> tuple[NDArray, NDArray]:
    """Closed outline in body axes: forward and to starboard, (11,) each. [m, m]

    Examples
    --------
    >>> forward, starboard = hull_outline(10.0, 4.0)
    >>> float(forward.max()), float(starboard.min()), float(starboard.max())
    (5.0, -2.0, 2.0)
    """
    starboard = np.array(HULL) * [length, breadth]
    port = starboard[-2::-1] * [1.0, -1.0]
    closed = np.vstack([starboard, port, starboard[:1]])
    return closed[:, 0], closed[:, 1]


def placed(outline: tuple[NDArray, NDArray], x: float, y: float, psi: float) -> tuple[NDArray, NDArray]:
    """An outline on the chart: east and north of its corners. [m, m]"""
    forward, starboard = outline
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    return y + s * forward + c * starboard, x + c * forward - s * starboard


def outline_rows(x: NDArray, y: NDArray, psi: NDArray, length: float) -> list[int]:
    """Rows at which to draw the ship: the first, the last, and whenever she moved or turned enough in between.

    Parameters
    ----------
    x, y, psi : (n,) array
        Pose. [m, m, deg]
    length : float
        Length of the ship. [m]

    Returns
    -------
    list of int
    """
    spacing, turn = SPACING * length, TURN
    while True:
        rows = [0]
        for k in range(1, len(x)):
            last = rows[-1]
            if np.hypot(x[k] - x[last], y[k] - y[last]) >= spacing or abs(psi[k] - psi[last]) >= turn:
                rows.append(k)
        if len(rows) <= MOST:
            return rows if rows[-1] == len(x) - 1 else [*rows, len(x) - 1]
        spacing, turn = 1.5 * spacing, 1.5 * turn


def track_figure(
    shown: Dataset, roles: Roles, verdicts: Sequence[Verdict], size: tuple[float, float] | None
) -> Track | None:
    """Traces and ranges of the chart, or None without a ship in the table.

    Parameters
    ----------
    shown : xarray.Dataset
        Table in the page's units.
    roles : Roles
        What the signals stand for.
    verdicts : sequence of Verdict
        Expectations; those on x and y together are drawn as circles.
    size : (float, float), optional
        Length and breadth of the ship; without them a small symbol shows where she was. [m, m]

    Returns
    -------
    Track or None
    """
    names = [roles.signal(roles.ship, axis) for axis in ("x", "y", "psi")]
    pose = [name for name in names if name is not None and name in shown]
    if len(pose) < 3:
        return None
    x, y, psi = (shown[name].values for name in pose)
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(psi)
    if not known.any():
        return None
    way = _line("track", y, x, palette.SHIP, 2.0)
    x, y, psi, time = x[known], y[known], psi[known], shown["time"].values[known]
    drawn = size or _symbol(x, y)
    ships = _ships(time, x, y, psi, drawn, scale="" if size else ", not to scale")
    traces = [*_aims(shown, roles, verdicts, pose[:2]), way, *ships]
    outline = [np.round(side, 3).tolist() for side in hull_outline(*drawn)]
    east, north = _ranges(traces)
    return Track(traces, east, north, pose, outline)


def _symbol(x: NDArray, y: NDArray) -> tuple[float, float]:
    """Length and breadth of an outline that shows where a ship of unknown size was. [m, m]"""
    length = max(SYMBOL * max(float(np.ptp(x)), float(np.ptp(y))), 1.0)
    return length, length / SLENDERNESS


def _ships(
    time: NDArray, x: NDArray, y: NDArray, psi: NDArray, size: tuple[float, float], scale: str
) -> list[dict[str, Any]]:
    """Outlines on the way, start and end, and a mark amidships of each that says when."""
    rows, outline = outline_rows(x, y, psi, size[0]), hull_outline(*size)
    corners = [placed(outline, x[k], y[k], psi[k]) for k in rows]
    marks = {
        **_line("position", y[rows], x[rows], palette.SHIP, 0.0),
        "mode": "markers",
        "marker": {"color": palette.SHIP, "size": 5},
        "text": [f"{time[k]:.6g} s\nnorth {x[k]:.2f} m\neast {y[k]:.2f} m\nheading {psi[k] % 360:.1f}°" for k in rows],
        "hovertemplate": "%{text}",
        "showlegend": False,
    }
    return [
        _hulls(f"ship on the way{scale}", corners[1:-1], palette.SHIP, 0.05, 0.8),
        _hulls("start", corners[:1], palette.INK, 0.06, 1.5, "dash"),
        _hulls("end", corners[-1:], palette.INK, 0.18, 2.0, fill=palette.SHIP),
        marks,
    ]


def _hulls(
    name: str,
    corners: Sequence[tuple[NDArray, NDArray]],
    colour: str,
    opacity: float,
    width: float,
    dash: str = "solid",
    fill: str = "",
) -> dict[str, Any]:
    """Closed outlines in one trace, set apart by gaps, filled with their own colour or another."""
    east = [value for e, _ in corners for value in [*_rounded(e), None]]
    north = [value for _, n in corners for value in [*_rounded(n), None]]
    line = {"color": colour, "width": width, "dash": dash}
    return {
        **{"type": "scatter", "mode": "lines", "name": name, "x": east, "y": north, "line": line},
        **{"fill": "toself", "fillcolor": palette.faded(fill or colour, opacity), "hoverinfo": "skip"},
    }


def _aims(shown: Dataset, roles: Roles, verdicts: Sequence[Verdict], position: list[str]) -> list[dict[str, Any]]:
    """Where she should go: circles of the expectations, reference track, set points."""
    aims = [circle for verdict in verdicts for circle in _circle(verdict, position)]
    reference = [name for axis in "xy" if (name := desired(roles, axis)) is not None]
    if len(reference) == 2:
        x, y = (shown[name].values for name in reference)
        aims.append(_line("reference", y, x, palette.REFERENCE, 1.5, "dash"))
    points = [names[0] for axis in "xy" if (names := roles.anywhere(f"{axis}_set"))]
    if len(points) == 2:
        x, y = (shown[name].values for name in points)
        marks = np.unique(np.round(np.column_stack([y, x]), 3), axis=0)
        symbol = {"symbol": "cross-thin", "size": 13, "line": {"width": 2, "color": palette.SET_POINT}}
        point = _line("set points", marks[:, 0], marks[:, 1], palette.SET_POINT, 0.0)
        aims.append({**point, "mode": "markers", "marker": symbol})
    return aims


def _circle(verdict: Verdict, position: list[str]) -> list[dict[str, Any]]:
    """The circle in which the ship should stay, of an expectation on her position; else nothing."""
    centre, radius = verdict.expect.near or [], verdict.expect.within or 0.0
    numbers = [value for value in centre if isinstance(value, int | float)]
    if verdict.expect.signal != position or len(numbers) != 2:
        return []
    angle = np.linspace(0.0, 2.0 * np.pi, 41)
    (north, east), colour = numbers, palette.PASSED if verdict.passed else palette.FAILED
    trace = _line("limit", east + radius * np.cos(angle), north + radius * np.sin(angle), colour, 1.5)
    return [{**trace, "showlegend": False, "hoverinfo": "skip"}]


def _line(name: str, east: NDArray, north: NDArray, colour: str, width: float, dash: str = "solid") -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _rounded(east),
        "y": _rounded(north),
        "line": {"color": colour, "width": width, "dash": dash},
        "hovertemplate": f"{name}\nnorth %{{y:.2f}} m\neast %{{x:.2f}} m",
        "named": False,
    }


def _rounded(values: ArrayLike) -> list[float | None]:
    return [round(float(v), 3) if np.isfinite(v) else None for v in np.asarray(values, float)]


def _ranges(traces: list[dict[str, Any]]) -> list[tuple[float, float]]:
    """Ranges that hold everything drawn, with a margin, and fill most of the place whichever way the track runs."""
    middle, half = {}, {}
    for axis in "xy":
        values = [v for trace in traces for v in trace[axis] if v is not None]
        middle[axis], half[axis] = 0.5 * (min(values) + max(values)), 0.55 * (max(values) - min(values))
    least = LEAST_ASPECT * max(half.values())
    return [(middle[axis] - max(half[axis], least), middle[axis] + max(half[axis], least)) for axis in "xy"]
