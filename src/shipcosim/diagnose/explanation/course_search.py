"""Causes that begin, grow, or come and go: a size over time, weighed against one that is the same all along.

All rows stay in and the ship's numbers are common to them: only the cause has a course. A cause of size θ with the
course c(t) does what its columns do, times c(t), as they are linear in θ.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, islice
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
    own_columns,
    prepared,
    theta_of,
)
from shipcosim.diagnose.inference.innovations import Noise
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
    found = given.identification
    if found.comparison.obstacles or any(fault.alternatives for fault in found.faults):
        return given
    # Log-evidence of steady causes, less the cost of another form: the score to beat.
    steady = given.fits[0].score - _cost(given)
    # The same search with other noise or form, as the result must not hang on these.
    sought = [(one, _clear_tries(one)) for one in (given, *_otherwise(given, plain))]
    enough = [pair for pair in sought if _worth(pair) >= steady + COURSE_GAIN]
    one, tries = max(sought, key=_worth)
    if tries and not enough and max(found.problem.noise.walk[:2]) > EXPLAINED_WALK:
        # Noise that was tuned without the course hides it: each side is weighed beside its own noise.
        tuned = _with_noise(one, tuned_noise(one.identification.problem, tries[0]))
        first = given.fits[0]
        rival = _with_noise(given, tuned_noise(found.problem, first)).identification.problem
        again = fitted(rival, first.hypotheses, first.values)
        steady = max(steady, again.score - _cost(given))
        pair = tuned, _clear_tries(tuned)
        enough = [pair] if _worth(pair) >= steady + COURSE_GAIN else []
    if not enough:
        return given
    explained, tries = max(enough, key=_worth)
    problem = explained.identification.problem
    # Fewer causes are preferred where they explain the log nearly as well.
    best = next(
        one
        for one in sorted(tries, key=lambda one: len(one.of.base.hypotheses))
        if one.score > tries[0].score - ENOUGH * len(tries[0].of.base.hypotheses) - APART
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
    known = {best.of.hypothesis.label: best.of.hypothesis}
    near = [(one, float(np.exp(one.score - best.score))) for one in tries]
    # Weights by log-evidence; the best alternatives from other noise or form count in full.
    for one, weight in [*((one, 1.0) for one in others), *near]:
        hypothesis = one.of.hypothesis
        if weight > np.exp(-APART) and hypothesis.label not in weights:
            weights[hypothesis.label] = weight
            known[hypothesis.label] = hypothesis
    # Posterior probabilities with equal odds beforehand.
    total = sum(weights.values())
    chance, *rest = (min(weight / total, 0.99) for weight in weights.values())
    _, *hypotheses = known.values()
    return chance, tuple(
        Candidate(one.cause, one.component, share)
        for one, share in zip(hypotheses, rest, strict=True)
    )


def _clear_tries(explained: ExplainedLog) -> list[_Fitted]:
    """Causes with a course that are large enough to be named, likeliest first."""
    problem = explained.identification.problem
    tried = []
    for base in _bases(explained):
        # All columns of the base once, for every cause beside it.
        linear = base.linear
        tried += [_fitted(problem, one, linear) for one in _tries(problem, base, linear)]
    return sorted(
        (one for one in tried if one is not None and _is_clear(one)), key=lambda one: -one.score
    )


def _otherwise(given: ExplainedLog, plain: Identification) -> Iterator[ExplainedLog]:
    """The log without a cause as it is sought besides: by the model's form, and with a force that wanders no faster
    than on healthy ships, as noise that was tuned without the course grows to cover it.
    """
    found = given.identification
    if found.faults != plain.faults:  # labels were corrected since
        return
    # The plain form, where another one was learnt.
    if found.problem.model.form_scale:
        yield replace(given, identification=plain, fits=(fitted(plain.problem),))
    # Tuned noise may have grown to cover the cause: bound the random walk by that of healthy ships.
    walk = np.minimum(plain.problem.noise.walk, CALM_WALK * np.array([1.0, 1.0, WALK_IN_YAW]))
    if np.any(walk < 0.9 * np.asarray(plain.problem.noise.walk)):
        noise = replace(plain.problem.noise, walk=walk)
        yield _with_noise(replace(given, identification=plain), noise)


def _with_noise(explained: ExplainedLog, noise: Noise) -> ExplainedLog:
    """The log with another noise, without a cause."""
    found = explained.identification
    problem = prepared(replace(found.problem, noise=noise), rounds=1)
    return replace(
        explained, identification=replace(found, problem=problem), fits=(fitted(problem),)
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


def _tries(problem: IdentificationProblem, base: Fit, linear: InParts) -> list[_Try]:
    """The likeliest courses of the likeliest causes beside a fit, each by the evidence of its own columns."""
    known = {hypothesis.label for hypothesis in base.hypotheses}
    # A cause whose vector turns already varies over the log.
    wanted = [
        one
        for one in problem.hypotheses
        if one.label not in known and one.definition.law != "turning"
    ]
    if not wanted:
        return []
    # Coarse search: all courses by sums over blocks of the log; the likeliest causes go on.
    blocks = _blocks(problem, base, linear, wanted)
    first = sorted(_first_sight(blocks, wanted), key=lambda one: -one.score)
    labels = list(dict.fromkeys(one.hypothesis.label for one in first))[: 2 * LIKELIEST_COURSES]
    chosen = [one for one in first if one.hypothesis.label in labels]
    time = problem.record.time
    # Filter the columns of the chosen courses row by row, all in one pass.
    for one in chosen:
        linear = beside(linear, _shaped(problem.base_of(one.group), one.course.at(time)))
    products = problem.gram(linear).products
    found: dict[str, _Try] = {}
    place = len(base.columns)
    # Evidence of each course, with what the search over its times costs; the best course of each
    # cause.
    for one in chosen:
        own = range(place, place + len(one.group))
        place += len(one.group)
        gain, theta, _ = _weighed(products, base, own)
        scored = one._replace(score=gain + one.occam, values=_values(problem, one.group, theta))
        label = one.hypothesis.label
        if label not in found or scored.score > found[label].score:
            found[label] = scored
    likely = sorted(found.values(), key=lambda one: -one.score)[:LIKELIEST_COURSES]
    # Further spells are found at first sight, and fitted beside the course without them.
    further = (_with_further_spells(blocks, one) for one in likely)
    changed = [
        one for one, other in zip(further, likely, strict=True) if one.course != other.course
    ]
    return [*likely, *changed]


def _values(problem, group, theta) -> dict[str, float]:
    """Numbers of the ship with the columns of a group at some θ."""
    return moved(group, theta, problem.model.get)


def _fitted(problem: IdentificationProblem, one: _Try, linear: InParts) -> _Fitted | None:
    """A cause with a course, linearised about its size while it acts and about zero otherwise.

    None where the ship's loads are no numbers along the log.
    """
    base = one.base
    count = len(base.columns)
    own = own_columns(problem, (one.hypothesis,))
    # Columns about the ship without the cause, where its share is 0.
    shares = one.course.at(problem.record.time)
    plain = beside(linear, linearised_by_parts(base.about, base.record, base.model, own))
    prior = np.array([column.prior for column in (*base.columns, *own)])
    values = bounded((one.hypothesis,), one.values)
    # Gauss-Newton: columns about the present size too, as causes need not be linear; both are mixed
    # by the course.
    for _ in range(ROUNDS_OF_COURSE):
        model = base.model.with_values(values)
        there = linearised_by_parts(base.about, base.record, model, own)
        mixed = _mixed(plain, there, shares, count)
        filtered = problem.gram(mixed)
        if not np.isfinite(filtered.products).all():
            return None
        # The base stays at its own point of linearisation, the cause at its present values.
        centre = np.concatenate([base.centre, [theta_of(column, model, problem) for column in own]])
        score, theta, covariance = evidence(filtered.products, prior, centre)
        values = bounded((one.hypothesis,), values | _values(problem, own, theta[count:]))
    # Log-evidence with the cost of the search over times.
    total = score + float(filtered.free) + one.occam
    hypotheses = (*base.hypotheses, one.hypothesis)
    values = base.values | values
    columns = [*base.columns, *own]
    posterior = (columns, filtered, theta, covariance, centre)
    about = (model, base.about, base.motion, base.record)
    spread = base.std | deviations((one.hypothesis,), covariance)
    return _Fitted(hypotheses, values, spread, total, *posterior, *about, one, mixed)


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
            own = by * (a[..., 1 + count :] + by * (b[..., 1:] - a[..., 1 + count :]))
            mixed[name] = np.concatenate([log, a[..., 1 : 1 + count], own], axis=-1)
        for name in ("transition", "output"):
            a, b = getattr(without, name), getattr(within, name)
            mixed[name] = a + share[: len(a), None, None] * (b - a)
        return without._replace(**mixed)

    return InParts(plain.rows, plain.columns, part)


def _shaped(plain: InParts, shares: np.ndarray) -> InParts:
    """Columns of a cause times its share of its size in each row."""

    def part(rows):
        own = plain.part(rows)
        share = shares[rows]
        return own._replace(
            driven=own.driven * share[: len(own.driven), None, None],
            seen=own.seen * share[:, None, None],
        )

    return InParts(plain.rows, plain.columns, part)


def _weighed(products, base, own) -> tuple[float, np.ndarray, np.ndarray]:
    """Score of own columns beside those of a fit [nats], their θ and its covariance."""
    count = len(base.columns)
    chosen = [0, *range(1, count + 1), *(1 + place for place in own)]
    # A course leaves the numbers' own tolerances in place: they are of all rows.
    prior = np.concatenate([[column.prior for column in base.columns], np.ones(len(own))])
    centre = np.concatenate([base.centre, np.zeros(len(own))])
    score, theta, covariance = evidence(products[np.ix_(chosen, chosen)], prior, centre)
    return score, theta[count:], covariance[count:, count:]


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
        known = slice(1, count + 1)
        prior = np.array([column.prior for column in self.base.columns])
        scale = prior[:, None] * prior
        total = self.parts.sum(0)
        # The gradient is taken about θ = 0 rather than the point of linearisation.
        inverse = np.linalg.inv(np.eye(count) + scale * total[known, known]) * scale
        return inverse, total[known, 0] + total[known, known] @ self.base.centre

    def gains(self, own: slice, shares: np.ndarray) -> np.ndarray:
        """Gain of a cause for each course, (c,) array; `shares` is its size in each block, (c, b). [nats]"""
        # Products of the cause's columns times the course: linear in the share with others,
        # quadratic with themselves.
        known = slice(1, len(self.base.columns) + 1)
        inverse, log = self.known
        across = np.tensordot(shares, self.parts[:, known, own], 1)
        within = np.tensordot(shares**2, self.parts[:, own, own], 1)
        pull = shares @ self.parts[:, own, 0] + np.swapaxes(across, 1, 2) @ self.base.centre
        # What the known numbers explain, within their tolerances, is taken out.
        explained = np.swapaxes(across, 1, 2) @ inverse
        within = within - explained @ across
        pull = pull - explained @ log
        # Laplace evidence of a unit normal prior: half the explained sum of squares less half the
        # log-determinant.
        inner = np.eye(within.shape[-1]) + within
        mean = np.linalg.solve(inner, pull[..., None])[..., 0]
        return 0.5 * (pull * mean).sum(1) - 0.5 * np.linalg.slogdet(inner)[1]


def _blocks(problem, base, linear, wanted) -> _Blocks:
    time = problem.record.time
    # Blocks of COURSE_BLOCK each, within limits, so that the number of courses stays small.
    count = int(np.clip((time[-1] - time[0]) / COURSE_BLOCK, 8, MOST_COURSE_BLOCKS))
    linear = beside(linear, problem.base_of(regressors_of(wanted)))
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
    of_kind = {kind: [i for i, one in enumerate(courses) if one.kind == kind] for kind in KINDS}
    found = []
    for hypothesis in wanted:
        best: dict[str, _Try] = {}
        groups = screening_regressors(hypothesis)
        # Screen every regressor group with every course at once.
        for group, own in zip(groups, blocks.places[hypothesis.label], strict=True):
            gains = blocks.gains(own, shares)
            for kind, places in of_kind.items():
                top = places[int(gains[places].argmax())]
                # Evidence averaged over the kind's times, as each is equally likely: relative to
                # the best it is a cost.
                occam = float(np.log(np.exp(gains[places] - gains[top]).mean()))
                gain = float(gains[top]) + occam
                one = _Try(blocks.base, hypothesis, group, courses[top], gain, occam, {})
                if kind not in best or gain > best[kind].score:
                    best[kind] = one
        found += best.values()
    return found


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


def _with_further_spells(blocks: _Blocks, one: _Try) -> _Try:
    """A spell or step with further ones; each must gain more than the cost of its search."""
    groups = screening_regressors(one.hypothesis)
    # Sums by block let further spells be tried without filtering again.
    own = blocks.places[one.hypothesis.label][groups.index(one.group)]
    spells = [course for course in _courses(blocks.edges) if course.kind != RAMP]
    each = np.stack([course.at(blocks.middle) for course in spells])
    course = one.course
    if course.kind == RAMP:
        return one
    occam = one.occam
    share = course.at(blocks.middle)
    gain = blocks.gains(own, share[None])[0]
    # Greedy search: the best further spell or hole is kept while it gains enough.
    while True:
        # Spells that neither overlap with those that are there nor touch them, or holes in one of them.
        apart = each @ np.convolve(share, np.ones(3), "same") == 0.0
        inside = np.all(each <= share, axis=1) & (each @ share < share.sum())
        tried = np.where(inside[:, None], share - each, share + each)
        tried = tried[apart | inside]
        if not len(tried):
            break
        gains = blocks.gains(own, tried)
        # Each spell was chosen among many: the logarithm of their number is paid.
        paid = float(np.log(len(tried)))
        if gains.max() - paid < gain + ENOUGH:
            break
        share, gain, occam = tried[gains.argmax()], gains.max(), occam - paid
    # Edges of the spells are where the share rises and falls.
    rises = np.diff(np.concatenate([[0.0], share, [0.0]]))
    starts, ends = (blocks.edges[rises == sign] for sign in (1.0, -1.0))
    found = tuple((float(a), float(b)) for a, b in zip(starts, ends, strict=True))
    if len(found) == 1:
        kind = STEP if found[0][1] == blocks.edges[-1] else SPELL
        return one._replace(course=Course(kind, found), occam=occam)
    return one._replace(course=Course(SWITCHING, found), occam=occam)


def _estimates(hypothesis, columns, theta, covariance) -> dict[str, ParameterEstimate]:
    """The parameters of a cause at some θ of its columns."""
    found = {}
    for of in hypothesis.parameters:
        # Columns that change this number, by their sizes.
        which = [i for i, column in enumerate(columns) if of.path in column.changes]
        sizes = np.array([columns[i].changes[of.path] for i in which])
        value = of.neutral + float(sizes @ theta[which])
        # Standard deviation of a linear combination of the columns.
        std = float(np.sqrt(sizes @ covariance[np.ix_(which, which)] @ sizes))
        found[of.name] = of.estimate(value, std)
    return found


def _is_clear(one: _Fitted) -> bool:
    """Whether a cause with a course is large enough to matter, clearly off none, within its bounds, and measured.

    What is wrong beside a gap pushes the ship where nobody measured her.
    """
    record = one.of.base.record
    # Most rows while the cause is present must have been measured.
    present = one.of.course.at(record.time) > 0.0
    if np.isfinite(record.measured[present, :3]).all(-1).mean() < MEASURED_WHILE_PRESENT:
        return False
    parameters = one.of.hypothesis.parameters
    own = slice(-len(parameters), None)
    # Size in typical units, against the mean standard deviation; it must lie inside all bounds.
    size = float(np.linalg.norm(one.theta[own]))
    spread = float(np.sqrt(np.diag(one.covariance)[own].mean()))
    within = all(
        of.bounds[0] < of.neutral + share * of.typical < of.bounds[1]
        for of, share in zip(parameters, one.theta[own], strict=True)
    )
    return within and size >= max(one.of.hypothesis.definition.least, DEVIATIONS * spread)


def _finding(one: _Fitted, chance: float) -> Finding:
    hypothesis = one.of.hypothesis
    course = one.of.course
    return Finding(
        hypothesis.cause,
        hypothesis.component,
        probability=chance,
        parameters=_estimates(
            hypothesis, one.columns[one.own], one.theta[one.own], one.covariance[one.own, one.own]
        ),
        segments=course.spells,
        onset=course.start,
        course=course.kind,
    )


def _sizes_over_time(problem, one: _Fitted) -> tuple[SizeOverTime, ...]:
    """The size of a cause in each part of the log by itself, linearised about the ship without it."""
    time = problem.record.time
    hypothesis = one.of.hypothesis
    base = one.of.base
    # Equal parts, each with its own copy of the cause's columns.
    edges = np.linspace(time[0], time[-1] + problem.record.step, SIZES_OVER_TIME + 1)
    spells = list(zip(map(float, edges[:-1]), map(float, edges[1:]), strict=True))
    group = one.columns[one.own]
    plain = linearised_by_parts(base.about, base.record, base.model, group)
    linear = base.linear
    for spell in spells:
        linear = beside(linear, _shaped(plain, Course(SPELL, (spell,)).at(time)))
    # One joint fit of all parts beside the base, so that their sizes are estimated together.
    products = problem.gram(linear).products
    count = len(base.columns)
    own = range(count, count + len(group) * len(spells))
    _, theta, covariance = _weighed(products, base, own)
    # Collect the estimates of each parameter over the parts.
    each: dict[str, list[ParameterEstimate]] = {}
    for k in range(len(spells)):
        part = slice(k * len(group), (k + 1) * len(group))
        sizes = _estimates(hypothesis, group, theta[part], covariance[part, part])
        for name, size in sizes.items():
            each.setdefault(name, []).append(size)
    return tuple(
        SizeOverTime(
            name,
            sizes[0].unit,
            0.5 * (edges[:-1] + edges[1:]),
            np.array([size.estimate for size in sizes]),
            np.array([size.std for size in sizes]),
        )
        for name, sizes in each.items()
    )


def _of_its_rows(explained: ExplainedLog, best: _Try, course: CourseFound) -> ExplainedLog:
    """The log where the cause acts longest, fitted with it and with the steady ones, and without."""
    found = explained.identification
    time = found.repaired["time"].values
    # The longest spell is a log of a steady cause: solve it as an identification problem of its
    # own.
    longest = max(best.course.spells, key=lambda spell: spell[1] - spell[0])
    part = found.repaired.isel(time=slice(*np.searchsorted(time, longest)))
    problem = None
    if longest[1] - longest[0] >= SHORTEST_SPELL:
        with suppress(ShipcosimError):  # too few whole rows for a ship of her size
            problem = identification_problem(part, found.ship, found.causes, found.problem.noise)
    if problem is None:
        # Predictions are of the ship without the cause.
        nothing = without_causes(explained.fits)
        return replace(explained, fits=(nothing,), is_healthy=False, course=course)
    # The same hypotheses in the problem of these rows.
    hypotheses = tuple(
        own
        for one in (best.hypothesis, *best.base.hypotheses)
        for own in problem.hypotheses
        if own.label == one.label
    )
    fits = (fitted(problem, hypotheses, best.values), fitted(problem))
    return replace(
        explained,
        identification=replace(found, repaired=part, problem=problem),
        fits=fits,
        is_healthy=False,
        course=course,
    )
