"""Views that are plots: polar, curves, bars, Pareto, scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shipcosim.report.study.frames import (
    RUNS,
    Frame,
    SeriesOfRows,
    frame_of,
    gathered,
    how_gathered,
    left_out,
    series_of,
)
from shipcosim.report.study.statistics import distribution, pareto_front
from shipcosim.report.study.tables import Column, StudyTables
from shipcosim.report.study.words import is_failed
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import band, evenly, line, polar_axes, polar_curve, rounded
from shipcosim.report.theme.numbers import finite
from shipcosim.report.theme.views import Figure, PlotlyDict
from shipcosim.sweep.study_model import View

TALL = 380  # px
POLAR = 420
BAR = 18
MOST_DOTS = 2500
"""Dots of a figure; the table and the scatter plot beside it hold more."""


def polar(tables: StudyTables, view: View) -> Figure:
    """A value over the direction that weather comes from, bow up."""
    frame = frame_of(tables, view.table, [view.angle, view.radius])
    around = frame.column(view.angle)
    size = frame.column(view.radius)
    series = series_of(frame, view.series, [around.name])
    traces = []
    groups = []
    # Each series of directions: rows of the same direction are gathered into one point.
    for k, curve in enumerate(series):
        degrees = np.unique(around.values[curve.rows][np.isfinite(around.values[curve.rows])])
        rows_by_degree = [curve.rows[around.values[curve.rows] == at] for at in degrees]
        points = np.array([gathered(frame, size, rows) for rows in rows_by_degree]).reshape(-1, 3)
        groups += rows_by_degree
        traces += _around(
            curve, degrees, points, with_band=len(series) <= 3, fill=0.14 if k == 0 else None
        )
    # Static capability curves for the same quantity.
    traces += _static_curves(tables, view, series)
    note = "Bow up; angle: where the weather comes from, 90° from starboard."
    notes = [
        view.note or note,
        how_gathered(frame, size, groups),
        left_out(frame, series),
        in_part(size),
    ]
    title = f"{size.name} by direction"
    # A little more room than the largest radius.
    most = max((r for trace in traces for r in trace["r"] if r is not None), default=1.0)
    axes = polar_axes(range=[0, 1.08 * most if most > 0 else 1.0], nticks=6)
    return _figure(view, title, size.unit, traces, {"polar": axes}, notes, POLAR)


def in_part(column: Column) -> str:
    """Sentence on values that the study knows only as a range; empty if there are none."""
    open_ = sorted({text for text in column.ranges if not text.lstrip("-").isdigit()})
    if not open_:
        return ""
    listed = ", ".join(open_[:4])
    return f"The curve shows the last case that was held. Not every case was run: values are known as {listed}."


def _around(
    series: SeriesOfRows, degrees: NDArray, points: NDArray, *, with_band: bool, fill: float | None
) -> list[PlotlyDict]:
    """A curve around the ship, closed if directions go all around, and the band of its interval."""
    # Closed if no gap is much larger than the mean spacing.
    closed = len(degrees) > 2 and np.diff(
        np.append(degrees, degrees[0] + 360.0)
    ).max() <= 1.5 * 360.0 / len(degrees)
    end = [0] if closed else []
    theta = [*degrees, *degrees[end]]
    value, low, high = np.concatenate([points, points[end]]).T
    # The curve itself, filled for the first series only.
    name = series.label or "all"
    look: PlotlyDict = {"mode": "lines+markers", "marker": {"size": 4}}
    traces = [polar_curve(name, theta, value, series.colour, fill=fill if closed else None, **look)]
    # The interval as dotted curves, where it is known.
    if with_band and (np.isfinite(low) & np.isfinite(high)).any():
        look = {"width": 1, "dash": "dot", "showlegend": False, "hoverinfo": "skip"}
        traces += [polar_curve("", theta, edge, series.colour, **look) for edge in (low, high)]
    return traces


def _static_curves(
    tables: StudyTables, view: View, series: Sequence[SeriesOfRows]
) -> list[PlotlyDict]:
    """Curves from `about` for the same quantity and series, such as static capability."""
    colours = {each.label: each.colour for each in series}
    traces = []
    for entry in tables.about.get("beside") or ():
        # Same quantity, same basis, and a series that is drawn.
        is_asked = entry.get("radius") == view.radius and (
            "basis" not in entry or entry["basis"] in view.static
        )
        if is_asked and str(entry["series"]) in colours:
            degrees = np.degrees(np.asarray(entry["angle"], float))
            radius = entry["radius_values"]
            traces.append(
                polar_curve(
                    str(entry["name"]),
                    [*degrees, degrees[0]],
                    [*radius, radius[0]],
                    colours[str(entry["series"])],
                    dash=entry.get("dash", "dash"),
                )
            )
    return traces


def curves(tables: StudyTables, view: View) -> Figure:
    """Empirical distribution of a quantity, with its simultaneous 95 % band."""
    # Failed runs say nothing about the distribution.
    frame = frame_of(tables, view.table or "runs", [view.quantity])
    quantity = frame.column(view.quantity)
    series = series_of(frame, view.series, [quantity.name])
    failed = is_failed(tables)
    traces = []
    never = 0
    widths = []
    largest = np.nanmax(quantity.values) if np.isfinite(quantity.values).any() else 1.0
    # Runs that never reach a value keep the curve below 1.
    for curve in series:
        rows = curve.rows
        if len(failed) == frame.rows:
            rows = rows[~failed[rows]]
        # Empirical distribution with its simultaneous band.
        reached, share, half = distribution(quantity.values[rows])
        never += len(rows) - len(reached)
        widths.append(half)
        traces += _steps(curve, reached, share, half, largest, with_band=len(series) <= 4)
    notes = [
        view.note or "Share of runs up to each value.",
        f"Band: 95 %, for the whole curve at once (Dvoretzky-Kiefer-Wolfowitz), ± {max(widths):.2g}."
        if widths
        else "",
        f"{never} runs never reach it: their curve ends below 1." if never else "",
        left_out(frame, series),
    ]
    layout = {
        "xaxis": {"title": {"text": quantity.titled}},
        "yaxis": {"range": [0, 1.02], "title": {"text": "share"}},
    }
    return _figure(
        view,
        f"Distribution of {quantity.name}",
        "",
        traces,
        layout | {"hovermode": "closest"},
        notes,
        TALL,
    )


def _steps(
    series: SeriesOfRows,
    reached: NDArray,
    share: NDArray,
    half: float,
    largest: float,
    *,
    with_band: bool,
) -> list[PlotlyDict]:
    # Prolong the last step to the right edge of the figure.
    x = np.concatenate([reached, [largest]])
    y = np.concatenate([share, share[-1:] if len(share) else [0.0]])
    curve = line(
        series.label or "all runs",
        x,
        y,
        series.colour,
        width=2,
        hovertemplate="%{y:.3~f} up to %{x:.4~g}",
    )
    # Band of the distribution, within 0 and 1.
    low, high = (np.clip(y + edge, 0, 1) for edge in (-half, half))
    traces = [*band(x, low, high, series.colour), curve] if with_band else [curve]
    # Steps: the share is constant between two values.
    for trace in traces:
        trace["line"] |= {"shape": "hv"}
    return traces


def bars(tables: StudyTables, view: View) -> Figure:
    """Values by category, with their intervals."""
    # One or several values, each with its bars in the same categories.
    frame = frame_of(tables, view.table, [view.category, *view.value])
    category = frame.column(view.category)
    values = [frame.column(name) for name in view.value]
    # Levels of a factor, else the different numbers.
    every = category.levels or tuple(np.unique(finite(category.values)).tolist())
    levels = every[: view.most]
    # With several values the colours tell these apart, not series.
    has_several = len(values) > 1
    factors = [] if has_several and view.series is None else view.series
    series = series_of(frame, factors, [category.name])
    names = [category.text(at) for at in levels]
    traces = []
    groups = []
    colours = iter(palette.CYCLE)
    for value in values:
        for group in series:
            # Gather the rows of each category into a value with interval.
            rows_by_level = [group.rows[category.values[group.rows] == level] for level in levels]
            points = np.array(
                [
                    gathered(frame, value, rows) if len(rows) else (np.nan,) * 3
                    for rows in rows_by_level
                ]
            )
            groups += rows_by_level
            label = ", ".join(filter(None, (value.name if has_several else "", group.label)))
            traces.append(_bar(label or value.name, names, points, next(colours, palette.INK)))
    # Tell the reader what is left out, and what the interval is.
    fewer = f"The first {len(levels)} of {len(every)}." if len(levels) < len(every) else ""
    notes = [
        view.note,
        fewer,
        how_gathered(frame, values[0], groups),
        left_out(frame, series),
    ]
    title = f"{', '.join(view.value)} by {category.name}"
    height = max(TALL, BAR * len(levels) * len(traces))
    # Names stand next to the bars, the first one on top.
    axes = {"barmode": "group", "yaxis": {"type": "category", "autorange": "reversed"}}
    return _figure(view, title, values[0].unit, traces, axes, notes, height)


def _bar(name: str, categories: Sequence[str], points: NDArray, colour: str) -> PlotlyDict:
    made: PlotlyDict = {
        "type": "bar",
        "orientation": "h",
        "name": name,
        "x": rounded(points[:, 0]),
        "y": list(categories),
        "marker": {"color": palette.faded(colour, 0.75)},
        "hovertemplate": "%{x:.3~g}",
    }
    # Error bars from the interval, where there is one.
    if not np.isfinite(points[:, 1:]).any():
        return made
    with np.errstate(invalid="ignore"):  # what never happens is infinite, and has no bar
        up = points[:, 2] - points[:, 0]
        down = points[:, 0] - points[:, 1]
    ends = {"type": "data", "symmetric": False, "array": rounded(up), "arrayminus": rounded(down)}
    return made | {"error_x": ends | {"color": palette.INK, "thickness": 1.4, "width": 4}}


def pareto(tables: StudyTables, view: View) -> Figure:
    """Two or three quantities against each other; runs on the Pareto front are marked."""
    frame = frame_of(tables, view.table, view.quantities)
    columns = [frame.column(name) for name in view.quantities]
    # Smaller is better, unless the view says larger.
    front = pareto_front([-c.values if c.name in view.largest else c.values for c in columns])
    # Sort the front by the first quantity, so that a line can join it.
    rows = {"others": np.flatnonzero(~front), "front": np.flatnonzero(front)}
    rows["front"] = rows["front"][np.argsort(columns[0].values[rows["front"]])]
    third = columns[2] if len(columns) == 3 else None
    look = {
        "size": 9,
        "color": palette.VERMILLION,
        "opacity": 0.95,
        "line": {"color": palette.INK, "width": 1},
    }
    # Others small and faint, the front on top of them.
    traces = [
        _dots(
            "other runs" if frame.name == RUNS else "others",
            frame,
            tables,
            columns,
            _even(rows["others"]),
            third,
            {"size": 5, "color": palette.FAINT},
        ),
        _dots("not beaten", frame, tables, columns, rows["front"], third, look),
    ]
    # With two quantities the front is a curve.
    if third is None:
        traces[1] |= {
            "mode": "lines+markers",
            "line": {"color": palette.VERMILLION, "width": 1, "dash": "dot"},
        }
    # A run that the view marks, such as the shipped gains.
    if name := view.marked:
        rows["marked"] = np.flatnonzero(frame.column(name).values == 1.0)
        mark = {
            "size": 14,
            "symbol": "star",
            "color": palette.BLUE,
            "line": {"color": palette.INK, "width": 1},
        }
        traces.append(
            _dots(name.replace("_", " "), frame, tables, columns, rows["marked"], None, mark)
        )
    # The note says which direction is better.
    better = ", ".join(
        f"{c.name} {'large' if c.name in view.largest else 'small'}" for c in columns
    )
    wanted = f"Wanted: {better}. Marked: the {front.sum()} of {frame.rows} that no other beats."
    notes = [view.note or wanted]
    if third is not None and len(numbers := finite(third.values)):
        ends = f"{third.text(numbers.min())} to {third.text(numbers.max())}"
        notes.append(f"Size of a dot: {third.name}, {ends}.")
    title = " against ".join(view.quantities)
    return _figure(view, title, "", traces, _axes(*columns[:2]), notes, TALL)


def scatter(tables: StudyTables, view: View) -> Figure:
    """One column against another, by series."""
    frame = frame_of(tables, view.table, [view.x, view.y])
    columns = [frame.column(name) for name in (view.x, view.y)]
    # Colour by a factor, if it has few enough levels.
    chosen = view.series or []
    has_levels = all(frame.column(name).levels for name in chosen)
    series = series_of(frame, chosen if has_levels else [], ())
    # Evenly fewer dots, by the same share in each series.
    share = min(MOST_DOTS / max(frame.rows, 1), 1.0)
    traces = [
        _dots(
            group.label or "runs",
            frame,
            tables,
            columns,
            _even(group.rows, share),
            None,
            {"color": group.colour, "size": 6},
        )
        for group in series
    ]
    notes = [
        view.note,
        left_out(frame, series),
        f"Drawn are {sum(len(t['x']) for t in traces)} of {frame.rows} rows."
        if share < 1.0
        else "",
    ]
    return _figure(view, f"{view.y} against {view.x}", "", traces, _axes(*columns), notes, TALL)


def _dots(
    name: str,
    frame: Frame,
    tables: StudyTables,
    columns: Sequence[Column],
    rows: NDArray,
    third: Column | None,
    look: Mapping[str, Any],
) -> PlotlyDict:
    """Dots, each with the number of its run if it shows a single run."""
    marker = {"opacity": 0.7, "line": {"width": 0}} | dict(look)
    # A third quantity sets the size of the dots.
    if third is not None and len(rows):
        low = np.nanmin(third.values)
        span = np.ptp(finite(third.values)) or 1.0
        marker["size"] = rounded(5 + 12 * (third.values[rows] - low) / span, 3)
    made = {"type": "scatter", "mode": "markers", "name": name, "marker": marker}
    made |= {
        "x": _drawn(columns[0], rows),
        "y": _drawn(columns[1], rows),
        "hovertemplate": "%{x}, %{y}",
    }
    # The number of the run links a dot to its page.
    if frame.name == RUNS:
        numbers = tables.runs["run"].to_numpy()[rows].tolist()
        made |= {"customdata": numbers, "hovertemplate": "run %{customdata}: %{x:.4~g}, %{y:.4~g}"}
    return made


def _drawn(column: Column, rows: NDArray) -> list[Any]:
    return (
        rounded(column.values[rows])
        if column.is_number
        else [column.text(v) for v in column.values[rows]]
    )


def _even(rows: NDArray, share: float | None = None) -> NDArray:
    """Evenly thinned rows."""
    most = MOST_DOTS if share is None else max(int(share * len(rows)), 1)
    return rows if len(rows) <= most else rows[evenly(len(rows), most)]


def _axes(x: Column, y: Column) -> PlotlyDict:
    return {"xaxis": {"title": {"text": x.titled}}, "yaxis": {"title": {"text": y.titled}}}


def _figure(
    view: View,
    title: str,
    unit: str,
    traces: Sequence[PlotlyDict],
    layout: Mapping[str, Any],
    notes: Sequence[str],
    height: int,
) -> Figure:
    return Figure(
        view.title or title,
        unit,
        traces,
        dict(layout),
        " ".join(filter(None, notes)),
        height,
    )


def distance_figure(time: NDArray, spread: Sequence[tuple[SeriesOfRows, NDArray]]) -> Figure:
    """Distance from the first position over time: median and 5 to 95 % range of each series.

    Parameters
    ----------
    time : (m,) array
        [s]
    spread : sequence of (SeriesOfRows, (3, m) array)
        5 %, 50 % and 95 % of the tracks. [m]
    """
    traces = []
    for group, (low, middle, high) in spread:
        # Band between the outer quantiles, then the median on top.
        look: PlotlyDict = {"width": 2, "hovertemplate": "%{y:.3~g} m"}
        traces += band(time, low, high, group.colour)
        traces.append(line(group.label, time, middle, group.colour, **look))
    layout = {
        "xaxis": {"title": {"text": "time [s]"}},
        "yaxis": {"rangemode": "tozero"},
        "hovermode": "x unified",
    }
    return Figure(
        "Distance from where each run began",
        "m",
        traces,
        layout,
        "Line: median of the runs; band: from 5 to 95 % of them at each time.",
        TALL,
    )
