"""Sets of causes fitted to several logs together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import (
    ROUNDS,
    Fit,
    bounded,
    deviations,
    largest_move,
    linearised,
    next_values,
    own_columns,
    tolerated,
)
from shipcosim.diagnose.inference.innovations import Gram
from shipcosim.diagnose.inference.linearisation import Regressor, moved
from shipcosim.diagnose.inference.parts import beside
from shipcosim.diagnose.inference.regressors import regressors_of
from shipcosim.diagnose.inference.screening import Gain, gains
from shipcosim.diagnose.reference.several_logs import Layout, SeveralLogs, laid_out, values_in
from shipcosim.diagnose.reference.thresholds import CLOSE


@dataclass(frozen=True, eq=False)
class JointFit(Fit):
    """A set of causes fitted to several logs; its model, motions and record are those of the first.

    Attributes
    ----------
    parts : dict of str to Fit
        By name of the log: its causes, with the posterior of all logs.
    layout : Layout
        Of its columns.
    """

    parts: dict[str, Fit] = field(default_factory=dict)
    layout: Layout = field(default_factory=lambda: Layout([], {}))

    def get(self, path: str) -> float:
        """Value of a number of the ship, or of the day of one log, that the columns were linearised about."""
        name, separator, number = path.rpartition("|")
        return self.parts[name].model.get(number) if separator else self.model.get(path)


def fitted_jointly(
    logs: SeveralLogs,
    hypotheses: Sequence[Hypothesis] = (),
    values: Mapping[str, float] | None = None,
    rounds: int = ROUNDS,
    *,
    scale: float = 1.0,
    about_all: bool = False,
) -> JointFit:
    """Fit the parameters of some causes to several logs, with all known numbers within their tolerances.

    Parameters
    ----------
    logs : SeveralLogs
    hypotheses : sequence of Hypothesis
        Of `SeveralLogs.hypotheses`.
    values : dict of str to float, optional
        To start from.
    rounds : int
        Of linearisation.
    scale : float
        Of the tolerances of the ship's numbers.
    about_all : bool
        Whether the known numbers of the ship, too, are linearised about where the logs would have them.

    Returns
    -------
    JointFit
    """
    # Start values within bounds, and for each log its motion and its causes.
    values = bounded(hypotheses, values or {})
    last = None
    about: dict[str, dict[str, float]] = {name: {} for name in logs.problems}
    motions = {name: problem.motion for name, problem in logs.problems.items()}
    by_log = {
        name: tuple(hypothesis for _, hypothesis in logs.all_within(name, hypotheses))
        for name in logs.problems
    }
    # Columns of each log: its known numbers, the ship's with scaled tolerances, and its causes.
    columns = {
        name: [
            column if column.is_of_day else replace(column, prior=scale * column.prior)
            for column in problem.ship_columns(by_log[name])
        ]
        + own_columns(problem, by_log[name])
        for name, problem in logs.problems.items()
    }
    # Common columns for numbers of the ship, separate ones for those of a day.
    layout, common = _layout(logs, hypotheses, columns)
    # Gauss-Newton: linearise each log about its own
    # motion, solve for all logs together, and repeat.
    for _ in range(rounds):
        fitted_logs = {
            name: linearised(
                problem, columns[name], values_in(name, values) | about[name], motions[name]
            )
            for name, problem in logs.problems.items()
        }
        fit = _posterior(logs, hypotheses, by_log, values, layout, fitted_logs)
        motions = {name: part.motion for name, part in fit.parts.items()}
        values = next_values(fit)
        # New point of linearisation for the known numbers.
        about = {
            name: tolerated(part) | (_at_the_mean(fit, common) if about_all else {})
            for name, part in fit.parts.items()
        }
        # Converged if no parameter moves much and the evidence hardly changes.
        if (
            largest_move(fit, values, fit.get) < CLOSE
            and last
            and abs(fit.score - last.score) < 1.0
        ):
            break
        last = fit
    return fit


def _layout(
    logs: SeveralLogs, hypotheses: Sequence[Hypothesis], columns: Mapping[str, Sequence[Regressor]]
) -> tuple[Layout, np.ndarray]:
    """Where the columns of each log are among all, and which of all are known numbers of the ship, (p,) bool array."""
    # One column for each parameter of each cause.
    parameters = [
        (f"{hypothesis.label}, {k}", Regressor(dict.fromkeys(parameter.paths, parameter.typical)))
        for hypothesis in hypotheses
        for k, parameter in enumerate(hypothesis.parameters)
    ]
    of_ship = {}
    companions = []
    named = {}
    # The columns of a log are its known numbers, then
    # companions of its causes, then their parameters.
    for name in logs.problems:
        pairs = logs.all_within(name, hypotheses)
        turned = [
            f"{hypothesis.label}, {k}"
            for hypothesis, _ in pairs
            for k in range(len(hypothesis.parameters))
        ]
        about = sum(len(hypothesis.definition.companions) for _, hypothesis in pairs)
        split = len(columns[name]) - len(turned) - about
        of_ship[name] = columns[name][:split]
        beside_them = [
            (f"{name}, {i}", column)
            for i, column in enumerate(columns[name][split : split + about])
        ]
        companions += beside_them
        named[name] = [key for key, _ in beside_them] + turned
    layout = laid_out(of_ship, companions + parameters, named)
    # Known numbers come first in the layout; those that are not of a day are common.
    first = len(layout.regressors) - len(companions) - len(parameters)
    common = [i < first and not column.is_of_day for i, column in enumerate(layout.regressors)]
    return layout, np.array(common, bool)


def _posterior(logs, hypotheses, hypotheses_of_log, values, layout, linearised):
    """The joint fit of logs that are linearised, each about its own motion."""
    # Independent logs: inner products, determinants and free terms of the likelihood add up.
    products = Gram(
        np.sum(
            [layout.spread(name, part.products.products) for name, part in linearised.items()],
            axis=0,
        ),
        np.concatenate(
            [layout.spread(name, part.products.blocks) for name, part in linearised.items()]
        ),
        np.sum([part.products.log_determinant for part in linearised.values()], axis=0),
    )
    centre = layout.together({name: part.centre for name, part in linearised.items()})
    # Posterior of all columns by the combined products, and the log-evidence.
    score, theta, covariance = evidence(products.products, layout.prior, centre)
    score += sum(float(part.products.free) for part in linearised.values())
    # Each log gets its part of the joint posterior.
    parts = {}
    for name, of_log in linearised.items():
        at = layout.places[name]
        posterior = theta[at], covariance[np.ix_(at, at)]
        parts[name] = of_log.with_posterior(
            logs.problems[name], hypotheses_of_log[name], values_in(name, values), score, *posterior
        )
    first = next(iter(parts.values()))
    return JointFit(
        tuple(hypotheses),
        dict(values),
        deviations(hypotheses, covariance),
        score,
        layout.regressors,
        products,
        theta,
        covariance,
        centre,
        first.model,
        first.about,
        first.motion,
        first.record,
        parts,
        layout,
    )


def _at_the_mean(fit: JointFit, common: np.ndarray) -> dict[str, float]:
    """Every known number of the ship where the logs would have it."""
    columns = [fit.columns[i] for i in np.flatnonzero(common)]
    return moved(columns, fit.left[common], fit.model.get)


def screened_jointly(logs: SeveralLogs, fit: JointFit) -> list[Gain]:
    """Gain in log-evidence of each hypothesis beside a fit to several logs, linearised once; as `screened`."""
    # Hypotheses that are not in the fit yet.
    wanted = [hypothesis for hypothesis in logs.hypotheses if hypothesis not in fit.hypotheses]
    products_by_log = {}
    # Inner products of each log with the columns of the fit and the new ones.
    for name, problem in logs.problems.items():
        part = fit.parts[name]
        added = regressors_of(hypothesis for _, hypothesis in logs.all_within(name, wanted))
        linear = beside(part.linear, problem.base_of(added))
        products_by_log[name] = problem.gram(linear).products
    # Add them up over the logs, and compute the gain of each hypothesis.
    layout = screening_layout(logs, fit.layout, wanted)
    products = np.sum(
        [layout.spread(name, product) for name, product in products_by_log.items()], axis=0
    )
    return gains(products, fit.columns, fit.centre, wanted, fit.get)


def screening_layout(logs: SeveralLogs, layout: Layout, wanted: Sequence[Hypothesis]) -> Layout:
    """Columns of a fit to several logs, and behind them those by which hypotheses are first sought.

    Parameters
    ----------
    logs : SeveralLogs
    layout : Layout
        Of the fit.
    wanted : sequence of Hypothesis
        Of `SeveralLogs.hypotheses`, in their order.

    Returns
    -------
    Layout
        In each log the columns of the fit are followed by those of the hypotheses that it has something to say of.
    """
    regressors = list(layout.regressors)
    places = {name: list(where_in_all) for name, where_in_all in layout.places.items()}
    for hypothesis in wanted:
        columns = regressors_of([hypothesis])
        where = range(len(regressors), len(regressors) + len(columns))
        for name, log_places in places.items():
            if logs.within(name, hypothesis) is not None:
                log_places += where
        regressors += columns
    return Layout(regressors, {name: np.array(columns, int) for name, columns in places.items()})
