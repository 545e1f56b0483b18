"""Figures of the log: channels as logged and as used, faulty stretches shaded."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from xarray import DataArray, Dataset

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line, shade
from shipcosim.report.theme.views import Figure, PlotlyDict

GROUPS = (  # title, channels, unit
    ("Position", ("north", "east"), "m"),
    ("Heading", ("heading",), "deg"),
    ("Velocity over ground", ("surge", "sway"), "m/s"),
    ("Rate of turn", ("yaw_rate",), "deg/s"),
    ("Wind speed", ("wind_speed", "true_wind_speed"), "m/s"),
    ("Wind from", ("wind_from", "true_wind_from"), "deg"),
)


def log_figures(log: Dataset, clean: Dataset, findings: Sequence[Finding]) -> list[Figure]:
    """Figures of all channels.

    Parameters
    ----------
    log, clean : xarray.Dataset
        As read; and repaired, with the coordinate `logged_time`.
    findings : sequence of Finding
        Those of the data are shaded.

    Returns
    -------
    list of Figure
    """
    # The rows in the order of their times; rows without a time are left out.
    raw = log.isel(time=np.isfinite(log["time"].values)).sortby("time")
    # The repaired log over the logged times, so that both can be compared.
    used = clean
    if "logged_time" in clean.coords:
        used = clean.assign_coords(time=("time", clean["logged_time"].values))
    faults = [f for f in findings if f.kind == "data"]
    # Known channels in fixed groups, thrusters by quantity.
    named = {channel for _, channels, _ in GROUPS for channel in channels}
    groups = [*GROUPS, *_thrusters([str(n) for n in log.data_vars if n not in named], log)]
    figures = []
    for title, channels, unit in groups:
        there = [c for c in channels if c in raw and raw[c].dtype.kind in "fiu"]
        if not there:
            continue
        # Logged curves first, so that the used ones lie on top.
        pairs = [
            _traces(raw[channel], used.get(channel), channel, palette.in_turn(k), unit)
            for k, channel in enumerate(there)
        ]
        traces = [trace for pair in pairs for trace in pair[:-1]] + [pair[-1] for pair in pairs]
        # Shade only faults that concern a channel of this figure.
        shapes = []
        for fault in faults:
            everywhere = not fault.channels or read_faults()[fault.cause].in_every_channel
            if everywhere or not set(fault.channels).isdisjoint(there):
                shapes += _shades(fault, raw)
        figures.append(Figure(title, unit, tuple(traces), {"shapes": shapes, "xaxis": TIME}))
    return figures


def _thrusters(names: Sequence[str], log: Dataset) -> list[tuple[str, tuple[str, ...], str]]:
    """Groups of the thrusters' channels, by quantity and size."""
    groups = []
    # A main propeller and a small thruster on one axis would hide the small one.
    for suffix, title, unit in (
        ("_rpm", "Shaft speed", "rpm"),
        ("_azimuth", "Azimuth", "deg"),
        ("_thrust", "Thrust", "N"),
    ):
        mine = [name for name in names if name.endswith(suffix)]
        top = {name: np.nanmax(np.abs(log[name].values), initial=0.0) for name in mine}
        large = [name for name in mine if top[name] > 5.0 * min(top.values())]
        for group in ([name for name in mine if name not in large], large):
            heading = f"{title}, {group[0].removesuffix(suffix)}" if len(group) == 1 else title
            groups.append((heading, tuple(group), unit))
    return groups


def _traces(
    logged: DataArray, used: DataArray | None, channel: str, colour: str, unit: str
) -> list[PlotlyDict]:
    """A channel as used, and as logged if that differs."""
    label = channel.replace("_", " ")
    traces = []
    # The logged curve is wide and pale under the used one.
    if used is None or not np.array_equal(logged, used, equal_nan=True):
        look = {"width": 3.0, "showlegend": False}
        traces.append(_curve(f"{label}, logged", logged, palette.FAINT, unit, **look))
    if used is not None:
        traces.append(_curve(label, used, colour, unit))
    return traces


def _curve(name: str, drawn: DataArray, colour: str, unit: str, **look: Any) -> PlotlyDict:
    """A channel over time; angles are interrupted where they wrap."""
    time = drawn["time"].values
    values = drawn.values.astype(float)
    # A gap at each wrap, instead of a line across the figure.
    if unit == "deg":
        turns = np.flatnonzero(np.abs(np.diff(values)) > 180.0) + 1
        time = np.insert(time, turns, np.nan)
        values = np.insert(values, turns, np.nan)
    return line(name, time, values, colour, hovertemplate=f"%{{y:.4~g}} {unit}", **look)


def _shades(fault: Finding, raw: Dataset) -> list[PlotlyDict]:
    # A fault without segments concerns the whole log.
    time = raw["time"].values
    return [
        shade(palette.FAULT, x=(float(start), float(end)))
        for start, end in fault.segments or ((time[0], time[-1]),)
    ]
