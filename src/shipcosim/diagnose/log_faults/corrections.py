"""What is wrong with a log or with the system's connections, and only the ship's answer tells: found, and put right.

Each step gives back what it was given where nothing is wrong. A step is taken where the evidence for what is put right
is larger than that for any cause that would leave it as it is.
"""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.inference.problem import prepare
from shipcosim.diagnose.inference.search import at_first_sight, explain
from shipcosim.diagnose.inference.unmodelled import unexplained
from shipcosim.diagnose.inference.verdict import MOST, UNMODELLED
from shipcosim.diagnose.log.checks.wind import leaps
from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of, mislabel_of, possible
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log_faults.clock import clock_by_answer, with_rate
from shipcosim.diagnose.log_faults.input_labels import likelihood, settled, suspected, with_label
from shipcosim.diagnose.log_faults.navigation_labels import relabelled
from shipcosim.diagnose.result import Finding
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.wiring import put_right

__all__ = ["rewired", "with_right_clock", "with_right_inputs", "with_right_wind", "with_right_sensors"]

_FAULT = 15.0  # nats that a fault of the data has to gain over the best causes without it
_UNIT = 3.0  # nats that another unit has to gain over the scale of the same channel, which is free to be anything
_SUSPECTS = 3  # faults of thrusters' and the wind's channels that are tried
_SETTLING = 2  # times that the segment of one is settled, at most


def with_right_sensors(log, faults, clean, problem, model, catalogue):
    """Faults, log and case with the channels of the navigation labelled as the ship's answer says."""
    found, likely = (faults, clean, problem), relabelled(log, faults, problem)
    enough = explain(problem, most=1)[0].score + _FAULT if likely else None
    for better in likely:
        right = repaired(log, better.faults)
        again = prepare(right, model, catalogue)
        if at_first_sight(again) + better.stretch < enough:
            continue
        score = explain(again, most=1)[0].score + better.stretch
        if score > enough:
            found, enough = (better.faults, right, again), score
    return found


def with_right_clock(log, faults, clean, problem, model, catalogue):
    """Faults, log and case with the segments of a wrong clock that the ship's answer tells of."""
    others = [fault for fault in faults if fault.cause != "clock"]
    as_logged = problem if len(others) == len(faults) else prepare(repaired(log, others), model, catalogue)
    clock = clock_by_answer(as_logged)
    if clock is None:
        return faults, clean, problem
    clean = repaired(log, [*others, clock])
    problem = prepare(clean, model, catalogue)
    faults = [*others, with_rate(problem, clock, clean["logged_time"].values)]
    clean = repaired(log, faults)
    return faults, clean, prepare(clean, model, catalogue, problem.noise)


def with_right_wind(log, faults, clean, problem, model, catalogue):
    """Faults, log and case with a wrongly labelled wind as the ship's answer says: what it is instead, and where."""
    for i, fault in enumerate(faults):
        if mislabel_of(fault) in WIND_LABELS and len(fault.segments) < 2:
            raw = repaired(log, faults[:i] + faults[i + 1 :])
            fault, problem = _counted_otherwise(raw, fault, problem, model, catalogue)
            fault, clean, problem = _settled(raw, mislabel_of(fault), fault, problem, model, catalogue)
            faults = [*faults[:i], fault, *faults[i + 1 :]]
    return faults, clean, problem


def _counted_otherwise(raw, told, problem, model, catalogue):
    """A fault of the wind's direction, and its case, by the likeliest label of those that could be meant."""
    if mislabel_of(told).scale is not None:
        return told, problem
    directions = [label for label in possible(WIND_LABELS, raw) if label.scale is None]
    rights = {label: with_label(raw, label, told.segments) for label in directions}
    label = max(rights, key=lambda label: likelihood(problem, record_of(rights[label], model)))
    if label is mislabel_of(told):
        return told, problem
    again = prepare(rights[label], model, catalogue)
    if at_first_sight(again) < at_first_sight(problem) + _FAULT:
        return told, problem
    return finding_of(label, told.probability, *told.segments), again


def rewired(clean, model, catalogue, problem):
    """Connections of the system that the log contradicts, and ship and case with them as their names say."""
    if model.wiring is None:
        return [], model, problem
    found, score = [], at_first_sight(problem)
    for name, told in model.wiring.odd.items():
        better = replace(model, wiring=put_right(model.wiring, name))
        again = prepare(clean, better, catalogue)
        scored = at_first_sight(again)
        if scored > score + _FAULT:
            found.append(Finding("connection", name, "physics", 0.99, {}, note=told))
            model, problem, score = better, again, scored
    return found, model, problem


def with_right_inputs(clean, problem, fits, model, catalogue):
    """The likeliest fault of thrusters' or the wind's channels, and all with it put right; None if there is none.

    The ends of a segment are rough until they are settled, so the likeliest fault is settled before it is held against
    all causes; further ones only where they are better than those even so.
    """
    likely = []
    for _, mislabel, fault in suspected(clean, problem)[:_SUSPECTS]:
        again = prepare(with_label(clean, mislabel, fault.segments), model, catalogue)
        likely.append((at_first_sight(again), mislabel, fault, again))
    least = min(fits[0].score, at_first_sight(problem) + _FAULT) if likely else 0.0
    for sight, mislabel, fault, again in sorted(likely, key=lambda entry: -entry[0]):
        if sight < least:
            return None
        least = fits[0].score
        fault, right, again = _settled(clean, mislabel, fault, again, model, catalogue)
        if at_first_sight(again) < fits[0].score or not _shows(clean, mislabel, fault):
            continue
        better = explain(again)
        close = [fit for fit in better[:3] if fit.score > fits[0].score + _price(fault, fits[0])]
        if any(_is_explained(again, fit) for fit in close):
            return fault, right, again, better
    return None


def _shows(clean, mislabel, fault):
    """Whether another unit of the wind in a part of a log shows at its ends: what takes her wind away does not."""
    if mislabel not in WIND_LABELS or mislabel.scale is None:
        return True
    speed = clean["wind_speed"].values
    known = np.isfinite(speed)
    return leaps(clean["time"].values[known], speed[known], next(iter(fault.segments), None), 1.0 / mislabel.scale)


def _settled(clean, mislabel, fault, problem, model, catalogue):
    """A fault of labels with its segment settled, the log with that put right, and its case."""
    right = with_label(clean, mislabel, fault.segments)
    for _ in range(_SETTLING):
        moved = settled(clean, mislabel, fault, problem)
        if moved is fault:
            break
        fault, right = moved, with_label(clean, mislabel, moved.segments)
        problem = prepare(right, model, catalogue)
    return fault, right, problem


def _price(fault, fit):
    """What a fault of the inputs' channels has to gain over a fit: little, if a wrong unit looks like a cause in it."""
    label, alike = mislabel_of(fault), {channel for one in fit.hypotheses for channel in one.effect.unit_of}
    is_unit = label is not None and label.scale is not None
    return _UNIT if is_unit and alike & set(fault.channels) else _FAULT


def _is_explained(problem, fit):
    """Whether nothing without a name is left beside a fit."""
    return len(fit.hypotheses) <= MOST and max(unexplained(problem, fit).values()) < UNMODELLED
