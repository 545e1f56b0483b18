"""Sets of causes weighed by the features of sea trials."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, HypothesisParameter
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.features import covariance_of, features_of
from shipcosim.diagnose.sea_trials.sailing import sailed
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.diagnose.ship.instruments import MOUNTING
from shipcosim.diagnose.ship.model import ShipModel

_PART = 0.3  # of the typical size, by which a cause is moved for its first derivative


@dataclass(frozen=True)
class SetOfCauses:
    """A set of causes fitted to sea trials.

    Attributes
    ----------
    hypotheses : tuple of Hypothesis
    values : (p,) array
        Distance of each parameter from its neutral value, in typical sizes.
    std : (p,) array
        The same of their standard deviations.
    evidence : float
        Logarithm, up to a constant that all sets on these trials share. [nats]
    """

    hypotheses: tuple[Hypothesis, ...]
    values: np.ndarray
    std: np.ndarray
    evidence: float

    @property
    def parameters(self) -> list[tuple[Hypothesis, HypothesisParameter]]:
        """All parameters, each with its cause."""
        return [(cause, parameter) for cause in self.hypotheses for parameter in cause.parameters]

    @property
    def label(self) -> str:
        """``drag + mass``, or ``no cause``."""
        return " + ".join(cause.label for cause in self.hypotheses) or "no cause"

    @property
    def plausible(self) -> bool:
        """Whether each estimate is inside its bounds, and one of each cause at least the least that matters."""
        pairs = list(zip(self.parameters, self.values, strict=True))
        inside = all(
            p.bounds[0] < p.neutral + value * p.typical < p.bounds[1] for (_, p), value in pairs
        )
        return inside and all(
            max(abs(value) for (owner, _), value in pairs if owner is cause)
            > cause.definition.least
            for cause in self.hypotheses
        )


@dataclass(frozen=True)
class TrialEvidence:
    """Sea trials and all that may be wrong, linearised about the ship as modelled.

    Attributes
    ----------
    trials : tuple of SeaTrial
    model : ShipModel
    hypotheses : tuple of Hypothesis
    measured : (f,) array
        Features of all trials, one after the other.
    predicted : (f,) array
        Those of the ship as modelled.
    slopes : (p, f) array
        By parameter of the hypotheses, over a typical size.
    ship_slopes : (q, f) array
        By what is known within a tolerance or allowed for, over its standard deviation.
    noise : (f, f) array
        How well the features repeat, at the scale of most evidence.
    scale : float
        That scale: how well they repeat over what is assumed. [1]
    """

    trials: tuple[SeaTrial, ...]
    model: ShipModel
    hypotheses: tuple[Hypothesis, ...]
    measured: np.ndarray
    predicted: np.ndarray
    slopes: np.ndarray
    ship_slopes: np.ndarray
    noise: np.ndarray
    scale: float = 1.0

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the features about those of a ship with the right causes."""
        return self.noise + self.ship_slopes.T @ self.ship_slopes


def trial_evidence(
    trials: Sequence[SeaTrial], model: ShipModel, hypotheses: Sequence[Hypothesis]
) -> TrialEvidence:
    """Linearise sea trials about the ship as modelled, and find how well their features repeat.

    Parameters
    ----------
    trials : sequence of SeaTrial
    model : ShipModel
    hypotheses : sequence of Hypothesis
        Causes to weigh.

    Returns
    -------
    TrialEvidence
    """
    # Central differences for the causes, forward ones for numbers that are only allowed for; all
    # ships in one simulation.
    causes = [
        (parameter, _PART * parameter.typical)
        for hypothesis in hypotheses
        for parameter in hypothesis.parameters
    ]
    of_ship = known_numbers(model)
    both = [dict.fromkeys(p.paths, sign * size) for sign in (1.0, -1.0) for p, size in causes]
    features = predicted(trials, model, [{}, *both, *({path: size} for path, size in of_ship)])
    slopes = (features[1 : 1 + len(causes)] - features[1 + len(causes) : 1 + 2 * len(causes)]) / (
        2.0 * _PART
    )
    ship_slopes = features[1 + 2 * len(causes) :] - features[0]
    length = model.length
    # Covariance of features by how well trials repeat, independent between trials.
    noise = blocks([covariance_of(trial, length) for trial in trials])
    measured = np.concatenate([features_of(trial, trial.measured) for trial in trials])
    first = TrialEvidence(
        tuple(trials),
        model,
        tuple(hypotheses),
        measured,
        features[0],
        slopes,
        ship_slopes,
        noise,
    )
    # How well they repeat is unknown: take the scale of largest evidence with up to two causes.
    scaled = [replace(first, noise=scale**2 * noise, scale=scale) for scale in thresholds.SCALES]
    return max(
        scaled, key=lambda scaled_evidence: max(value for value, _ in _linear(scaled_evidence, 2))
    )


def known_numbers(model: ShipModel) -> list[tuple[str, float]]:
    """What is uncertain whatever the cause: tolerances of hull and thrusters, current, compass and antenna.

    Returns
    -------
    list of (str, float)
        Number of the ship and standard deviation; compass and antenna, `MOUNTING`, last.
    """
    # Tolerances of hull and thrusters, without the wind's, as trials are sailed calm.
    places = (model.vessel, *model.thrusters)
    numbers = [
        (path, size) for path, size in model.tolerances.items() if path.rpartition(".")[0] in places
    ]
    numbers = [
        (path, size)
        for path, size in numbers
        if isinstance(model.get(path), float) and "wind" not in path
    ]
    # Current and mounting errors have standard deviations of their own.
    numbers += [
        ("water.current_north", thresholds.CURRENT),
        ("water.current_east", thresholds.CURRENT),
    ]
    sizes = thresholds.HEADING_BIAS, thresholds.LEVER * model.length
    return [*numbers, *zip(MOUNTING, sizes, strict=True)]


def predicted(
    trials: Sequence[SeaTrial],
    model: ShipModel,
    changes: Sequence[dict[str, float]],
) -> np.ndarray:
    """Features of trials by changed ships, (p, f) array of all trials one after the other."""
    motions = sailed(trials, model, changes)
    return np.array(
        [
            np.concatenate(
                [
                    features_of(trial, motion[i])
                    for trial, motion in zip(trials, motions, strict=True)
                ]
            )
            for i in range(len(changes))
        ]
    )


def slopes_of(
    trials: Sequence[SeaTrial], model: ShipModel, sets: Sequence[SetOfCauses]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Features of trials by fitted sets, (f,) array, and their slopes by parameter, (p, f), over a typical size."""
    # The set itself, then each of its parameters moved.
    changes = []
    for cause_set in sets:
        moves = _PART * np.eye(len(cause_set.values))
        changes += [
            changes_of(cause_set),
            *(_changes(cause_set.hypotheses, cause_set.values + by) for by in moves),
        ]
    features = iter(predicted(trials, model, changes))
    linearised = []
    for cause_set in sets:
        here = next(features)
        linearised.append(
            (
                here,
                np.array([(next(features) - here) / _PART for _ in cause_set.values]).reshape(
                    -1, here.size
                ),
            )
        )
    return linearised


def blocks(matrices: Sequence[np.ndarray]) -> np.ndarray:
    """A matrix of square matrices along its diagonal."""
    size = sum(len(matrix) for matrix in matrices)
    joined = np.zeros((size, size))
    at = 0
    for matrix in matrices:
        joined[at : at + len(matrix), at : at + len(matrix)] = matrix
        at += len(matrix)
    return joined


def changes_of(fitted_set: SetOfCauses) -> dict[str, float]:
    """What a fitted set adds to the numbers of the ship."""
    return _changes(fitted_set.hypotheses, fitted_set.values)


def allowed_for(evidence: TrialEvidence, fitted_set: SetOfCauses) -> dict[str, float]:
    """What compass and antenna are most likely off, beside a fitted set: numbers of the ship and what is added."""
    here = predicted(evidence.trials, evidence.model, [changes_of(fitted_set)])[0]
    # Posterior mean of known numbers given the residual: their share of the total covariance.
    shares = evidence.ship_slopes @ np.linalg.solve(evidence.covariance, evidence.measured - here)
    return {
        path: float(share) * size
        for share, (path, size) in zip(shares, known_numbers(evidence.model), strict=True)
        if path in MOUNTING
    }


def _changes(hypotheses, values):
    changes = {}
    parameters = (parameter for hypothesis in hypotheses for parameter in hypothesis.parameters)
    for parameter, value in zip(parameters, values, strict=True):
        for path in parameter.paths:
            changes[path] = changes.get(path, 0.0) + float(value) * parameter.typical
    return changes


def _linear(evidence: TrialEvidence, most: int) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Log-evidence of sets of hypotheses in the linear approximation, with their places."""
    # Whitened products once; every set only selects from them.
    products, free = _products(
        evidence.covariance, evidence.measured - evidence.predicted, evidence.slopes
    )
    places_of = _columns(evidence.hypotheses)
    yield free, ()
    for count in range(1, most + 1):
        for places in combinations(range(len(places_of)), count):
            yield (
                free + _gain(products, [i for place in places for i in places_of[place]])[0],
                places,
            )


def _columns(hypotheses):
    """Places of each hypothesis' parameters among all."""
    ends = np.cumsum([len(hypothesis.parameters) for hypothesis in hypotheses])
    return [
        list(range(end - len(hypothesis.parameters), end))
        for hypothesis, end in zip(hypotheses, ends, strict=True)
    ]


def _products(covariance, rest, slopes):
    """Inner products of residual and slopes, whitened; and the log-density of the residual alone."""
    # Whiten by the Cholesky factor of the covariance.
    L = np.linalg.cholesky(covariance)
    white = np.linalg.solve(L, np.column_stack((rest, slopes.T)) if len(slopes) else rest[:, None])
    products = white.T @ white
    return products, -0.5 * products[0, 0] - np.log(np.diag(L)).sum()


def _gain(products, columns):
    rows = [0, *(1 + i for i in columns)]
    return evidence(products[np.ix_(rows, rows)], np.ones(len(columns)))


def ranked(evidence: TrialEvidence) -> list[SetOfCauses]:
    """Sets of causes by evidence, best first: those best in the linear approximation, fitted to the simulation itself.

    Parameters
    ----------
    evidence : TrialEvidence

    Returns
    -------
    list of SetOfCauses
        The empty set among them, and every part of a set.
    """
    # Rank all sets linearly, keep the best of each size, and every set with one cause less, for
    # comparisons.
    everyone = sorted(_linear(evidence, thresholds.MOST_CAUSES), reverse=True)
    chosen = {()}
    for count in range(1, thresholds.MOST_CAUSES + 1):
        chosen |= {
            places
            for _, places in [ranked_set for ranked_set in everyone if len(ranked_set[1]) == count][
                : thresholds.RELINEARISED
            ]
        }
    chosen |= {part for places in chosen for part in combinations(places, max(len(places) - 1, 0))}
    sets = [tuple(evidence.hypotheses[i] for i in places) for places in sorted(chosen)]
    return sorted(_fitted(evidence, sets), key=lambda fitted_set: -fitted_set.evidence)


def _fitted(evidence, sets):
    """Sets fitted by linearising about what was found, a few times, all sets in one simulation."""
    # First solve with the slopes about the ship as modelled.
    places_of = dict(
        zip((h.label for h in evidence.hypotheses), _columns(evidence.hypotheses), strict=True)
    )
    slopes = [
        evidence.slopes[[i for cause in causes for i in places_of[cause.label]]] for causes in sets
    ]
    fits = [
        _solved(evidence, causes, s, evidence.predicted, np.zeros(len(s)))
        for causes, s in zip(sets, slopes, strict=True)
    ]
    # Gauss-Newton: simulate each set where it is and solve again.
    for _ in range(thresholds.ROUNDS):
        about = slopes_of(evidence.trials, evidence.model, fits)
        fits = [
            _solved(evidence, fit.hypotheses, slopes, here, fit.values)
            for fit, (here, slopes) in zip(fits, about, strict=True)
        ]
    return fits


def _solved(of_trials, causes, slopes, here, centre):
    """Posterior and evidence of a set, linearised about a centre."""
    products, free = _products(of_trials.covariance, of_trials.measured - here, slopes)
    gain, mean, covariance = evidence(products, np.ones(len(centre)), centre)
    # Steps of the estimate are limited, as slopes hold near the centre only.
    limit = 1.5 + np.abs(centre)
    return SetOfCauses(
        causes, np.clip(mean, -limit, limit), np.sqrt(np.diag(covariance)), free + gain
    )
