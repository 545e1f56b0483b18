"""The identification problem of a log, and how the parameters of a set of causes are fitted to it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, parameters_of, paths_of
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.innovations import Gram, Noise, inner_products, smoothed
from shipcosim.diagnose.inference.linearisation import Regressor
from shipcosim.diagnose.inference.parts import InParts, explained, linearised_by_parts
from shipcosim.diagnose.inference.regressors import regressors_of
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.instruments import NONLINEAR
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion

ROUNDS = 5
_FAR = 3.0  # tolerances, beyond which nothing is linearised about
_RUNS_AWAY = (
    5.0  # times the velocity of a motion, beyond which one that is smoothed about it has run away
)


@dataclass(frozen=True)
class IdentificationProblem:
    """A log with the ship that is to explain it, and where to start.

    Attributes
    ----------
    record : Record
    model : ShipModel
        With all causes neutral.
    hypotheses : tuple of Hypothesis
    noise : Noise
    motion : Motion
    base : InParts, optional
        About the ship without a cause, with the columns of `basis`.
    known_of : tuple of Hypothesis, optional
        Hypotheses whose numbers are known within a tolerance, where those are more than `hypotheses`.
    fits : dict
        What `fitted` has made of this problem: stages ask for the same fits again.
    """

    record: Record
    model: ShipModel
    hypotheses: tuple[Hypothesis, ...]
    noise: Noise
    motion: Motion
    base: InParts | None = None
    known_of: tuple[Hypothesis, ...] = ()
    fits: dict[tuple[Any, ...], Fit] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @cached_property
    def basis(self) -> list[Regressor]:
        """Regressors of all known numbers, and of every hypothesis for the first search."""
        return self.ship_columns(()) + regressors_of(self.hypotheses)

    @property
    def linear(self) -> InParts:
        """The linear problem about the ship without a cause; only `prepared` problems have it."""
        if self.base is None:
            raise ValueError("the problem is not prepared")
        return self.base

    def base_of(self, columns: Iterable[Regressor]) -> InParts:
        """The problem about the ship without a cause, with these columns of the basis."""
        return self.linear.chosen(self.places(columns))

    def places(self, columns: Iterable[Regressor]) -> list[int]:
        """Numbers of some columns of the basis, from 1 on."""
        places = {column.key: i for i, column in enumerate(self.basis, start=1)}
        return [places[column.key] for column in columns]

    def gram(self, linear: InParts, parts: int = 8) -> Gram:
        """Inner products of a linear problem of this log, filtered by its noise, as `inner_products`."""
        return inner_products(linear, self.noise, self.record, parts)

    def ship_columns(self, hypotheses: Sequence[Hypothesis]) -> list[Regressor]:
        """Columns of the numbers that are known within a tolerance, except those that these hypotheses change."""
        # Numbers that these causes estimate themselves, or that stand for something they replace.
        taken = paths_of(hypotheses)
        taken |= {path for hypothesis in hypotheses for path in hypothesis.definition.replaces}
        everyone = self.known_of or self.hypotheses
        # Companions belong to the columns of their own hypothesis.
        taken |= {path for hypothesis in everyone for path in hypothesis.definition.companions}
        # Directions of a reference's covariance stay whatever the causes; single numbers of it do
        # not count a second time.
        columns = [Regressor(direction, beside=True) for direction in self.model.directions]
        taken |= self.model.referenced
        sizes = self.model.uncertainties
        columns += [Regressor({path: size}) for path, size in sizes.items() if path not in taken]
        # Parameters of linear causes with a tolerance that no listed uncertainty covers already.
        for hypothesis in everyone:
            for parameter in hypothesis.parameters if hypothesis.definition.law == "linear" else ():
                listed = all(path in sizes for path in parameter.paths)
                if parameter.tolerance > 0.0 and not listed and not taken & set(parameter.paths):
                    columns.append(Regressor(dict.fromkeys(parameter.paths, parameter.tolerance)))
        return columns


@dataclass(frozen=True, eq=False)
class Fit:
    """A set of causes fitted to a log.

    Attributes
    ----------
    hypotheses : tuple of Hypothesis
    values, std : dict of str to float
        Of each number that they turn.
    score : float
        Log-evidence of the log with these causes, up to a constant of the log.
    columns : list of Regressor
        Of known numbers, then of the causes.
    products : Gram
    theta, covariance : array
        Posterior of the columns, causes about neutral.
    centre : array
        θ that they were linearised about.
    model : ShipModel
    about : Motion
        That they were linearised about.
    motion : Motion
    record : Record
    """

    hypotheses: tuple[Hypothesis, ...]
    values: dict[str, float]
    std: dict[str, float]
    score: float
    columns: list[Regressor]
    products: Gram
    theta: np.ndarray
    covariance: np.ndarray
    centre: np.ndarray
    model: ShipModel
    about: Motion
    motion: Motion
    record: Record

    @property
    def linear(self) -> InParts:
        """The linear problem that was fitted; it is made again, as all of many fits would fill the memory."""
        return linearised_by_parts(self.about, self.record, self.model, self.columns)

    @property
    def label(self) -> str:
        return " + ".join(hypothesis.label for hypothesis in self.hypotheses) or "nothing"

    @property
    def left(self) -> np.ndarray:
        """θ that the columns still have to explain about this fit's ship: those of known numbers."""
        return self.theta - self.centre


def prepared(problem: IdentificationProblem, rounds: int = 3) -> IdentificationProblem:
    """The problem with its base: every column of the basis, about the motion smoothed without a cause."""
    # Linearise and smooth in turn, as an iterated extended Kalman smoother does, until the motion
    # suits both model and measurements.
    motion = problem.motion
    for _ in range(rounds):
        alone = linearised_by_parts(motion, problem.record, problem.model, [])
        products = problem.gram(alone).products
        motion = _smoothed(alone, products[..., 0, 0], problem, motion)
    # The columns are expensive: they are linearised only about the last motion.
    base = linearised_by_parts(motion, problem.record, problem.model, problem.basis)
    return replace(problem, motion=motion, base=base)


def _smoothed(
    linear: InParts, squares: np.ndarray, problem: IdentificationProblem, motion: Motion
) -> Motion:
    """The motion to linearise about next: that of the ship as the problem has her, as far as she can follow the log.

    `squares` is the sum of the innovations' squares. Where she cannot, the measurements rule: jolts are as much larger
    as the innovations' mean square is. Otherwise a boat whose propeller has lost a third of its thrust is smoothed far
    off her track, and nothing is found about that.
    """
    # Mean square of the whitened innovations: 1 where model and noise agree.
    misfit = squares / np.isfinite(problem.record.measured).sum((-2, -1))
    jolt = np.maximum(misfit, 1.0)[..., None] * np.asarray(problem.noise.jolt)
    noise = replace(problem.noise, jolt=jolt, walk=np.broadcast_to(problem.noise.walk, jolt.shape))
    # Iterated smoothing may diverge with a wrong model: then the motion before is kept.
    smooth = smoothed(linear, noise, problem.record, motion)[0]
    # Whether a smoothed motion is a number throughout, and no velocity of it far beyond that of the one before.
    fastest = [np.abs(velocity).max() for velocity in smooth[3:]]
    before = [np.abs(velocity).max() for velocity in motion[3:]]
    follows = bool(
        np.isfinite(np.stack(smooth)).all()
        and np.all(np.less(fastest, _RUNS_AWAY * np.array(before) + 0.1))
    )
    return smooth if follows else motion


def fitted(
    problem: IdentificationProblem,
    hypotheses: Sequence[Hypothesis] = (),
    values: Mapping[str, float] | None = None,
    rounds: int = ROUNDS,
) -> Fit:
    """Fit the parameters of some causes, with all known numbers within their tolerances.

    Parameters
    ----------
    problem : IdentificationProblem
    hypotheses : tuple of Hypothesis
    values : dict of str to float, optional
        To start from, brought within bounds.
    rounds : int
        Of linearisation.

    Returns
    -------
    Fit
        The same one where the same has been asked for before.
    """
    key = (
        tuple(hypothesis.label for hypothesis in hypotheses),
        tuple(sorted((values or {}).items())),
        rounds,
    )
    if key not in problem.fits:
        problem.fits[key] = _fitted(problem, hypotheses, values, rounds)
    return problem.fits[key]


def fitted_beside(noise: Noise, fit: Fit, problem: IdentificationProblem) -> Fit:
    """The causes of a fit fitted again beside another noise, as scores beside different noises do not compare."""
    beside_it = prepared(replace(problem, noise=noise), rounds=1)
    return fitted(beside_it, fit.hypotheses, fit.values)


def _fitted(problem, hypotheses, values, rounds):
    """A fit, made again."""
    # Start from finite values within their bounds.
    finite = {
        path: v if np.isfinite(v) else problem.model.get(path) for path, v in (values or {}).items()
    }
    values = bounded(hypotheses, finite)
    # Companions and nonlinear numbers keep the ship's values until the first estimate.
    about = {}
    motion = problem.motion
    last = None
    columns = problem.ship_columns(hypotheses) + own_columns(problem, hypotheses)
    # Gauss-Newton: linearise about the last estimate, solve for the posterior, and go on from its
    # mean.
    for _ in range(rounds):
        about_it = linearised(problem, columns, values | about, motion)
        prior = np.array([column.prior for column in columns])
        # A ship model that diverges cannot be filtered; the last good fit stands.
        if not np.isfinite(about_it.products.products).all():
            return last or _impossible(problem, hypotheses, values, columns, about_it)
        score, theta, covariance = evidence(about_it.products.products, prior, about_it.centre)
        # Evidence over θ = 0 plus the log-likelihood at θ = 0 is the log-evidence itself.
        score += float(about_it.products.free)
        if not (np.isfinite(score) and np.isfinite(theta).all()):
            return last or _impossible(problem, hypotheses, values, columns, about_it)
        # Smooth the motion with the posterior, and linearise there next.
        fit = about_it.with_posterior(problem, hypotheses, values, score, theta, covariance)
        motion = fit.motion
        values = next_values(fit)
        about = tolerated(fit)
        # Converged when neither the parameters nor the log-evidence still move.
        if (
            largest_move(fit, values, fit.model.get) < 0.02
            and last
            and abs(fit.score - last.score) < 1.0
        ):
            break
        last = fit
    return fit


def _impossible(problem, hypotheses, values, columns, about_it) -> Fit:
    """The fit of a ship whose loads are not finite along the log: infinitely unlikely."""
    # Without information from the log the posterior is the prior.
    covariance = np.diag([column.prior**2 for column in columns])
    rest = (columns, about_it.products, about_it.centre, covariance, about_it.centre)
    spread = deviations(hypotheses, covariance)
    about = (about_it.model, problem.motion, problem.motion, problem.record)
    return Fit(tuple(hypotheses), dict(values), spread, -np.inf, *rest, *about)


def largest_move(fit: Fit, values: Mapping[str, float], value_of: Callable[[str], float]) -> float:
    """How far the next values of the parameters are from those of a fit, in typical sizes; the largest."""
    return max(
        (abs(values[k.path] - value_of(k.path)) / k.typical for k in parameters_of(fit.hypotheses)),
        default=0.0,
    )


def own_columns(
    problem: IdentificationProblem, hypotheses: Sequence[Hypothesis]
) -> list[Regressor]:
    """Columns of hypotheses, what is only known within a tolerance about them first."""
    # Companions go first; the parameters' columns must be the last ones.
    about = [path for hypothesis in hypotheses for path in hypothesis.definition.companions]
    columns = [Regressor({path: problem.model.tolerances[path]}) for path in about]
    # The regressor of a parameter of a hypothesis.
    return columns + [
        Regressor(dict.fromkeys(of.paths, of.typical), vector=hypothesis.vector_of(of))
        for hypothesis in hypotheses
        for of in hypothesis.parameters
    ]


@dataclass(frozen=True)
class Linearised:
    """A problem about some values of the numbers, filtered.

    Attributes
    ----------
    columns : list of Regressor
    linear : InParts
    products : Gram
        Of its innovations.
    centre : (p,) array
        θ of the columns that they were linearised about.
    model : ShipModel
    motion : Motion
    """

    columns: list[Regressor]
    linear: InParts
    products: Gram
    centre: np.ndarray
    model: ShipModel
    motion: Motion

    def with_posterior(
        self,
        problem: IdentificationProblem,
        hypotheses: Sequence[Hypothesis],
        values: Mapping[str, float],
        score: float,
        theta: np.ndarray,
        covariance: np.ndarray,
    ) -> Fit:
        """The fit with a posterior of the columns; its motion is smoothed with that."""
        # Innovations left by the posterior mean, by the inner products: (1, -θ) P (1, -θ)'.
        left = theta - self.centre
        shares = np.concatenate([[1.0], -left])
        squares = shares @ self.products.products @ shares
        motion = _smoothed(explained(self.linear, left), squares, problem, self.motion)
        about = self.centre, self.model, self.motion
        rest = (self.columns, self.products, theta, covariance, *about, motion, problem.record)
        return Fit(
            tuple(hypotheses), dict(values), deviations(hypotheses, covariance), score, *rest
        )


def linearised(
    problem: IdentificationProblem,
    columns: list[Regressor],
    values: Mapping[str, float],
    motion: Motion,
) -> Linearised:
    """A problem about some values of the ship's numbers and a motion, with these columns."""
    model = problem.model.with_values(values)
    linear = linearised_by_parts(motion, problem.record, model, columns)
    products = problem.gram(linear)
    # θ of the ship model that the columns were linearised about; 0 for known numbers.
    centre = np.zeros(len(columns))
    for i, column in enumerate(columns):
        if not column.beside:
            centre[i] = theta_of(column, model, problem)
    return Linearised(columns, linear, products, centre, model, motion)


def theta_of(column: Regressor, model: ShipModel, problem: IdentificationProblem) -> float:
    """θ of a column at the numbers of a ship model."""
    path, size = next(iter(column.changes.items()))
    return float((model.get(path) - problem.model.get(path)) / size)


def deviations(hypotheses: Sequence[Hypothesis], covariance: np.ndarray) -> dict[str, float]:
    """Standard deviation of each parameter of some hypotheses, whose columns are the last."""
    parameters = parameters_of(hypotheses)
    # The parameters' columns are the last of the covariance.
    stds = np.sqrt(np.diag(covariance))[len(covariance) - len(parameters) :]
    return {
        parameter.path: float(deviation * parameter.typical)
        for parameter, deviation in zip(parameters, stds, strict=True)
    }


def next_values(fit: Fit) -> dict[str, float]:
    """Values of the numbers at the posterior's mean, within their bounds."""
    parameters = parameters_of(fit.hypotheses)
    values = dict(fit.values)
    # θ counts from neutral in typical sizes.
    for parameter, theta in zip(
        parameters, fit.theta[fit.theta.size - len(parameters) :], strict=True
    ):
        values.update(
            dict.fromkeys(parameter.paths, float(parameter.neutral + theta * parameter.typical))
        )
    return bounded(fit.hypotheses, values)


def bounded(hypotheses: Sequence[Hypothesis], values: Mapping[str, float]) -> dict[str, float]:
    """Values with the numbers that some hypotheses turn within their bounds."""
    bounds = {
        path: parameter.bounds
        for parameter in parameters_of(hypotheses)
        for path in parameter.paths
    }
    return {
        path: float(np.clip(v, *bounds[path])) if path in bounds else v
        for path, v in values.items()
    }


def tolerated(fit: Fit) -> dict[str, float]:
    """What is only known within a tolerance, and does not act along a line through neutral, at the posterior's mean."""
    # Only numbers that the columns represent badly far from the point of linearisation are moved
    # there.
    wanted = NONLINEAR | {
        path for hypothesis in fit.hypotheses for path in hypothesis.definition.companions
    }
    values = {}
    # Clipped, as a linearisation several tolerances away says nothing.
    for column, theta, centre in zip(fit.columns, fit.theta, fit.centre, strict=True):
        for path, size in column.changes.items() if wanted & set(column.changes) else ():
            values[path] = fit.model.get(path) + size * float(np.clip(theta, -_FAR, _FAR) - centre)
    return values
