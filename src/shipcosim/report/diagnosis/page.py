"""The page of a diagnosis: what it shows, and the functions that write it."""

from dataclasses import dataclass

from shipcosim.diagnose.result import Diagnosis, LogSummary
from shipcosim.report.diagnosis.cause_section import CauseSection, cause_section
from shipcosim.report.diagnosis.error_section import ErrorSection, error_section
from shipcosim.report.diagnosis.extension_section import ExtensionSection, extension_section
from shipcosim.report.diagnosis.gain_section import GainSection, gain_section
from shipcosim.report.diagnosis.key_figures import key_figures
from shipcosim.report.diagnosis.log_section import LogSection, log_section
from shipcosim.report.diagnosis.scene import ScenePage, make_scene
from shipcosim.report.diagnosis.track_figures import over_time_figures, track_figure
from shipcosim.report.diagnosis.words import discrepancy_rows, next_steps, outcome
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Fact,
    Figure,
    Link,
    Table,
    known_facts,
)
from shipcosim.ssp import System


@dataclass(frozen=True)
class DiagnosisPage(ScenePage):
    """What the page of a diagnosis shows: figures that matter, what to do next, and five sections.

    Attributes
    ----------
    discrepancies : Table
        What is wrong at first sight, largest first.
    next_steps : tuple of str
        What to do now.
    tracks : tuple of Figure
        Track and speeds, measured and simulated; empty where no stretch of the log is whole.
    log, error, cause, extension, gain : section of the page
    """

    discrepancies: Table
    next_steps: tuple[str, ...]
    tracks: tuple[Figure, ...]
    log: LogSection
    error: ErrorSection
    cause: CauseSection
    extension: ExtensionSection
    gain: GainSection


def render(diagnosis: Diagnosis) -> str:
    """The page as HTML."""
    return render_template("diagnosis/templates/diagnosis.html.jinja", _page(diagnosis))


def _page(diagnosis: Diagnosis) -> DiagnosisPage:
    # A page needs the log and the evidence; a stored result has neither.
    if diagnosis.log is None or diagnosis.evidence is None:
        raise ValueError(
            "only a diagnosis with its log and evidence has a page; shipcosim.diagnose makes one"
        )
    # Sections first: links and figures follow from them.
    log = log_section(diagnosis, diagnosis.log)
    cause = cause_section(diagnosis, diagnosis.evidence)
    error = error_section(diagnosis)
    extension = extension_section(diagnosis)
    gain = gain_section(diagnosis)
    # All figures in the order in which the page draws them.
    causes = (*cause.sizes, *cause.figures, *cause.unmodelled, *cause.whiteness)
    tracks = (
        ()
        if diagnosis.tracks is None
        else (track_figure(diagnosis.tracks), *over_time_figures(diagnosis.tracks))
    )
    figures = (*tracks, *log.figures, *error.figures, *error.forces, *causes, *gain.figures)
    # Each link tells the result of its section.
    links = {"log": ("Log", log), "error": ("Error", error), "causes": ("Cause", cause)}
    links |= {"extension": ("Extension", extension), "gain": ("Gain", gain)}
    steps = next_steps(
        diagnosis, extension.system if extension.state == "extended" else None, diagnosis.causes
    )
    return DiagnosisPage(
        title=f"Diagnosis of {diagnosis.log.name}",
        facts=_facts(diagnosis.log, diagnosis.system),
        outcome=outcome(diagnosis, diagnosis.causes),
        links=tuple(
            Link(anchor, title, section.found) for anchor, (title, section) in links.items()
        ),
        key_figures=key_figures(diagnosis),
        discrepancies=Table(discrepancy_rows(diagnosis), ("", "size", "of the error")),
        next_steps=tuple(steps),
        tracks=tracks,
        log=log,
        error=error,
        cause=cause,
        extension=extension,
        gain=gain,
        scene=make_scene(diagnosis.tracks, diagnosis.force, diagnosis.system),
        figures=figures,
    )


def _facts(log: LogSummary, system: System | None) -> tuple[Fact, ...]:
    """System, length of the log and its step."""
    time = log.measured["time"].values
    length = f"{(time[-1] - time[0]) / 60:.0f} min, {time.size} rows"
    facts = (
        ("System", system.name if system else ""),
        ("Log", length),
        ("Step", f"{log.step:g} s"),
    )
    return known_facts(facts)
