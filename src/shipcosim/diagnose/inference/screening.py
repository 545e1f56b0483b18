"""Screening of hypotheses: what each would gain in log-evidence beside a fit, linearised once."""

from collections.abc import Callable, Sequence

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.linearisation import Regressor, moved
from shipcosim.diagnose.inference.parts import beside
from shipcosim.diagnose.inference.regressors import regressors_of, screening_regressors

Gain = tuple[float, "Hypothesis", dict[str, float]]
"""Gain in log-evidence of a hypothesis, and first values of its parameters."""

_SLOW = (
    0.35  # of the faster end: a vector this short at first sight has no direction; where it starts
)
_STILL = 0.05


def screened(problem: IdentificationProblem, fit: Fit) -> list[Gain]:
    """Gain in log-evidence of each hypothesis beside a fit, linearised once.

    Parameters
    ----------
    problem : IdentificationProblem
    fit : Fit

    Returns
    -------
    list of (float, Hypothesis, dict of str to float)
        Gain, hypothesis, first values of the numbers that it changes; best first.
    """
    # Only hypotheses that are not fitted already, about the ship without a cause.
    wanted = [s for s in problem.hypotheses if s not in fit.hypotheses]
    linear = beside(fit.linear, problem.base_of(regressors_of(wanted)))
    products = problem.gram(linear).products
    return gains(products, fit.columns, fit.centre, wanted, fit.model.get)


def gains(
    products: np.ndarray,
    columns: Sequence[Regressor],
    centre: np.ndarray,
    wanted: Sequence[Hypothesis],
    value_of: Callable[[str], float],
) -> list[Gain]:
    """Gain in log-evidence of hypotheses, from inner products of the log and of regressors.

    Parameters
    ----------
    products : (1 + p, 1 + p) array
        The log, then `columns`, then the screening regressors of each wanted hypothesis in turn.
    columns : list of Regressor
    centre : array
        θ of these columns that they were linearised about.
    wanted : sequence of Hypothesis
    value_of : callable
        Value of a number that they were linearised about.

    Returns
    -------
    list of (float, Hypothesis, dict of str to float)
        As `screened`.
    """
    # First the fit's own columns with their priors; candidates are off (prior 0).
    base = len(columns)
    prior = np.concatenate(
        [[column.prior for column in columns], np.zeros(len(products) - 1 - base)]
    )
    centre = np.concatenate([centre, np.zeros(prior.size - base)])
    # Evidence of the fit by itself: gains count from here.
    nothing = evidence(products, prior, centre)[0]
    place = base
    gained = []
    for hypothesis in wanted:
        # Each group switches its own columns on, with unit prior.
        tries = []
        for group in screening_regressors(hypothesis):
            here = prior.copy()
            here[place : place + len(group)] = 1.0
            # Known numbers that the hypothesis estimates itself are switched off.
            taken = {path for column in group for path in column.changes} | set(
                hypothesis.definition.replaces
            )
            here[[i for i, column in enumerate(columns) if column.gives_way(taken)]] = 0.0
            # Log Bayes factor and posterior mean, which gives first values for a full fit.
            score, theta, _ = evidence(products, here, np.where(here > 0.0, centre, 0.0))
            values = moved(group, theta[place : place + len(group)], value_of)
            tries.append((score - nothing, values))
            place += len(group)
        gain, values = _together(tries, hypothesis)
        gained.append((gain, hypothesis, values))
    return sorted(gained, key=lambda entry: -entry[0])


def _together(
    tries: list[tuple[float, dict[str, float]]], hypothesis: Hypothesis
) -> tuple[float, dict[str, float]]:
    """Evidence of a hypothesis averaged over its directions, and the values of the best."""
    # Directions are equally likely beforehand: average the likelihoods (log of the mean of
    # exponentials).
    scores = np.array([score for score, _ in tries])
    best = int(scores.argmax())
    values = tries[best][1]
    # Start and growth become the vector at both ends of the log.
    if hypothesis.definition.law == "turning":
        first, grown = np.array([values[path] for path in hypothesis.definition.sought_by]).reshape(
            2, 2
        )
        names = [parameter.path for parameter in hypothesis.parameters]
        ends = _one_way(first, first + grown)
        values = dict(zip(names, map(float, np.concatenate(ends)), strict=True))
    return float(scores[best] + np.log(np.exp(scores - scores[best]).mean())), values


def _one_way(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of a turning vector; a negligible end gets the direction of the other, since its own is noise."""
    sizes = np.linalg.norm(first), np.linalg.norm(last)
    if sizes[0] < _SLOW * sizes[1]:
        first = last * max(sizes[0] / sizes[1], _STILL)
    elif sizes[1] < _SLOW * sizes[0]:
        last = first * max(sizes[1] / sizes[0], _STILL)
    return first, last
