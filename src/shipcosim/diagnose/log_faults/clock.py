"""Segments in which the clock runs wrong, found from how the ship responds to thrusters and wind.

With ρ true seconds per logged second, a step moves the ship ρ times as far, and changes her velocity ρ times as much.
Each block of a log has a column for its own ρ; where a run of blocks agrees on one, the clock was wrong.
"""

from dataclasses import dataclass, replace

import numpy as np
import xarray

from shipcosim.diagnose.finding import Finding, ParameterEstimate, log_fault
from shipcosim.diagnose.inference.fitting import IdentificationProblem, Regressor, fitted, prepared
from shipcosim.diagnose.inference.linearisation import rows_first
from shipcosim.diagnose.inference.parts import with_columns
from shipcosim.diagnose.inference.screening import screened
from shipcosim.diagnose.log.checks.clock import differences, evidence_of_rate, sums_of_runs
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log_faults.thresholds import (
    ASPECT_APART,
    ASPECT_CHANCE,
    CLOCK_BLOCK,
    CLOCK_GAIN,
    END_BLOCK,
    ENDS_TRIED,
    LARGEST_SHARE,
    MOST_BLOCKS,
    MOST_SEGMENTS,
    MOTION_GAIN,
    OVER_CAUSE,
    PLAUSIBLE_RATES,
    RATE_UNSURE,
    SHORTEST_CLOCK,
    SMALLEST_RATE,
    TYPICAL_RATE,
    TYPICAL_SEGMENT,
)
from shipcosim.diagnose.numerics import running_sums, runs, survival
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.models.core.motion import Motion

ASPECTS = [0, 1], [3, 4], [2], [5]  # states of the motion: way and speed, heading and rate of turn
_OF_MOTION = [0, 2]  # the aspects that are motion alone: way and heading


@dataclass(frozen=True)
class _Blocks:
    """Match of each block's column with the log, and the columns' Gram matrix, known numbers integrated out."""

    edges: np.ndarray
    match: np.ndarray
    gram: np.ndarray


def clock_by_response(problem: IdentificationProblem) -> Finding | None:
    """A clock that runs wrong at one rate in a segment or two, if nothing else explains as much.

    Parameters
    ----------
    problem : IdentificationProblem

    Returns
    -------
    Finding or None
    """
    # Evidence for a wrong clock, with the uncertain parameters of the model integrated out.
    of_ship = problem.ship_columns(())
    edges = _edges(problem)
    gain, finding = _most_likely(_blocks(problem, edges, of_ship))
    if finding is None:
        return None
    # The likeliest single cause is the rival. The clock must explain
    # more, and all aspects of the motion must agree on its rate.
    rival, hypothesis, values = screened(problem, fitted(problem))[0]
    if gain < rival + OVER_CAUSE or not _all_aspects_agree(problem, finding, of_ship):
        return None
    # If a cause explains something too, the clock must still be found beside the fitted cause.
    if rival > 0.0:
        fit = fitted(problem, (hypothesis,), values)
        with_cause = prepared(replace(problem, model=fit.model, motion=fit.motion))
        if _most_likely(_blocks(with_cause, edges, of_ship))[1] is None:
            return None
    return finding


def _all_aspects_agree(problem, finding, of_ship):
    """Whether distance, speed, heading and turning agree with one rate.

    A compass can be wrong alone, and so can a force: it changes the speed, but how far the ship comes at her speed
    is a matter of the clock.
    """
    # Regressors: the motion in the segments, separately for way, speed, heading and turning.
    here = inside(0.5 * (problem.record.time[:-1] + problem.record.time[1:]), finding.segments)
    moved = _moved(problem) * here[:, None]
    aspects = np.zeros((6, len(ASPECTS)))
    for aspect, states in enumerate(ASPECTS):
        aspects[states, aspect] = 1.0
    match, inner = _left(
        problem, of_ship, len(ASPECTS), lambda steps: -moved[steps, :, None] * aspects
    )
    # Rate of each aspect by least squares, with its covariance.
    covariance = np.linalg.pinv(inner)
    rates = covariance @ match
    claimed = finding.parameters["rate"].estimate - 1.0
    # How far she comes at her speed, and how far she turns at her rate, hang on no force: both by themselves
    # must prefer this rate to a right clock. Forces that the model lacks, as of swell, look like a rate of speed.
    mean, weight = _weighted_mean(rates[_OF_MOTION], covariance[np.ix_(_OF_MOTION, _OF_MOTION)])
    if 0.5 * weight.sum() * (mean**2 - (mean - claimed) ** 2) < MOTION_GAIN:
        return False
    # Chi-square test of equal rates, with some allowance for
    # model error; their common mean costs one degree of freedom.
    apart = ASPECT_APART * claimed
    mean, weight = _weighted_mean(rates, covariance + apart**2 * np.eye(len(ASPECTS)))
    rest = rates - mean
    return survival(rest @ weight @ rest, len(ASPECTS) - 1) > ASPECT_CHANCE


def _weighted_mean(rates, covariance):
    """The mean of rates with a covariance that has the least variance, and the inverse of that covariance."""
    weight = np.linalg.inv(covariance)
    return weight.sum(axis=0) @ rates / weight.sum(), weight


def settled_clock(problem: IdentificationProblem, finding: Finding, log: xarray.Dataset) -> Finding:
    """A finding on the clock, its ends and rate settled: the first are about a motion that the wrong clock has distorted.

    Parameters
    ----------
    problem : IdentificationProblem
        Of the log with the finding repaired.
    finding : Finding
    log : xarray.Dataset
        That log.
    """
    time = problem.record.time
    rate = finding.parameters["rate"]
    # The repaired log runs in true time, so the segments are converted to it. About each end are small blocks.
    logged, true = log["logged_time"].values, log["time"].values
    first_ends = np.interp(np.ravel(finding.segments), logged, true)
    near = first_ends[:, None] + END_BLOCK * np.arange(-ENDS_TRIED, ENDS_TRIED + 1)
    edges = np.unique(np.clip([time[0], *near.ravel(), time[-1]], time[0], time[-1]))
    blocks = _blocks(problem, edges, problem.ship_columns(()))
    sums = sums_of_runs(blocks.match, blocks.gram)
    ends = [
        _likeliest_end(edges, *sums, end, i % 2 == 1, rate.estimate)
        for i, end in enumerate(first_ends)
    ]
    # What is left of the rate's error, by regularised least squares in the rows that were corrected and should be.
    middles = 0.5 * (edges[1:] + edges[:-1])
    is_wrong = inside(middles, _segments(first_ends)) & inside(middles, _segments(ends))
    energy = blocks.gram[np.ix_(is_wrong, is_wrong)].sum()
    _, more, _ = evidence_of_rate(blocks.match[is_wrong].sum(), energy)
    return replace(
        finding,
        segments=_segments(np.interp(ends, true, logged)),
        parameters={"rate": replace(rate, estimate=float(rate.estimate * (1.0 + more)))},
    )


def _segments(ends):
    """Segments that begin and end at some times in turn."""
    return tuple((float(first), float(last)) for first, last in np.reshape(ends, (-1, 2)))


def _likeliest_end(edges, match, energy, end, is_last, rate):
    """The edge near the start, or the end, of a segment of wrong clock at which it is likeliest.

    Between the two the clock goes at the rate where the segment lacks these rows, and is over-corrected by it where the
    segment has them too much.
    """
    at = int(np.searchsorted(edges, end))
    is_before = np.arange(edges.size) < at
    error = np.where(is_before != is_last, rate, 1.0 / rate) - 1.0
    # A sum backwards from the end has the other sign.
    gain = error * np.where(is_before, -match[at], match[at]) - 0.5 * error**2 * energy[at]
    is_near = np.abs(edges - end) < (ENDS_TRIED + 0.5) * END_BLOCK
    return float(edges[np.argmax(np.where(is_near, gain, -np.inf))])


def is_testable(problem: IdentificationProblem) -> bool:
    """Whether a typical wrong clock, at any time of the log with even odds, would have gained enough to be seen."""
    # Expected gain of a typical wrong clock, if its rate
    # error stood in the data: match = rate times energy.
    blocks = _blocks(problem, _edges(problem), problem.ship_columns(()))
    count = len(blocks.edges) - 1
    span = max(int(TYPICAL_SEGMENT / (blocks.edges[1] - blocks.edges[0])), 1)
    energies = np.diagonal(sums_of_runs(blocks.match, blocks.gram)[1], offset=span)
    if not energies.size:  # the log is shorter than a typical segment
        return False
    energy = np.median(energies)
    nats, _, _ = evidence_of_rate(TYPICAL_RATE * energy, energy)
    return bool(nats - 2.0 * np.log(count) > CLOCK_GAIN)


def _edges(problem):
    """Even edges of blocks."""
    time = problem.record.time
    return np.linspace(
        time[0], time[-1], int(np.clip(np.ptp(time) / CLOCK_BLOCK, 4, MOST_BLOCKS)) + 1
    )


def _most_likely(blocks):
    """Gain of the likeliest runs of blocks, less the cost of choosing them, and the finding; 0 and None without."""
    # Evidence of each run of blocks, and which lengths are allowed.
    match, energy = sums_of_runs(blocks.match, blocks.gram)
    count = len(blocks.edges) - 1
    span = differences(np.arange(count + 1))
    block = blocks.edges[1] - blocks.edges[0]
    allowed = (span * block >= SHORTEST_CLOCK) & (span <= LARGEST_SHARE * count)
    cost = 2.0 * np.log(count)
    gain = value = std = 0.0
    is_wrong = np.zeros(count, bool)
    # Greedy search: add the run of blocks that gains most together with those that were chosen before, at a rate
    # common to all; or take a run out of these, which leaves two segments of them.
    for number in range(1, MOST_SEGMENTS + 1):
        of_wrong = differences(running_sums(is_wrong))
        sign = np.where(of_wrong > 0, -1.0, 1.0)
        shared = differences(running_sums(blocks.gram[:, is_wrong].sum(axis=1)))
        matches = blocks.match[is_wrong].sum() + sign * match
        energies = blocks.gram[np.ix_(is_wrong, is_wrong)].sum() + energy + 2.0 * sign * shared
        whole = allowed & ((of_wrong == 0) | (of_wrong == span))
        nats, *estimates = evidence_of_rate(matches, energies)
        most = np.argmax(np.where(whole, nats, -np.inf))
        first, last = at = np.unravel_index(most, match.shape)
        # Both ends of each run are chosen among all edges, which costs two logarithms of their number.
        if nats[at] - cost * number < gain + CLOCK_GAIN * (number == 1):
            break
        gain = nats[at] - cost * number
        value, std = (estimate[at] for estimate in estimates)
        is_wrong[first:last] ^= True
    if not PLAUSIBLE_RATES[0] < 1.0 + value < PLAUSIBLE_RATES[1] or abs(value) < SMALLEST_RATE:
        return 0.0, None
    # Segments are where it begins to be wrong and ends.
    segments = _segments(blocks.edges[runs(is_wrong)])
    rate = {
        "rate": ParameterEstimate(
            1.0 + float(value), float(np.hypot(std, RATE_UNSURE * value)), "1"
        )
    }
    note = "the ship answers thrusters and wind at another rate than logged"
    return float(gain), log_fault("clock", ("time",), note, segments, 0.98, rate)


def _blocks(problem, edges, columns: list[Regressor]):
    """The blocks of a log, from its innovations with a column for each; what other columns can explain is theirs."""
    count = len(edges) - 1
    # A block's regressor is what the ship moves in its steps: an error of the rate scales it.
    moved = _moved(problem)
    place = np.clip(
        np.searchsorted(edges, problem.record.time[:-1], side="right") - 1, 0, count - 1
    )
    blocks = np.arange(count)
    return _Blocks(
        edges,
        *_left(
            problem,
            columns,
            count,
            lambda steps: -moved[steps, :, None] * (place[steps, None, None] == blocks),
        ),
    )


def _moved(problem):
    """What each step moves the ship, (n-1, 6) array."""
    record = problem.record
    # Change of state at the middle of each step, by the equations of motion, times the step.
    middle = Motion(*(0.5 * (value[:-1] + value[1:]) for value in problem.motion))
    moved = record.step * rows_first(
        motion_rates(middle, record.inputs(problem.model, 0.5), problem.model)
    )
    return np.where(record.usable[:-1, None], moved, 0.0)


def _left(problem, columns, count, driven):
    """Match with the log of further columns and their Gram matrix, less what other columns explain.

    `driven` gives what they do in the steps from some rows on, a (k, 6, count) array.
    """
    others = len(columns)
    # Linear model with the uncertain parameters and the further regressors.
    linear = with_columns(
        problem.base_of(columns),
        count,
        lambda rows: (driven(rows), np.zeros((rows.stop - rows.start, 6, count))),
    )
    # Inner products of the whitened log and regressors; the first row belongs to the log.
    products = problem.gram(linear, parts=1).products
    theirs = slice(1, 1 + others)
    further = slice(1 + others, None)
    # Integrate the parameters out: the Schur complement, with their prior precisions.
    inner = products[theirs, theirs] + np.diag([column.prior**-2 for column in columns])
    left = products - products[:, theirs] @ np.linalg.solve(inner, products[theirs, :])
    return left[further, 0], left[further, further]
