"""How far the form of a ship's loads differs from her model's, learnt from the log by evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.explanation.search import ExplainedLog, explain
from shipcosim.diagnose.explanation.unmodelled import is_healthy
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import IdentificationProblem, fitted, prepared
from shipcosim.diagnose.inference.linearisation import Regressor
from shipcosim.diagnose.inference.parts import beside, linearised_by_parts
from shipcosim.diagnose.inference.problem import beside_likeliest, tuned_noise
from shipcosim.diagnose.inference.regressors import regressors_of
from shipcosim.diagnose.inference.screening import gains
from shipcosim.diagnose.inference.thresholds import (
    FORM_COST,
    FORM_SCALES,
)


def with_learnt_form(identification: Identification) -> Identification:
    """An identified log whose ship may differ from the model's form as far as the log says."""
    problem = learnt(identification.problem)
    return replace(
        identification,
        ship=replace(identification.ship, form_scale=problem.model.form_scale),
        problem=problem,
    )


def learnt(problem: IdentificationProblem) -> IdentificationProblem:
    """The problem of a ship that may differ from the model's form as far as the log says.

    The model's form is preferred by `FORM_COST`. The scale is that of largest evidence at first sight, and is kept if
    the log is likelier too once its likeliest cause is fitted beside each. What a reference says of a ship is kept.

    Parameters
    ----------
    problem : IdentificationProblem
        With a ship of the model's form.

    Returns
    -------
    IdentificationProblem
    """
    if problem.model.form_scale or problem.model.directions:
        return problem
    # Choose the scale of largest evidence (empirical Bayes), at a cost for leaving the model's
    # form.
    scores = scores_by_scale(problem)
    scale = max(scores, key=lambda scale: scores[scale] - FORM_COST * (scale > 0.0))
    if not scale:
        return problem
    # A cause may mimic the form: compare again with the likeliest cause fitted in full, and noise
    # tuned for both.
    formed = of_scale(problem, scale)
    is_likelier = beside_likeliest(formed).score - FORM_COST > beside_likeliest(problem).score
    return formed if is_likelier else problem


def with_settled_form(explained: ExplainedLog) -> ExplainedLog:
    """An explained log, its ship of the model's form after all where the causes found do without another.

    At first sight a cause that is not linear, or the second of two, can look like another form.
    """
    identification = explained.identification
    best = explained.fits[0]
    if not identification.problem.model.form_scale:
        return explained
    # The same causes with the plain form: the learnt one is kept only where it gains its cost.
    plain = of_scale(identification.problem, 0.0, best.hypotheses, best.values)
    same = fitted(plain, best.hypotheses, best.values).score
    to_beat = best.score - FORM_COST if same > best.score - FORM_COST else best.score
    # A full search with the plain form: another cause may take all that the learnt form took.
    fits = tuple(explain(plain))
    if fits[0].score < to_beat:
        return explained
    again = replace(
        identification, ship=replace(identification.ship, form_scale=0.0), problem=plain
    )
    return ExplainedLog(again, fits, is_healthy(plain, fits[0]))


def scores_by_scale(problem: IdentificationProblem) -> dict[float, float]:
    """Evidence of a log by the scale of the form, each with its likeliest cause at first sight.

    Parameters
    ----------
    problem : IdentificationProblem
        With a ship of the model's form.

    Returns
    -------
    dict of float to float
        Of scale 0 and `FORM_SCALES`. [nats, up to a constant of the log]
    """
    fit = fitted(problem)
    wanted = problem.hypotheses
    # Columns of the form's numbers, linearised once for all scales.
    sizes = problem.model.form_sizes
    of_form = [Regressor({path: size}) for path, size in sizes.items()]
    form = linearised_by_parts(fit.about, problem.record, fit.model, of_form)
    linear = beside(beside(fit.linear, form), problem.base_of(regressors_of(wanted)))
    products = problem.gram(linear).products
    scores = {}
    # The scale only sets the prior of these columns: each is one more evidence from the same
    # products.
    for scale in (0.0, *FORM_SCALES):
        columns = [
            *fit.columns,
            *(Regressor({path: size}, prior=scale) for path, size in sizes.items()),
        ]
        centre = np.concatenate([fit.centre, np.zeros(len(sizes))])
        prior = np.zeros(len(products) - 1)
        prior[: len(columns)] = [column.prior for column in columns]
        # Log-evidence without a cause, plus the gain of the likeliest one.
        alone = evidence(
            products, prior, np.concatenate([centre, np.zeros(prior.size - centre.size)])
        )[0]
        more = gains(products, columns, centre, wanted, fit.model.get)
        scores[scale] = alone + max(more[0][0] if more else 0.0, 0.0)
    return scores


def of_scale(
    problem: IdentificationProblem,
    scale: float,
    hypotheses: Sequence[Hypothesis] = (),
    values: Mapping[str, float] | None = None,
) -> IdentificationProblem:
    """The problem of a ship whose form may differ by some scale, its noise tuned again beside some causes."""
    # The allowed error of the form changes what noise is left: tune it again.
    formed = prepared(replace(problem, model=replace(problem.model, form_scale=scale)), rounds=1)
    fit = fitted(formed, hypotheses, values) if hypotheses else beside_likeliest(formed)
    return prepared(replace(formed, noise=tuned_noise(formed, fit)), rounds=1)
