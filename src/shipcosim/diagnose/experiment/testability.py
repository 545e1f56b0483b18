"""What a log could not have shown, whatever is wrong: causes for which it has too little excitation."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.explanation.search import without_causes
from shipcosim.diagnose.explanation.verdict import JudgedLog, usual_gain
from shipcosim.diagnose.finding import VisibleSize
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, hypotheses_of
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import IdentificationProblem, Regressor
from shipcosim.diagnose.inference.regressors import placed, regressors_of
from shipcosim.diagnose.inference.thresholds import (
    DEVIATIONS,
    MORE_THAN_NOISE,
    NINE_OF_TEN,
    NULL_GAIN_WITHOUT_WIND,
    TESTABLE,
)
from shipcosim.diagnose.log.mislabels import THRUSTER_LABELS
from shipcosim.diagnose.log_faults.clock import is_testable
from shipcosim.diagnose.ship.inputs import rate_of
from shipcosim.diagnose.ship.model import ShipModel


@dataclass(frozen=True)
class Excitation:
    """Information of a log on each cause of typical size.

    Attributes
    ----------
    products : (1 + p, 1 + p) array
        Inner products of the log, of the known numbers and of all hypotheses' first columns.
    columns : sequence of p Regressor
    groups : sequence of (Hypothesis, indices)
        Of the columns that are a hypothesis's.
    least : float
        Log-evidence that a cause must gain to be named. [nats]
    """

    products: np.ndarray
    columns: Sequence[Regressor]
    groups: Sequence[tuple[Hypothesis, list[int]]]
    least: float = TESTABLE

    def informations(self) -> Iterator[tuple[Hypothesis, list[int], np.ndarray]]:
        """Information on each column of each group, while all known numbers may be off within their tolerances.

        As the inverse of a variance, in units of the cause's typical size. What a number of the ship that the cause
        changes may be off by itself counts as variance, and not for the cause.
        """
        # Only what the columns tell counts, so the log's own residual is set to zero.
        blank = self.products.copy()
        blank[0, :] = blank[:, 0] = 0.0
        # Known numbers are free within tolerances; causes are switched on one at a time.
        tolerance = np.array([column.prior for column in self.columns])
        for _, places in self.groups:
            tolerance[places] = 0.0
        for hypothesis, places in self.groups:
            prior = tolerance.copy()
            prior[places] = 1.0
            # Known numbers that the cause changes itself have no tolerance of their own beside it.
            taken = {path for i in places for path in self.columns[i].changes}
            yielding = [
                i for i, c in enumerate(self.columns) if i not in places and c.gives_way(taken)
            ]
            prior[yielding] = 0.0
            # Posterior variance with a unit prior: its inverse less 1 is the information of the
            # log.
            covariance = evidence(blank, prior)[2][np.ix_(places, places)]
            variance = 1.0 / np.maximum(1.0 / np.diag(covariance) - 1.0, 1e-12)
            # Without the cause these numbers, free within tolerance and form, explain as much as they are free.
            own = np.zeros(len(places))
            for i in yielding:
                path, size = next(iter(self.columns[i].changes.items()))
                sizes = np.array([self.columns[k].changes.get(path, np.inf) for k in places])
                own += (tolerance[i] * size / sizes) ** 2
            yield hypothesis, places, np.maximum(1.0 - own, 0.0) / (own + variance)


def excitation_of(log: JudgedLog) -> Excitation:
    """Information of a log on each cause that can be sought in it."""
    problem = log.problem
    # Known numbers and first columns of all causes, about the ship without one.
    of_ship = without_causes(log.fits).columns
    columns = [*of_ship, *regressors_of(problem.hypotheses)]
    groups = [
        (hypothesis, places) for hypothesis, _, places in placed(problem.hypotheses, len(of_ship))
    ]
    products = problem.gram(problem.base_of(columns)).products
    without_wind = NULL_GAIN_WITHOUT_WIND if problem.record.wind is None else 0.0
    least = TESTABLE + usual_gain(problem.model) + without_wind
    return Excitation(products, columns, groups, least)


def untestable_causes(log: JudgedLog, excitation: Excitation) -> tuple[str, ...]:
    """Causes of the catalogue, the clock, and labels of thrusters that a log could not have shown.

    Causes as they would have shown had they had their typical size.

    All causes where something keeps the log from telling any.
    """
    problem = log.problem
    identification = log.explained.identification
    # Faults of the thrusters' labels, where a log does not tell whether it has them.
    judged = (
        identification.comparison is None
        or identification.comparison.labels is None
        or identification.comparison.labels.is_judged
    )
    of_log = (*(() if is_testable(problem) else ("clock",)), *(() if judged else THRUSTER_LABELS))
    everywhere = {
        hypothesis.cause for hypothesis in hypotheses_of(identification.causes, problem.model)
    }
    if identification.comparison.obstacles:
        return tuple(sorted({*of_log, *everywhere}))
    identifiable = {hypothesis.cause for hypothesis in problem.hypotheses}
    return tuple(sorted({*not_testable(excitation), *of_log, *(everywhere - identifiable)}))


def hidden_by_form(log: JudgedLog, excitation: Excitation) -> tuple[str, ...]:
    """Causes that a log could have shown on a ship of the model's form, and not on one whose form is uncertain."""
    model = log.problem.model
    if not model.form_scale or model.directions:
        return ()
    of_model_form = [_as_known(column, model) for column in excitation.columns]
    of_known_form = replace(excitation, columns=of_model_form, least=TESTABLE)
    return tuple(sorted({*not_testable(excitation)} - {*not_testable(of_known_form)}))


def _as_known(column: Regressor, model: ShipModel) -> Regressor:
    """Column of a number known within its tolerance; the form does not matter."""
    path = next(iter(column.changes))
    if path not in model.form_sizes or column.prior != 1.0:
        return column
    return replace(column, prior=model.tolerances.get(path, 0.0) / model.uncertainties[path])


def expected_gain(information: float) -> float:
    """Log-evidence that a cause of typical size gains by the information on it. [nats]

    Half the information, less the evidence's penalty for the parameter.
    """
    return 0.5 * information - 0.5 * float(np.log1p(information))


def not_testable(excitation: Excitation) -> tuple[str, ...]:
    """Causes that would have gained too little to be seen in a log, had they had their typical size.

    Parameters
    ----------
    excitation : Excitation

    Returns
    -------
    tuple of str
        Names of causes, none of whose places could have shown it.
    """
    gains: dict[str, float] = {}
    for hypothesis, _, informations in excitation.informations():
        gain = expected_gain(float(np.max(informations)))
        gains[hypothesis.cause] = max(gains.get(hypothesis.cause, -np.inf), gain)
    return tuple(cause for cause, gain in sorted(gains.items()) if gain < excitation.least)


def visible_sizes(excitation: Excitation) -> tuple[VisibleSize, ...]:
    """The smallest size of each cause that a log would have shown in nine of ten cases.

    The estimate of a cause of size s, in units of its typical size, varies about s with the variance 1/J that the
    information J of the log leaves. Its log-evidence is half of the estimate's square, over its prior and posterior
    variances, less half of log(1 + J). It is named where that is enough, and where the estimate is both large enough to
    matter and clearly off neutral; the ship's own number may be off within its tolerance besides.

    Returns
    -------
    tuple of VisibleSize
        By hypothesis and parameter, in the catalogue's order; of a vector its length, in the direction that shows
        least. Causes whose law turns over time are left out: the steady ones stand for them.
    """
    sizes: dict[tuple[str, str], VisibleSize] = {}
    for hypothesis, places, informations in excitation.informations():
        if hypothesis.definition.law == "turning":
            continue
        is_vector = len(places) < len(hypothesis.parameters)
        for place, information in zip(places, informations, strict=True):
            spread = 1.0 / np.sqrt(max(float(information), 1e-12))
            cost = hypothesis.definition.cost
            # Evidence that is needed, solved for the estimate: z^2 / (2 s^2 (1 + s^2)) = wanted
            # with s the standard deviation.
            wanted = excitation.least + cost + 0.5 * np.log1p(information)
            of_evidence = spread * np.sqrt(2.0 * wanted * (1.0 + spread**2))
            least = max(of_evidence, hypothesis.definition.least, DEVIATIONS * spread)
            path = next(iter(excitation.columns[place].changes))
            parameter = next(of for of in hypothesis.parameters if path in of.paths)
            # The estimate varies by the log's noise, and the well ship's own number within its tolerance.
            varies = np.hypot(spread, parameter.tolerance / parameter.typical)
            size = least + NINE_OF_TEN * MORE_THAN_NOISE * varies
            # Beyond its bounds the cause is not sought.
            largest = max(abs(bound - parameter.neutral) for bound in parameter.bounds)
            visible = VisibleSize(
                hypothesis.cause,
                hypothesis.component,
                "" if is_vector else parameter.name,
                float(size * abs(parameter.typical * parameter.factor)),
                parameter.unit,
                float(largest * abs(parameter.factor)),
            )
            # A vector is sought in several directions: the one that shows least counts.
            key = hypothesis.label, visible.parameter
            if key not in sizes or visible.size > sizes[key].size:
                sizes[key] = visible
    return tuple(sizes.values())


def log_facts(problem: IdentificationProblem) -> dict[str, float | None]:
    """Motion, thrust astern and wind of a log, by the names of `FACTS`; None for missing ones.

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
