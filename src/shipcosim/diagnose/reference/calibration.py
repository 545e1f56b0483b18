"""The ship as her logs would have her, where she is known to be well: a fit of her numbers alone, and its reference."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import cast

import numpy as np

import shipcosim
from shipcosim.diagnose.explanation.form import of_scale, scores_by_scale
from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.explanation.unmodelled import errors_of_the_fit, unmodelled_gains
from shipcosim.diagnose.explanation.verdict import admissible
from shipcosim.diagnose.hypotheses.catalogue import paths_of
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.linearisation import Regressor
from shipcosim.diagnose.inference.thresholds import ENOUGH, FORM_COST
from shipcosim.diagnose.reference.joint_fit import JointFit, fitted_jointly, screened_jointly
from shipcosim.diagnose.reference.reference import (
    SCHEMA,
    KnownNumber,
    Reference,
    ReferenceLog,
    fingerprint,
)
from shipcosim.diagnose.reference.several_logs import SeveralLogs, is_in_one_log
from shipcosim.diagnose.reference.thresholds import (
    MOST_SUSPECTS,
    MOST_WEIGHT,
    SCALES,
    USUAL_FORM,
    WEATHER_GAIN,
    WIDER,
)
from shipcosim.diagnose.ship.model import ShipModel


@dataclass(frozen=True)
class Calibration:
    """A ship fitted to logs in which she is well.

    Attributes
    ----------
    logs : SeveralLogs
        With the ship's form as uncertain as they say.
    fit : JointFit
        With causes of the days, where a log has any.
    scale : float
        Times the stated tolerances within which her numbers were moved.
    unmodelled : dict of str to dict of str to float
        Gain of unmodelled errors that are left, by log and kind. [nats]
    form_gain : float
        Log-evidence of the form that she has in `logs`, over the model's own. [nats]
    """

    logs: SeveralLogs
    fit: JointFit
    scale: float
    unmodelled: dict[str, dict[str, float]]
    form_gain: float


def calibrated_to(logs: SeveralLogs) -> Calibration:
    """Move the numbers of a ship that is well to fit logs, the weather of each day beside them.

    Parameters
    ----------
    logs : SeveralLogs
        With `is_well`.

    Returns
    -------
    Calibration
    """
    # First the form of the loads and the width of the tolerances, both by the evidence of all logs.
    logs, form_gain = with_common_form(logs)
    scale = likeliest_scale(fitted_jointly(logs, about_all=True))
    # Then causes of the weather of each day, with the ship's numbers free within these tolerances.
    fit = partial(fitted_jointly, scale=scale, about_all=True)
    fits = cast(
        list[JointFit],
        explain(logs, most=2 * len(logs.problems), fitted=fit, screened=screened_jointly),
    )
    # The best set of causes in which each gains clearly more than weather may by chance.
    ordinary = {hypothesis.label: WEATHER_GAIN for hypothesis in logs.hypotheses}
    best = next(
        fitted_set
        for fitted_set in fits
        if not fitted_set.hypotheses or admissible(fitted_set, fits, ordinary)
    )
    # With the weather explained, the tolerances may need another width: fit once more.
    again = likeliest_scale(best, scale)
    if again != scale:
        best = fitted_jointly(logs, best.hypotheses, best.values, scale=again, about_all=True)
    # Gain of unmodelled errors that remain in each log.
    errors = errors_of_the_fit(best)
    unmodelled = {
        name: unmodelled_gains(problem, best.parts[name]) | errors
        for name, problem in logs.problems.items()
    }
    return Calibration(logs, best, again, unmodelled, form_gain)


def with_common_form(logs: SeveralLogs) -> tuple[SeveralLogs, float]:
    """The logs of a ship whose form may differ from the model's as far as they say together.

    Where they do not tell, it is as uncertain as usual: a log of stationkeeping says nothing of drag, and a reference
    that took the model's form as certain would call the ship wrong on the first day that she moves.

    Returns
    -------
    SeveralLogs
    float
        Log-evidence of the form over the model's own. [nats]
    """
    # Log-evidence of each scale of the form, added up over the logs.
    scores: dict[float, float] = {}
    for problem in logs.problems.values():
        for scale, score in scores_by_scale(problem).items():
            scores[scale] = scores.get(scale, 0.0) + score
    # The usual scale is kept unless the logs clearly prefer another one.
    best = max(scores, key=lambda scale: scores[scale] + FORM_COST * (scale == USUAL_FORM))
    if not best:
        return logs, 0.0
    formed = {name: of_scale(problem, best) for name, problem in logs.problems.items()}
    return replace(logs, problems=formed), scores[best] - scores[0.0]


def causes_beside(calibration: Calibration) -> dict[str, float]:
    """Causes in the ship that the logs still look like beside the calibrated ship, with their gain. [nats]

    Parameters
    ----------
    calibration : Calibration

    Returns
    -------
    dict of str to float
        By label; those that could be named, were healthy logs to gain what is assumed of weather. Where the logs want
        wider tolerances, a cause beside the stated ones must explain them better than those do.
    """
    # Allow causes in the ship, which the calibration excluded.
    every = replace(calibration.logs, is_well=False)
    suspects = {}
    # Try beside the calibrated tolerances and beside the
    # stated ones, as wide tolerances can hide a cause.
    for scale in dict.fromkeys((calibration.scale, 1.0)):
        fit = partial(fitted_jointly, scale=scale, about_all=True)
        without = (
            calibration.fit
            if scale == calibration.scale
            else fit(every, calibration.fit.hypotheses, calibration.fit.values)
        )
        # Look closer at the causes in the ship that gain most at first sight.
        gains = [gain for gain in screened_jointly(every, without) if not is_in_one_log(gain[1])]
        for at_first_sight, hypothesis, values in gains[:MOST_SUSPECTS]:
            if at_first_sight <= WEATHER_GAIN:
                continue
            # Fit the cause jointly; it must gain enough over the calibrated ship to be a suspect.
            again = fit(every, (*without.hypotheses, hypothesis), without.values | values)
            gain = again.score - calibration.fit.score
            if gain > ENOUGH + WEATHER_GAIN and admissible(again, [without, again], {}):
                suspects[hypothesis.label] = max(gain, suspects.get(hypothesis.label, 0.0))
    return suspects


def likeliest_scale(fit: JointFit, scale: float = 1.0) -> float:
    """Times the stated tolerances within which logs are likeliest; 1 unless more is clearly likelier.

    Parameters
    ----------
    fit : JointFit
        By some scale of the tolerances.
    scale : float
        That scale.

    Returns
    -------
    float
    """
    # Scale the priors of the ship's numbers only, and compare the log-evidence of each scale.
    of_ship = np.array([_is_known_of_ship(column, fit) for column in fit.columns])
    prior = np.array([column.prior for column in fit.columns])
    scores = np.array(
        [
            evidence(fit.products.products, np.where(of_ship, s / scale, 1.0) * prior, fit.centre)[
                0
            ]
            for s in SCALES
        ]
    )
    # The smallest scale within the margin of the best,
    # so that tolerances are not widened without need.
    near = np.flatnonzero(scores > scores.max() - WIDER)
    return SCALES[near[0]]


def _is_known_of_ship(column: Regressor, fit: JointFit) -> bool:
    """Whether a column is of known numbers of the ship, and of no cause."""
    turned = paths_of(fit.hypotheses)
    return not column.is_of_day and turned.isdisjoint(column.changes)


def numbers_of(fit: JointFit) -> tuple[list[str], np.ndarray, np.ndarray, np.ndarray]:
    """The ship's numbers by a fit.

    Returns
    -------
    tuple of list of str, (n,) array, (n,) array, (n, n) array
        Names, tolerances before the logs, by how much each is moved, covariance of what they are on another day: that
        of the posterior, and twice that from part to part of the logs, for these days and the other.
    """
    # Columns of the ship's numbers, and by how much each column changes each number.
    wanted = [i for i, column in enumerate(fit.columns) if _is_known_of_ship(column, fit)]
    names = list(dict.fromkeys(path for i in wanted for path in fit.columns[i].changes))
    sizes = np.array([[fit.columns[i].changes.get(name, 0.0) for i in wanted] for name in names])
    # Covariance of the columns' θ by how differently the parts of the logs pull at them, (p, p) array.
    moves = _pulls(fit) @ fit.covariance
    # Posterior covariance plus a sandwich term: how differently
    # the parts of the logs pull, doubled for another day.
    spread = (fit.covariance + 2.0 * (moves.T @ moves))[np.ix_(wanted, wanted)]
    return names, np.sqrt((sizes**2).sum(1)), sizes @ fit.theta[wanted], sizes @ spread @ sizes.T


def dispersion_of(fit: JointFit) -> float:
    """How much more the parts of logs pull at the columns than by noise, mean square; 1 where the form is right."""
    # Pull of each part, and its information about each column.
    pulls = _pulls(fit)
    information = np.stack([np.diag(part)[1:] for part in fit.products.blocks])
    # Mean of squared pulls over their expected variance,
    # weighted by information, with a limit for each part.
    informed = np.minimum(
        information * np.array([column.prior for column in fit.columns]) ** 2, MOST_WEIGHT
    )
    return float((informed * pulls**2 / np.maximum(information, 1e-12)).sum() / informed.sum())


def _pulls(fit: JointFit) -> np.ndarray:
    """How much each part of the logs pulls at each column, (parts, p) array."""
    return np.stack([part[1:, 0] - part[1:, 1:] @ fit.left for part in fit.products.blocks])


def reference_of(
    calibration: Calibration,
    ship: ShipModel,
    ordinary: Mapping[str, float],
    logs: Sequence[ReferenceLog],
    system: str,
) -> Reference:
    """What a calibration leaves uncertain of a ship's numbers.

    Parameters
    ----------
    calibration : Calibration
    ship : ShipModel
        With the system's own numbers.
    ordinary : mapping of str to float
        Gain of unmodelled errors in these logs. [nats]
    logs : sequence of ReferenceLog
    system : str
        Its name.

    Returns
    -------
    Reference
    """
    # Estimates and covariance of the ship's numbers; the
    # covariance is stored as deviations and correlations.
    names, tolerances, moved, covariance = numbers_of(calibration.fit)
    std = np.sqrt(np.diag(covariance))
    correlation = np.clip(covariance / np.outer(std, std), -1.0, 1.0)
    numbers = [
        KnownNumber(
            name=name,
            unit=ship.about(name)["unit"],
            nominal=float(ship.get(name)),
            tolerance=float(tolerance),
            estimate=ship.within_bounds(name, float(ship.get(name) + by)),
            std=float(deviation),
        )
        for name, tolerance, by, deviation in zip(names, tolerances, moved, std, strict=True)
    ]
    first = next(iter(calibration.logs.problems.values()))
    return Reference(
        schema=SCHEMA,
        form_scale=first.model.form_scale,
        shipcosim=shipcosim.__version__,
        system=system,
        system_sha256=fingerprint(ship, names),
        tolerance_scale=calibration.scale,
        logs=tuple(logs),
        dispersion=dispersion_of(calibration.fit),
        ordinary_errors={kind: float(gain) for kind, gain in ordinary.items()},
        numbers=tuple(numbers),
        correlation=tuple(tuple(map(float, row)) for row in correlation),
    )
