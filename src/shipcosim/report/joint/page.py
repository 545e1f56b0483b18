"""The page of a diagnosis of several logs: what they say together, what that gains in each, and each by itself."""

from dataclasses import dataclass, replace

from shipcosim.diagnose.reference.held_out import LogErrors
from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.report.diagnosis.extension_section import ExtensionSection, section_of
from shipcosim.report.diagnosis.testability import visible_rows
from shipcosim.report.diagnosis.track_figures import track_figure
from shipcosim.report.diagnosis.words import title, title_of
from shipcosim.report.joint.words import (
    cause_rows,
    discrepancy_rows,
    error_rows,
    fault_rows,
    log_rows,
    next_steps,
    outcome,
    predicted_better,
)
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import bars
from shipcosim.report.theme.numbers import metres, percent
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Fact,
    Figure,
    FigurePage,
    Figures,
    KeyFigure,
    Link,
    PlotlyDict,
    Table,
)

TRACKS = 3
"""Logs whose tracks are all shown; of more the longest."""
LOOKS = {
    "before": ("as the system is", palette.VERMILLION),
    "after": ("with the common causes", palette.BLUE),
}
SECTIONS = {
    "common": "In common",
    "errors": "Error",
    "each": "Each log",
    "extension": "Extension",
    "silent": "Not shown",
}


@dataclass(frozen=True)
class JointPage(FigurePage):
    """What the page of a diagnosis of several logs shows.

    Attributes
    ----------
    discrepancies : Table
        Those of half of the logs, two at least, largest first.
    next_steps, remarks : tuple of str
    causes, faults : Table
        What is common: causes with their sizes by all logs and by each, and faults of the data.
    alike : Table
        Causes that the logs cannot tell apart.
    tracks, errors : tuple of Figure
    error_table, logs : Table
    is_held_out : bool
        Whether a log's errors are by causes that other logs have sized.
    extension : ExtensionSection
    silent : Table
        Causes that all logs together could not have shown.
    visible : Table
        The smallest size of the others that they would have shown.
    """

    discrepancies: Table
    next_steps: tuple[str, ...]
    remarks: tuple[str, ...]
    causes: Table
    faults: Table
    alike: Table
    tracks: Figures
    errors: Figures
    error_table: Table
    is_held_out: bool
    logs: Table
    extension: ExtensionSection
    silent: Table
    visible: Table


def render(found: JointDiagnosis) -> str:
    """The page as HTML."""
    return render_template("joint/templates/joint.html.jinja", _page(found))


def _page(found: JointDiagnosis) -> JointPage:
    of_ship = any(one.component not in found.logs for one in found.of_kind("physics"))
    extension = section_of(found.extension, found.changes, of_ship)
    tracks = _track_figures(found.errors)
    errors = _error_figures(found.errors)
    steps = next_steps(found, extension.system if extension.state == "extended" else None)
    alike = tuple((title_of(one), percent(one.probability, 1)) for one in found.indistinguishable)
    silent = tuple(
        (title(name), found.causes[name].sentence if name in found.causes else "")
        for name in found.not_testable
    )
    return JointPage(
        title=f"Diagnosis of {len(found.logs)} logs of one ship",
        facts=_facts(found),
        outcome=outcome(found),
        links=tuple(
            Link(anchor, name, text)
            for (anchor, name), text in zip(SECTIONS.items(), _found(found), strict=True)
        ),
        key_figures=key_figures(found),
        discrepancies=Table(discrepancy_rows(found), ("", "size", "of the error", "logs")),
        next_steps=tuple(steps),
        remarks=found.remarks,
        causes=Table(cause_rows(found), ("Cause", "By", "Parameter", "Size"), (3,)),
        faults=Table(fault_rows(found), ("Fault of the data", "Channels", "Logs", "Done about it")),
        alike=Table(alike, ("Cause", "Probability")),
        tracks=tracks,
        errors=errors,
        error_table=Table(error_rows(found), _ERROR_HEAD, (0, 1, 2, 3, 4, 5)),
        is_held_out=any(one.fitted_on for one in found.errors.values()),
        logs=Table(
            log_rows(found),
            ("Log", "Verdict", "Faults of its own", "Causes", "Largest discrepancy", "Error"),
            (0, 5),
        ),
        extension=extension,
        silent=Table(silent, ("Cause", "What it would be")),
        visible=Table(visible_rows(found.smallest_visible), ("Cause", "Size, in 9 of 10 cases")),
        figures=(*tracks, *errors),
    )


_ERROR_HEAD = (
    "Log",
    "After",
    "Position, as it is",
    "with the causes",
    "Heading, as it is",
    "with the causes",
    "",
)


def _facts(found: JointDiagnosis) -> tuple[Fact, ...]:
    rows = 0
    minutes = 0.0
    for one in found.logs.values():
        if one.basis:
            time = one.basis.explained.identification.log["time"].values
            rows = rows + time.size
            minutes = minutes + float(time[-1] - time[0]) / 60.0
    length = f"{', '.join(found.logs)}; {minutes:.0f} min, {rows} rows in all"
    return Fact("System", found.system.name if found.system else "–"), Fact("Logs", length)


def _found(found: JointDiagnosis) -> list[str]:
    """What each section found, in a few words."""
    causes = [title_of(one.what) for one in found.findings]
    worst = max((one.position["before"][-1] for one in found.errors.values()), default=None)
    agree = sum(one.verdict == "consistent" for one in found.logs.values())
    return [
        ", ".join(causes) or "nothing",
        "not measured" if worst is None else f"up to {metres(worst)}",
        f"{agree} of {len(found.logs)} agree with the simulation"
        if agree
        else "none agrees with the simulation",
        "extended.ssp" if found.extension else "none",
        f"{len(found.not_testable)} causes" if found.not_testable else "nothing",
    ]


def key_figures(found: JointDiagnosis) -> tuple[KeyFigure, ...]:
    """The numbers that matter most: how sure, and the errors of the worst and of all logs."""
    sure = [one.probability for one in found.of_kind("physics")]
    figures = (
        [KeyFigure(percent(min(sure)), "probability that the causes are right")] if sure else []
    )
    if not found.errors:
        return tuple(figures)
    name, worst = max(found.errors.items(), key=lambda one: one[1].position["before"][-1])
    after = f"after {worst.horizon[-1]:g} s"
    figures.append(
        KeyFigure(
            metres(worst.position["before"][-1]),
            f"position error of the simulation {after}, {name}",
        )
    )
    if "after" in worst.position:
        figures.append(
            KeyFigure(
                metres(worst.position["after"][-1]), "the same with the common causes in the system"
            )
        )
    better, judged = predicted_better(found)
    if judged:
        figures.append(
            KeyFigure(f"{better} of {judged}", "logs are predicted better by what the others say")
        )
    return tuple(figures)


def _error_figures(errors: dict[str, LogErrors]) -> Figures:
    """Errors after the longest horizon by log, before and after."""
    if not errors:
        return ()
    names = [f"{name}, {one.horizon[-1]:g} s" for name, one in errors.items()]
    layout = {"barmode": "group", "xaxis": {"type": "category"}}
    position = _bars(
        {name: one.position for name, one in zip(names, errors.values(), strict=True)}, "m"
    )
    heading = _bars(
        {name: one.heading for name, one in zip(names, errors.values(), strict=True)}, "deg"
    )
    return Figure("Position error by log", "m", position, layout), Figure(
        "Heading error by log", "deg", heading, layout
    )


def _bars(sizes: dict[str, dict[str, tuple[float, ...]]], unit: str) -> tuple[PlotlyDict, ...]:
    """Bars by log, before and after; none where a log has no after."""
    shown = {
        label: look for label, look in LOOKS.items() if any(label in one for one in sizes.values())
    }
    return tuple(
        bars(
            name,
            list(sizes),
            [one.get(label, (float("nan"),))[-1] for one in sizes.values()],
            colour,
            unit,
        )
        for label, (name, colour) in shown.items()
    )


def _track_figures(errors: dict[str, LogErrors]) -> Figures:
    """Tracks of the logs, or where there are many of the longest."""
    longest = sorted(
        errors, key=lambda name: -errors[name].tracks.predicted["before"].sizes["segment"]
    )
    names = list(errors) if len(errors) <= TRACKS else longest[:1]
    return tuple(
        replace(track_figure(errors[name].tracks), title=f"Track, {name}") for name in names
    )
