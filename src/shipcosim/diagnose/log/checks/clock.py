"""Segments in which the clock runs wrong: positions and headings both go at another rate than speeds and yaw rates say.

With true seconds per logged second ρ, the way seen in a segment is ρ times the integral of the velocity over logged
time, in all channels. What holds for the whole log alike, such as a scale of the velocity, is fitted beside it.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.finding import Finding, ParameterEstimate, log_fault
from shipcosim.diagnose.log.checks.kinematics import (
    Filter,
    Motion,
    filter_for,
    heading_motion,
    is_clear,
    position_motion,
    whiteness,
)
from shipcosim.diagnose.log.thresholds import (
    CLOCK_CLIP,
    CLOCK_GAIN,
    CLOCK_REACH,
    CLOCK_SLAB,
    CLOCK_TOLERANCE,
    FEWEST_BLOCKS,
    LARGEST_SHARE,
    MOST_BLOCKS,
    MOST_SEGMENTS,
    PLAUSIBLE_RATES,
    RATE_UNSURE,
    ROUGHEST,
    SCALE_SLAB,
    SHORTEST_BLOCK,
)
from shipcosim.diagnose.numerics import Bands, running_sums, spline_integral

_AT_ONCE = (
    8  # columns that are whitened together, over the rows in which any of them is not nothing
)
_FORGOTTEN = 37.0  # nats: what is left after them is lost in rounding


@dataclass(frozen=True)
class _Side:
    """One comparison, of positions or of headings: its motion, filter and whitened rest (n, a).

    `scale`: (n * a,) whitened way of the whole log, by which a scale error of the velocity is projected out; less than
    of length 1 by the prior of that error. Until a row the filter has `forgotten` so many nats of what was before the
    first one.
    """

    motion: Motion
    whitener: Filter
    rest: np.ndarray
    scale: np.ndarray
    steps: np.ndarray
    rough: float
    forgotten: np.ndarray

    def column(self, first, last):
        """Whitened change (n * a, k) of the level by a clock that is wrong by 1 in each of k segments.

        It begins with the segment, and soon after it the filter has forgotten it; so it is sparse.
        """
        parts = [slice(k, k + _AT_ONCE) for k in range(0, len(first), _AT_ONCE)]
        return Bands(
            self.rest.size,
            [self._columns(np.asarray(first[p]), np.asarray(last[p])) for p in parts],
        )

    def _columns(self, first, last):
        """Columns of some segments that are near each other, from a row on."""
        # Rows from the start of the first segment until the filter has forgotten the last one.
        time = self.motion.time
        axes = self.rest.shape[1]
        begin = max(int(np.searchsorted(time, first.min(), side="right")) - 1, 0)
        over = min(int(np.searchsorted(time, last.max(), side="right")), time.size - 1)
        rows = slice(
            begin, int(np.searchsorted(self.forgotten, self.forgotten[over] + _FORGOTTEN)) + 1
        )
        # Way made inside each segment: a rate wrong by 1 adds all of it to the level.
        inner = (time[rows, None] > first) & (time[rows, None] <= last)
        ways = np.cumsum(self.steps[rows, :, None] * inner[:, None, :], axis=0)
        # Whiten with the part of the filter that belongs to these rows.
        whitener = replace(
            self.whitener, gains=self.whitener.gains[rows], scale=self.whitener.scale[rows]
        )
        return begin * axes, whitener(ways).reshape(-1, first.size)

    def match(self, columns):
        """Match of columns with the rest, beside the scale of the whole log, (k,)."""
        rest = self.rest.ravel()
        shared = columns.with_series(self.scale)
        return (columns.with_series(rest) - shared * (self.scale @ rest)) / self.rough

    def gram(self, columns):
        """Gram matrix of columns, beside the scale of the whole log, (k, k)."""
        shared = columns.with_series(self.scale)
        return (columns.products() - np.outer(shared, shared)) / self.rough

    def energy(self, columns):
        """Diagonal of the Gram matrix, (k,)."""
        return (columns.squares() - columns.with_series(self.scale) ** 2) / self.rough

    def alone(self, first, last):
        """Rate error of a segment by this comparison alone, its standard deviation, and its whitened column."""
        column = self.column([first], [last])
        energy = max(float(self.energy(column)[0]), 1e-9)
        return float(self.match(column)[0]) / energy, energy**-0.5, column


@dataclass(frozen=True)
class _Segment:
    """A segment of wrong clock: evidence, ρ - 1 with standard deviation, and both for each side alone."""

    first: float
    last: float
    gain: float
    value: float
    std: float
    apart: tuple[tuple[float, float], ...]


def wrong_clock(log: dict) -> list[Finding]:
    """Segments of a wrong clock; segments of one rate are one finding.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; labels corrected.
    """
    # Positions and headings, each where the motion stands clear of the noise.
    sides = [
        _side(motion)
        for motion in (position_motion(log), heading_motion(log))
        if motion is not None
    ]
    sides = [side for side in sides if is_clear(side.motion, side.whitener)]
    if not sides:
        return []
    # Divide the log into blocks, with one whitened regressor
    # for each. A run of blocks is the sum of theirs.
    edges = _block_edges(sides)
    blocks = [side.column(edges[:-1], edges[1:]) for side in sides]
    gram = sum(side.gram(columns) for side, columns in zip(sides, blocks, strict=True))
    # Greedy search: find the segment with most evidence, subtract its effect, and repeat.
    segments = []
    for _ in range(MOST_SEGMENTS):
        segment = _best(sides, blocks, gram, edges)
        if segment is None:
            break
        segments.append(segment)
        sides = [_explained(side, segment) for side in sides]
    # Residuals that remain correlated mean a model error, against which no segment can be trusted.
    if max(whiteness(side.rest) for side in sides) > ROUGHEST:
        return []
    # A segment needs both comparisons, or one of them and the rate of such a segment.
    sure = [s for s in segments if _is_said_by_both(s)]
    similar = [s for s in segments if s not in sure and _is_like(s, sure)]
    return _findings([*sure, *similar])


def _block_edges(sides):
    start = min(s.motion.time[0] for s in sides)
    end = max(s.motion.time[-1] for s in sides)
    count = int(np.clip((end - start) / SHORTEST_BLOCK, 2 * FEWEST_BLOCKS, MOST_BLOCKS))
    return np.linspace(start, end, count + 1)


def _side(motion):
    # Innovations of the level, clipped against outliers.
    whitener = filter_for(motion)[0]
    rest = np.clip(whitener(motion.level), -CLOCK_CLIP, CLOCK_CLIP)
    # The way that a wrong clock adds, from the smoothed
    # velocity: its noise would correlate with the level.
    way = spline_integral(motion.time, motion.slow(motion.velocity))
    # A filter of gain K forgets a factor 1 - K in each row; the sum counts it in nats.
    forgotten = np.cumsum(-np.log(np.maximum(1.0 - whitener.gains, np.exp(-_FORGOTTEN))))
    steps = np.diff(way, axis=0, prepend=way[:1])
    # Regularised least squares of a scale error of the velocity in the whole log.
    scale = whitener(way).ravel()
    scale /= np.sqrt(np.sum(scale**2) + SCALE_SLAB[rest.shape[1]] ** -2)
    return _Side(motion, whitener, rest, scale, steps, whiteness(rest), forgotten)


def _explained(side, segment):
    """The side without what the segment explains."""
    # Least-squares estimate of the rate error, subtracted from the residuals.
    value, _, column = side.alone(segment.first, segment.last)
    return replace(side, rest=side.rest - value * column.dense().reshape(side.rest.shape))


def _best(sides, blocks, gram, edges):
    """The segment with most evidence, None where there is too little."""
    # Evidence of all runs of blocks at once, from cumulated sums.
    count = len(edges) - 1
    match = np.sum([side.match(c) for side, c in zip(sides, blocks, strict=True)], axis=0)
    span = differences(np.arange(count + 1))
    nats, value, _ = evidence_of_rate(*sums_of_runs(match, gram))
    # Exclude runs that are too short, too long for
    # part of a log, or off by less than the tolerance.
    nats[
        (span < FEWEST_BLOCKS) | (span > LARGEST_SHARE * count) | (np.abs(value) < CLOCK_TOLERANCE)
    ] = -np.inf
    first, last = np.unravel_index(np.argmax(nats), nats.shape)
    # Both ends were chosen among all edges: a Bonferroni cost of two logarithms of their number.
    cost = 2.0 * np.log(count)
    if not nats[first, last] - cost > CLOCK_GAIN:
        return None
    return _refined(sides, edges[first], edges[last], cost)


def differences(values: np.ndarray) -> np.ndarray:
    """By how much the value of each column is above that of each row, (n, n)."""
    return values[None, :] - values[:, None]


def sums_of_runs(match: np.ndarray, gram: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Match and energy of all runs of blocks from an edge (row) to another (column)."""
    # With the double cumulated sum G of the Gram matrix, the
    # energy of blocks i to j is G_ii + G_jj - G_ij - G_ji.
    grams = np.pad(np.cumsum(np.cumsum(gram, axis=0), axis=1), ((1, 0), (1, 0)))
    on_diagonal = np.diag(grams)
    return (
        differences(running_sums(match)),
        on_diagonal[None, :] + on_diagonal[:, None] - grams - grams.T,
    )


def evidence_of_rate(match: Any, energy: Any) -> tuple[Any, Any, Any]:
    """Nats, estimate and standard deviation of ρ - 1 from the match of a column with the data and its energy.

    Both are floats, or arrays of one shape.
    """
    # Bayes factor of a normal prior of width CLOCK_SLAB against a rate of exactly 1.
    precision = np.maximum(energy, 0.0) + CLOCK_SLAB**-2
    nats = 0.5 * match**2 / precision - 0.5 * np.log(precision * CLOCK_SLAB**2)
    return nats, match / precision, precision**-0.5


def _refined(sides, first, last, cost):
    """The segment with its ends at the largest evidence."""
    time = sides[0].motion.time
    # Coarse then fine search: move one end at a time to the place of most evidence.
    for reach, stride in ((3 * CLOCK_REACH, 6), (CLOCK_REACH // 2, 1)):
        for end in (0, 1):
            near = np.abs(np.searchsorted(time, (first, last)[end]) - np.arange(len(time))) <= reach
            right = (
                time < last if end == 0 else time > first
            )  # rows may be so far apart that the other end is near
            places = time[near & right][::stride]
            ends = [np.full_like(places, first), np.full_like(places, last)]
            ends[end] = places
            nats = evidence_of_rate(*_joint(sides, *ends))[0]
            # The coarse search takes the best place, the fine one the median of the posterior.
            place = float(places[np.argmax(nats)]) if stride > 1 else _middle(places, nats)
            first, last = (place, last) if end == 0 else (first, place)
    # Final estimate from both comparisons jointly, and from each alone.
    nats, value, std = (float(x[0]) for x in evidence_of_rate(*_joint(sides, [first], [last])))
    apart = tuple(side.alone(first, last)[:2] for side in sides)
    return _Segment(first, last, nats - cost, value, std, apart)


def _middle(places, nats):
    """Median place by the evidence of each: where a ship hardly moves, an end can be anywhere."""
    weights = np.cumsum(np.exp(nats - nats.max()))
    return float(places[np.searchsorted(weights, 0.5 * weights[-1])])


def _joint(sides, firsts, lasts):
    columns = [side.column(firsts, lasts) for side in sides]
    energy = sum(side.energy(c) for side, c in zip(sides, columns, strict=True))
    return sum(side.match(c) for side, c in zip(sides, columns, strict=True)), energy


def _is_said_by_both(segment):
    """Whether positions and headings both say so, by about the same rate: a single side can have a fault of its own."""
    # Each comparison alone must show a clear part of the joint estimate.
    telling = [
        value / segment.value > 0.4 and abs(value) > 2.5 * std for value, std in segment.apart
    ]
    plausible = PLAUSIBLE_RATES[0] < 1.0 + segment.value < PLAUSIBLE_RATES[1]
    return plausible and len(telling) == 2 and all(telling) and _agree(segment.apart, segment.value)


def _is_like(segment, sure):
    """Whether a segment that only one relation shows has the rate of one that both relations show."""
    return any(
        abs(segment.value - other.value) < 3.0 * np.hypot(segment.std, other.std)
        and _agree(segment.apart, other.value)
        for other in sure
    )


def _agree(apart, rate):
    return all(abs(value - rate) < 3.0 * std + 0.3 * abs(rate) for value, std in apart)


def _findings(segments):
    findings = []
    # Group segments of equal rate around the one with most evidence.
    while segments:
        lead = max(segments, key=lambda s: s.gain)
        same = [
            s
            for s in segments
            if abs(s.value - lead.value) < 3.0 * np.hypot(s.std, lead.std) + 0.02
        ]
        segments = [s for s in segments if s not in same]
        # Common rate: mean weighted by inverse variances.
        weight = np.array([s.std**-2 for s in same])
        rate = 1.0 + float(weight @ [s.value for s in same] / weight.sum())
        spans = tuple(sorted((s.first, s.last) for s in same))
        # Logistic function of the evidence; the rate has a model error besides its statistical one.
        probability = float(0.98 / (1.0 + np.exp(-lead.gain)))
        std = float(np.hypot(weight.sum() ** -0.5, RATE_UNSURE * abs(rate - 1.0)))
        rates = {"rate": ParameterEstimate(rate, std, "1")}
        note = "positions and headings go at another rate than speeds and yaw rates say"
        findings.append(log_fault("clock", ("time",), note, spans, probability, rates))
    return findings
