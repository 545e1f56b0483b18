"""View of recorded tracks: positions, density, outlines to scale, circles of distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pandas import DataFrame

from shipcosim.report.run.track import hull_outline, symbol_size
from shipcosim.report.study.figures import distance_figure
from shipcosim.report.study.frames import RUNS, Frame, Lacking, SeriesOfRows, series_of
from shipcosim.report.study.tables import StudyTables
from shipcosim.report.theme.figures import evenly
from shipcosim.report.theme.numbers import finite
from shipcosim.report.theme.packing import packed_series
from shipcosim.report.theme.views import Figure, JsonObject
from shipcosim.sweep.study_model import View

MOST_TRACKS = 150
MOST_TIMES = 80
CELLS = 72
"""Tracks that are drawn, times of them, and cells of the density each way."""
LEVELS = 3000


@dataclass(frozen=True)
class TracksView:
    """A chart of tracks.

    Attributes
    ----------
    title, note : str
    series : sequence of (str, str)
        Label and colour of each.
    data : dict
        What the script draws: times, tracks, density and the share beyond each circle over time.
    distance : Figure
        How far the runs are from where they began, over time.
    """

    title: str
    note: str
    series: Sequence[tuple[str, str]]
    data: JsonObject
    distance: Figure


@dataclass(frozen=True)
class _Tracks:
    """Tracks on common times: each from where it began; after its end a run stays unknown."""

    time: NDArray  # (m,) [s]
    north: NDArray  # (n, m) [m]
    east: NDArray
    heading: NDArray  # [deg]


def tracks_view(tables: StudyTables, view: View) -> TracksView:
    """The chart of all recorded tracks.

    Raises
    ------
    Lacking
        If no tracks were kept.
    """
    # Series of the runs that have a track.
    frame = Frame(RUNS, tables.columns(tables.runs))
    tracks = _read(tables)
    has_track = np.asarray(np.isfinite(tracks.north).any(axis=1))
    series = []
    for group in series_of(frame, view.series or [], []):
        rows = group.rows[has_track[group.rows]]
        if len(rows):
            series.append(SeriesOfRows(group.label or "all runs", group.colour, rows))
    # Circles and figure use the distance from the start.
    distance = np.hypot(tracks.north, tracks.east)
    circles = view.circles or _circles(distance)
    # Rows of the drawn tracks: equally many of each series.
    most = MOST_TRACKS // len(series)
    drawn = [group.rows[evenly(len(group.rows), most)] for group in series]
    note = (
        f"North up, each from where it began. Drawn are {sum(map(len, drawn))} of {sum(len(s.rows) for s in series)} "
        "tracks, with her outline at the time shown; shaded: where all of them were, the darker the longer."
    )
    # Quantiles over all tracks, not only over the drawn ones; NaN where no run is left.
    spread = [
        (group, DataFrame(distance[group.rows]).quantile([0.05, 0.5, 0.95]).to_numpy())
        for group in series
    ]
    return TracksView(
        title=view.title or "Tracks",
        note=view.note or note,
        series=[(group.label, group.colour) for group in series],
        data=_data(tables, tracks, series, drawn, circles),
        distance=distance_figure(tracks.time, spread),
    )


def _read(tables: StudyTables) -> _Tracks:
    """Read the tracks on few common times."""
    # Signals north, east and heading as the study names them.
    names = [str(name) for name in (tables.study.get("tracks") or {}).get("signals", ())]
    runs = tables.runs["run"]
    of_runs = None if tables.tracks is None else tables.tracks.loc[tables.tracks["run"].isin(runs)]
    if of_runs is None or of_runs.empty or len(names) < 2:
        raise Lacking(
            "No tracks were kept: the study has no [tracks] with signals of north, east and heading."
        )
    # A row for each run, a column for each time; evenly fewer times, first and last included.
    once = of_runs.drop_duplicates(["run", "time"], keep="last")
    table = once.pivot(index="run", columns="time", values=names[:3]).reindex(runs)
    time = table[names[0]].columns.to_numpy(float)
    kept = evenly(len(time), MOST_TIMES)
    north, east, *headings = (table[name].to_numpy(float) for name in names[:3])
    heading = headings[0] if headings else np.full_like(north, np.nan)
    # Each track relative to its first known position.
    first = [table[name].bfill(axis=1).to_numpy(float)[:, :1] for name in names[:2]]
    return _Tracks(
        time[kept],
        (north - first[0])[:, kept],
        (east - first[1])[:, kept],
        np.degrees(heading)[:, kept],
    )


def _circles(distance: NDArray) -> list[float]:
    """Three round radii within the reach of the runs. [m]"""
    # Radii 1, 2 and 5 times powers of ten.
    most = float(np.nanmax(distance)) if np.isfinite(distance).any() else 1.0
    power = 10.0 ** np.floor(np.log10(max(most, 0.1)))
    return [r for r in np.outer([0.1, 1.0], [1.0, 2.0, 5.0]).ravel() * power if r <= most][-3:] or [
        power
    ]


def _data(
    tables: StudyTables,
    tracks: _Tracks,
    series: Sequence[SeriesOfRows],
    drawn: Sequence[NDArray],
    circles: Sequence[float],
) -> JsonObject:
    every = np.concatenate([group.rows for group in series])
    # West, east, south and north end of all tracks, the start included. [m]
    ends = []
    for values in (tracks.east[every], tracks.north[every]):
        numbers = np.append(finite(values), 0.0)
        ends += [numbers.min(), numbers.max()]
    box = [float(f"{end:.6g}") for end in ends]
    # Outline to scale where the ship's size is known.
    ship = tables.about.get("ship") or {}
    size = (float(ship.get("length") or 0.0), float(ship.get("breadth") or 0.0))
    is_to_scale = min(size) > 0.0
    forward, starboard = hull_outline(
        *(size if is_to_scale else symbol_size(tracks.north[every], tracks.east[every]))
    )
    return {
        "time": tracks.time.tolist(),
        "box": box,
        "hull": [forward.tolist(), starboard.tolist()],
        "toScale": is_to_scale,
        "circles": list(circles),
        "series": [
            {
                "label": group.label,
                "colour": group.colour,
                "count": len(group.rows),
                "cells": _density(tracks, group.rows, box),
                "beyond": _beyond(tracks, group.rows, circles),
                "tracks": [
                    {
                        "run": int(tables.runs["run"].iloc[row]),
                        "north": packed_series(tracks.north[row], LEVELS),
                        "east": packed_series(tracks.east[row], LEVELS),
                        "heading": packed_series(tracks.heading[row], LEVELS),
                    }
                    for row in rows
                ],
            }
            for group, rows in zip(series, drawn, strict=True)
        ],
        "cells": CELLS,
    }


def _density(tracks: _Tracks, rows: NDArray, box: Sequence[float]) -> list[int]:
    """Number of positions in each cell, row by row from the north."""
    # All positions of the series within the box of all tracks.
    north = tracks.north[rows].ravel()
    east = tracks.east[rows].ravel()
    is_known = np.isfinite(north) & np.isfinite(east)
    west, right, south, top = (
        end + k for end, k in zip(box, (-1e-6, 1e-6, -1e-6, 1e-6), strict=True)
    )
    counts, _, _ = np.histogram2d(
        north[is_known], east[is_known], bins=CELLS, range=[[south, top], [west, right]]
    )
    return counts[::-1].astype(int).ravel().tolist()


def _beyond(tracks: _Tracks, rows: NDArray, circles: Sequence[float]) -> list[list[float]]:
    """Share of the runs that have left each circle by each time."""
    # Largest distance so far: a run that returns has still left the circle.
    distance = np.hypot(tracks.north[rows], tracks.east[rows])
    largest = np.fmax.accumulate(np.where(np.isfinite(distance), distance, 0.0), axis=1)
    return [(largest > radius).mean(axis=0).round(4).tolist() for radius in circles]
