"""What each of several logs shows in one diagnosis of all: rows and figures by log."""

from dataclasses import replace

from shipcosim.diagnose.reference.held_out import LogErrors
from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.track_figures import track_figure
from shipcosim.report.diagnosis.words import listed, title, told
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import bars
from shipcosim.report.theme.numbers import metres, plain
from shipcosim.report.theme.views import Figure, Figures, Table

TRACKS = 3
"""Logs whose tracks are all shown; of more the longest."""
LOOKS = {
    "before": ("as the system is", palette.VERMILLION),
    "after": ("with the causes", palette.BLUE),
}


def error_table(found: JointDiagnosis) -> Table:
    """Errors by log after each horizon: position and heading, before and after, and which logs sized the causes."""
    head = ("Log", "After", "Position", "with the causes", "Heading", "with the causes", "")
    rows = []
    for name, one in found.errors.items():
        after = " / ".join(f"{horizon:.2g}" for horizon in one.horizon)
        cells = [
            _by_horizon(of.get(label), unit)
            for of, unit in ((one.position, " m"), (one.heading, "°"))
            for label in LOOKS
        ]
        rows.append((name, f"{after} s", *cells, _sized_by(one)))
    return Table(rows, head, (0, 1, 2, 3, 4, 5))


def _by_horizon(values: tuple[float, ...] | None, unit: str) -> str:
    return "–" if values is None else " / ".join(plain(value, 2) for value in values) + unit


def _sized_by(one: LogErrors) -> str:
    """Logs that gave the sizes of the causes in the extended system."""
    if not one.fitted_on:
        return "–"
    many = len(one.fitted_on) > 2
    text = f"sizes by {'all other logs' if many else ', '.join(one.fitted_on)}"
    own = listed([title(cause).lower() for cause in one.own]) if one.own else ""
    return f"{text}; {own} by this log itself" if own else text


def log_table(found: Diagnosis) -> Table:
    """What each log says by itself: verdict, faults of its own, causes, its largest discrepancy, error; none of one."""
    if not isinstance(found, JointDiagnosis):
        return Table(())
    rows = []
    for name, one in found.logs.items():
        faults = [fault.sentence or told(fault) for fault in found.own_faults(name)]
        causes = [told(finding, found.causes) for finding in one.physics]
        first = one.discrepancies[0].what if one.discrepancies else "none"
        rows.append(
            (
                name,
                one.verdict,
                "; ".join(faults) or "none",
                "; ".join(causes) or "none",
                first,
                error_after(one),
            )
        )
    head = ("Log", "Verdict", "Faults of its own", "Causes", "Largest discrepancy", "Error")
    return Table(rows, head, (0, 5))


def error_after(found: Diagnosis) -> str:
    """Position error of the simulation after the longest horizon."""
    base = found.baseline
    if not base:
        return "not measured"
    return f"{metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:.4g} s"


def error_figures(errors: dict[str, LogErrors]) -> Figures:
    """Errors after the longest horizon by log, before and after."""
    if not errors:
        return ()
    position = {name: one.position for name, one in errors.items()}
    heading = {name: one.heading for name, one in errors.items()}
    after = f"after {next(iter(errors.values())).horizon[-1]:g} s, by log"
    return (
        _bars(f"Position error {after}", "m", position),
        _bars(f"Heading error {after}", "deg", heading),
    )


def _bars(heading: str, unit: str, sizes: dict[str, dict[str, tuple[float, ...]]]) -> Figure:
    """Bars by log, before and after; none where a log has no after."""
    traces = []
    for label, (name, colour) in LOOKS.items():
        if any(label in one for one in sizes.values()):
            last = [one.get(label, (float("nan"),))[-1] for one in sizes.values()]
            traces.append(bars(name, list(sizes), last, colour, unit))
    layout = {"barmode": "group", "xaxis": {"type": "category"}}
    return Figure(heading, unit, tuple(traces), layout)


def track_figures(errors: dict[str, LogErrors]) -> Figures:
    """Tracks of the logs, or where there are many of the longest."""
    longest = sorted(
        errors, key=lambda name: -errors[name].tracks.predicted["before"].sizes["segment"]
    )
    names = list(errors) if len(errors) <= TRACKS else longest[:1]
    return tuple(
        replace(track_figure(errors[name].tracks), title=f"Track, {name}") for name in names
    )
