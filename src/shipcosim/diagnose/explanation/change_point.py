"""Whether a cause began during the log: the rows before it are then healthy, and the rest is diagnosed on its own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipcosim.diagnose.explanation.search import (
    ExplainedLog,
    at_first_sight,
    explain,
    without_causes,
)
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem, fitted
from shipcosim.diagnose.inference.innovations import inner_products
from shipcosim.diagnose.inference.parts import beside
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.inference.regressors import regressors_of, screening_regressors
from shipcosim.diagnose.inference.thresholds import (
    CHANGE_POINT_BLOCK,
    CHANGE_POINT_GAIN,
    CHANGE_POINT_MARGIN,
    CHANGE_POINT_SKIPPED,
    MOST_CHANGE_POINT_BLOCKS,
)


def with_change_point(explained: ExplainedLog) -> ExplainedLog:
    """The log from a change point on with its own causes, where that explains the whole better; else as it was.

    A healthy log has no change point.
    """
    found = explained.identification
    time = None if explained.is_healthy else change_point_of(found.problem, explained.fits)
    if time is None:
        return explained
    row = int(np.searchsorted(found.repaired["time"].values, time))
    whole = explained.fits[0].score
    earlier = found.repaired.isel(time=slice(0, row))
    later = found.repaired.isel(time=slice(row, None))
    before, after = (
        identification_problem(part, found.ship, found.causes, found.problem.noise)
        for part in (earlier, later)
    )
    healthy = fitted(before)
    if healthy.score + at_first_sight(after) < whole:
        return explained
    fits = tuple(explain(after))
    if healthy.score + fits[0].score < whole + 2.0 * CHANGE_POINT_GAIN:
        return explained
    return replace(
        explained,
        identification=replace(found, repaired=later, problem=after),
        fits=fits,
        change_point=time,
    )


def change_point_of(problem: IdentificationProblem, fits: Sequence[Fit]) -> float | None:
    """When the likeliest cause would have begun: where the log splits best into rows without and with it.

    Parameters
    ----------
    problem : IdentificationProblem
    fits : sequence of Fit
        Of `explain`.

    Returns
    -------
    float or None
        Time [s]; None where nothing is gained by a change point.
    """
    nothing = without_causes(fits)
    hypotheses = [
        hypothesis for hypothesis in problem.hypotheses if hypothesis.definition.law != "turning"
    ]
    groups = [group for hypothesis in hypotheses for group in screening_regressors(hypothesis)]
    linear = beside(nothing.linear, problem.base_of(regressors_of(hypotheses)))
    span = problem.record.time.size * problem.record.step
    parts = int(np.clip(span / CHANGE_POINT_BLOCK, 8, MOST_CHANGE_POINT_BLOCKS))
    blocks = inner_products(linear, problem.noise, problem.record, parts).blocks
    known = len(nothing.columns)
    place = len(nothing.columns)
    gains = []
    priors = []
    for group in groups:
        prior = np.zeros(linear.columns)
        prior[:known] = prior[place : place + len(group)] = 1.0
        place += len(group)
        priors.append(prior)
    none = np.where(np.arange(prior.size) < known, 1.0, 0.0)
    for first in range(CHANGE_POINT_MARGIN, parts - CHANGE_POINT_SKIPPED - CHANGE_POINT_MARGIN):
        before = blocks[:first].sum(0)
        after = blocks[first + CHANGE_POINT_SKIPPED :].sum(0)
        healthy = evidence(before, none)[0]
        throughout = before + after
        later = max(evidence(after, prior)[0] for prior in priors)
        gains.append(
            healthy + later - max(evidence(throughout, prior)[0] for prior in (none, *priors))
        )
    if not gains:  # too short to be parted
        return None
    best = int(np.argmax(gains))
    row = round((CHANGE_POINT_MARGIN + best) / parts * problem.record.time.size)
    return float(problem.record.time[row]) if gains[best] > CHANGE_POINT_GAIN else None
