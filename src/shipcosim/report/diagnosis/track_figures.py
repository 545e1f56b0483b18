"""A log and its simulations: track, heading and speeds, measured, before and after."""

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line
from shipcosim.report.theme.numbers import plain
from shipcosim.report.theme.views import Figure, Table

COLOURS = (palette.ORANGE, palette.BLUE, palette.GREEN)
OVER_TIME = (
    ("heading", "Heading", "deg"),
    ("surge", "Surge", "m/s"),
    ("sway", "Sway", "m/s"),
    ("yaw_rate", "Yaw rate", "deg/s"),
)


def track_figure(tracks: Tracks) -> Figure:
    """Measured and simulated tracks on one chart, north up, equal scales."""
    # The measured track wide and pale, simulations thin on top of it.
    seen = tracks.measured
    traces = [
        line("measured", seen["east"].values, seen["north"].values, palette.MEASURED, width=4.0)
    ]
    for (name, prediction), colour in zip(tracks.predicted.items(), COLOURS, strict=False):
        traces.append(
            line(name, joined(prediction, "east"), joined(prediction, "north"), colour, width=1.3)
        )
    layout = {
        "xaxis": {"title": {"text": "East"}},
        "yaxis": {"title": {"text": "North"}, "scaleanchor": "x"},
    }
    note = f"Every {tracks.horizon:.0f} s the simulation starts again from the measured position, heading and velocity."
    return Figure("Track", "m", tuple(traces), layout, note, height=460)


def over_time_figures(tracks: Tracks) -> list[Figure]:
    """Heading, surge, sway and yaw rate over time, if logged."""
    return [
        _over_time(tracks, *row)
        for row in OVER_TIME
        if np.isfinite(tracks.measured[row[0]].values).any()
    ]


def _over_time(tracks: Tracks, role: str, title: str, unit: str) -> Figure:
    seen = tracks.measured
    traces = [line("measured", seen["time"].values, seen[role].values, palette.MEASURED, width=3.0)]
    for (name, prediction), colour in zip(tracks.predicted.items(), COLOURS, strict=False):
        # Absolute times of each prediction, with a gap between two predictions.
        time = prediction["start_time"].values[:, None] + prediction["time"].values
        traces.append(line(name, _with_gaps(time), joined(prediction, role), colour, width=1.2))
    return Figure(title, unit, tuple(traces), {"xaxis": TIME})


def joined(prediction: Dataset, role: str) -> NDArray:
    """A channel of all predictions in sequence, with gaps between them."""
    return _with_gaps(prediction[role].values)


def _with_gaps(values: NDArray) -> NDArray:
    return np.hstack([values, np.full((len(values), 1), np.nan)]).ravel()


def error_rows(errors: Dataset) -> Table:
    """Root mean square errors by simulation and time, from `errors_of`."""
    # Channels that the log has.
    channels = [str(name) for name in errors.data_vars if np.isfinite(errors[name].values).any()]
    head = (
        "after",
        "simulation",
        *(f"{name.replace('_', ' ')} [{errors[name].attrs['units']}]" for name in channels),
    )
    rows = [
        (
            f"{after:g} s",
            str(name),
            *(plain(float(errors[c].sel(after=after, simulation=name))) for c in channels),
        )
        for after in errors["after"].values
        for name in errors["simulation"].values
    ]
    return Table(rows, head)
