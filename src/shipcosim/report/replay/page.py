"""The page of a replay: a log, and its simulation by one or two systems."""

from collections.abc import Sequence

from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.report.diagnosis.scene import ScenePage, make_scene
from shipcosim.report.diagnosis.track_figures import error_rows, over_time_figures, track_figure
from shipcosim.report.theme.numbers import metres
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import Outcome, known_facts


def render(replay: LogReplay, title: str, facts: dict[str, str]) -> str:
    """The page of a replay as HTML; `title` is the name of the log, `facts` are shown below it."""
    # Track and channels, measured and simulated.
    tracks = replay.tracks
    figures = (track_figure(tracks), *over_time_figures(tracks))
    page = ScenePage(
        title=f"Replay of {title}",
        facts=known_facts(facts),
        outcome=replay_outcome(replay),
        scene=make_scene(tracks, None, replay.system),
        figures=figures,
    )
    return render_template(
        "replay/templates/replay.html.jinja",
        page,
        errors=error_rows(errors_of(tracks)),
        remarks=remarks_of(replay),
    )


def remarks_of(replay: LogReplay) -> Sequence[str]:
    """What was found in the log and handled: its faults, then other remarks."""
    faults = (
        f"{fault.label}: {fault.note}" if fault.note else fault.label for fault in replay.faults
    )
    return (*faults, *replay.remarks)


def replay_outcome(replay: LogReplay) -> Outcome:
    """Position errors of the simulations at the end of their predictions."""
    tracks = replay.tracks
    last = errors_of(tracks)["position"].isel(after=-1)
    errors = ", ".join(
        f"{name} {metres(float(last.sel(simulation=name)))}" for name in tracks.predicted
    )
    return Outcome(
        "replayed",
        "REPLAYED",
        f"Position error after {float(last['after']):.0f} s, root mean square of predictions over the whole log: {errors}.",
    )
