"""Section 3 of the page: which cause?"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.experiment.manoeuvres import cannot_turn, library
from shipcosim.diagnose.inference.search import without_causes
from shipcosim.diagnose.inference.verdict import gained
from shipcosim.diagnose.result import Candidate, Diagnosis
from shipcosim.report.diagnosis.cause_figures import (
    estimate_figure,
    evidence_figure,
    unmodelled_figure,
    whiteness,
    whiteness_figure,
)
from shipcosim.report.diagnosis.manoeuvre_steps import manoeuvre_steps
from shipcosim.report.diagnosis.story import Story
from shipcosim.report.diagnosis.testability import not_testable_rows
from shipcosim.report.diagnosis.words import estimate_rows, title
from shipcosim.report.theme.numbers import percent, plain
from shipcosim.report.theme.views import Figure, Table


@dataclass(frozen=True)
class Sail:
    """A prescribed manoeuvre: its name and duration, what it tells apart, and its steps."""

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
    change_point : str
        When the causes began to act, in s; empty if they acted from the start.
    estimates, gains : Table
        Of the named causes: their parameters; what they gain, beside what healthy ships show.
    figures, unmodelled, whiteness : tuple of Figure
    alike, others : Table
        Causes that this log cannot tell apart, and other candidates.
    is_unknown : bool
        Whether something acts that no cause explains.
    sail : Sail, optional
    not_testable : Table
        Causes that this log could not have shown, and why.
    """

    found: str
    change_point: str
    estimates: Table
    gains: Table
    figures: tuple[Figure, ...]
    unmodelled: tuple[Figure, ...]
    whiteness: tuple[Figure, ...]
    alike: Table
    others: Table
    is_unknown: bool
    sail: Sail | None
    not_testable: Table


def cause_section(story: Story) -> CauseSection:
    """The section as the template fills it in."""
    diagnosis, details = story.diagnosis, story.details
    began = sorted({f.onset for f in diagnosis.findings if f.onset is not None})
    named = {(f.cause, f.component) for f in diagnosis.findings}
    alike = diagnosis.indistinguishable
    others = [c for c in diagnosis.candidates if (c.cause, c.component) not in named and c not in alike]
    weak = not_testable_rows(details.problem, diagnosis.not_testable, story.causes) if diagnosis.not_testable else ()
    figures = [evidence_figure(details.fits, details.fit)] if len(details.fits) > 1 else []
    return CauseSection(
        found=_found(diagnosis),
        change_point=f"{began[0]:.0f}" if began else "",
        estimates=_estimates(diagnosis),
        gains=_gains(story),
        figures=(*figures, *([estimate_figure(details.fit)] if details.fit.hypotheses else [])),
        unmodelled=(unmodelled_figure(details.unmodelled),) if details.unmodelled else (),
        whiteness=_whiteness(story),
        alike=_chances(alike),
        others=_chances(others),
        is_unknown=diagnosis.verdict == "unknown",
        sail=_sail(story),
        not_testable=Table(tuple(weak), head=("Cause", "What it would be", "Why not")),
    )


def _found(diagnosis: Diagnosis) -> str:
    names = [title(f.cause, f.component) for f in diagnosis.findings if f.kind == "physics"]
    return ", ".join(names) or {"consistent": "none", "named": "none"}.get(diagnosis.verdict, diagnosis.verdict)


def _estimates(diagnosis: Diagnosis) -> Table:
    rows = [
        (title(f.cause, f.component), name, value, f"± {std}", unit, percent(f.probability))
        for f in diagnosis.findings
        if f.kind == "physics"
        for name, value, std, unit in estimate_rows(f)
    ]
    head = ("Cause", "Parameter", "Estimate", "Std", "Unit", "Probability")
    return Table(tuple(rows), head, tight=(1, 2, 3, 4, 5))


def _gains(story: Story) -> Table:
    """What each cause gains, beside what it gains by chance on healthy ships."""
    details, rows = story.details, []
    for hypothesis in details.fit.hypotheses:
        chance = details.null_gains.get(hypothesis.label)
        by_chance = "far above what healthy ships show" if chance is None else f"up to {plain(chance, 2)} nats"
        gain = plain(gained(hypothesis, details.fit, details.fits))
        rows.append((title(hypothesis.cause, hypothesis.component), gain, by_chance))
    head = ("Cause", "Makes the log likelier by [nats]", "The same on healthy ships on this track")
    return Table(tuple(rows), head, tight=(1,))


def _whiteness(story: Story) -> tuple[Figure, ...]:
    """Autocorrelation of the innovations before and after, to one scale."""
    problem, fit = story.details.problem, story.details.fit
    found = {"Before: the plain model": whiteness(problem, without_causes(story.details.fits), as_it_is=True)}
    if fit.hypotheses:
        found["After: with the causes"] = whiteness(problem, fit)
    every = np.stack(list(found.values()))
    between = (min(-0.2, 1.05 * float(np.nanmin(every))), max(0.2, 1.05 * float(np.nanmax(every))))
    step, rows = problem.record.step, problem.record.time.size
    return tuple(whiteness_figure(name, values, step, rows, between) for name, values in found.items())


def _chances(candidates: Iterable[Candidate]) -> Table:
    rows = tuple((title(c.cause, c.component), percent(c.probability, 1)) for c in candidates)
    return Table(rows, head=("Cause", "Probability"))


def _sail(story: Story) -> Sail | None:
    """The prescribed manoeuvre step by step."""
    prescription, problem = story.diagnosis.prescription, story.details.problem
    if prescription is None:
        return None
    known = library(problem.model, cannot_turn(problem.record, problem.model))
    manoeuvre = next((one for one in known if one.name == prescription.manoeuvre), None)
    if manoeuvre is None:
        return None
    return Sail(
        name=manoeuvre.name,
        minutes=f"{prescription.minutes:g}",
        separates=tuple(f"It tells {a} from {b}.".replace("_", " ") for a, b in prescription.separates),
        steps=Table(tuple(manoeuvre_steps(manoeuvre)), head=("When", "What"), tight=(0,)),
    )
