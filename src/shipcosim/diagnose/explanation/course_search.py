"""Causes that begin, grow, or come and go: a size over time, weighed against one that is the same all along.

All rows stay in and the ship's numbers are common to them: only the cause has a course. A cause of size θ with the
course c(t) does what its columns do, times c(t), as they are linear in θ.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, combinations, islice
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.explanation.course import (
    KINDS,
    RAMP,
    SPELL,
    STEP,
    SWITCHING,
    Course,
    CourseFound,
    SizeOverTime,
)
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.explanation.search import ExplainedLog, without_causes
from shipcosim.diagnose.explanation.unmodelled import unmodelled_gains
from shipcosim.diagnose.explanation.verdict import admissible
from shipcosim.diagnose.finding import Candidate, Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import (
    Fit,
    IdentificationProblem,
    bounded,
    deviations,
    fitted,
    fitted_beside,
    own_columns,
    prepared,
    theta_of,
)
from shipcosim.diagnose.inference.innovations import Noise, innovations
from shipcosim.diagnose.inference.linearisation import Regressor, moved
from shipcosim.diagnose.inference.parts import InParts, beside, linearised_by_parts
from shipcosim.diagnose.inference.problem import identification_problem, tuned_noise
from shipcosim.diagnose.inference.regressors import placed, regressors_of, screening_regressors
from shipcosim.diagnose.inference.thresholds import (
    APART,
    CALM_WALK,
    COURSE_BLOCK,
    COURSE_GAIN,
    DEVIATIONS,
    ENOUGH,
    EXPLAINED_WALK,
    FORM_COST,
    LIKELIEST_COURSES,
    MEASURED_WHILE_PRESENT,
    MOST_COURSE_BLOCKS,
    ROUNDS_OF_COURSE,
    SHORTEST_SPELL,
    SIZES_OVER_TIME,
    WALK_IN_YAW,
)
from shipcosim.diagnose.inference.workers import each
from shipcosim.errors import ShipcosimError


class _Try(NamedTuple):
    """A cause with a course on top of a fit, and its score; `occam` is what the search over the kind's times costs."""

    base: Fit
    hypothesis: Hypothesis
    group: list[Regressor]
    course: Course
    score: float
    occam: float
    values: dict[str, float]


@dataclass(frozen=True, eq=False)
class _Fitted(Fit):
    """A cause with a course fitted beside the steady ones of a fit; its linear problem has the course in it."""

    of: _Try
    mixed: InParts

    @property
    def linear(self) -> InParts:
        """The linear problem that was fitted."""
        return self.mixed

    @property
    def own(self) -> slice:
        """Places of the cause's columns."""
        return slice(len(self.of.base.columns), None)


def with_course(given: ExplainedLog, plain: Identification) -> ExplainedLog:
    """The log with a cause that has a course, where that explains it better than any set of steady causes.

    Parameters
    ----------
    given : ExplainedLog
    plain : Identification
        The log before another form of the ship's loads was learnt from it: such a form, free in every row, hides changes.

    Returns
    -------
    ExplainedLog
        As given, or with the course and of the rows in which the cause acts.
    """
    # Nothing is sought where the log cannot tell causes or a label is still open.
    identification = given.identification
    if identification.comparison.obstacles or any(
        fault.alternatives for fault in identification.faults
    ):
        return given
    # Log-evidence of steady causes, less the cost of another form: the score to beat.
    steady = given.fits[0].score - _cost(given)
    # The same search with other noise or form, as the result must not hang on these.
    logs = [given, *_otherwise(given, plain)]
    sought = list(zip(logs, each(_clear_tries, logs), strict=True))
    enough = [pair for pair in sought if _is_better(*pair, given)]
    chosen, tries = max(sought, key=_worth)
    if tries and not enough and max(identification.problem.noise.walk[:2]) > EXPLAINED_WALK:
        # Noise that was tuned without the course hides it: each side is weighed beside its own noise.
        tuned = _with_noise(chosen, tuned_noise(chosen.identification.problem, tries[0]))
        noise = tuned_noise(identification.problem, given.fits[0])
        again = fitted_beside(noise, given.fits[0], identification.problem)
        steady = max(steady, again.score - _cost(given))
        pair = tuned, _clear_tries(tuned)
        enough = [pair] if _worth(pair) >= steady + COURSE_GAIN else []
    if not enough:
        return given
    explained, tries = max(enough, key=_worth)
    problem = explained.identification.problem
    # Fewer causes are preferred where they explain the log nearly as well.
    best = next(
        attempt
        for attempt in sorted(tries, key=lambda rival: len(rival.of.base.hypotheses))
        if attempt.score > tries[0].score - ENOUGH * len(tries[0].of.base.hypotheses) - APART
    )
    chance, rivals = _rivals(best, tries, [others[0] for _, others in enough])
    hypothesis = best.of.hypothesis
    course = CourseFound(
        _finding(best, chance),
        best.score - _cost(explained) - steady,
        rivals,
        _sizes_over_time(problem, best),
        {of.name: of.neutral * of.factor for of in hypothesis.parameters},
        (problem.record.time, best.of.course.at(problem.record.time)),
        explained.fits,
        unmodelled_gains(problem, best),
    )
    return _of_its_rows(explained, best.of, course)


def _is_better(explained: ExplainedLog, tries: Sequence[_Fitted], given: ExplainedLog) -> bool:
    """Whether a course explains a log far better than steady causes that are no more, and better than all sets of them.

    A second steady cause may stand for what the course of the first one leaves.
    """
    best = given.fits[0].score + APART
    for attempt in tries:
        causes = len(attempt.of.base.hypotheses) + 1
        no_more = max(fit.score for fit in given.fits if len(fit.hypotheses) <= causes)
        to_beat = max(no_more + COURSE_GAIN, best) - _cost(given)
        if attempt.score - _cost(explained) >= to_beat:
            return True
    return False


def _worth(pair: tuple[ExplainedLog, list[_Fitted]]) -> float:
    """Log-evidence of a log with the likeliest of some courses. [nats]"""
    explained, tries = pair
    return tries[0].score - _cost(explained) if tries else -np.inf


def _rivals(
    best: _Fitted, tries: Sequence[_Fitted], others: Sequence[_Fitted]
) -> tuple[float, tuple[Candidate, ...]]:
    """How likely a cause with a course is, and those that the log cannot tell from it.

    Causes as likely as it beside the same noise; and the best beside other noise or form, which weigh as much: what
    the name depends on is not known.
    """
    weights = {best.of.hypothesis.label: 1.0}
    by_label = {best.of.hypothesis.label: best.of.hypothesis}
    near = [(attempt, float(np.exp(attempt.score - best.score))) for attempt in tries]
    # Weights by log-evidence; the best alternatives from other noise or form count in full.
    for fit, weight in [*((rival, 1.0) for rival in others), *near]:
        hypothesis = fit.of.hypothesis
        if weight > np.exp(-APART) and hypothesis.label not in weights:
            weights[hypothesis.label] = weight
            by_label[hypothesis.label] = hypothesis
    # Posterior probabilities with equal odds beforehand.
    total = sum(weights.values())
    chance, *rest = (min(weight / total, 0.99) for weight in weights.values())
    _, *hypotheses = by_label.values()
    return chance, tuple(
        Candidate(hypothesis.cause, hypothesis.component, share)
        for hypothesis, share in zip(hypotheses, rest, strict=True)
    )


def _clear_tries(explained: ExplainedLog) -> list[_Fitted]:
    """Causes with a course that are large enough to be named, likeliest first."""
    problem = explained.identification.problem
    tried = []
    for base in _bases(explained):
        # All columns of the base once, for every cause beside it.
        whitened = _Whitened(problem, base)
        tried += [_fitted(problem, attempt, whitened.linear) for attempt in _tries(whitened)]
    return sorted(
        (fit for fit in tried if fit is not None and _is_clear(fit)), key=lambda fit: -fit.score
    )


def _otherwise(given: ExplainedLog, plain: Identification) -> Iterator[ExplainedLog]:
    """The log without a cause as it is sought besides: by the model's form, and with a force that wanders no faster
    than on healthy ships, as noise that was tuned without the course grows to cover it.
    """
    identification = given.identification
    if identification.faults != plain.faults:  # labels were corrected since
        return
    # The plain form, where another one was learnt.
    if identification.problem.model.form_scale:
        yield replace(given, identification=plain, fits=(fitted(plain.problem),))
    # Tuned noise may have grown to cover the cause: bound the random walk by that of healthy ships.
    walk = np.minimum(plain.problem.noise.walk, CALM_WALK * np.array([1.0, 1.0, WALK_IN_YAW]))
    if np.any(walk < 0.9 * np.asarray(plain.problem.noise.walk)):
        noise = replace(plain.problem.noise, walk=walk)
        yield _with_noise(replace(given, identification=plain), noise)


def _with_noise(explained: ExplainedLog, noise: Noise) -> ExplainedLog:
    """The log with another noise, without a cause."""
    identification = explained.identification
    problem = prepared(replace(identification.problem, noise=noise), rounds=1)
    return replace(
        explained, identification=replace(identification, problem=problem), fits=(fitted(problem),)
    )


def _cost(explained: ExplainedLog) -> float:
    """Cost of a form that differs from the model's. [nats]"""
    model = explained.identification.problem.model
    return FORM_COST if model.form_scale and not model.directions else 0.0


def _bases(explained: ExplainedLog) -> list[Fit]:
    """Sets beside which a course is sought: none, and the best set of steady causes that may be named."""
    nothing = without_causes(explained.fits)
    named = (
        fit for fit in explained.fits if fit.hypotheses and admissible(fit, explained.fits, {})
    )
    return [nothing, *islice(named, 1)]


class _Whitened:
    """The columns of a fit, filtered once; those of causes with a course are filtered beside them.

    Attributes
    ----------
    problem : IdentificationProblem
    base : Fit
    linear : InParts
        Of the fit.
    """

    def __init__(self, problem: IdentificationProblem, base: Fit):
        self.problem = problem
        self.base = base
        self.linear = base.linear
        # The filter depends on the log's own column alone: further columns need no other.
        self._alone = linearised_by_parts(base.about, base.record, base.model, [])
        self._columns = self._filtered(self.linear)
        self._products = self._columns.T @ self._columns

    def _filtered(self, linear: InParts) -> np.ndarray:
        """Whitened columns of a problem, rows and channels in one axis."""
        white = innovations(linear, self.problem.noise, self.problem.record).white
        return white.reshape(-1, white.shape[-1])

    def weighed(
        self, plain: InParts, groups: Sequence[Sequence[tuple[int, np.ndarray]]]
    ) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
        """Evidence of each group of columns by itself, beside the fit.

        Parameters
        ----------
        plain : InParts
        groups : sequence of sequence of tuple of int and (n,) array
            Number of each column in `plain`, from 1 on, and its share of its size in each row.

        Yields
        ------
        tuple of float, (k,) array, (k, k) array
            Score [nats], θ of the group and its covariance.
        """
        # All groups in one pass of the filter; of the products each takes the fit's columns and its own.
        places, shares = zip(*chain.from_iterable(groups), strict=True)
        shaped = _shaped(self._alone, plain, list(places), np.stack(shares, axis=-1))
        further = self._filtered(shaped)[:, 1:]
        across = self._columns.T @ further
        products = np.block([[self._products, across], [across.T, further.T @ further]])
        first = len(self._products)
        of_fit = range(first)
        # A course leaves the numbers' own tolerances in place: they are of all rows.
        priors = [column.prior for column in self.base.columns]
        for new in map(len, groups):
            chosen = [*of_fit, *range(first, first + new)]
            first += new
            score, theta, covariance = evidence(
                products[np.ix_(chosen, chosen)],
                np.concatenate([priors, np.ones(new)]),
                np.concatenate([self.base.centre, np.zeros(new)]),
            )
            yield score, theta[-new:], covariance[-new:, -new:]


def _tries(whitened: _Whitened) -> list[_Try]:
    """The likeliest courses of the likeliest causes beside a fit, each by the evidence of its own columns."""
    problem, base = whitened.problem, whitened.base
    in_base = {hypothesis.label for hypothesis in base.hypotheses}
    # A cause whose vector turns already varies over the log.
    wanted = [
        hypothesis
        for hypothesis in problem.hypotheses
        if hypothesis.label not in in_base and hypothesis.definition.law != "turning"
    ]
    if not wanted:
        return []
    # Coarse search: all courses by sums over blocks of the log; the likeliest causes go on.
    blocks = _blocks(whitened, wanted)
    first = _first_sight(blocks, wanted)
    leaders = _likeliest(first)[: 2 * LIKELIEST_COURSES]
    labels = {attempt.hypothesis.label for attempt in leaders}
    chosen = [attempt for attempt in first if attempt.hypothesis.label in labels]
    # Row by row the best course of each cause: each kind as it is, and the likeliest with its edges at their rows.
    of_rows = _of_rows(whitened, chosen)
    sharp = _to_the_row(whitened, blocks, leaders[:LIKELIEST_COURSES])
    likely = _likeliest([*of_rows, *sharp])[:LIKELIEST_COURSES]
    # Further spells are found at first sight, and fitted beside the course without them.
    further = (_with_further_spells(blocks, attempt) for attempt in likely)
    changed = [
        longer
        for longer, other in zip(further, likely, strict=True)
        if longer.course != other.course
    ]
    return [*likely, *_to_the_row(whitened, blocks, changed)]


def _likeliest(tries: Sequence[_Try]) -> list[_Try]:
    """The best course of each cause, the likeliest cause first."""
    best: dict[str, _Try] = {}
    for attempt in sorted(tries, key=lambda attempt: -attempt.score):
        best.setdefault(attempt.hypothesis.label, attempt)
    return list(best.values())


def _of_rows(whitened: _Whitened, tries: Sequence[_Try]) -> list[_Try]:
    """Courses with their evidence row by row, less what the search over their times costs."""
    problem = whitened.problem
    groups = []
    for attempt in tries:
        share = attempt.course.at(problem.record.time)
        groups.append([(place, share) for place in problem.places(attempt.group)])
    return [
        attempt._replace(score=gain + attempt.occam, values=_values(problem, attempt.group, theta))
        for attempt, (gain, theta, _) in zip(
            tries, whitened.weighed(problem.linear, groups), strict=True
        )
    ]


def _to_the_row(whitened: _Whitened, blocks: _Blocks, tries: Sequence[_Try]) -> list[_Try]:
    """Steps and spells, one of a cause, with their edges at the likeliest rows instead of between two blocks.

    A compass that jumps by 4 deg is wrong by it in each row between the two: such a step at a wrong second is unlikely.
    """
    step = whitened.problem.record.step
    end = float(blocks.edges[-1])
    move = 0.5 * float(blocks.edges[1] - blocks.edges[0])
    # Each edge is one among the rows of a block, which costs as the search among blocks does.
    cost = float(np.log(max(2.0 * move / step, 1.0)))
    edged = [
        attempt._replace(occam=attempt.occam - cost * len(attempt.course.moved(0.0, end)))
        for attempt in tries
        if attempt.course.kind != RAMP
    ]
    sharp = _of_rows(whitened, edged) if edged else []
    # Edges are moved to and fro while that gains clearly, then by half as much, down to a row.
    while sharp and move > 0.5 * step:
        near = [
            attempt._replace(course=course)
            for attempt in sharp
            for by in (move, -move)
            for course in attempt.course.moved(by, end)
        ]
        least = {attempt.hypothesis.label: attempt.score + APART for attempt in sharp}
        better = [
            attempt
            for attempt in _of_rows(whitened, near)
            if attempt.score > least[attempt.hypothesis.label]
        ]
        sharp = _likeliest([*better, *sharp])
        if not better:
            move *= 0.5
    return sharp


def _values(problem, group, theta) -> dict[str, float]:
    """Numbers of the ship with the columns of a group at some θ."""
    return moved(group, theta, problem.model.get)


def _fitted(problem: IdentificationProblem, attempt: _Try, linear: InParts) -> _Fitted | None:
    """A cause with a course, linearised about its size while it acts and about zero otherwise.

    None where the ship's loads are no numbers along the log.
    """
    base = attempt.base
    count = len(base.columns)
    cause_columns = own_columns(problem, (attempt.hypothesis,))
    # Columns about the ship without the cause, where its share is 0.
    shares = attempt.course.at(problem.record.time)
    plain = beside(linear, linearised_by_parts(base.about, base.record, base.model, cause_columns))
    prior = np.array([column.prior for column in (*base.columns, *cause_columns)])
    values = bounded((attempt.hypothesis,), attempt.values)
    # Gauss-Newton: columns about the present size too, as causes need not be linear; both are mixed
    # by the course.
    for _ in range(ROUNDS_OF_COURSE):
        model = base.model.with_values(values)
        there = linearised_by_parts(base.about, base.record, model, cause_columns)
        mixed = _mixed(plain, there, shares, count)
        filtered = problem.gram(mixed)
        if not np.isfinite(filtered.products).all():
            return None
        # The base stays at its own point of linearisation, the cause at its present values.
        centre = np.concatenate(
            [base.centre, [theta_of(column, model, problem) for column in cause_columns]]
        )
        score, theta, covariance = evidence(filtered.products, prior, centre)
        values = bounded(
            (attempt.hypothesis,), values | _values(problem, cause_columns, theta[count:])
        )
    # Log-evidence with the cost of the search over times.
    total = score + float(filtered.free) + attempt.occam
    hypotheses = (*base.hypotheses, attempt.hypothesis)
    values = base.values | values
    columns = [*base.columns, *cause_columns]
    posterior = (columns, filtered, theta, covariance, centre)
    about = (model, base.about, base.motion, base.record)
    spread = base.std | deviations((attempt.hypothesis,), covariance)
    return _Fitted(hypotheses, values, spread, total, *posterior, *about, attempt, mixed)


def _mixed(plain: InParts, there: InParts, shares: np.ndarray, count: int) -> InParts:
    """The problem without a cause where its share is 0, and about its size where it is 1; in between by the share.

    `plain` has the columns of a fit, `count` of them, before those of the cause, `there` the latter alone.
    """

    def part(rows):
        without, within = plain.part(rows), there.part(rows)
        share = shares[rows]
        mixed = {}
        for name in ("driven", "seen"):
            a, b = getattr(without, name), getattr(within, name)
            # Innovations of a linear mixture: between the ship without the cause and the ship with
            # it.
            by = share[: len(a), None, None]
            log = a[..., :1] + by * (b[..., :1] - a[..., :1])
            # Derivative with respect to the size: the share times the slope at that share.
            of_cause = by * (a[..., 1 + count :] + by * (b[..., 1:] - a[..., 1 + count :]))
            mixed[name] = np.concatenate([log, a[..., 1 : 1 + count], of_cause], axis=-1)
        for name in ("transition", "output"):
            a, b = getattr(without, name), getattr(within, name)
            mixed[name] = a + share[: len(a), None, None] * (b - a)
        return without._replace(**mixed)

    return InParts(plain.rows, plain.columns, part)


def _shaped(alone: InParts, plain: InParts, places: Sequence[int], shares: np.ndarray) -> InParts:
    """The log's own column, then columns of another problem, each times its share of its size in each row."""

    def part(rows):
        first, of_part = alone.part(rows), plain.part(rows)
        share = shares[rows, None]
        columns = {
            name: np.concatenate(
                [getattr(first, name), values[..., places] * share[: len(values)]], axis=-1
            )
            for name, values in (("driven", of_part.driven), ("seen", of_part.seen))
        }
        return first._replace(**columns)

    return InParts(plain.rows, len(places), part)


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Inner products by blocks of the log, of a fit's columns and of causes, `places` by label and group.

    Within a block a course is taken as constant, and the filter as if it knew of it at once.
    """

    base: Fit
    parts: np.ndarray
    edges: np.ndarray
    places: dict[str, list[slice]]

    @property
    def middle(self) -> np.ndarray:
        """Middle of each block. [s]"""
        return 0.5 * (self.edges[:-1] + self.edges[1:])

    @cached_property
    def known(self) -> tuple[np.ndarray, np.ndarray]:
        """Posterior covariance of the fit's own columns, and how the log pulls at them."""
        # Posterior covariance of the base's columns without the cause, S (I + S G S)^-1 S in scaled
        # form.
        count = len(self.base.columns)
        of_fit = slice(1, count + 1)
        prior = np.array([column.prior for column in self.base.columns])
        scale = prior[:, None] * prior
        total = self.parts.sum(0)
        # The gradient is taken about θ = 0 rather than the point of linearisation.
        inverse = np.linalg.inv(np.eye(count) + scale * total[of_fit, of_fit]) * scale
        return inverse, total[of_fit, 0] + total[of_fit, of_fit] @ self.base.centre

    def gains(self, place: slice, shares: np.ndarray) -> np.ndarray:
        """Gain of a cause for each course, (c,) array; `shares` is its size in each block, (c, b). [nats]"""
        # Products of the cause's columns times the course: linear in the share with others,
        # quadratic with themselves.
        of_fit = slice(1, len(self.base.columns) + 1)
        inverse, log = self.known
        across = np.tensordot(shares, self.parts[:, of_fit, place], 1)
        within = np.tensordot(shares**2, self.parts[:, place, place], 1)
        pull = shares @ self.parts[:, place, 0] + np.swapaxes(across, 1, 2) @ self.base.centre
        # What the known numbers explain, within their tolerances, is taken out.
        explained = np.swapaxes(across, 1, 2) @ inverse
        within = within - explained @ across
        pull = pull - explained @ log
        # Laplace evidence of a unit normal prior: half the explained sum of squares less half the
        # log-determinant.
        inner = np.eye(within.shape[-1]) + within
        mean = np.linalg.solve(inner, pull[..., None])[..., 0]
        return 0.5 * (pull * mean).sum(1) - 0.5 * np.linalg.slogdet(inner)[1]


def _blocks(whitened: _Whitened, wanted) -> _Blocks:
    problem, base = whitened.problem, whitened.base
    time = problem.record.time
    # Blocks of COURSE_BLOCK each, within limits, so that the number of courses stays small.
    count = int(np.clip((time[-1] - time[0]) / COURSE_BLOCK, 8, MOST_COURSE_BLOCKS))
    linear = beside(whitened.linear, problem.base_of(regressors_of(wanted)))
    parts = problem.gram(linear, count).blocks
    edges = np.linspace(time[0], time[-1] + problem.record.step, count + 1)
    places: dict[str, list[slice]] = {}
    for hypothesis, _, where in placed(wanted, len(base.columns) + 1):
        places.setdefault(hypothesis.label, []).append(slice(where[0], where[-1] + 1))
    return _Blocks(base, parts, edges, places)


def _first_sight(blocks: _Blocks, wanted) -> list[_Try]:
    """The best course of each kind for each cause."""
    # The share of each course in the middle of each block.
    courses = list(_courses(blocks.edges))
    shares = np.stack([course.at(blocks.middle) for course in courses])
    of_kind = {
        kind: [i for i, course in enumerate(courses) if course.kind == kind] for kind in KINDS
    }
    tries = []
    for hypothesis in wanted:
        best: dict[str, _Try] = {}
        groups = screening_regressors(hypothesis)
        # Screen every regressor group with every course at once.
        for group, place in zip(groups, blocks.places[hypothesis.label], strict=True):
            gains = blocks.gains(place, shares)
            for kind, places in of_kind.items():
                top = places[int(gains[places].argmax())]
                # Evidence averaged over the kind's times, as each is equally likely: relative to
                # the best it is a cost.
                occam = float(np.log(np.exp(gains[places] - gains[top]).mean()))
                gain = float(gains[top]) + occam
                attempt = _Try(blocks.base, hypothesis, group, courses[top], gain, occam, {})
                if kind not in best or gain > best[kind].score:
                    best[kind] = attempt
        tries += best.values()
    return tries


def _courses(edges: np.ndarray) -> Iterator[Course]:
    """Courses that begin and end at some times; none is there all along, or for one block alone.

    A few wrong rows, as beside a gap, push the ship for a block.
    """
    *starts, last, end = map(float, edges)
    for start in starts[1:]:
        yield Course(STEP, ((start, end),))
    for start in starts:
        yield Course(RAMP, ((start, end),))
    times = (*starts, last)
    for first, after in combinations(range(len(times)), 2):
        if after - first > 1:
            yield Course(SPELL, ((times[first], times[after]),))


def _with_further_spells(blocks: _Blocks, attempt: _Try) -> _Try:
    """A spell or step with further ones; each must gain more than the cost of its search."""
    groups = screening_regressors(attempt.hypothesis)
    # Sums by block let further spells be tried without filtering again.
    place = blocks.places[attempt.hypothesis.label][groups.index(attempt.group)]
    spells = [course for course in _courses(blocks.edges) if course.kind != RAMP]
    added = np.stack([course.at(blocks.middle) for course in spells])
    course = attempt.course
    if course.kind == RAMP:
        return attempt
    occam = attempt.occam
    share = course.at(blocks.middle)
    gain = blocks.gains(place, share[None])[0]
    # Greedy search: the best further spell or hole is kept while it gains enough.
    while True:
        # Spells that neither overlap with those that are there nor touch them, or holes in one of them.
        apart = added @ np.convolve(share, np.ones(3), "same") == 0.0
        inside = np.all(added <= share, axis=1) & (added @ share < share.sum())
        tried = np.where(inside[:, None], share - added, share + added)
        tried = tried[apart | inside]
        if not len(tried):
            break
        gains = blocks.gains(place, tried)
        # Each spell was chosen among many: the logarithm of their number is paid.
        paid = float(np.log(len(tried)))
        if gains.max() - paid < gain + ENOUGH:
            break
        share, gain, occam = tried[gains.argmax()], gains.max(), occam - paid
    if np.array_equal(share, course.at(blocks.middle)):
        return attempt
    # Edges of the spells are where the share rises and falls.
    rises = np.diff(np.concatenate([[0.0], share, [0.0]]))
    starts, ends = (blocks.edges[rises == sign] for sign in (1.0, -1.0))
    parts = tuple((float(a), float(b)) for a, b in zip(starts, ends, strict=True))
    if len(parts) == 1:
        kind = STEP if parts[0][1] == blocks.edges[-1] else SPELL
        return attempt._replace(course=Course(kind, parts), occam=occam)
    return attempt._replace(course=Course(SWITCHING, parts), occam=occam)


def _estimates(hypothesis, columns, theta, covariance) -> dict[str, ParameterEstimate]:
    """The parameters of a cause at some θ of its columns."""
    estimates = {}
    for of in hypothesis.parameters:
        # Columns that change this number, by their sizes.
        which = [i for i, column in enumerate(columns) if of.path in column.changes]
        sizes = np.array([columns[i].changes[of.path] for i in which])
        value = of.neutral + float(sizes @ theta[which])
        # Standard deviation of a linear combination of the columns.
        std = float(np.sqrt(sizes @ covariance[np.ix_(which, which)] @ sizes))
        estimates[of.name] = of.estimate(value, std)
    return estimates


def _is_clear(fit: _Fitted) -> bool:
    """Whether a cause with a course is large enough to matter, clearly off none, within its bounds, and measured.

    What is wrong beside a gap pushes the ship where nobody measured her.
    """
    record = fit.of.base.record
    # Most rows while the cause is present must have been measured.
    present = fit.of.course.at(record.time) > 0.0
    if np.isfinite(record.measured[present, :3]).all(-1).mean() < MEASURED_WHILE_PRESENT:
        return False
    parameters = fit.of.hypothesis.parameters
    of_cause = slice(-len(parameters), None)
    # Size in typical units, against the mean standard deviation; it must lie inside all bounds.
    size = float(np.linalg.norm(fit.theta[of_cause]))
    spread = float(np.sqrt(np.diag(fit.covariance)[of_cause].mean()))
    within = all(
        of.bounds[0] < of.neutral + share * of.typical < of.bounds[1]
        for of, share in zip(parameters, fit.theta[of_cause], strict=True)
    )
    return within and size >= max(fit.of.hypothesis.definition.least, DEVIATIONS * spread)


def _finding(fit: _Fitted, chance: float) -> Finding:
    hypothesis = fit.of.hypothesis
    course = fit.of.course
    return Finding(
        hypothesis.cause,
        hypothesis.component,
        probability=chance,
        parameters=_estimates(
            hypothesis, fit.columns[fit.own], fit.theta[fit.own], fit.covariance[fit.own, fit.own]
        ),
        segments=course.spells,
        onset=course.start,
        course=course.kind,
    )


def _sizes_over_time(problem, fit: _Fitted) -> tuple[SizeOverTime, ...]:
    """The size of a cause in each part of the log by itself, linearised about the ship without it."""
    time = problem.record.time
    hypothesis = fit.of.hypothesis
    base = fit.of.base
    # Equal parts, each with its own copy of the cause's columns.
    edges = np.linspace(time[0], time[-1] + problem.record.step, SIZES_OVER_TIME + 1)
    spells = list(zip(map(float, edges[:-1]), map(float, edges[1:]), strict=True))
    group = fit.columns[fit.own]
    plain = linearised_by_parts(base.about, base.record, base.model, group)
    # One joint fit of all parts beside the base, so that their sizes are estimated together.
    shares = [Course(SPELL, (spell,)).at(time) for spell in spells]
    columns = [(1 + place, share) for share in shares for place in range(len(group))]
    ((_, theta, covariance),) = _Whitened(problem, base).weighed(plain, [columns])
    # Collect the estimates of each parameter over the parts.
    by_name: dict[str, list[ParameterEstimate]] = {}
    for k in range(len(spells)):
        part = slice(k * len(group), (k + 1) * len(group))
        sizes = _estimates(hypothesis, group, theta[part], covariance[part, part])
        for name, size in sizes.items():
            by_name.setdefault(name, []).append(size)
    return tuple(
        SizeOverTime(
            name,
            sizes[0].unit,
            0.5 * (edges[:-1] + edges[1:]),
            np.array([size.estimate for size in sizes]),
            np.array([size.std for size in sizes]),
        )
        for name, sizes in by_name.items()
    )


def _of_its_rows(explained: ExplainedLog, best: _Try, course: CourseFound) -> ExplainedLog:
    """The log where the cause acts longest, fitted with it and with the steady ones, and without."""
    identification = explained.identification
    time = identification.repaired["time"].values
    # The longest spell is a log of a steady cause: solve it as an identification problem of its
    # own.
    longest = max(best.course.spells, key=lambda spell: spell[1] - spell[0])
    part = identification.repaired.isel(time=slice(*np.searchsorted(time, longest)))
    problem = None
    if longest[1] - longest[0] >= SHORTEST_SPELL:
        with suppress(ShipcosimError):  # too few whole rows for a ship of her size
            problem = identification_problem(
                part, identification.ship, identification.causes, identification.problem.noise
            )
    if problem is None:
        # Predictions are of the ship without the cause.
        nothing = without_causes(explained.fits)
        return replace(explained, fits=(nothing,), is_healthy=False, course=course)
    # The same hypotheses in the problem of these rows.
    hypotheses = tuple(
        hypothesis
        for refitted in (best.hypothesis, *best.base.hypotheses)
        for hypothesis in problem.hypotheses
        if hypothesis.label == refitted.label
    )
    fits = (fitted(problem, hypotheses, best.values), fitted(problem))
    return replace(
        explained,
        identification=replace(identification, repaired=part, problem=problem),
        fits=fits,
        is_healthy=False,
        course=course,
    )
