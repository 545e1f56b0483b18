"""The track on a chart: north up, one scale both ways, the ship drawn to scale where she was."""

import json

import numpy as np

from shipcosim.report.run.derived import desired
from shipcosim.report.run.roles import join
from shipcosim.report.theme import palette

LENGTH, BREADTH = 33.9, 9.6  # m, R/V Gunnerus between perpendiculars: for tables that do not say
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


def ship_size(table, roles):
    """Length and breadth of the ship to draw, from the start values in the table's attributes. [m, m]"""
    known = json.loads(table.attrs.get("start_values", "{}"))
    sizes = (("length", LENGTH), ("breadth", BREADTH))
    return tuple(float(known.get(join(roles.ship or "", name), default)) for name, default in sizes)


def hull_outline(length, breadth):
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


def placed(outline, x, y, psi):
    """An outline on the chart: east and north of its corners. [m, m]"""
    forward, starboard = outline
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    return y + s * forward + c * starboard, x + c * forward - s * starboard


def outline_rows(x, y, psi, length):
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


def track_figure(shown, roles, verdicts, size):
    """Traces and ranges of the chart, or None without a ship in the table.

    Parameters
    ----------
    shown : xarray.Dataset
        Table in the page's units.
    roles : Roles
        What the signals stand for.
    verdicts : sequence of Verdict
        Expectations; those on x and y together are drawn as circles.
    size : (float, float)
        Length and breadth of the ship. [m, m]

    Returns
    -------
    dict or None
        `traces` for plotly, `x` and `y` ranges, `pose` (names of the signals) and `outline` in body axes.
    """
    names = [roles.signal(roles.ship, axis) for axis in ("x", "y", "psi")]
    if None in names or any(name not in shown for name in names):
        return None
    x, y, psi = (shown[name].values for name in names)
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(psi)
    if not known.any():
        return None
    time = shown["time"].values[known]
    ships = _ships(time, x[known], y[known], psi[known], size)
    traces = [*_aims(shown, roles, verdicts, names), _line("track", y, x, palette.SHIP, 2.0), *ships]
    outline = [np.round(side, 3).tolist() for side in hull_outline(*size)]
    return {"traces": traces, **_ranges(traces), "pose": names, "outline": outline}


def _ships(time, x, y, psi, size):
    """Outlines on the way, start and end, and a mark amidships of each that says when."""
    rows, outline = outline_rows(x, y, psi, size[0]), hull_outline(*size)
    corners = [placed(outline, x[k], y[k], psi[k]) for k in rows]
    mark = [f"{time[k]:.6g} s<br>north {x[k]:.2f} m<br>east {y[k]:.2f} m<br>heading {psi[k] % 360:.1f}°" for k in rows]
    marks = {
        **_line("position", y[rows], x[rows], palette.SHIP, 0.0),
        "mode": "markers",
        "marker": {"color": palette.SHIP, "size": 5},
        "text": mark,
        "hovertemplate": "%{text}<extra></extra>",
        "showlegend": False,
    }
    return [
        _hulls("ship on the way", corners[1:-1], palette.SHIP, "rgba(0,114,178,0.05)", 0.8),
        _hulls("start", corners[:1], palette.INK, "rgba(31,41,51,0.06)", 1.5, "dash"),
        _hulls("end", corners[-1:], palette.INK, "rgba(0,114,178,0.18)", 2.0),
        marks,
    ]


def _hulls(name, corners, colour, fill, width, dash="solid"):
    """Closed outlines in one trace, set apart by gaps."""
    east = [value for e, _ in corners for value in [*_rounded(e), None]]
    north = [value for _, n in corners for value in [*_rounded(n), None]]
    line = {"color": colour, "width": width, "dash": dash}
    return {
        **{"type": "scatter", "mode": "lines", "name": name, "x": east, "y": north, "line": line},
        **{"fill": "toself", "fillcolor": fill, "hoverinfo": "skip"},
    }


def _aims(shown, roles, verdicts, names):
    """Where she should go: circles of the expectations, reference track, set points."""
    aims = [_circle(verdict) for verdict in verdicts if _is_circle(verdict.expect, names[:2])]
    reference = [desired(roles, axis) for axis in "xy"]
    if None not in reference:
        x, y = (shown[name].values for name in reference)
        aims.append(_line("reference", y, x, palette.REFERENCE, 1.5, "dash"))
    points = [next(iter(roles.anywhere(f"{axis}_set")), None) for axis in "xy"]
    if None not in points:
        x, y = (shown[name].values for name in points)
        marks = np.unique(np.round(np.column_stack([y, x]), 3), axis=0)
        symbol = {"symbol": "cross-thin", "size": 13, "line": {"width": 2, "color": palette.SET_POINT}}
        point = _line("set points", marks[:, 0], marks[:, 1], palette.SET_POINT, 0.0)
        aims.append({**point, "mode": "markers", "marker": symbol})
    return aims


def _is_circle(expect, position):
    numbers = all(isinstance(n, (int, float)) for n in expect.near or ["none"])
    return expect.signal == position and numbers


def _circle(verdict):
    angle = np.linspace(0.0, 2.0 * np.pi, 41)
    north, east = verdict.expect.near
    radius, colour = verdict.expect.within, palette.PASSED if verdict.passed else palette.FAILED
    trace = _line("limit", east + radius * np.cos(angle), north + radius * np.sin(angle), colour, 1.5)
    return {**trace, "showlegend": False, "hoverinfo": "skip"}


def _line(name, east, north, colour, width, dash="solid"):
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _rounded(east),
        "y": _rounded(north),
        "line": {"color": colour, "width": width, "dash": dash},
        "hovertemplate": f"{name}<br>north %{{y:.2f}} m<br>east %{{x:.2f}} m<extra></extra>",
    }


def _rounded(values):
    return [round(float(v), 3) if np.isfinite(v) else None for v in values]


def _ranges(traces):
    """Ranges that hold everything drawn, with a margin, and fill most of the place whichever way the track runs."""
    middle, half = {}, {}
    for axis in "xy":
        values = [v for trace in traces for v in trace[axis] if v is not None]
        middle[axis], half[axis] = 0.5 * (min(values) + max(values)), 0.55 * (max(values) - min(values))
    least = LEAST_ASPECT * max(half.values())
    return {axis: [middle[axis] - max(half[axis], least), middle[axis] + max(half[axis], least)] for axis in "xy"}
