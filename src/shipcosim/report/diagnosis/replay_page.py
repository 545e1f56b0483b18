"""The page of a replay: a log, and its simulation by one or two systems."""

import os
from dataclasses import dataclass

from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.report.diagnosis.track_figures import error_rows, over_time_figures, track_figure
from shipcosim.report.theme.numbers import metres
from shipcosim.report.theme.pages import render
from shipcosim.report.theme.views import Fact, Figure, Outcome, Page, Table
from shipcosim.series import write_file


@dataclass(frozen=True)
class ReplayPage(Page):
    """What the page of a replay shows.

    Attributes
    ----------
    figures : tuple of Figure
        The track, then channels over time.
    errors : Table
    remarks : tuple of str
        What was found in the log and handled.
    """

    figures: tuple[Figure, ...]
    errors: Table
    remarks: tuple[str, ...]


def write_replay(
    replay: LogReplay, path: str | os.PathLike[str], title: str, facts: dict[str, str]
) -> None:
    """Write the page of a replay.

    Parameters
    ----------
    replay : LogReplay
    path : path
        HTML file; it is there completely or not at all.
    title : str
        Name of the log.
    facts : dict of str to str
        Shown below the title.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    # Track and channels, measured and simulated.
    tracks = replay.tracks
    figures = (track_figure(tracks), *over_time_figures(tracks))
    # Faults of the log come before other remarks.
    faults = tuple(
        f"{fault.label}: {fault.note}" if fault.note else fault.label for fault in replay.faults
    )
    page = ReplayPage(
        title=f"Replay of {title}",
        facts=tuple(Fact(name, text) for name, text in facts.items()),
        outcome=replay_outcome(replay),
        links=(),
        data=tuple(figure.drawn for figure in figures),
        figures=figures,
        errors=error_rows(errors_of(tracks)),
        remarks=(*faults, *replay.remarks),
    )
    write_file(path, render("diagnosis/templates/replay.html.jinja", page).encode())


def replay_outcome(replay: LogReplay) -> Outcome:
    """Position errors of the simulations at the end of their predictions."""
    tracks = replay.tracks
    last = errors_of(tracks)["position"].isel(after=-1)
    told = ", ".join(
        f"{name} {metres(float(last.sel(simulation=name)))}" for name in tracks.predicted
    )
    return Outcome(
        "replayed",
        "REPLAYED",
        f"Position error after {float(last['after']):.0f} s, root mean square: {told}.",
    )
