"""Which manoeuvre tells sets of causes apart that the trials cannot: computed, for every manoeuvre of the catalogue."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from shipcosim.diagnose.experiment.design import MOST_SETS, Separation, TellingFeature
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.evidence import (
    SetOfCauses,
    TrialEvidence,
    blocks,
    changes_of,
    known_numbers,
    predicted,
    slopes_of,
)
from shipcosim.diagnose.sea_trials.features import (
    ANGLES,
    FEATURES,
    SOUGHT,
    covariance_of,
    is_logarithm,
)
from shipcosim.diagnose.sea_trials.manoeuvres import as_trials, catalogue
from shipcosim.diagnose.ship.model import ShipModel

_PART = 0.3  # of a standard deviation, by which known numbers are moved


def separations(evidence: TrialEvidence, sets: Sequence[SetOfCauses]) -> list[Separation]:
    """What each manoeuvre of the catalogue would tell of sets of causes that fit sea trials alike.

    The first set's ship sails them; the ships of all sets are simulated on the same orders. Their parameters and the
    known numbers are as free as the trials left them, and so are causes that the trials said nothing of. The current,
    the compass and the antenna are those of another day. Of both sets being true the smaller difference counts.

    Parameters
    ----------
    evidence : TrialEvidence
        Of the trials that were sailed.
    sets : sequence of SetOfCauses
        Those to tell apart, the best first; no more than four are compared.

    Returns
    -------
    list of Separation
        Best first: by the log-evidence of the closest pair.
    """
    # Sail each manoeuvre with the best set's ship, then simulate all sets on the same orders.
    sets = list(sets)[:MOST_SETS]
    model = evidence.model
    # Largest shaft speed of each thruster in the trials, as the median of a trial. [rev/s]
    shafts = {
        name: max(float(np.median(abs(trial.units[name][0]))) for trial in evidence.trials)
        for name in model.thrusters
    }
    planned = as_trials(catalogue(model), model, shafts, changes_of(sets[0]))
    trials = [trial for _, pair in planned for trial in pair]
    there = slopes_of(trials, model, sets)
    # Numbers that stay uncertain: known ones, and causes that the trials said nothing of.
    numbers = known_numbers(model)
    untold = _untold(evidence, sets)
    sizes = [{path: size} for path, size in numbers] + [
        dict.fromkeys(p.paths, p.typical) for _, p in untold
    ]
    first = changes_of(sets[0])
    # Slopes of the new features by them, by forward differences about the best set.
    moved = [
        first | {path: first.get(path, 0.0) + _PART * size for path, size in step.items()}
        for step in sizes
    ]
    slopes_of_ship = (predicted(trials, model, moved) - there[0][0]) / _PART
    # What the trials said constrains sets and numbers: predict the new features from that
    # posterior.
    with_untold = replace(
        evidence,
        ship_slopes=np.vstack((evidence.ship_slopes, *(evidence.slopes[i] for i, _ in untold))),
    )
    spread = evidence.scale**2 * blocks([covariance_of(trial, model.length) for trial in trials])
    of_day = np.array([ShipModel.is_of_day(path) for size in sizes for path in list(size)[:1]])
    priors = [
        _prediction(with_untold, at_trials, here, slopes_of_ship, of_day, spread)
        for at_trials, here in zip(slopes_of(evidence.trials, model, sets), there, strict=True)
    ]
    results = []
    at = 0
    for manoeuvre, pair in planned:
        names = [(trial.kind, trial.side, name) for trial in pair for name in FEATURES[trial.kind]]
        part = slice(at, at + len(names))
        at += len(names)
        # Expected lead for each pair of sets, on the features of this manoeuvre.
        pairs = {
            (a, b): _apart(priors[a], priors[b], part, names)
            for a, b in combinations(range(len(sets)), 2)
        }
        minutes = float(sum(trial.logged[1] + _approach(trial, model) for trial in pair)) / 60.0
        results.append(
            Separation(
                manoeuvre.name,
                round(minutes, 1),
                {key: nats for key, (nats, _) in pairs.items()},
                manoeuvre.kind in SOUGHT,
                {key: telling for key, (_, telling) in pairs.items()},
            )
        )
    return sorted(results, key=lambda result: -result.least)


def _untold(evidence, sets):
    """Parameters of causes in no set that the trials said next to nothing of: allowed for at their typical size."""
    held = {cause.label for cause_set in sets for cause in cause_set.hypotheses}
    pairs = [(cause, parameter) for cause in evidence.hypotheses for parameter in cause.parameters]
    # Information on each parameter: the sum of squares of its whitened slopes.
    white = np.linalg.solve(np.linalg.cholesky(evidence.covariance), evidence.slopes.T)
    information = np.sum(white**2, axis=0)
    return [
        (i, parameter)
        for i, (cause, parameter) in enumerate(pairs)
        if cause.label not in held and information[i] < thresholds.UNTOLD
    ]


def _approach(trial, model):
    """Time of the straight run before a manoeuvre. [s]"""
    return thresholds.SETTLED * model.length / np.hypot(*trial.measured[0, 3:5])


def _prediction(evidence, at_trials, here, ship_slopes, of_day, spread):
    """Features of new trials by a set, and their covariance: by the posterior of the trials that were sailed."""
    features, slopes = at_trials
    # Posterior covariance of parameters and numbers with unit prior: (I + A R^-1 A')^-1.
    columns = np.vstack((slopes, evidence.ship_slopes))
    weighted = columns @ np.linalg.inv(evidence.noise)
    P = np.linalg.inv(np.eye(len(columns)) + weighted @ columns.T)
    mean = (P @ weighted @ (evidence.measured - features))[len(slopes) :]
    # Current, compass and antenna are of another day: they keep their prior, the rest the
    # posterior.
    lasting = np.concatenate((np.ones(len(slopes), bool), ~of_day))
    new = np.vstack((here[1], ship_slopes))[lasting]
    C = (
        spread
        + new.T @ P[np.ix_(lasting, lasting)] @ new
        + ship_slopes[of_day].T @ ship_slopes[of_day]
    )
    return here[0] + (mean * ~of_day) @ ship_slopes, C


def _apart(first, other, part, names):
    """Log-evidence by which the right one of two is expected to lead, and the feature that says most."""
    (a, C_a) = first
    (b, C_b) = other
    d = (b - a)[part]
    separations = []
    # Expected log-evidence between two predictions: half the Mahalanobis distance; the smaller of
    # both being true.
    for C in (C_a[part, part], C_b[part, part]):
        separations.append((0.5 * float(d @ np.linalg.solve(C, d)), np.sqrt(np.diag(C))))
    nats, sigma = min(separations, key=lambda pair: pair[0])
    # The feature with the largest difference in standard deviations.
    best = int(np.argmax(abs(d) / sigma))
    kind, side, name = names[best]
    unit, factor = ("deg", np.degrees(1.0)) if name in ANGLES else ("%", 100.0)
    difference = np.expm1(d[best]) if is_logarithm(kind, name) else d[best]
    to = "to starboard" if side > 0 else "to port"
    telling = TellingFeature(
        f"{name} {to}", float(factor * difference), float(factor * sigma[best]), unit
    )
    return nats, telling
