"""The page of a diagnosis: what it shows, and the functions that write it."""

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.by_log import track_figures
from shipcosim.report.diagnosis.cause_section import cause_section
from shipcosim.report.diagnosis.extension_section import extension_section
from shipcosim.report.diagnosis.gain_section import gain_section
from shipcosim.report.diagnosis.log_section import log_section
from shipcosim.report.diagnosis.prediction_errors import error_section
from shipcosim.report.diagnosis.scene import ScenePage, make_scene
from shipcosim.report.diagnosis.summary import key_figures
from shipcosim.report.diagnosis.track_figures import over_time_figures, track_figure
from shipcosim.report.diagnosis.words import discrepancy_rows, facts_of, next_steps, outcome
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Fact,
    Figures,
    Table,
)


def render(diagnosis: Diagnosis) -> str:
    """The page as HTML."""
    # A page needs the log and the evidence, or several logs; a stored result has neither.
    several = isinstance(diagnosis, JointDiagnosis)
    if not several and (diagnosis.log is None or diagnosis.evidence is None):
        raise ValueError(
            "only a diagnosis with its log and evidence has a page; shipcosim.diagnose makes one"
        )
    # Sections first: figures follow from them.
    log = log_section(diagnosis)
    cause = cause_section(diagnosis, diagnosis.evidence)
    error = error_section(diagnosis)
    extension = extension_section(diagnosis)
    gain = gain_section(diagnosis)
    # All figures in the order in which the page draws them.
    causes = (*cause.sizes, *cause.whiteness)
    tracks = _track_figures(diagnosis)
    figures = (*tracks, *log.figures, *error.forces, *causes, *gain.figures)
    step = [Fact("Step", f"{diagnosis.log.step:g} s")] if diagnosis.log else []
    is_extended = extension.state == "extended"
    page = ScenePage(
        title=f"Diagnosis of {diagnosis.name}",
        facts=(*facts_of(diagnosis), *step),
        outcome=outcome(diagnosis),
        key_figures=key_figures(diagnosis),
        scene=() if several else make_scene(diagnosis.tracks, diagnosis.force, diagnosis.system),
        figures=figures,
    )
    head = ("", "size", "of the error", "logs")
    return render_template(
        "diagnosis/templates/diagnosis.html.jinja",
        page,
        discrepancies=Table(discrepancy_rows(diagnosis), head[: 4 if several else 3]),
        next_steps=next_steps(diagnosis, extension.system if is_extended else None),
        tracks=tracks,
        log=log,
        error=error,
        cause=cause,
        extension=extension,
        gain=gain,
    )


def _track_figures(diagnosis: Diagnosis) -> Figures:
    """Track and speeds of a log; of several logs the tracks."""
    if isinstance(diagnosis, JointDiagnosis):
        return track_figures(diagnosis.errors)
    if diagnosis.tracks is None:
        return ()
    return (track_figure(diagnosis.tracks), *over_time_figures(diagnosis.tracks))
