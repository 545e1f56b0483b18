"""From fitted sets of causes to a verdict: what may be named, how sure, and what cannot be told apart."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import chi2

from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.search import names, without_causes
from shipcosim.diagnose.result import Candidate, Estimate, Finding

__all__ = [
    "APART",
    "ENOUGH",
    "MOST",
    "UNMODELLED",
    "TESTABLE",
    "Judgement",
    "admissible",
    "gained",
    "judge",
    "labels",
    "not_testable",
]

ENOUGH = 5.0
"""What a cause must gain over the log without it. [nats]"""
APART = 3.0
"""Sets of causes closer than this cannot be told apart. [nats]"""
TESTABLE = 8.0
"""What a cause of typical size would have to gain, or this log could not have shown it. [nats]"""
UNMODELLED = 8.0
"""An error without a name that gains more than this beside the best set is one that nobody knows. [nats]"""
MOST = 2
"""Causes at once that are named. Where a third is needed, one that nobody knows is likelier than three at once."""
_ANOTHER = 0.01  # probability of a shape as far from the known one, below which it is that of something else
_LITTLE = 12.0  # nats, that a few wrong rows may give a cause
_ROUGH = 0.02  # of the gain of large causes, whose laws are never that exact
_AS_THEY_ARE = ("from part to part", "beyond tolerances")  # errors without a name that allow for that themselves


@dataclass(frozen=True)
class Judgement:
    """What the evidence says.

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
    fit: Any
    findings: tuple
    candidates: tuple
    indistinguishable: tuple
    rivals: tuple = ()


def judge(fits, unmodelled, chance=None):
    """The verdict on a log.

    Parameters
    ----------
    fits : list of Fit
        Of `explain`.
    unmodelled : callable
        Gives the gain of nameless forces beside a fit, as `unexplained` does.
    chance : dict of str to float, optional
        What each hypothesis gains on healthy logs like this one, by label. [nats]

    Returns
    -------
    Judgement
    """
    nothing = without_causes(fits)
    fair = [fit for fit in fits if not fit.hypotheses or admissible(fit, fits, chance or {})]
    best = _steadiest(sorted(fair, key=lambda fit: -fit.score), unmodelled)
    scores = [fit.score if fit.hypotheses else fit.score + ENOUGH for fit in fair]
    candidates = _candidates(dict(zip(fair, _weights(scores), strict=True)))
    worth = best.score - nothing.score
    if len(best.hypotheses) > MOST or all(
        _is_odd(unmodelled(fit), worth) for fit in (best, *_with_a_trifle(best, fits))
    ):
        return Judgement("unknown", best, (), candidates, ())
    if not best.hypotheses:
        return Judgement("consistent", best, (), candidates, ())
    rivals = [fit for fit in fair if fit.hypotheses and fit is not best and fit.score > best.score - APART]
    rivals = [fit for fit in rivals if not set(labels(best)) < set(labels(fit))]
    findings = tuple(sorted((_finding(s, best, candidates) for s in best.hypotheses), key=lambda f: -f.probability))
    if rivals:
        named = {label for fit in (best, *rivals) for label in labels(fit)}
        same = tuple(c for c in candidates if c.label in named)
        shared = set(labels(best)).intersection(*(labels(fit) for fit in rivals))
        findings = tuple(f for f in findings if f.label in shared)
        return Judgement("ambiguous", best, findings, candidates, same, tuple(rivals))
    return Judgement("named", best, findings, candidates, ())


def _is_odd(gains, worth):
    """Whether errors without a name gain more than the worth of the causes lets one expect."""
    rough = max(UNMODELLED, _ROUGH * worth)
    return any(gain > (UNMODELLED if kind in _AS_THEY_ARE else rough) for kind, gain in gains.items())


def _steadiest(ranked, unmodelled):
    """The best set, or one a little below it where the size of its causes differs from part to part of the log."""
    best = ranked[0]
    for other in ranked[1:]:
        if unmodelled(best).get("from part to part", 0.0) <= UNMODELLED or best.score - other.score > _LITTLE:
            break
        best = other
    return best


def labels(fit):
    return [hypothesis.label for hypothesis in fit.hypotheses]


def admissible(fit, fits, chance):
    """Whether each cause of a set is large enough, within its bounds, in its shape, and gains more than by chance."""
    for hypothesis in fit.hypotheses:
        size = _size(hypothesis, fit)
        sure = np.hypot.reduce([fit.std[k.paths[0]] / k.typical for k in hypothesis.parameters]) / np.sqrt(
            len(hypothesis.parameters)
        )
        at_bound = any(
            fit.values[k.paths[0]] in k.bounds and fit.values[k.paths[0]] != k.neutral for k in hypothesis.parameters
        )
        if size < hypothesis.effect.least or size < 3.0 * sure or at_bound or not _in_shape(hypothesis, fit):
            return False
        if gained(hypothesis, fit, fits) < ENOUGH + max(chance.get(hypothesis.label, 0.0), 0.0):
            return False
    return True


def _in_shape(hypothesis, fit):
    """Whether what tells a cause's shape lies within its tolerances, taken together."""
    shape = set(hypothesis.effect.shape)
    squares = sum(t**2 for t, column in zip(fit.theta, fit.columns, strict=True) if set(column.changes) & shape)
    return not shape or bool(chi2.sf(squares, len(shape)) > _ANOTHER)


def _size(hypothesis, fit):
    """Of a cause in a fit, in units of its typical size."""
    return np.hypot.reduce([(fit.values[k.paths[0]] - k.neutral) / k.typical for k in hypothesis.parameters])


def _with_a_trifle(best, fits):
    """The likeliest fit with one more cause that is too small to matter, if any: what is odd without it has a name."""
    for fit in sorted(fits, key=lambda fit: -fit.score):
        more = [hypothesis for hypothesis in fit.hypotheses if hypothesis not in best.hypotheses]
        if len(more) == 1 and len(fit.hypotheses) == len(best.hypotheses) + 1 and fit.score > best.score + ENOUGH:
            if _size(more[0], fit) < more[0].effect.least:
                return [fit]
    return []


def gained(hypothesis, fit, fits):
    """What a cause gains in a set, against the set without it. [nats]"""
    rest = names(s for s in fit.hypotheses if s is not hypothesis)
    without = [other.score for other in fits if names(other.hypotheses) == rest]
    return fit.score - max(without, default=-np.inf)


def _weights(scores):
    scores = np.array(scores)
    weights = np.exp(np.clip(scores - scores.max(), -700.0, 0.0))
    return weights / weights.sum()


def _candidates(chances):
    """Each cause with the probability of all sets that it is in, most likely first."""
    found = {}
    for fit, chance in chances.items():
        for hypothesis in fit.hypotheses:
            key = hypothesis.cause, hypothesis.component
            found[key] = found.get(key, 0.0) + float(chance)
    ranked = sorted(found.items(), key=lambda entry: -entry[1])
    return tuple(Candidate(*key, min(chance, 0.99)) for key, chance in ranked if chance > 1e-3)


def _finding(hypothesis, fit, candidates):
    parameters = {
        # of the log, and of a model that knows no number better than within its tolerance
        k.name: Estimate(
            fit.values[k.paths[0]] * k.factor, float(abs(np.hypot(fit.std[k.paths[0]], k.tolerance) * k.factor)), k.unit
        )
        for k in hypothesis.parameters
    }
    chance = next((c.probability for c in candidates if c.label == hypothesis.label), 0)
    return Finding(hypothesis.cause, hypothesis.component, "physics", chance, parameters)


def not_testable(problem, products, columns, groups):
    """Causes that would have gained too little to be seen in this log, had they had their typical size.

    Parameters
    ----------
    problem : IdentificationProblem
    products : array
        Of the known numbers and all hypotheses' first columns.
    columns : list of Regressor
    groups : list of (Hypothesis, indices)

    Returns
    -------
    tuple of str
        Names of causes, none of whose places could have shown it.
    """
    seen = {}
    known = np.array([column.prior for column in columns])
    for _, places in groups:
        known[list(places)] = 0.0
    for hypothesis, places in groups:
        prior = known.copy()
        prior[list(places)] = 1.0
        taken = {path for i in places for path in columns[i].changes}
        prior[[i for i, c in enumerate(columns) if i not in places and taken & set(c.changes)]] = 0.0
        blank = products.copy()
        blank[0, :] = blank[:, 0] = 0.0
        covariance = evidence(blank, prior)[2][np.ix_(places, places)]
        gains = 0.5 * (1.0 / np.diag(covariance) - 1.0)
        gain = float(np.max(gains)) - 0.5 * float(np.log1p(2.0 * np.max(gains)))
        seen[hypothesis.cause] = max(seen.get(hypothesis.cause, -np.inf), gain)
    return tuple(cause for cause, gain in sorted(seen.items()) if gain < TESTABLE)
