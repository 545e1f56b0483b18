"""The verdict on several logs of one ship together: common causes, and those of each log's weather."""

from dataclasses import dataclass
from typing import cast

import numpy as np

from shipcosim.diagnose.experiment.testability import Excitation
from shipcosim.diagnose.explanation.null_distribution import (
    gains_of_each,
    healthy_products,
    on_track,
)
from shipcosim.diagnose.explanation.search import explain, without_causes
from shipcosim.diagnose.explanation.unmodelled import errors_of_the_fit, unmodelled_gains
from shipcosim.diagnose.explanation.verdict import (
    Judgement,
    judge_against_healthy,
    usual_gain,
)
from shipcosim.diagnose.inference.regressors import placed, regressors_of
from shipcosim.diagnose.inference.thresholds import (
    NULL_GAIN_WITHOUT_WIND,
    TESTABLE,
)
from shipcosim.diagnose.reference.joint_fit import (
    JointFit,
    fitted_jointly,
    screened_jointly,
    screening_layout,
)
from shipcosim.diagnose.reference.several_logs import SeveralLogs


@dataclass(frozen=True)
class JointVerdict:
    """What several logs say together.

    Attributes
    ----------
    logs : SeveralLogs
    fits : tuple of JointFit
        Best first; the one without a cause is among them.
    judgement : Judgement
    unmodelled : dict of str to float
        Gain of unmodelled errors beside its causes, by kind. [nats]
    null_gains : dict of str to float
        Gain of its causes on simulated healthy logs, by label. [nats]
    """

    logs: SeveralLogs
    fits: tuple[JointFit, ...]
    judgement: Judgement
    unmodelled: dict[str, float]
    null_gains: dict[str, float]

    @property
    def fit(self) -> JointFit:
        """The set of causes that the verdict rests on."""
        return cast(JointFit, self.judgement.fit)


def judged_jointly(logs: SeveralLogs) -> JointVerdict:
    """The sets of causes that explain several logs together, and the verdict on them.

    Parameters
    ----------
    logs : SeveralLogs

    Returns
    -------
    JointVerdict
    """
    # Search sets of causes that explain all logs.
    fits = cast(list[JointFit], explain(logs, fitted=fitted_jointly, screened=screened_jointly))
    # If a log lacks the wind, chance explains more, and the threshold rises.
    silent = any(problem.record.wind is None for problem in logs.problems.values())
    models = [problem.model for problem in logs.problems.values()]
    usual = max(map(usual_gain, models)) + NULL_GAIN_WITHOUT_WIND * silent
    # Judge the best sets against what causes gain in healthy logs.
    judgement = judge_against_healthy(
        fits,
        lambda fit: _unmodelled(logs, fit),
        lambda fit: _null_gains(logs, fit, fits),
        null={hypothesis.label: usual for hypothesis in logs.hypotheses},
        without_wind=silent,
    )
    return JointVerdict(logs, tuple(fits), *judgement)


def _unmodelled(logs: SeveralLogs, fit: JointFit) -> dict[str, float]:
    """Gain of unmodelled errors beside a joint fit: of a force or a channel in any log, or the same kind in all."""
    # Gains in each log, and errors of the joint fit itself.
    each = [unmodelled_gains(problem, fit.parts[name]) for name, problem in logs.problems.items()]
    of_fit = errors_of_the_fit(fit)
    kinds = (kind for kind in each[0] if kind not in of_fit)
    by_kind = {}
    for kind in kinds:
        # Either one log shows the error, at the cost of
        # choosing this log, or all show the same kind.
        values = [gains[kind] for gains in each]
        by_kind[kind] = max(max(values) - float(np.log(len(values))), sum(values))
    return by_kind | of_fit


def _null_gains(logs, fit, fits):
    """Gains of a fit's causes on simulated healthy logs of the same drawn ships, as with one log."""
    # Simulate healthy logs with the inputs of each log, and add up their inner products.
    nothing = cast(JointFit, without_causes(fits))
    wanted = fit.hypotheses
    layout = screening_layout(logs, nothing.layout, wanted)
    together = np.zeros(())
    kept = np.array(True)
    for name, problem in logs.problems.items():
        hypotheses = [hypothesis for _, hypothesis in logs.all_within(name, wanted)]
        _, products = healthy_products(problem, fit.parts[name].motion, hypotheses)
        kept = kept & on_track(products)
        together = together + layout.spread(name, products)
    # Gain of each cause on each simulated set of logs, where the ship stayed on its track.
    return gains_of_each(together[kept], nothing.columns, wanted, nothing.get)


def joint_excitation(verdict: JointVerdict) -> Excitation:
    """Information of all logs together on each cause of typical size."""
    # Inner products of the columns of all causes, added up over the logs.
    logs = verdict.logs
    nothing = cast(JointFit, without_causes(verdict.fits))
    layout = screening_layout(logs, nothing.layout, logs.hypotheses)
    together = np.zeros(())
    for name, problem in logs.problems.items():
        hypotheses = (hypothesis for _, hypothesis in logs.all_within(name, logs.hypotheses))
        columns = nothing.parts[name].columns + regressors_of(hypotheses)
        products = problem.gram(problem.base_of(columns)).products
        together = together + layout.spread(name, products)
    # Columns of each cause, and the evidence that it needs to count as testable.
    groups = [
        (hypothesis, places)
        for hypothesis, _, places in placed(logs.hypotheses, len(nothing.columns))
    ]
    usual = max(usual_gain(problem.model) for problem in logs.problems.values())
    return Excitation(together, layout.regressors, groups, TESTABLE + usual)
