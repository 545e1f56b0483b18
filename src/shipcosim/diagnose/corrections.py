"""What is wrong with a log or with the system's connections, and only the ship's answer tells: found, and put right.

Each step gives back what it was given where nothing is wrong. A step is taken where the evidence for what is put right
is larger than that for any cause that would leave it as it is.
"""

from dataclasses import replace

from shipcosim.diagnose.drivers import settled, suspected, with_label
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.mislabels import WIND_LABELS, mislabel_of
from shipcosim.diagnose.nameless import unexplained
from shipcosim.diagnose.preparing import prepare
from shipcosim.diagnose.repair import repaired
from shipcosim.diagnose.search import at_first_sight, explain
from shipcosim.diagnose.sensors import relabelled
from shipcosim.diagnose.timing import clock_by_answer, with_rate
from shipcosim.diagnose.verdict import MOST, STRANGE
from shipcosim.diagnose.wiring import put_right

__all__ = ["rewired", "with_right_clock", "with_right_drivers", "with_right_ends", "with_right_sensors"]

_FAULT = 15.0  # nats that a fault of the data has to gain over the best causes without it
_UNIT = 3.0  # nats that another unit has to gain over the scale of the same channel, which is free to be anything
_SUSPECTS = 3  # faults of thrusters' and the wind's channels that are tried
_SETTLING = 2  # times that the segment of one is settled, at most


def with_right_sensors(log, faults, clean, case, plant, catalogue):
    """Faults, log and case with the channels of the navigation labelled as the ship's answer says."""
    found, likely = (faults, clean, case), relabelled(log, faults, case)
    enough = explain(case, most=1)[0].score + _FAULT if likely else None
    for better in likely:
        right = repaired(log, better.faults)
        again = prepare(right, plant, catalogue)
        score = at_first_sight(again) + better.stretch
        if score > enough:
            found, enough = (better.faults, right, again), score
    return found


def with_right_clock(log, faults, clean, case, plant, catalogue):
    """Faults, log and case with the segments of a wrong clock that the ship's answer tells of."""
    others = [fault for fault in faults if fault.cause != "clock"]
    as_logged = case if len(others) == len(faults) else prepare(repaired(log, others), plant, catalogue)
    clock = clock_by_answer(as_logged)
    if clock is None:
        return faults, clean, case
    clean = repaired(log, [*others, clock])
    case = prepare(clean, plant, catalogue)
    faults = [*others, with_rate(case, clock, clean["logged_time"].values)]
    clean = repaired(log, faults)
    return faults, clean, prepare(clean, plant, catalogue, case.noise)


def with_right_ends(log, faults, clean, case, plant, catalogue):
    """Faults, log and case with the segment of a wrongly labelled wind as the ship's answer says."""
    for i, fault in enumerate(faults):
        if mislabel_of(fault) in WIND_LABELS and len(fault.segments) == 1:
            raw = repaired(log, faults[:i] + faults[i + 1 :])
            moved, clean, case = _settled(raw, mislabel_of(fault), fault, case, plant, catalogue)
            faults = [*faults[:i], moved, *faults[i + 1 :]]
    return faults, clean, case


def rewired(clean, plant, catalogue, case):
    """Connections of the system that the log contradicts, and ship and case with them as their names say."""
    if plant.wiring is None:
        return [], plant, case
    found, score = [], at_first_sight(case)
    for name, told in plant.wiring.odd.items():
        better = replace(plant, wiring=put_right(plant.wiring, name))
        again = prepare(clean, better, catalogue)
        scored = at_first_sight(again)
        if scored > score + _FAULT:
            found.append(Finding("connection", name, "physics", 0.99, {}, note=told))
            plant, case, score = better, again, scored
    return found, plant, case


def with_right_drivers(clean, case, fits, plant, catalogue):
    """The likeliest fault of thrusters' or the wind's channels, and all with it put right; None if there is none."""
    likely = []
    for _, mislabel, fault in suspected(clean, case)[:_SUSPECTS]:
        again = prepare(with_label(clean, mislabel, fault.segments), plant, catalogue)
        sight = at_first_sight(again)
        if sight > fits[0].score:
            likely.append((sight, mislabel, fault, again))
    for _, mislabel, fault, again in sorted(likely, key=lambda entry: -entry[0]):
        fault, right, again = _settled(clean, mislabel, fault, again, plant, catalogue)
        better = explain(again)
        close = [fit for fit in better[:3] if fit.score > fits[0].score + _price(fault, fits[0])]
        if any(_is_explained(again, fit) for fit in close):
            return fault, right, again, better
    return None


def _settled(clean, mislabel, fault, case, plant, catalogue):
    """A fault of labels with its segment settled, the log with that put right, and its case."""
    right = with_label(clean, mislabel, fault.segments)
    for _ in range(_SETTLING if fault.segments else 0):
        moved = settled(clean, mislabel, fault, case)
        if moved is fault:
            break
        fault, right = moved, with_label(clean, mislabel, moved.segments)
        case = prepare(right, plant, catalogue)
    return fault, right, case


def _price(fault, fit):
    """What a fault of the drivers' channels has to gain over a fit: little, if it is a unit and the fit a scale."""
    label = mislabel_of(fault)
    is_scale = any(suspect.cause == "wind_scale" for suspect in fit.suspects)
    return _UNIT if label is not None and label.scale is not None and is_scale else _FAULT


def _is_explained(case, fit):
    """Whether nothing without a name is left beside a fit."""
    return len(fit.suspects) <= MOST and max(unexplained(case, fit).values()) < STRANGE
