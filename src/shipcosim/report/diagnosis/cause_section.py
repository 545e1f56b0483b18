"""Section 3 of the page: which cause?"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from shipcosim.diagnose.explanation.summary import Evidence
from shipcosim.diagnose.finding import Candidate
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.cause_figures import (
    course_figures,
    evidence_table,
    unmodelled_table,
    whiteness_figures,
)
from shipcosim.report.diagnosis.form_section import FormSection, form_section
from shipcosim.report.diagnosis.manoeuvre_steps import manoeuvre_steps
from shipcosim.report.diagnosis.testability import not_testable_rows, visible_rows
from shipcosim.report.diagnosis.words import by_log, course_of, estimate_rows, size_rows, title_of
from shipcosim.report.theme.numbers import percent, plain
from shipcosim.report.theme.views import Figure, Table


@dataclass(frozen=True)
class Sail:
    """A prescribed manoeuvre: name, duration, causes it separates, steps."""

    name: str
    minutes: str
    separates: tuple[str, ...]
    steps: Table


@dataclass(frozen=True)
class CauseSection:
    """Named causes with their estimates and evidence, what cannot be told apart or seen, and what to sail next.

    Attributes
    ----------
    found : str
        The result in a few words.
    course : str
        When a cause that begins, grows, or comes and goes is there; empty if none does.
    sizes : tuple of Figure
        Its size over time.
    estimates, gains : Table
        Of the named causes: their parameters; what they gain, beside what healthy ships show.
    sets, unmodelled : Table
        Evidence of sets of causes, and of errors that none describes.
    whiteness : tuple of Figure
    rivals, others : Table
        Causes that this log cannot tell apart, and other candidates.
    is_unknown : bool
        Whether something acts that no cause explains.
    sail : Sail, optional
    not_testable : Table
        Causes that this log could not have shown, and why.
    visible : Table
        The smallest size of the others that it would have shown.
    form : FormSection, optional
        How far the form of her loads differs, where it does.
    """

    found: str
    estimates: Table
    rivals: Table
    others: Table
    is_unknown: bool
    sail: Sail | None
    not_testable: Table
    visible: Table
    form: FormSection | None
    course: str = ""
    sizes: tuple[Figure, ...] = ()
    gains: Table = Table(())
    sets: Table = Table(())
    unmodelled: Table = Table(())
    whiteness: tuple[Figure, ...] = ()


def cause_section(diagnosis: Diagnosis, evidence: Evidence | None) -> CauseSection:
    """Section 3 of the page for the template."""
    named = {(f.cause, f.component) for f in diagnosis.findings}
    rivals = diagnosis.indistinguishable
    # Candidates that are neither named nor indistinguishable.
    others = [
        c for c in diagnosis.candidates if (c.cause, c.component) not in named and c not in rivals
    ]
    # Causes that this log could not show, and why.
    hidden = diagnosis.form.hides if diagnosis.form else ()
    silent = () if diagnosis.is_assumed else diagnosis.not_testable
    weak = not_testable_rows(silent, diagnosis.causes, diagnosis.facts, hidden)
    section = CauseSection(
        found=_found_text(diagnosis),
        estimates=_estimates(diagnosis),
        rivals=_chances(rivals),
        others=_chances(others),
        is_unknown=diagnosis.verdict == "unknown",
        sail=_sail(diagnosis),
        not_testable=Table(weak, head=("Cause", "What it would be", "Why not")),
        visible=Table(
            visible_rows(diagnosis.smallest_visible, diagnosis.not_testable),
            head=("Cause", "Size, in 9 of 10 cases"),
        ),
        form=form_section(diagnosis.form) if diagnosis.form else None,
    )
    if evidence is None:
        return section
    return replace(
        section,
        course="" if evidence.course is None else course_of(evidence.course.finding),
        sizes=() if evidence.course is None else course_figures(evidence.course),
        gains=_gains(evidence),
        sets=evidence_table(evidence),
        unmodelled=unmodelled_table(evidence.unmodelled),
        whiteness=whiteness_figures(evidence),
    )


def _found_text(diagnosis: Diagnosis) -> str:
    if diagnosis.is_assumed:
        return "not sought"
    names = [title_of(f) for f in diagnosis.physics]
    return ", ".join(names) or {
        "consistent": "none",
        "named": "none",
        "form": "none: loads of another form",
    }.get(diagnosis.verdict, diagnosis.verdict)


def _estimates(diagnosis: Diagnosis) -> Table:
    physics = diagnosis.physics
    if any(finding.at_reference for finding in physics):
        rows = [
            (title_of(f), *row, percent(f.probability)) for f in physics for row in size_rows(f)
        ]
        return Table(
            rows,
            head=("Cause", "Parameter", "At the reference → now", "Probability"),
        )
    rows = []
    for finding in physics:
        named = [(title_of(finding), finding, percent(finding.probability))]
        named += [(f"{log} alone", estimates, "") for log, estimates in by_log(finding)]
        for name, estimated, sure in named:
            for parameter, value, std, unit in estimate_rows(estimated):
                rows.append((name, parameter, value, f"± {std}", unit, sure))
    head = ("Cause", "Parameter", "Estimate", "Std", "Unit", "Probability")
    return Table(rows, head)


def _gains(evidence: Evidence) -> Table:
    """Gain of each cause, and its gain on simulated healthy logs."""
    rows = []
    # Where the gain is far above chance, healthy logs were not simulated.
    for of in evidence.gains:
        is_limited = of.null_gain is not None
        healthy = (
            f"up to {plain(of.null_gain, 2)} nats"
            if is_limited
            else "far above what healthy ships show"
        )
        rows.append((title_of(of), plain(of.gain), healthy))
    head = ("Cause", "Makes the log likelier by [nats]", "The same on healthy ships on this track")
    return Table(rows, head)


def _chances(candidates: Iterable[Candidate]) -> Table:
    rows = tuple((title_of(c), percent(c.probability, 1)) for c in candidates)
    return Table(rows, head=("Cause", "Probability"))


def _sail(diagnosis: Diagnosis) -> Sail | None:
    """The prescribed manoeuvre, step by step."""
    prescription = diagnosis.prescription
    manoeuvre = diagnosis.manoeuvre
    if prescription is None or manoeuvre is None:
        return None
    return Sail(
        name=manoeuvre.name,
        minutes=f"{prescription.minutes:g}",
        separates=tuple(
            f"It tells {a} from {b}.".replace("_", " ") for a, b in prescription.separates
        ),
        steps=Table(manoeuvre_steps(manoeuvre), head=("When", "What")),
    )
