"""The joint judgement of a log: which of its channels are not what they are labelled, or what is left open."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.finding import Finding, ParameterEstimate, log_fault
from shipcosim.diagnose.log.mislabels import (
    POSITION_IN_DEGREES,
    finding_of,
    turned_axes,
    turned_grid,
)
from shipcosim.diagnose.log.readings.changes import CLOCK, LogMistake, changes
from shipcosim.diagnose.log.readings.judgement import (
    Evidence,
    Judged,
    judged,
    off_angle,
    reading_of,
)
from shipcosim.diagnose.log.readings.relations import position_relations, rate_relations
from shipcosim.diagnose.log.readings.wind import wind_relations
from shipcosim.diagnose.log.roles import POSITION, VELOCITY
from shipcosim.diagnose.log.thresholds import (
    COMPASS_OFF,
    LEFT_OPEN,
    MOST_ALTERNATIVES,
    MOST_SURE,
    READING_SURE,
    UNLIKELY_READING,
)
from shipcosim.diagnose.numerics import finite, root_mean_square

NOTHING_ELSE = "nothing else is wrong"
ANOTHER_WAY = "the channels contradict each other in another way"
IN_PART = "only a part of the log is like that"
CONTRADICTION = "positions, heading, velocities and yaw rate contradict each other"
DEGREE = float(np.degrees(1.0))


class LabelJudgement(NamedTuple):
    """What is wrong throughout a log, by its labels and its time base.

    Attributes
    ----------
    findings : list of Finding
        What is sure; and what is left open, as one finding with `alternatives`.
    contradiction : Finding or None
        Channels contradict each other, and what is looked for explains it not throughout the log, or not at all. There
        are no findings then; a fault in a part of the log may be the reason.
    """

    findings: list[Finding]
    contradiction: Finding | None = None


def misread(log: dict, stated: dict[str, str], more: float = 0.0) -> LabelJudgement:
    """Mistakes of units, frames, signs and of the time base that hold throughout a log.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time`, increasing, and roles in their units as logged.
    stated : dict of str to str
        Units that headers or a channel file state, by role.
    more : float
        What any mistake costs more, as one of a part of a log does. [nats]
    """
    # The kinematic relations in the log; without any there is nothing to compare.
    evidence = evidence_of(log)
    if not evidence.position and not evidence.rate:
        return LabelJudgement([])  # what is usual alone says nothing
    # Posterior of all combinations of mistakes.
    readings, unexplained = judged(evidence, changes(stated), more)
    throughout = _holds_throughout(readings[0], evidence)
    if throughout and unexplained < LEFT_OPEN:
        angle = _angle(readings[0], evidence, "latitude" in stated)
        return LabelJudgement(_findings(readings, unexplained, angle))
    # A heading that cannot be followed as it is labelled contradicts nothing: its rows may be too far apart.
    followed = (not evidence.position or (1.0, False) in evidence.position) and (
        not evidence.rate or 1.0 in evidence.rate
    )
    return LabelJudgement(
        [], _contradiction(readings, unexplained, throughout) if followed else None
    )


def explained(log: dict) -> float:
    """How much likelier the relations are than none, each read in the way that suits it best. [nats]

    Parameters
    ----------
    log : dict of (n,) arrays
        As in `misread`.
    """
    evidence = evidence_of(log)
    position = [
        relation.evidence for forms in evidence.position.values() for relation in forms.values()
    ]
    return max(position, default=0.0) + max(
        (relation.evidence for relation in evidence.rate.values()), default=0.0
    )


def is_as_labelled(log: dict, stated: dict[str, str]) -> bool:
    """Whether the logged labels are the likeliest reading, apart from the clock.

    Parameters
    ----------
    log : dict of (n,) arrays
        As in `misread`.
    stated : dict of str to str
    """
    readings, unexplained = judged(evidence_of(log), changes(stated))
    # A wrong clock does not concern the labels.
    labels_only = [change for change in readings[0].changes if change.slot != "time"]
    return not labels_only and unexplained < LEFT_OPEN


def evidence_of(log: dict) -> Evidence:
    """What the relations of a log say, for each way to read heading and position.

    Parameters
    ----------
    log : dict of (n,) arrays
        As in `misread`.
    """
    if "heading" not in log:
        return Evidence({}, {})
    # The heading as logged, and read as radians or as degrees instead.
    headings = {unit: unit * log["heading"] for unit in (1.0, DEGREE, 1.0 / DEGREE)}
    # Heading against the integral of the yaw rate.
    rate = rate_relations(log, headings)
    position = {}
    speed = None
    courses = {}
    # Position against the integral of the velocity, with positions in metres or in degrees.
    if {"north", "east", "surge", "sway"} <= set(log):
        positions = {False: log["north"] + 1j * log["east"]}
        if _can_be_degrees(log):
            metres = POSITION_IN_DEGREES.undo(log)
            positions[True] = metres["north"] + 1j * metres["east"]
        position = position_relations(log, headings, positions)
        # Size and direction of the velocity: usual values
        # tell readings apart that the relations do not.
        speeds = np.hypot(log["surge"], log["sway"])
        speeds = finite(speeds)
        speed = root_mean_square(speeds) if speeds.size else None
        courses = {
            unit: _courses(log["surge"] + 1j * log["sway"], values)
            for unit, values in headings.items()
        }
    # Only headings that can be followed from row to row are compared with the wind.
    units = {*rate, *(unit for unit, _ in position)}
    followed = {unit: heading for unit, heading in headings.items() if unit in units}
    return Evidence(
        position,
        rate,
        wind_relations(log, followed),
        speed,
        float(np.median(np.diff(log["time"]))),
        courses,
    )


def _courses(velocity, heading):
    """Mean direction of the velocity against the bow, as `Reading.course` takes it; fast rows count for more."""
    turn = np.exp(1j * np.radians(heading))
    velocity, turn = (
        series[np.isfinite(velocity) & np.isfinite(turn)] for series in (velocity, turn)
    )
    # Weights by speed: at low speed the direction is mostly
    # noise. The length is 1 for a constant direction.
    weights = np.abs(velocity)
    energy = max(float(np.sum(np.abs(velocity) ** 2)), 1e-300)
    # Velocity as logged, and turned back from the earth with the heading as it is or mirrored.
    ways = {(False, False): 1.0, (True, False): np.conj(turn), (True, True): turn}
    return {way: complex(np.sum(weights * velocity * of) / energy) for way, of in ways.items()}


def _can_be_degrees(log):
    north, east = (log[role][np.isfinite(log[role])] for role in ("north", "east"))
    if not len(north) or not len(east):
        return False
    return bool(
        np.abs(north).max() <= 90.0
        and np.abs(east).max() <= 180.0
        and max(np.ptp(north), np.ptp(east)) < 5.0
    )


def _holds_throughout(best, evidence):
    """Whether a reading holds in the whole log, not in the larger part of it, by the relations of what it changes."""
    # Relations concern the best reading only through the channels that it changes.
    reading = reading_of(best.changes)
    changed = {role for change in best.changes for role in change.channels}
    relations = [(evidence.relation_of(reading), {*POSITION, *VELOCITY, "heading", "time"})]
    # With both signs wrong, heading and yaw rate agree as they are labelled: they do not tell.
    if not ({"heading", "yaw_rate"} <= changed and reading.rate_factor == 1.0):
        relations.append((evidence.rate.get(reading.heading_unit), {"yaw_rate", "heading", "time"}))
    return all(
        relation.throughout
        for relation, roles in relations
        if relation is not None and (roles & changed or not changed)
    )


def _angle(best, evidence, is_geodetic):
    """By how much the grid or the axes of the velocity are turned; None where that is not known, or not the cause."""
    # An angle is estimated only where it is free, and unique only without mirrored axes.
    reading = reading_of(best.changes)
    relation = evidence.relation_of(reading)
    axes = "axes" in reading.free
    mirrored = reading.mirrored & ({"position", "velocity"} if axes else {"position"})
    if relation is None or "angle" not in reading.free or mirrored:
        return None
    angle = ParameterEstimate(
        float(np.degrees(off_angle(relation, reading))), float(np.degrees(relation.std[1])), "deg"
    )
    # Larger than any error of a compass, the angle must be one of the grid. Positions
    # that were converted from latitude and longitude have no grid that could be turned.
    grid = abs(angle.estimate) > COMPASS_OFF and not is_geodetic
    return angle if axes or grid else None


def _findings(
    readings: list[Judged], unexplained: float, angle: ParameterEstimate | None
) -> list[Finding]:
    """Findings of the changes that are sure, and one of what is left open; `angle`: of a frame that can be corrected."""
    # Marginal probability of each mistake: the sum over all combinations that contain it.
    readings = _with_known_rates(readings)
    shares: dict[str, float] = {}
    for reading in readings:
        for change in reading.changes:
            shares[change.sentence] = shares.get(change.sentence, 0.0) + reading.probability
    first = _likeliest(readings)
    # Sure mistakes are findings of their own, unless another cause looks the same.
    sure = [
        sentence
        for sentence, share in shares.items()
        if share > READING_SURE and (not first[sentence].or_else or angle)
    ]
    findings = [_named(first[sentence], shares[sentence], readings, angle) for sentence in sure]
    remaining, rates = _rests(readings, sure)
    # The rest may well be nothing, and is not reported then.
    if unexplained + remaining.get((), 0.0) > LEFT_OPEN:
        return findings
    return [
        *findings,
        _left_open(remaining, rates, [ANOTHER_WAY] * (unexplained > UNLIKELY_READING)),
    ]


def _likeliest(readings):
    """By sentence: the change of its likeliest combination."""
    return {change.sentence: change for reading in reversed(readings) for change in reading.changes}


def _rests(readings, sure):
    """What remains besides the sure mistakes, with its probability and its rate of the clock."""
    first = _likeliest(readings)
    remaining: dict[tuple[LogMistake, ...], float] = {}
    rates: dict[tuple[LogMistake, ...], float] = {}
    for reading in readings:
        sentences = [change.sentence for change in reading.changes]
        if set(sure) <= set(sentences):
            rest = tuple(first[sentence] for sentence in sentences if sentence not in sure)
            remaining[rest] = remaining.get(rest, 0.0) + reading.probability
            rates.setdefault(rest, reading.rate[0])
    return remaining, rates


def _contradiction(readings, unexplained, throughout):
    """What is left open where nothing is sure throughout a log; None where the log as labelled is not unlikely."""
    if sum(reading.probability for reading in readings if not reading.changes) > UNLIKELY_READING:
        return None
    if unexplained > 1.0 - UNLIKELY_READING:
        channels = (*POSITION, "heading", *VELOCITY, "yaw_rate")
        note = f"{CONTRADICTION}: more than two labels are wrong"
        fault = log_fault("frame", channels, note, probability=min(unexplained, MOST_SURE))
        return replace(fault, alternatives=("one of the sensors is wrong",))
    readings = _with_known_rates(readings)
    remaining, rates = _rests(readings, [])
    others = [ANOTHER_WAY] * (unexplained > UNLIKELY_READING) + [IN_PART] * (not throughout)
    return _left_open(remaining, rates, others)


def _with_known_rates(readings):
    """Readings in which a clock of any rate is one of a usual rate, where that explains as much."""
    # Likeliest combination for each set of other changes that has a clock of a usual wrong rate.
    usual = {
        _beside_clock(reading): reading
        for reading in reversed(readings)
        if _clock_of(reading) not in (None, CLOCK)
    }
    with_rates = []
    # A free clock rate within 3 standard errors of a usual one is replaced by the usual one.
    for reading in readings:
        other = usual.get(_beside_clock(reading)) if _clock_of(reading) == CLOCK else None
        if (
            other is not None
            and abs(np.log(reading.rate[0] / other.rate[0]))
            < 3.0 * reading.rate[1] / reading.rate[0]
        ):
            reading = replace(other, probability=reading.probability)
        with_rates.append(reading)
    return sorted(with_rates, key=lambda entry: -entry.probability)


def _clock_of(reading):
    return next((change.sentence for change in reading.changes if change.slot == "time"), None)


def _beside_clock(reading):
    return frozenset(change.sentence for change in reading.changes if change.slot != "time")


def _named(change, probability, readings, angle):
    """The finding of one change."""
    # No probability of 1: the priors are assumed.
    probability = min(probability, MOST_SURE)
    # An angle near half a turn is also two wrong signs.
    if change.or_else:
        both = "both have the other sign, or " if abs(angle.estimate) > 180.0 - COMPASS_OFF else ""
        message = f"{change.sentence}; it looks the same if {both}{' or '.join(change.or_else)}"
        return replace(
            finding_of(turned_grid(angle.estimate), probability),
            parameters={"angle": angle},
            note=message,
        )
    if change.slot == "time":
        return replace(_clock(change, readings), probability=probability)
    if change.mislabel is not None:
        return finding_of(change.mislabel, probability)
    # Only the turned axes of the velocity are left. Without a known angle they cannot be corrected.
    if angle is None:
        return log_fault(change.cause, change.channels, change.sentence, probability=probability)
    turned = finding_of(turned_axes(angle.estimate), probability)
    return replace(turned, parameters={"angle": angle})


def _clock(change, readings):
    rate, std = next(reading.rate for reading in readings if change in reading.changes)
    rates = {"rate": ParameterEstimate(float(rate), float(std), "1")}
    return log_fault("clock", ("time",), change.sentence, parameters=rates)


def _left_open(remaining, rates, besides):
    """One finding of readings that explain a log equally well: the likeliest, and others and `besides` as alternatives."""
    # The likeliest non-empty set leads; the others are its alternatives.
    (first, share), *others = sorted(remaining.items(), key=lambda entry: (not entry[0], -entry[1]))
    words = {rest: _words(rest, rates[rest]) for rest in remaining}
    # Keep those that are not unlikely, and at least one.
    likely = [rest for rest, p in others if p > UNLIKELY_READING] or [
        rest for rest, _ in others[:1]
    ]
    other_ways = [sentence for change in first for sentence in change.or_else]
    other_ways += [words[rest] or NOTHING_ELSE for rest in likely if words[rest] != words[first]]
    channels = tuple(dict.fromkeys(role for change in first for role in change.channels))
    # What this log or no log can tell apart from it shares the probability.
    share = share / (1 + len(first[0].or_else) + len(besides))
    alternatives = tuple(dict.fromkeys(other_ways))[: MOST_ALTERNATIVES - len(besides)]
    return Finding(
        first[0].cause,
        None,
        "data",
        share,
        {},
        (),
        channels,
        note=words[first],
        alternatives=(*alternatives, *besides),
    )


def _words(rest, rate):
    """A reading in words, with the rate of a clock that can have any."""
    sentences = (
        f"{c.sentence}, {rate:.3g} s in each logged second" if c.sentence == CLOCK else c.sentence
        for c in rest
    )
    return " and ".join(sentences)
