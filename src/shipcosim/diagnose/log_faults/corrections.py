"""Faults of a log, and wrong connections of a system, that only the ship's response shows: found and corrected.

Each step leads from one identification to the next, and gives back the one that it was given where nothing is wrong. A
step is taken where the evidence for what is corrected is larger than that for any cause that would leave it as it is.
"""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.checked_log import CheckedLog
from shipcosim.diagnose.compared_log import compared
from shipcosim.diagnose.explanation.form import learnt, with_learnt_form
from shipcosim.diagnose.explanation.identification import Identification, identified
from shipcosim.diagnose.explanation.search import ExplainedLog, at_first_sight, explain
from shipcosim.diagnose.explanation.unmodelled import is_healthy, unmodelled_gains
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.inference.fitting import fitted_beside
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.inference.thresholds import EXPLAINED_WALK, MOST_CAUSES, UNMODELLED
from shipcosim.diagnose.inference.workers import each
from shipcosim.diagnose.log.checks.samples import LIFELESS
from shipcosim.diagnose.log.checks.wind import leaps
from shipcosim.diagnose.log.mislabels import (
    WIND_LABELS,
    finding_of,
    possible,
)
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log.roles import NAVIGATION
from shipcosim.diagnose.log_faults.clock import clock_by_response, settled_clock
from shipcosim.diagnose.log_faults.held_inputs import held_inputs, is_contradicted
from shipcosim.diagnose.log_faults.input_labels import (
    likelihood,
    suspected_inputs,
    with_label,
    with_refined_segment,
)
from shipcosim.diagnose.log_faults.navigation_labels import relabelled
from shipcosim.diagnose.log_faults.thresholds import (
    FAULT,
    MOST_INPUT_FAULTS,
    MOST_TRIED,
    PART_GAIN,
    ROUNDS_OF_CLOCK,
    ROUNDS_OF_SEGMENT,
    UNIT,
)
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.stretches import in_stretches
from shipcosim.diagnose.ship.wiring import put_right


def corrected(identification: Identification) -> Identification:
    """A log with thrusters, navigation, clock and wind, and a system with connections, as the ship's response says."""
    thrusters = with_right_thrusters(identification)
    navigation = with_right_navigation(thrusters)
    clock = with_right_clock(navigation)
    wind = with_right_wind(clock)
    return with_right_connections(with_measured_inputs(wind))


def with_right_thrusters(identification: Identification) -> Identification:
    """The log with sides and signs of the thrusters as logged, if the whole model says so against the forces alone.

    Thrusters that hold a ship follow the weather: then a current that turns looks like a wrong sign.
    """
    comparison = identification.comparison
    labels = comparison.labels
    changes = labels.best.changes if labels and labels.is_sure else ()
    if not changes or comparison.is_started_with:
        return identification
    others = identification.faults[: -len(changes)]
    log = CheckedLog(
        identification.log,
        identification.ship,
        identification.causes,
        others,
        repaired(identification.log, others),
    )
    as_logged = identified(compared(log, keeps_labels=True))
    score = explain(identification.problem, most=1)[0].score
    is_right = explain(as_logged.problem, most=1)[0].score > score + FAULT
    return as_logged if is_right else identification


def with_measured_inputs(identification: Identification) -> Identification:
    """The log without rows in which a channel of thrusters or wind keeps a value that the ship contradicts."""
    # A channel that is held can look like a wrong label of it: first without labels of inputs.
    navigation = {"time", *NAVIGATION}
    others = tuple(
        fault
        for fault in identification.faults
        if fault.mislabel is None or set(fault.channels) & navigation
    )
    is_labelled = len(others) < len(identification.faults)
    held = held_inputs(_without(identification, others), identification.ship) if is_labelled else []
    if held:
        plain = _repaired(identification, others)
        cut = _without_held_inputs(plain, held)
        if cut is not plain:
            return cut
    return _without_held_inputs(
        identification, held_inputs(identification.repaired, identification.ship)
    )


def _without_held_inputs(identification, held):
    """The log without held channels that the ship contradicts; itself where she is explained without that."""
    logged = learnt(identification.problem) if held else identification.problem
    if not held or is_healthy(logged, explain(logged, most=1)[0]):
        return identification
    for gap in held:
        cut = _repaired(identification, (*identification.faults, gap))
        # A wind that never changes while she sails is no apparent wind, and leaves no other rows.
        if gap.note == LIFELESS or is_contradicted(
            gap, identification.repaired, learnt(cut.problem)
        ):
            identification = cut
    return identification


def with_right_navigation(identification: Identification) -> Identification:
    """The log with the channels of the navigation labelled as the ship's response says."""
    # Labels of the navigation that the response of the ship prefers.
    candidates = relabelled(identification.log, identification.faults, identification.problem)
    if not candidates:
        return identification
    # Fit each candidate, with the best single cause, and keep the likeliest that
    # gains enough over the log as it is. The density makes units comparable.
    best = identification
    enough = explain(identification.problem, most=1)[0].score + FAULT
    for candidate in candidates:
        again = _repaired(identification, candidate.faults)
        # A cheap estimate of the evidence first, as a full fit takes long.
        if at_first_sight(again.problem) + candidate.density < enough:
            continue
        score = explain(again.problem, most=1)[0].score + candidate.density
        if score > enough:
            best = again
            enough = score
    return best


def with_right_clock(identification: Identification) -> Identification:
    """The log with the segments of a wrong clock that the ship's response shows."""
    # Identify with the rows as logged, without any segment of wrong clock found so far.
    others = tuple(
        fault for fault in identification.faults if fault.cause != "clock" or not fault.segments
    )
    as_logged = (
        identification
        if len(others) == len(identification.faults)
        else _repaired(identification, others)
    )
    clock = clock_by_response(as_logged.problem)
    if clock is None:
        return identification
    # The motion was distorted by the wrong clock, and the noise was tuned on it: correct it, then settle both again.
    right = _repaired(identification, (*others, clock))
    for _ in range(ROUNDS_OF_CLOCK):
        clock = settled_clock(right.problem, clock, right.repaired)
        right = _repaired(identification, (*others, clock))
    return right


def with_right_wind(identification: Identification) -> Identification:
    """The log with a mislabelled wind corrected by the ship's response: the label, and its segment."""
    for place, fault in enumerate(identification.faults):
        if fault.mislabel in WIND_LABELS and len(fault.segments) < 2:
            identification = _with_right_wind_label(identification, place)
    return identification


def _with_right_wind_label(identification, place):
    """The log with one fault of the wind's labels, by its place among the faults, settled.

    One that the log alone told of throughout, and the ship's answer of nearly nowhere, is none; nor is one that she
    puts elsewhere than the log.
    """
    # Log with all faults corrected but this one.
    before = identification.faults[:place]
    after = identification.faults[place + 1 :]
    as_logged = replace(identification, repaired=_without(identification, (*before, *after)))
    # First the label of the direction, then the segment.
    fault, problem = _likeliest_direction(as_logged, identification.faults[place])
    fault, right = _with_settled_segment(replace(as_logged, problem=problem), fault)
    # A fault throughout of which only a segment is left
    # needs evidence from the ship, else it is dropped.
    shrunk = fault.segments and not identification.faults[place].segments
    about = right.problem
    logged = record_of(as_logged.repaired, about.model)
    is_weak = shrunk and likelihood(about, about.record) <= likelihood(about, logged) + PART_GAIN
    if is_weak or _is_elsewhere(fault, identification.faults[place]):
        problem = identification_problem(
            as_logged.repaired, identification.ship, identification.causes
        )
        return replace(as_logged, faults=(*before, *after), problem=problem)
    return replace(right, faults=(*before, fault, *after))


def _is_elsewhere(fault, first):
    """Whether the parts of the log in which two findings of one fault see it have less than half in common."""
    if not (fault.segments and first.segments):
        return False
    ((start, end),) = fault.segments
    ((first_start, first_end),) = first.segments
    common = min(end, first_end) - max(start, first_start)
    return common < 0.5 * max(end - start, first_end - first_start)


def _likeliest_direction(as_logged, fault):
    """A fault of the wind's direction, and the problem, by the likeliest label of those that could be meant.

    `as_logged` has the log without that fault corrected, and the problem with it corrected.
    """
    log = as_logged.repaired
    problem = as_logged.problem
    # A unit of the speed leaves the direction as it is.
    if fault.mislabel.scale is not None:
        return fault, problem
    # Undo each label of the direction, and compare likelihoods about the same motion.
    directions = [label for label in possible(WIND_LABELS, log) if label.scale is None]
    rights = {label: with_label(log, label, fault.segments) for label in directions}
    label = max(
        rights, key=lambda label: likelihood(problem, record_of(rights[label], as_logged.ship))
    )
    if label == fault.mislabel:
        return fault, problem
    # Identify anew with the likeliest one; it must gain enough to replace the fault.
    again = identification_problem(rights[label], as_logged.ship, as_logged.causes)
    if at_first_sight(again) < at_first_sight(problem) + FAULT:
        return fault, problem
    return finding_of(label, fault.probability, *fault.segments), again


def with_right_connections(identification: Identification) -> Identification:
    """The ship with connections corrected by their names, where the log contradicts the system."""
    if identification.ship.wiring is None:
        return identification
    # Correct one odd connection at a time, and keep it if the evidence grows by the threshold.
    score = at_first_sight(identification.problem)
    for name, what in identification.ship.wiring.odd.items():
        if identification.ship.wiring is None:
            break
        ship = replace(identification.ship, wiring=put_right(identification.ship.wiring, name))
        problem = identification_problem(identification.repaired, ship, identification.causes)
        if (rewired := at_first_sight(problem)) > score + FAULT:
            finding = Finding("connection", name, "physics", 0.99, {}, note=what)
            identification = replace(
                identification,
                ship=ship,
                problem=problem,
                misconnections=(*identification.misconnections, finding),
            )
            score = rewired
    return identification


def with_right_inputs(explained: ExplainedLog, plain: Identification) -> ExplainedLog:
    """The log with mislabelled channels of thrusters and wind corrected, where it is not healthy; explained again.

    They are sought on the `plain` ship, of the model's form: one that is learnt from wrong channels hides where they
    are wrong.
    """
    before = len(explained.identification.faults)
    for _ in range(MOST_INPUT_FAULTS):
        better = None if explained.is_healthy else _with_right_input(explained, plain)
        if better is None:
            break
        *others, fault = better.identification.faults[before:]
        if any(set(fault.channels) & set(other.channels) for other in others):
            break  # what a channel already corrected cannot be again: something else is wrong with it
        explained = better
        plain = replace(_relabelled(plain, fault), faults=better.identification.faults)
    return explained


def _with_right_input(explained, plain):
    """The log with the likeliest fault of thrusters' or the wind's channels corrected; None if there is none.

    The ends of a segment are rough until they are settled, so the likeliest fault is settled before it is compared with
    all causes; further ones only where they are better than those even so.
    """
    best = explained.fits[0]
    # Candidates by their likelihood about the present motion, each then identified anew.
    suspects = suspected_inputs(plain.repaired, plain.problem)[:MOST_TRIED]

    def candidate(fault):
        problem = _relabelled(plain, fault).problem
        return at_first_sight(problem), fault, problem

    candidates = each(candidate, suspects)
    # The likeliest is settled in any case: a rough segment may hide it. Further ones must beat the best fit with causes
    # in their rough segments.
    least = -np.inf
    for score, fault, problem in sorted(candidates, key=lambda entry: -entry[0]):
        if score < least:
            return None
        least = best.score
        # Settle the segment, and learn the form of the ship from right channels, before the costly comparison with
        # all causes.
        fault, right = _with_settled_segment(replace(plain, problem=problem), fault)
        right = with_learnt_form(right)
        # Her wind must change with another unit, and beside the fault no force may wander.
        shows = _shows_at_its_ends(plain.repaired, fault)
        shows &= max(right.problem.noise.walk[:2]) < EXPLAINED_WALK
        if at_first_sight(right.problem) < best.score or not shows:
            continue
        # Fit causes beside the fault. It must gain over the best fit without it, beside the noise of either.
        fits = tuple(explain(right.problem))
        beside_it = fitted_beside(right.problem.noise, best, explained.identification.problem)
        enough = max(best.score, beside_it.score) + _least_gain(fault, best)
        # Whether no unmodelled error stands out beside a fit.
        if any(
            fit.score > enough
            and len(fit.hypotheses) <= MOST_CAUSES
            and max(unmodelled_gains(right.problem, fit).values()) < UNMODELLED
            for fit in fits[:3]
        ):
            right = replace(right, faults=(*plain.faults, fault))
            return ExplainedLog(right, fits, is_healthy(right.problem, fits[0]))
    return None


def _repaired(identification, faults):
    """A repeated identification, of the log as read with some faults corrected."""
    log = _without(identification, faults)
    problem = identification_problem(log, identification.ship, identification.causes)
    return replace(identification, faults=tuple(faults), repaired=log, problem=problem)


def _without(identification, faults):
    """The log as read with some faults corrected; a long one in stretches."""
    return in_stretches(repaired(identification.log, faults), identification.ship.length)


def _relabelled(identification, fault):
    """A repeated identification, of its repaired log with a mislabel undone too."""
    log = with_label(identification.repaired, fault.mislabel, fault.segments)
    return replace(
        identification,
        repaired=log,
        problem=identification_problem(log, identification.ship, identification.causes),
    )


def _with_settled_segment(identification, fault):
    """A mislabel with its segment settled, and the identification with it corrected.

    `identification` has the log without it corrected, and the problem with it corrected in its first segment.
    """
    # Segment and motion depend on each other: refine one with the other, a few times.
    right = replace(
        identification, repaired=with_label(identification.repaired, fault.mislabel, fault.segments)
    )
    for _ in range(ROUNDS_OF_SEGMENT):
        refined = with_refined_segment(identification.repaired, fault, right.problem)
        if refined is fault:
            break
        fault = refined
        right = _relabelled(identification, refined)
    return fault, right


def _shows_at_its_ends(log, fault):
    """Whether another unit of the wind in a part of a log shows at its ends: what takes her wind away does not."""
    mislabel = fault.mislabel
    if mislabel not in WIND_LABELS or mislabel.scale is None:
        return True
    speed = log["wind_speed"].values
    has_value = np.isfinite(speed)
    return leaps(
        log["time"].values[has_value],
        speed[has_value],
        next(iter(fault.segments), None),
        1.0 / mislabel.scale,
    )


def _least_gain(fault, fit):
    """What a fault of the inputs' channels must gain over a fit: little, if a wrong unit looks like a cause in it."""
    label = fault.mislabel
    mistakable = {
        channel for hypothesis in fit.hypotheses for channel in hypothesis.definition.unit_of
    }
    is_unit = label is not None and label.scale is not None
    return UNIT if is_unit and mistakable & set(fault.channels) else FAULT
