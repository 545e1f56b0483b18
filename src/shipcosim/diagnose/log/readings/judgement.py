"""The likeliest readings of a log: combinations of changes, weighed by all relations at once and by their costs.

For each combination the relations say how likely it is: by what its form leaves unexplained, by how near the factor
found is to the one that it predicts, and by the sign of the yaw rate. A factor that is free
costs the width of its prior.
"""

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from shipcosim.diagnose.log.readings.changes import LogInterpretation, LogMistake
from shipcosim.diagnose.log.readings.fit import Relation
from shipcosim.diagnose.log.readings.wind import WindRelations
from shipcosim.diagnose.log.thresholds import (
    ANGLE_TOLERANCE,
    DRIFT,
    FAR_SHARE,
    GOES_AHEAD,
    GOES_ASTERN,
    ONE_COURSE,
    RATE_TOLERANCE,
    SCALE_TOLERANCE,
    UNEXPLAINED_COST,
    USUAL_SPEED,
    USUAL_STEP,
)

GRID = np.linspace(-5.0, 5.0, 101)


@dataclass(frozen=True)
class Evidence:
    """What the relations of a log say.

    Attributes
    ----------
    position : dict of (float, bool) to dict of str to Relation
        By the heading's unit as a factor and whether positions are degrees: each form's relation. Empty without any.
    rate : dict of float to Relation
        By the heading's unit: heading against yaw rate.
    wind : WindRelations
        The wind against velocity and heading.
    speed, step : float or None
        As logged, of the craft and from row to row. [m/s, s]
    courses : dict of float to dict of (bool, bool) to complex
        By the heading's unit: where the craft goes against her bow, see `LogInterpretation.course`.
    """

    position: dict[tuple[float, bool], dict[tuple[str, str], Relation]]
    rate: dict[float, Relation]
    wind: WindRelations = field(default_factory=lambda: WindRelations({}))
    speed: float | None = None
    step: float | None = None
    courses: dict[float, dict[tuple[bool, bool], complex]] = field(default_factory=dict)

    def relation_of(self, reading: LogInterpretation) -> Relation | None:
        """Relation of position and velocity under a reading."""
        return self.position.get((reading.heading_unit, reading.degrees), {}).get(reading.form)


@dataclass(frozen=True)
class Judged:
    """A combination of changes with its probability; `rate`: true seconds per logged second, with standard deviation.

    None of the changes, and of no probability in itself: something is wrong that no combination explains.
    """

    changes: tuple[LogMistake, ...]
    probability: float
    rate: tuple[float, float] = (1.0, 0.0)


def judged(
    evidence: Evidence, changes: Sequence[LogMistake], more: float = 0.0
) -> tuple[list[Judged], float]:
    """Combinations of up to two changes, likeliest first; and the probability that none of them explains the log.

    Parameters
    ----------
    evidence : Evidence
    changes : sequence of LogMistake
    more : float
        What any mistake costs more, as one of a part of a log does. [nats]
    """
    # Score each combination, and the hypothesis that none of them explains the log.
    best = _best_forms(evidence)
    tried = list(_combinations(changes))
    scored = [_score(combination, evidence) for combination in tried]
    wrong = np.array([bool(combination) for combination in tried] + [True])
    likely = np.array([*(score for score, _ in scored), best - UNEXPLAINED_COST]) - more * wrong
    # Posterior probabilities: the exponentials of the scores,
    # normalised. The largest is subtracted first to avoid overflow.
    shares = np.exp(likely - likely.max())
    shares = shares / shares.sum()
    weighed = [
        Judged(c, float(p), rate)
        for c, p, (_, rate) in zip(tried, shares[:-1], scored, strict=True)
    ]
    return sorted(weighed, key=lambda each: -each.probability), float(shares[-1])


def reading_of(combination: Sequence[LogMistake]) -> LogInterpretation:
    """The reading of a log with some changes."""
    reading = LogInterpretation()
    for change in combination:
        reading = change.apply(reading)
    return reading


def _combinations(changes) -> Iterator[tuple[LogMistake, ...]]:
    yield ()
    for change in changes:
        yield (change,)
    for first, other in combinations(changes, 2):
        if first.slot != other.slot:
            yield first, other


def _best_forms(evidence):
    """What the likeliest forms say, whatever their factors."""
    # The largest evidence of each relation, without any penalty on its factor or angle.
    position = max(
        (r.evidence for forms in evidence.position.values() for r in forms.values()), default=0.0
    )
    rate = max((r.evidence for r in evidence.rate.values()), default=0.0)
    usual = _usual(evidence.speed, 1.0, USUAL_SPEED) + _usual(evidence.step, 1.0, USUAL_STEP)
    return position + rate + usual


def _score(combination, evidence) -> tuple[float, tuple[float, float]]:
    """Log of the probability of a combination, except for a constant, and the rate of the clock with its deviation."""
    # Relations that belong to the units and forms of this combination.
    reading = reading_of(combination)
    cost = sum(change.cost for change in combination)
    relation = evidence.relation_of(reading)
    rate = evidence.rate.get(reading.heading_unit)
    # This heading or position cannot be compared, while another interpretation can: excluded.
    if (evidence.position and relation is None) or (evidence.rate and rate is None):
        return -np.inf, (1.0, 0.0)
    # Add the log-likelihoods of the relations: wind,
    # position with its angle and course, and yaw rate.
    score = evidence.wind.likelihood(
        reading, off_angle(relation, reading) if relation is not None else 0.0
    )
    # Deviations of the factors from what the combination
    # predicts, with a wide prior where a factor is free.
    slabs = {change.slab.of: change.slab.std for change in combination if change.slab}
    offs = []
    if relation is not None:
        off = relation.factor.real - reading.factor.real
        offs.append((off, relation.std[0], SCALE_TOLERANCE, slabs.get("velocity")))
        score += (
            relation.evidence
            + _angle(relation, reading)
            + _ahead(relation, reading, evidence.courses)
        )
    if rate is not None:
        # Whether heading and yaw rate go the same way, as evidence.
        agrees = (math.cos(rate.factor.imag) > 0.0) == (reading.rate_factor > 0.0)
        score += rate.evidence if agrees else 0.0
        off = rate.factor.real - math.log(abs(reading.rate_factor))
        offs.append((off, rate.std[0], RATE_TOLERANCE, slabs.get("rate")))
    # Usual speeds and time steps tell units apart that no relation between channels does.
    score += _usual(evidence.speed, abs(reading.velocity), USUAL_SPEED) + _usual(
        evidence.step, reading.time, USUAL_STEP
    )
    # A free clock rate is integrated out, as it scales both relations.
    factors, clock = _factors(offs, slabs.get("time"))
    return score + factors - cost, (reading.time * math.exp(clock[0]), reading.time * clock[1])


def _usual(logged, factor, usual):
    """Log-density of a speed or a step, against what is usual."""
    # Lognormal density of the logged value in the unit of this reading.
    if not logged or not np.isfinite(logged):
        return 0.0
    middle, spread = usual
    return -0.5 * (math.log(logged * factor / middle) / math.log(spread)) ** 2


def _angle(relation, reading):
    """Log-density of the angle of a factor that was found."""
    # A free angle has the density of a uniform prior over all directions.
    if "angle" in reading.free:
        return -math.log(2.0 * math.pi)
    return float(_log_density(off_angle(relation, reading), relation.std[1], ANGLE_TOLERANCE))


def _ahead(relation, reading, courses):
    """Log-density of the direction in which the craft goes against her bow, over that of any: most go ahead."""
    if reading.heading_unit not in courses:
        return 0.0
    # Mean course relative to the bow. Its length says
    # how constant it is; a changing course says nothing.
    course = reading.course(courses[reading.heading_unit], off_angle(relation, reading))
    if abs(course) < ONE_COURSE:
        return 0.0
    # Circular standard deviation of the course, widened by the usual drift angle.
    spread = math.hypot(DRIFT, math.sqrt(-2.0 * math.log(min(abs(course), 1.0))))
    # Mixture: most craft go ahead, some astern, the rest
    # in any direction; relative to the uniform density.
    shares = [
        share * 2.0 * math.pi * math.exp(_log_normal(off, spread))
        for share, off in ((GOES_AHEAD, cmath.phase(course)), (GOES_ASTERN, cmath.phase(-course)))
    ]
    return math.log(sum(shares) + 1.0 - GOES_AHEAD - GOES_ASTERN)


def off_angle(relation: Relation, reading: LogInterpretation) -> float:
    """Angle between the change of position and what a reading makes of the velocity. [rad]"""
    return math.remainder(relation.factor.imag - reading.factor.imag, 2.0 * math.pi)


def _factors(offs, slab):
    """Log-density of the factors found, and the logarithm of the clock's rate with its deviation where it is free."""
    # Without a free clock the densities of the factors multiply.
    if slab is None or not offs:
        return float(sum(_one_factor(*off) for off in offs)), (0.0, 0.0)
    # The clock rate adds the same logarithm to all factors. Its estimate is their weighted mean.
    stds = np.array([np.hypot(std, tolerance[0]) for _, std, tolerance, _ in offs])
    weights = stds**-2 / np.sum(stds**-2)
    centre = float(weights @ [off[0] for off in offs])
    spread = float(np.sum(stds**-2) ** -0.5)
    # Integrate the joint density over the clock rate on
    # a grid about this estimate; its prior is normal.
    at = centre + 2.0 * max(stds) * GRID
    log = sum(_one_factor(value - at, *others) for value, *others in offs) + _log_normal(at, slab)
    # Sum on the grid relative to the largest value, against underflow.
    top = float(log.max())
    return top + math.log(float(np.sum(np.exp(log - top))) * (at[1] - at[0])), (centre, spread)


def _one_factor(value, std, tolerance, free):
    # A free factor has the wide normal density of its
    # prior instead of the tolerance of instruments.
    return _log_density(value, std, tolerance) if free is None else _log_normal(value, free)


def _log_normal(value, std):
    """Logarithm of the normal density about zero."""
    return -0.5 * (value / std) ** 2 - math.log(std * math.sqrt(2.0 * math.pi))


def _log_density(value, std, tolerance):
    """Log-density of a deviation: measured uncertainty and the spread of instruments, of which a few differ more."""
    # Measured uncertainty and both tolerances of instruments: a mixture of two normal densities.
    near, far = (np.exp(_log_normal(value, math.hypot(std, width))) for width in tolerance)
    return np.log((1.0 - FAR_SHARE) * near + FAR_SHARE * far + 1e-300)
