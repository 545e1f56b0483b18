"""What a log could not have shown, whatever is the matter: causes for which it has too little excitation."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipcosim.diagnose.explanation.search import without_causes
from shipcosim.diagnose.explanation.verdict import JudgedLog, usual_gain
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, hypotheses_of
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import IdentificationProblem, Regressor
from shipcosim.diagnose.inference.innovations import inner_products
from shipcosim.diagnose.inference.regressors import screening_regressors
from shipcosim.diagnose.inference.thresholds import TESTABLE
from shipcosim.diagnose.log.mislabels import THRUSTER_LABELS
from shipcosim.diagnose.log_faults.clock import is_testable
from shipcosim.diagnose.ship.inputs import rate_of
from shipcosim.diagnose.ship.model import ShipModel


def untestable_causes(log: JudgedLog) -> tuple[str, ...]:
    """Causes of the catalogue, the clock, and labels of thrusters that a log could not have shown.

    Causes as they would have shown had they had their typical size.

    All causes where something keeps the log from telling any.
    """
    problem = log.problem
    found = log.explained.identification
    # Faults of the thrusters' labels, where a log does not tell whether it has them.
    judged = (
        found.comparison is None
        or found.comparison.labels is None
        or found.comparison.labels.is_judged
    )
    of_log = (*(() if is_testable(problem) else ("clock",)), *(() if judged else THRUSTER_LABELS))
    everywhere = {hypothesis.cause for hypothesis in hypotheses_of(found.causes, problem.model)}
    if found.comparison.obstacles:
        return tuple(sorted({*of_log, *everywhere}))
    weak = not_testable(*_of_typical_size(log), TESTABLE + usual_gain(problem.model))
    identifiable = {hypothesis.cause for hypothesis in problem.hypotheses}
    return tuple(sorted({*weak, *of_log, *(everywhere - identifiable)}))


def hidden_by_form(log: JudgedLog) -> tuple[str, ...]:
    """Causes that a log could have shown on a ship of the model's form, and not on one whose form is uncertain."""
    model = log.problem.model
    if not model.form_scale or model.directions:
        return ()
    products, columns, groups = _of_typical_size(log)
    known = [_as_known(column, model) for column in columns]
    weak = not_testable(products, columns, groups, TESTABLE + usual_gain(model))
    return tuple(sorted({*weak} - {*not_testable(products, known, groups)}))


def _as_known(column: Regressor, model: ShipModel) -> Regressor:
    """A column of a number that is known within its tolerance, whatever the form says."""
    path = next(iter(column.changes))
    if path not in model.form_sizes or column.prior != 1.0:
        return column
    return replace(column, prior=model.tolerances.get(path, 0.0) / model.uncertainties[path])


def _of_typical_size(
    log: JudgedLog,
) -> tuple[np.ndarray, list[Regressor], list[tuple[Hypothesis, list[int]]]]:
    """Inner products of a log, its known numbers and every cause of typical size, as `not_testable` takes them."""
    problem = log.problem
    columns = list(without_causes(log.fits).columns)
    groups = []
    for hypothesis in problem.hypotheses:
        for group in screening_regressors(hypothesis):
            groups.append((hypothesis, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = inner_products(problem.base_of(columns), problem.noise, problem.record).products
    return products, columns, groups


def not_testable(
    products: np.ndarray,
    columns: Sequence[Regressor],
    groups: Sequence[tuple[Hypothesis, list[int]]],
    least: float = TESTABLE,
) -> tuple[str, ...]:
    """Causes that would have gained too little to be seen in a log, had they had their typical size.

    Parameters
    ----------
    products : (1 + p, 1 + p) array
        Inner products of the log, of the known numbers and of all hypotheses' first columns.
    columns : sequence of p Regressor
    groups : sequence of (Hypothesis, indices)
    least : float
        That it would have to gain. [nats]

    Returns
    -------
    tuple of str
        Names of causes, none of whose places could have shown it.
    """
    gains: dict[str, float] = {}
    blank = products.copy()
    blank[0, :] = blank[:, 0] = 0.0
    known = np.array([column.prior for column in columns])
    for _, places in groups:
        known[list(places)] = 0.0
    for hypothesis, places in groups:
        prior = known.copy()
        prior[list(places)] = 1.0
        taken = {path for i in places for path in columns[i].changes}
        prior[[i for i, c in enumerate(columns) if i not in places and c.gives_way(taken)]] = 0.0
        covariance = evidence(blank, prior)[2][np.ix_(places, places)]
        information = float(np.max(0.5 * (1.0 / np.diag(covariance) - 1.0)))
        gain = information - 0.5 * float(np.log1p(2.0 * information))
        gains[hypothesis.cause] = max(gains.get(hypothesis.cause, -np.inf), gain)
    return tuple(cause for cause, gain in sorted(gains.items()) if gain < least)


def log_facts(problem: IdentificationProblem) -> dict[str, float | None]:
    """What a log has of motion, thrust astern and wind, by the names of `FACTS`; None for what it does not have.

    Root mean squares of speed, surge and sway [m/s], of the acceleration in surge [m/s2] and of the rate of turn
    [deg/s]; the largest share of the log in which an azimuth thruster ran astern [1]; the mean wind speed [m/s].
    """
    record = problem.record
    motion = problem.motion
    astern = [float(np.mean(record.units[name][0] < 0.0)) for name in problem.model.azimuths]
    return {
        "astern_share": max(astern, default=0.0),
        "speed": _rms(np.hypot(motion.u, motion.v)),
        "surge": _rms(motion.u),
        "surge_acceleration": _rms(rate_of(motion.u, record)),
        "sway": _rms(motion.v),
        "wind_speed": None if record.wind is None else float(np.mean(record.wind[0])),
        "yaw_rate": _rms(np.degrees(motion.r)),
    }


def _rms(values):
    return float(np.sqrt(np.nanmean(np.asarray(values) ** 2)))
