"""Figures of a diagnosis' first link: the log over time, as logged and as used, with the stretches that are faulty."""

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.report.theme.display import as_variable, thinned

GROUPS = (  # title, channels, unit
    ("Position", ("north", "east"), "m"),
    ("Heading", ("heading",), "deg"),
    ("Velocity over ground", ("surge", "sway"), "m/s"),
    ("Rate of turn", ("yaw_rate",), "deg/s"),
    ("Wind speed", ("wind_speed", "true_wind_speed"), "m/s"),
    ("Wind from", ("wind_from", "true_wind_from"), "deg"),
)
COLOURS = ("blue", "orange", "green", "purple", "sky", "olive")
MOST_BYTES = 900_000
TIME = {"ticksuffix": " s", "showticksuffix": "first"}


def line(name, x, y, colour, **more):
    """A curve; colours are names of the style sheet."""
    look = {"color": f"@{colour}", "width": more.pop("width", 1.5), "dash": more.pop("dash", "solid")}
    return {"type": "scatter", "mode": "lines", "name": name, "x": rounded(x), "y": rounded(y), "line": look} | more


def rounded(values, digits=5):
    """Numbers with few digits, None where there is none."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, float)]


def panel(title, unit, traces, note="", **layout):
    """A figure of the page, with a heading above it and a sentence below."""
    return {"title": title, "unit": unit, "data": traces, "layout": layout, "note": note}


def log_panels(log, clean, findings):
    """Panels of all channels.

    Parameters
    ----------
    log, clean : xarray.Dataset
        As read; and repaired, with the coordinate `logged_time`.
    findings : sequence of Finding
        Those of the data are shaded.

    Returns
    -------
    list of dict
    """
    raw, used = _ordered(log), _on_log_time(clean)
    faults = [f for f in findings if f.kind == "data"]
    named = {channel for _, channels, _ in GROUPS for channel in channels}
    groups = [*GROUPS, *_thrusters([str(n) for n in log.data_vars if n not in named], log)]
    panels = []
    for title, channels, unit in groups:
        there = [c for c in channels if c in raw]
        if not there:
            continue
        pairs = [_traces(raw, used, channel, COLOURS[k % len(COLOURS)], unit) for k, channel in enumerate(there)]
        traces = [trace for pair in pairs for trace in pair[:-1]] + [pair[-1] for pair in pairs]
        shapes = [shape for fault in faults if _concerns(fault, there) for shape in _shades(fault, raw)]
        panels.append(panel(title, unit, traces, shapes=shapes, xaxis=TIME))
    return panels


def track_panel(clean):
    """Where the ship went, north up; None without positions."""
    if "north" not in clean or "east" not in clean:
        return None
    thin, _ = thinned(_on_log_time(clean)[["north", "east"]], MOST_BYTES // 10)
    north, east = thin["north"].values, thin["east"].values
    known = np.flatnonzero(np.isfinite(north) & np.isfinite(east))
    if not known.size:
        return None
    ends = [(known[0], "start", "circle-open"), (known[-1], "end", "circle")]
    marks = [
        {
            **{
                "type": "scatter",
                "mode": "markers",
                "name": name,
                "x": rounded(east[[row]]),
                "y": rounded(north[[row]]),
            },
            "marker": {"color": "@ink", "size": 9, "symbol": symbol, "line": {"color": "@ink", "width": 2}},
        }
        for row, name, symbol in ends
    ]
    axes = {
        "xaxis": {"title": {"text": "East"}},
        "yaxis": {"title": {"text": "North"}, "scaleanchor": "x"},
    }
    return panel("Track", "m", [line("track", east, north, "blue"), *marks], **axes)


def _ordered(log):
    time = log["time"].values
    rows = np.flatnonzero(np.isfinite(time))
    return _shown(log.isel(time=rows[np.argsort(time[rows], kind="stable")]))


def _on_log_time(clean):
    if "logged_time" not in clean.coords:
        return _shown(clean)
    return _shown(clean.assign_coords(time=("time", clean["logged_time"].values)).drop_vars("logged_time"))


def _shown(table):
    """The table as `thinned` takes it."""
    found = table.drop_vars([n for n in table.data_vars if table[n].dtype.kind not in "fiu"])
    for name in found.data_vars:
        about = found[name].attrs
        values = np.asarray(found[name].values, float)
        found[name] = as_variable(values, about.get("units"), about.get("long_name", ""))
    return found


def _thrusters(names, log):
    """Groups of the thrusters' channels: of one quantity, and of similar size."""
    found = []
    for suffix, title, unit in (
        ("_rpm", "Shaft speed", "rpm"),
        ("_azimuth", "Azimuth", "deg"),
        ("_thrust", "Thrust", "N"),
    ):
        mine = [name for name in names if name.endswith(suffix)]
        top = {name: np.nanmax(np.abs(log[name].values), initial=0.0) for name in mine}
        large = [name for name in mine if top[name] > 5.0 * min(top.values())]
        for group in ([name for name in mine if name not in large], large):
            shaft = title if len(group) > 1 or not group else f"{title}, {group[0].removesuffix(suffix)}"
            found.append((shaft, tuple(group), unit))
    return found


def _traces(raw, used, channel, colour, unit):
    label = channel.replace("_", " ")
    traces = []
    old, _ = thinned(raw[[channel]], MOST_BYTES // 40)
    new, _ = thinned(used[[channel]], MOST_BYTES // 40) if channel in used else (None, 1)
    if new is None or not _same(raw[channel], used[channel]):
        traces.append(
            _curve(
                f"{label}, logged", old["time"].values, old[channel].values, "faint", unit, width=3.0, showlegend=False
            )
        )
    if new is not None:
        traces.append(_curve(label, new["time"].values, new[channel].values, colour, unit))
    return traces


def _same(one, other):
    return one.size == other.size and np.array_equal(one.values, other.values, equal_nan=True)


def _curve(name, time, values, colour, unit, **look):
    """A channel over time; angles are interrupted where they go round."""
    if unit == "deg":
        turns = np.flatnonzero(np.abs(np.diff(values)) > 180.0) + 1
        time, values = np.insert(time, turns, np.nan), np.insert(values, turns, np.nan)
    return line(name, time, values, colour, hovertemplate=f"%{{y:.4~g}} {unit}", **look)


def _concerns(fault, channels):
    return not fault.channels or read_faults()[fault.cause].in_every_channel or set(fault.channels) & set(channels)


def _shades(fault, raw):
    time = raw["time"].values
    for start, end in fault.segments or ((time[0], time[-1]),):
        yield {
            **{"type": "rect", "x0": float(start), "x1": float(end), "y0": 0, "y1": 1, "yref": "paper"},
            **{"layer": "below", "fillcolor": "@fault", "line": {"width": 0}},
        }
