"""The sets of causes that explain a log best: hypotheses are screened, the likely ones fitted, others sought beside."""

from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from shipcosim.diagnose.explanation.course import CourseFound
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.explanation.unmodelled import is_healthy
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem, fitted
from shipcosim.diagnose.inference.screening import Gain, screened
from shipcosim.diagnose.inference.thresholds import ENOUGH
from shipcosim.diagnose.inference.workers import each
from shipcosim.diagnose.ship.model import ShipModel

STRAIN = (
    2.5  # tolerances off, from which on a number's cause is fitted whatever it gains at first sight
)
FAR = 4.0
"""Tolerances off, from which on every cause of a number's component of the ship is fitted: beside a current, say, the
resistance to sway acts otherwise than at first sight. Healthy ships reach 3.4."""
_LIKELY = 6  # causes that are fitted first; beside a set of causes half as many
_NEAR = 12.0
"""Causes this far below the best are still fitted, or 85 % of its gain: at first sight what is not linear, as a
current, gains too little. [nats]"""


@dataclass(frozen=True)
class ExplainedLog:
    """An identified log with the sets of causes that explain it.

    Attributes
    ----------
    identification : Identification
    fits : tuple of Fit
        One for each set of causes that was fitted, best first; that without a cause is among them.
    is_healthy : bool
        Whether the best set is empty and no unmodelled error stands out beside it.
    course : CourseFound or None
        A cause that begins, grows, or comes and goes; `identification` is then of the rows in which it acts.
    """

    identification: Identification
    fits: tuple[Fit, ...]
    is_healthy: bool
    course: CourseFound | None = None


def with_causes(identification: Identification) -> ExplainedLog:
    """An identified log with the sets of causes that explain it, best first; none of a log that cannot tell causes."""
    cannot_tell = identification.comparison.obstacles
    fits = tuple(
        explain(identification.problem, most=0) if cannot_tell else explain(identification.problem)
    )
    return ExplainedLog(identification, fits, is_healthy(identification.problem, fits[0]))


def explain(
    problem: Any,
    *,
    most: int = 3,
    fitted: Callable[..., Fit] = fitted,
    screened: Callable[..., list[Gain]] = screened,
) -> list[Fit]:
    """The sets of causes that explain a log best.

    Parameters
    ----------
    problem : IdentificationProblem
        Or what `fitted` and `screened` take as one, as several logs together.
    most : int
        Causes at once.
    fitted, screened : callable
        How a set of causes is fitted, and how all causes are first looked at beside one.

    Returns
    -------
    list of Fit
        All sets that were fitted, best first; the one without a cause among them.
    """
    # Start without causes, then extend the best sets by one cause at a time (beam search).
    nothing = fitted(problem)
    fits = {frozenset(): nothing}
    front = [nothing]
    for stage in range(most):
        best = max(fit.score for fit in fits.values())
        wanted = {}
        # Screen all causes beside each set in the front; fit those whose first gain is near the
        # best or large enough.
        for fit, gains in zip(front, each(lambda fit: screened(problem, fit), front), strict=True):
            most_gain = gains[0][0]
            least = max(
                most_gain - max(_NEAR, 0.85 * most_gain), -2.0 if stage == 0 else ENOUGH - 2.0
            )
            first = _LIKELY if stage == 0 else _LIKELY // 2
            # A number far outside its tolerance suggests a cause that the linear screening
            # underrates.
            off = _in_tolerances(fit)
            strained = {path for path in off if off[path] > STRAIN}
            far = _components(p for p in off if off[p] > FAR and not ShipModel.is_of_day(p))
            for place, (gain, hypothesis, values) in enumerate(gains):
                is_suspect = strained & hypothesis.paths or far & _components(hypothesis.paths)
                if (place >= first or gain < least) and not is_suspect:
                    continue
                hypotheses = (*fit.hypotheses, hypothesis)
                key = names(hypotheses)
                if key not in fits and key not in wanted:
                    wanted[key] = hypotheses, fit.values | values
        tried = dict(
            zip(
                wanted,
                each(lambda arguments: fitted(problem, *arguments), wanted.values()),
                strict=True,
            )
        )
        fits |= tried
        # The two best new sets go on, if they gain enough over all found before.
        ranked = sorted(tried.values(), key=lambda fit: -fit.score)
        front = [
            fit for fit in ranked[:2] if fit.score > max(ranked[0].score - _NEAR, best + ENOUGH)
        ]
        if not front:
            break
    # A larger set may have been reached by a detour: drop or simplify its causes.
    _simplify(problem, fits, fitted)
    return sorted(fits.values(), key=lambda fit: -fit.score)


def _components(paths: Iterable[str]) -> set[str]:
    """Components whose numbers these are."""
    return {path.rpartition(".")[0] for path in paths}


def _in_tolerances(fit: Fit) -> dict[str, float]:
    """How many tolerances the estimate of each parameter is off; far off the linearisation may fail, as for a lag."""
    off = defaultdict(float)
    tolerated = defaultdict(float)
    # Sum the shifts of all columns that move a number, and the variance of their tolerances.
    for column, theta in zip(fit.columns, fit.theta, strict=True):
        for path, size in column.changes.items():
            off[path] += theta * size
            tolerated[path] += size**2
    return {path: abs(off[path]) / tolerated[path] ** 0.5 for path in off if tolerated[path]}


def at_first_sight(problem: IdentificationProblem) -> float:
    """Evidence of a log with its likeliest cause, linearised once."""
    nothing = fitted(problem)
    return nothing.score + max(screened(problem, nothing)[0][0], 0.0)


def without_causes(fits: Iterable[Fit]) -> Fit:
    """The fit without a cause among others."""
    return next(fit for fit in fits if not fit.hypotheses)


def names(hypotheses: Iterable[Hypothesis]) -> frozenset[str]:
    """Labels of hypotheses, in no order."""
    return frozenset(hypothesis.label for hypothesis in hypotheses)


def _simplify(
    problem: Any, fits: dict[frozenset[str], Fit], fitted: Callable[..., Fit] = fitted
) -> None:
    """Fit the best set again without each of its causes, and with simpler ones instead, from the values that it has."""
    while True:
        # Fit simpler sets from the best set's values until none improves any more.
        best = max(fits.values(), key=lambda fit: fit.score)
        new = False
        sets = _simpler(problem, best.hypotheses)
        tried = each(lambda some, start=best: fitted(problem, some, _values(some, start)), sets)
        for hypotheses, again in zip(sets, tried, strict=True):
            simpler = fits.get(names(hypotheses))
            if simpler is None or again.score > simpler.score + 0.1:
                fits[names(hypotheses)], new = again, True
        if not new:
            return


def _values(hypotheses, fit):
    """Estimates of the numbers of some hypotheses by a fit."""
    parameters = [
        (parameter, hypothesis) for hypothesis in hypotheses for parameter in hypothesis.parameters
    ]
    return {
        path: _value(parameter, hypothesis, fit)
        for parameter, hypothesis in parameters
        for path in parameter.paths
    }


def _simpler(problem, hypotheses):
    """Sets without one of the causes, and with the special case of one instead."""
    sets = []
    # Leave each cause out, or replace it by the special case that it contains.
    for left in hypotheses:
        rest = tuple(hypothesis for hypothesis in hypotheses if hypothesis is not left)
        special = [
            s
            for s in problem.hypotheses
            if s.cause == left.definition.special and s.component == left.component
        ]
        sets += [rest] if rest else []
        sets += [(*rest, simple) for simple in special if simple not in rest]
    return sets


def _value(parameter, hypothesis, fit):
    """Estimate of a number by a fit: its own, or the mean of those of the more general cause."""
    if parameter.path in fit.values:
        return fit.values[parameter.path]
    # A general cause has several copies of the parameter, as start and end; their mean is the start
    # value.
    general = next(s for s in fit.hypotheses if s.definition.special == hypothesis.cause)
    place = hypothesis.parameters.index(parameter)
    return float(
        np.mean(
            [fit.values[k.path] for k in general.parameters[place :: len(hypothesis.parameters)]]
        )
    )
