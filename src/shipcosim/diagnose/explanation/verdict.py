"""From fitted sets of causes to a verdict: what may be named, how sure, and what cannot be told apart."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.compared_log import with_learned_craft
from shipcosim.diagnose.explanation.course import CourseFound
from shipcosim.diagnose.explanation.null_distribution import null_gains
from shipcosim.diagnose.explanation.search import ExplainedLog, names, without_causes
from shipcosim.diagnose.explanation.unmodelled import FORCES, unmodelled_gains
from shipcosim.diagnose.finding import Candidate, Finding
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.thresholds import (
    APART,
    BESIDE_A_LARGE_CAUSE,
    BESIDE_UNKNOWN,
    DEVIATIONS,
    ENOUGH,
    FAR_ABOVE_NULL,
    MOST_CAUSES,
    NULL_GAIN_OF_FORM,
    NULL_GAIN_UNKNOWN,
    NULL_GAIN_WITHOUT_WIND,
    SHAPE_CHANCE,
    STEADY_SET_LOSS,
    UNMODELLED,
    UNMODELLED_SHARE,
)
from shipcosim.diagnose.numerics import survival
from shipcosim.diagnose.ship.model import ANY_CAUSE, ShipModel

_BY_PART = "from part to part"
_AS_THEY_ARE = (
    _BY_PART,
    "beyond tolerances",
)  # unmodelled errors whose evidence hardly grows with the causes' gain


@dataclass(frozen=True)
class Judgement:
    """Evidence on the sets of causes.

    Attributes
    ----------
    verdict : str
    fit : Fit
        The set of causes that is taken to be there; may be empty.
    findings : tuple of Finding
    candidates, indistinguishable : tuple of Candidate
    rivals : tuple of Fit
        Sets that cannot be told from `fit`.
    """

    verdict: str
    fit: Fit
    findings: tuple[Finding, ...]
    candidates: tuple[Candidate, ...]
    indistinguishable: tuple[Candidate, ...]
    rivals: tuple[Fit, ...] = ()


@dataclass(frozen=True)
class JudgedLog:
    """An explained log with the verdict on its causes.

    Attributes
    ----------
    explained : ExplainedLog
    judgement : Judgement
    unmodelled : dict of str to float
        Gain of unmodelled errors beside the causes of the judgement, by kind. [nats]
    null_gains : dict of str to float
        Gain of its causes on simulated healthy logs, by label; not computed where the real gain is far larger. [nats]
    """

    explained: ExplainedLog
    judgement: Judgement
    unmodelled: dict[str, float]
    null_gains: dict[str, float]

    @property
    def problem(self) -> IdentificationProblem:
        """The identification problem that the verdict is on."""
        return self.explained.identification.problem

    @property
    def fits(self) -> tuple[Fit, ...]:
        """The sets of causes that were fitted, best first."""
        return self.explained.fits

    @property
    def fit(self) -> Fit:
        """The set of causes that the verdict rests on; empty where nothing is named."""
        return self.judgement.fit


def judged(explained: ExplainedLog) -> JudgedLog:
    """The verdict on an explained log, by what its causes gain beyond what they gain on healthy logs like it."""
    problem = explained.identification.problem
    # Logs that cannot tell causes get no verdict.
    fits = explained.fits
    if explained.identification.comparison.obstacles:
        return JudgedLog(explained, Judgement("unknown", without_causes(fits), (), (), ()), {}, {})
    if explained.course is not None:
        return _judged_course(explained, explained.course)
    # Gain that causes have on healthy logs of such ships, more where the wind is unknown.
    without_wind = problem.record.wind is None
    usual = usual_gain(problem.model) + (NULL_GAIN_WITHOUT_WIND if without_wind else 0.0)
    judgement = judge_against_healthy(
        fits,
        lambda fit: unmodelled_gains(problem, fit),
        lambda fit: null_gains(problem, fit.motion, fit.hypotheses),
        null={hypothesis.label: usual for hypothesis in problem.hypotheses} if usual else {},
        without_wind=without_wind,
    )
    return JudgedLog(explained, *judgement)


def _judged_course(explained: ExplainedLog, course: CourseFound) -> JudgedLog:
    """The verdict on a cause with a course, which was weighed against all steady ones; beside it steady ones may be."""
    problem = explained.identification.problem
    fit = explained.fits[0]
    # Steady causes that were fitted beside the one with a course.
    steady_causes = [
        hypothesis for hypothesis in fit.hypotheses if hypothesis.label != course.finding.label
    ]
    of_course = (
        Candidate(course.finding.cause, course.finding.component, course.finding.probability),
    )
    candidates = of_course + course.rivals
    steady = tuple(
        _finding(hypothesis, fit, _of_all(course.steady)) for hypothesis in steady_causes
    )
    # Whatever else pushes the ship is looked for as ever; the size of a cause with a course varies by itself.
    others = {kind: gain for kind, gain in course.unmodelled.items() if kind != _BY_PART}
    if problem.record.wind is None:
        others = {kind: gain for kind, gain in others.items() if kind not in FORCES}
    # Gain of all causes together, against which unmodelled errors are judged.
    of_causes = course.gain + course.steady[0].score - without_causes(course.steady).score
    if _stands_out(others, of_causes):
        judgement = Judgement("unknown", fit, (), _beside_unknown(candidates), ())
    elif course.rivals:
        judgement = Judgement("ambiguous", fit, steady, candidates, candidates)
    else:
        judgement = Judgement("named", fit, (course.finding, *steady), candidates, ())
    return JudgedLog(explained, judgement, course.unmodelled, {})


def judge_against_healthy(
    fits: Sequence[Any],
    gains_of: Callable[[Any], dict[str, float]],
    healthy_gains: Callable[[Any], Mapping[str, Sequence[float] | np.ndarray]],
    *,
    null: dict[str, float],
    without_wind: bool,
) -> tuple[Judgement, dict[str, float], dict[str, float]]:
    """The verdict on causes by what they gain beyond what they gain on healthy logs.

    Parameters
    ----------
    fits : sequence of Fit or JointFit
        Best first.
    gains_of, healthy_gains : function
        Gains of unmodelled errors beside a fit, by kind; of its causes on simulated healthy logs, by label. [nats]
    null : dict of str to float
        Gains on healthy logs that are known before any is simulated, by label. [nats]
    without_wind : bool
        A log does not have the wind.

    Returns
    -------
    tuple of Judgement, and two dicts of str to float
        With the gains of unmodelled errors beside the judged fit, and the gains of causes on healthy logs. [nats]
    """
    unmodelled: dict[Any, dict[str, float]] = {}

    def unmodelled_beside(fit):
        if fit not in unmodelled:
            unmodelled[fit] = gains_of(fit)
        # where the wind is unknown, a force that nobody explains is no surprise
        return {
            kind: gain
            for kind, gain in unmodelled[fit].items()
            if kind not in FORCES or not without_wind
        }

    judgement = judge(fits, unmodelled_beside, null)
    # An error that nobody explains, with causes and without, stays unknown whatever healthy logs gain.
    is_unknown = (
        judgement.verdict == "unknown"
        and judge([without_causes(fits)], unmodelled_beside).verdict == "unknown"
    )
    # Healthy logs are simulated where a cause gains so little that chance may give it.
    fit = judgement.fit
    if not is_unknown and any(
        gained(hypothesis, fit, fits) < FAR_ABOVE_NULL for hypothesis in fit.hypotheses
    ):
        # The null gain is the largest of the simulated ones, or mean plus three standard
        # deviations.
        null = {
            label: null.get(label, 0.0)
            + (
                float(max(np.mean(values) + 3.0 * np.std(values), np.max(values)))
                if len(values)
                else NULL_GAIN_UNKNOWN
            )
            for label, values in healthy_gains(fit).items()
        }
        judgement = judge(fits, unmodelled_beside, null)
    return judgement, unmodelled[judgement.fit], null


def with_craft(log: JudgedLog) -> JudgedLog:
    """A judged log, where no cause explains it, with what it teaches of the craft."""
    identified = log.explained.identification
    comparison = identified.comparison
    unclear = any(fault.alternatives for fault in identified.faults)
    if comparison.obstacles or comparison.craft is not None or unclear:
        return log
    if log.judgement.verdict != "unknown":
        return log
    learned = with_learned_craft(comparison, identified.repaired, identified.ship)
    identification = replace(identified, comparison=learned)
    return replace(log, explained=replace(log.explained, identification=identification))


def usual_gain(model: ShipModel) -> float:
    """Gain that an unknown form of the ship can give a cause: from a reference, or assumed."""
    if model.directions or not model.form_scale:
        return model.ordinary_errors.get(ANY_CAUSE, 0.0)
    return NULL_GAIN_OF_FORM


def judge(
    fits: Sequence[Fit],
    unmodelled: Callable[[Fit], dict[str, float]],
    null: dict[str, float] | None = None,
) -> Judgement:
    """The verdict on the sets of causes that were fitted to a log.

    Parameters
    ----------
    fits : sequence of Fit
        Of `explain`.
    unmodelled : callable
        Gain of unmodelled errors beside a fit by kind, as `unmodelled_gains` gives it. [nats]
    null : dict of str to float, optional
        What each hypothesis gains on healthy logs like this one, by label. [nats]

    Returns
    -------
    Judgement
    """
    nothing = without_causes(fits)
    # Only sets whose causes are each large and certain enough compete.
    fair = [fit for fit in fits if not fit.hypotheses or admissible(fit, fits, null or {})]
    best = _best_steady(sorted(fair, key=lambda fit: -_with_odds(fit)), unmodelled)
    candidates = _of_all(fair)
    gain = best.score - nothing.score
    # Unknown where too many causes are needed, or an unmodelled error remains beside the best set.
    if len(best.hypotheses) > MOST_CAUSES or all(
        _stands_out(unmodelled(fit), gain) for fit in (best, *_with_a_small_cause(best, fits))
    ):
        return Judgement("unknown", best, (), _beside_unknown(candidates), ())
    if not best.hypotheses:
        return Judgement("consistent", best, (), candidates, ())
    # Sets that the evidence cannot separate, without those that only add causes to the best one.
    rivals = [
        fit
        for fit in fair
        if fit.hypotheses and fit is not best and _with_odds(fit) > _with_odds(best) - APART
    ]
    rivals = [fit for fit in rivals if not names(best.hypotheses) < names(fit.hypotheses)]
    findings = tuple(
        sorted(
            (_finding(s, best, candidates) for s in best.hypotheses), key=lambda f: -f.probability
        )
    )
    # With rivals only causes common to all of them are named.
    if rivals:
        each = [names(fit.hypotheses) for fit in (best, *rivals)]
        same = tuple(c for c in candidates if c.label in frozenset.union(*each))
        shared = frozenset.intersection(*each)
        findings = tuple(f for f in findings if f.label in shared)
        return Judgement("ambiguous", best, findings, candidates, same, tuple(rivals))
    return Judgement("named", best, findings, candidates, ())


def _of_all(fits):
    """Causes with their probabilities by all sets that were fitted, none of them preferred."""
    # Probabilities over all sets; the empty one is preferred by what a cause has to gain.
    scores = [_with_odds(fit) if fit.hypotheses else fit.score + ENOUGH for fit in fits]
    return _candidates(dict(zip(fits, _weights(scores), strict=True)))


def _with_odds(fit):
    """Log-evidence of a set less what its causes cost: the logarithm of its odds. [nats]"""
    return fit.score - sum(hypothesis.definition.cost for hypothesis in fit.hypotheses)


def _beside_unknown(candidates):
    """Candidates beside an unexplained error: their gain may belong to it."""
    return tuple(
        replace(candidate, probability=round(BESIDE_UNKNOWN * candidate.probability, 4))
        for candidate in candidates
    )


def _stands_out(gains, of_causes):
    """Whether unmodelled errors gain more than the gain of the causes lets one expect."""
    share = {kind: BESIDE_A_LARGE_CAUSE for kind in _AS_THEY_ARE}
    return any(
        gain > max(UNMODELLED, share.get(kind, UNMODELLED_SHARE) * of_causes)
        for kind, gain in gains.items()
    )


def _best_steady(ranked, unmodelled):
    """The best set, or one a little below it where the size of its causes differs from part to part of the log."""
    # Change to the next set while the present one's size varies over the log and the loss is small.
    best = ranked[0]
    for other in ranked[1:]:
        if (
            unmodelled(best).get(_BY_PART, 0.0) <= UNMODELLED
            or best.score - other.score > STEADY_SET_LOSS
        ):
            break
        best = other
    return best


def admissible(fit: Fit, fits: Sequence[Fit], null: dict[str, float]) -> bool:
    """Whether each cause of a set is large enough, within its bounds and shape, and gains more than on healthy logs."""
    return all(
        _is_sized(hypothesis, fit)
        and _in_shape(hypothesis, fit)
        and _exceeds_special(hypothesis, fit, fits)
        and not gained(hypothesis, fit, fits)
        < ENOUGH + hypothesis.definition.cost + max(null.get(hypothesis.label, 0.0), 0.0)
        for hypothesis in fit.hypotheses
    )


def _is_sized(hypothesis, fit):
    """Whether a cause is large enough to matter, beyond the ship's tolerances, clearly off neutral, and not at a bound."""
    parameters = hypothesis.parameters
    # Size against mean standard deviation, both in typical units.
    size = _size(hypothesis, fit)
    std = np.hypot.reduce([fit.std[k.path] / k.typical for k in parameters]) / np.sqrt(
        len(parameters)
    )
    at_bound = any(
        fit.values[k.path] in k.bounds and fit.values[k.path] != k.neutral for k in parameters
    )
    # What the ship's file leaves open itself is no cause.
    is_ordinary = all(abs(fit.values[k.path] - k.neutral) < k.tolerance for k in parameters)
    is_small = size < hypothesis.definition.least or size < DEVIATIONS * std
    return not (is_small or is_ordinary or at_bound)


def _exceeds_special(hypothesis, fit, fits):
    """Whether a cause differs enough from the simpler cause that it contains.

    A steady current beside a model of another form seems to turn a little.
    """
    # The general cause must differ enough between its ends or parts from the special one.
    fitted = (hypothesis for other in fits for hypothesis in other.hypotheses)
    special = next((cause for cause in fitted if _is_special(cause, hypothesis)), None)
    if special is None:
        return True
    sizes = [fit.values[k.path] / k.typical for k in hypothesis.parameters]
    beyond = np.ptp(np.reshape(sizes, (-1, len(special.parameters))), axis=0)
    return bool(np.linalg.norm(beyond) >= hypothesis.definition.least)


def _is_special(cause, general):
    """Whether a cause is a simpler form of another one."""
    return cause.cause == general.definition.special and cause.component == general.component


def _in_shape(hypothesis, fit):
    """Whether the numbers of a cause's shape lie within their tolerances, taken together."""
    # Sum of squares of the shape's numbers in tolerances: chi-square with as many degrees of
    # freedom.
    shape = set(hypothesis.definition.shape)
    squares = sum(
        t**2
        for t, column in zip(fit.theta, fit.columns, strict=True)
        if set(column.changes) & shape
    )
    return not shape or survival(squares, len(shape)) > SHAPE_CHANCE


def _size(hypothesis, fit):
    """Size of a cause in a fit, over its typical size. [1]"""
    return np.hypot.reduce(
        [(fit.values[k.path] - k.neutral) / k.typical for k in hypothesis.parameters]
    )


def _with_a_small_cause(best, fits):
    """The likeliest fit with one more cause, or a more general one, that is too small to matter, if any.

    It may explain an unmodelled error.
    """
    # One more cause that gains much but is too small to be named.
    for fit in sorted(fits, key=lambda fit: -fit.score):
        more = [hypothesis for hypothesis in fit.hypotheses if hypothesis not in best.hypotheses]
        left = [hypothesis for hypothesis in best.hypotheses if hypothesis not in fit.hypotheses]
        if len(more) != 1 or fit.score <= best.score + ENOUGH:
            continue
        if not left and _size(more[0], fit) < more[0].definition.least:
            return [fit]
        if (
            len(left) == 1
            and _is_special(left[0], more[0])
            and not _exceeds_special(more[0], fit, fits)
        ):
            return [fit]
    return []


def gained(hypothesis: Hypothesis, fit: Fit, fits: Sequence[Fit]) -> float:
    """What a cause gains in a set, against the set without it. [nats]"""
    # Best score of the same set without this cause.
    rest = names(s for s in fit.hypotheses if s is not hypothesis)
    without = [other.score for other in fits if names(other.hypotheses) == rest]
    return fit.score - max(without, default=-np.inf)


def _weights(scores):
    # Softmax of the log-odds, without overflow.
    scores = np.array(scores)
    weights = np.exp(np.clip(scores - scores.max(), -700.0, 0.0))
    return weights / weights.sum()


def _candidates(chances):
    """Each cause with the probability of all sets that it is in, most likely first."""
    # Marginal probability: sum over the sets that contain the cause.
    chances_by_cause = {}
    for fit, chance in chances.items():
        for hypothesis in fit.hypotheses:
            key = hypothesis.cause, hypothesis.component
            chances_by_cause[key] = chances_by_cause.get(key, 0.0) + float(chance)
    ranked = sorted(chances_by_cause.items(), key=lambda entry: -entry[1])
    return tuple(
        Candidate(cause, of, min(chance, 0.99)) for (cause, of), chance in ranked if chance > 1e-3
    )


def _finding(hypothesis, fit, candidates):
    parameters = {
        # of the log, and of a model that knows no number better than within its tolerance
        k.name: k.estimate(
            fit.values[k.path],
            float(np.hypot(fit.std[k.path], k.tolerance)),
            None if k.neutral in (0.0, 1.0) else k.neutral * k.factor,
        )
        for k in hypothesis.parameters
    }
    chance = next((c.probability for c in candidates if c.label == hypothesis.label), 0)
    return Finding(hypothesis.cause, hypothesis.component, "physics", chance, parameters)
