"""The diagnosis from end to end: a log goes in, findings come out."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.drivers import settled, suspected, with_label
from shipcosim.diagnose.effects import read_catalogue, suspects
from shipcosim.diagnose.evidence import gram
from shipcosim.diagnose.examine import examine
from shipcosim.diagnose.finding import Diagnosis, Finding
from shipcosim.diagnose.law import lawful
from shipcosim.diagnose.log import read_log
from shipcosim.diagnose.mislabels import WIND_LABELS, mislabel_of
from shipcosim.diagnose.nameless import FORCES, unexplained
from shipcosim.diagnose.noise import first_noise, tuned
from shipcosim.diagnose.null import null_gains
from shipcosim.diagnose.onset import from_onset
from shipcosim.diagnose.plant import plant_of
from shipcosim.diagnose.prescription import prescribe
from shipcosim.diagnose.ranking import Case, fitted, prepared, probes, weighed
from shipcosim.diagnose.record import first_motion, record_of
from shipcosim.diagnose.repair import repaired
from shipcosim.diagnose.search import at_first_sight, explain, without_causes
from shipcosim.diagnose.sensors import relabelled
from shipcosim.diagnose.timing import clock_by_answer, is_testable, with_rate
from shipcosim.diagnose.verdict import MOST, STRANGE, gained, judge, not_testable
from shipcosim.diagnose.whitening import innovations
from shipcosim.diagnose.wiring import put_right

__all__ = ["Details", "diagnose", "prepare"]

_FAULT = 15.0  # nats that a fault of the data has to gain over the best causes without it
_UNIT = 3.0  # nats that another unit has to gain over the scale of the same channel, which is free to be anything
_LIKE_WIND = ("wind_scale", "wind_direction", "wave_drift", "tow")  # steady forces, from the earth or the air
_FAULTS = 2  # of the drivers' channels, at most
_SUSPECTS, _SETTLING = 3, 2  # of those, that are tried; how often the segment of one is settled, at most
_WITHOUT_WIND = 40.0  # nats more that a cause has to gain where the wind could be it (assumed)
_GUSTS = 10.0  # times as fast may an unexplained force walk where nobody knows the wind
_BLIND = 25.0  # nats, that a cause may gain by chance where that cannot be tried (assumed)
_SURE = 100.0  # nats, far above what any healthy log gained
_MOST_WALK = 3e-5  # m/s2.5: some 400 N on Gunnerus in ten minutes


@dataclass(frozen=True)
class Details:
    """What the diagnosis rests on, for the page and for further work.

    Attributes
    ----------
    log, clean : xarray.Dataset
        As read, and repaired.
    case : Case
    fits : list of Fit
        Best first.
    fit : Fit
        The set of causes that the verdict rests on; empty where nothing is named.
    strange : dict of str to float
        Gain of errors without a name beside it, by kind. [nats]
    chance : dict of str to float
        What its causes gain on healthy logs like this one; empty where they gain far more anyway. [nats]
    """

    log: Any
    clean: Any
    case: Any
    fits: list
    fit: Any
    strange: dict
    chance: dict


def diagnose(data, system, channels=None, effects=None, progress=None):
    """Diagnose a log.

    Parameters
    ----------
    data : path
        Measured data, see docs/measured-data.md.
    system : System
        The ship that the log is held against, as `read_system` gives it.
    channels : path, optional
        Channel file.
    effects : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.

    Returns
    -------
    tuple of Diagnosis, Details

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda _: None)
    with threadpool_limits(1):  # many small matrices: threads would only wait for each other
        say("is the log right?")
        log = read_log(data, channels)
        faults = examine(log)
        clean = repaired(log, faults)
        plant, catalogue = plant_of(system), read_catalogue(effects)
        say("which causes explain it?")
        case = prepare(clean, plant, catalogue)
        plant = replace(plant, strangers=case.plant.strangers)
        faults, clean, case = _with_right_sensors(log, faults, clean, case, plant, catalogue)
        faults, clean, case = _with_right_clock(log, faults, clean, case, plant, catalogue)
        faults, clean, case = _with_right_ends(log, faults, clean, case, plant, catalogue)
        wrong, plant, case = _rewired(clean, plant, catalogue, case)
        fits = explain(case)
        clean, case, fits, more, began = _looked_closer(clean, case, fits, plant, catalogue)
        faults += more
        say("what do healthy ships look like?")
        judgement, strange, chance = _judged(case, fits)
        verdict = "named" if (faults or wrong) and judgement.verdict == "consistent" else judgement.verdict
        diagnosis = Diagnosis(
            verdict,
            (*faults, *wrong, *(replace(finding, onset=began) for finding in judgement.findings)),
            judgement.candidates,
            judgement.indistinguishable,
            tuple(sorted({*_not_testable(case, fits), *_hidden(catalogue, case)})),
            prescribe(case, judgement.fit, judgement.rivals) if judgement.rivals and not plant.strangers else None,
        )
        return diagnosis, Details(log, clean, case, fits, judgement.fit, strange, chance)


def _with_right_sensors(log, faults, clean, case, plant, catalogue):
    """Faults, log and case with the channels of the navigation labelled as the ship's answer says."""
    best, enough = None, None
    for better in relabelled(log, faults, case):
        enough = explain(case, most=1)[0].score + _FAULT if enough is None else enough
        right = repaired(log, better.faults)
        again = prepare(right, plant, catalogue)
        score = at_first_sight(again) + better.stretch
        if score > enough:
            best, enough = (better.faults, right, again), score
    return best or (faults, clean, case)


def _with_right_clock(log, faults, clean, case, plant, catalogue):
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


def _rewired(clean, plant, catalogue, case):
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


def _looked_closer(clean, case, fits, plant, catalogue):
    """Where something is wrong: whether channels of the drivers are wrong instead, or it began during the log.

    Returns
    -------
    tuple
        Log, case and fits with that put right; faults of the data; time from which on causes act, or None. [s]
    """
    faults, began, healthy = [], None, _is_healthy(case, fits[0])
    while len(faults) < _FAULTS and not healthy:
        better = _with_right_drivers(clean, case, fits, plant, catalogue)
        if better is None or any(set(better[0].channels) & set(fault.channels) for fault in faults):
            break  # nothing, or what a channel already put right elsewhere cannot be: something else is wrong with it
        fault, clean, case, fits = better
        faults.append(fault)
        healthy = _is_healthy(case, fits[0])
    if not healthy:
        later = from_onset(clean, case, fits, lambda part: prepare(part, plant, catalogue, case.noise))
        if later is not None:
            began, clean, case, fits = later
    return clean, case, fits, faults, began


def _is_healthy(case, fit):
    """Whether neither a cause nor an error without a name is in sight."""
    return not fit.suspects and max(unexplained(case, fit).values()) < STRANGE


def _judged(case, fits):
    """The verdict, errors without a name beside it, and what its causes would have gained by chance."""
    strange, unknown_wind = {}, case.record.wind is None

    def beside(fit):
        if fit not in strange:
            strange[fit] = unexplained(case, fit)
        # where nobody knows the wind, a force that nobody explains is no surprise
        return {kind: gain for kind, gain in strange[fit].items() if kind not in FORCES or not unknown_wind}

    chance = {suspect.label: _WITHOUT_WIND for suspect in case.suspects if unknown_wind}
    judgement = judge(fits, beside, chance)
    if judgement.verdict == "unknown" and judge([without_causes(fits)], beside).verdict == "unknown":
        return judgement, strange[judgement.fit], chance  # whatever its causes gain by chance
    more = _by_chance(case, judgement.fit, fits)
    if more:
        chance = {label: chance.get(label, 0.0) + gain for label, gain in more.items()}
        judgement = judge(fits, beside, chance)
    return judgement, strange[judgement.fit], chance


def _by_chance(case, fit, fits):
    """What causes gain on healthy logs like this one, where that could matter: mean and three deviations.

    Where no healthy ship keeps to the log's track, as one that cannot go sideways, nobody knows: it is assumed.
    """
    if not any(gained(suspect, fit, fits) < _SURE for suspect in fit.suspects):
        return {}
    found = null_gains(case, fit.motion, fit.suspects)
    return {
        label: float(max(values.mean() + 3.0 * values.std(), values.max())) if values.size else _BLIND
        for label, values in found.items()
    }


def _with_right_drivers(clean, case, fits, plant, catalogue):
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


def _with_right_ends(log, faults, clean, case, plant, catalogue):
    """Faults, log and case with the segment of a wrongly labelled wind as the ship's answer says."""
    for i, fault in enumerate(faults):
        if mislabel_of(fault) in WIND_LABELS and len(fault.segments) == 1:
            raw = repaired(log, faults[:i] + faults[i + 1 :])
            moved, clean, case = _settled(raw, mislabel_of(fault), fault, case, plant, catalogue)
            faults = [*faults[:i], moved, *faults[i + 1 :]]
    return faults, clean, case


def _settled(clean, mislabel, fault, case, plant, catalogue):
    """A fault of labels with its segment settled, the log with that put right, and its case."""
    for _ in range(_SETTLING if fault.segments else 0):
        moved = settled(clean, mislabel, fault, case)
        if moved is fault:
            break
        fault, case = moved, prepare(with_label(clean, mislabel, moved.segments), plant, catalogue)
    return fault, with_label(clean, mislabel, fault.segments), case


def _price(fault, fit):
    """What a fault of the drivers' channels has to gain over a fit: little, if it is a unit and the fit a scale."""
    label = mislabel_of(fault)
    is_scale = any(suspect.cause == "wind_scale" for suspect in fit.suspects)
    return _UNIT if label is not None and label.scale is not None and is_scale else _FAULT


def _is_explained(case, fit):
    """Whether nothing without a name is left beside a fit."""
    return len(fit.suspects) <= MOST and max(unexplained(case, fit).values()) < STRANGE


def prepare(clean, plant, catalogue, noise=None):
    """The case of a repaired log: noise tuned beside whatever explains it best at first sight.

    Parameters
    ----------
    clean : xarray.Dataset
    plant : Plant
    catalogue : dict of str to Effect
    noise : Noise, optional
        Where it is known already.

    Returns
    -------
    Case
    """
    plant = replace(plant, span=(float(clean["time"][0]), float(clean["time"][-1])))
    plant = replace(plant, wind_is_true="wind_speed" not in clean and "true_wind_speed" in clean)
    plant = replace(plant, fixed={n: angle for n, angle in plant.fixed.items() if f"{n}_azimuth" not in clean})
    record, length = record_of(clean, plant), plant.parts["hull"].length
    motion = first_motion(record, plant)
    plant = lawful(plant, record, motion)
    everyone = suspects(catalogue, plant)
    hidden = unidentifiable(everyone, record, clean, plant.strangers)
    if record.wind is None:
        plant = replace(plant, tolerances=plant.tolerances | _unknown_wind(everyone))
    wanted = tuple(suspect for suspect in everyone if suspect not in hidden)
    start = first_noise(record, length) if noise is None else noise
    case = prepared(Case(record, plant, wanted, start, motion))
    if noise is not None:
        return case
    fit = fitted(case)
    gain, suspect, values = weighed(case, fit)[0]
    if gain > 3.0:
        fit = fitted(case, (suspect,), values)
    most = _MOST_WALK * np.array([1.0, 1.0, 4.0 / length])
    most *= 1.0 if record.wind is not None else _GUSTS
    noise = tuned(start, fit.linear, record, fit.left, most_walk=most)
    return prepared(replace(case, noise=noise))


def unidentifiable(everyone, record, clean, strangers=()):
    """Suspects that a log without some channels cannot show: of wind and what acts like it, of silent thrusters.

    Parameters
    ----------
    everyone : sequence of Suspect
    record : Record
    clean : xarray.Dataset
    strangers : collection of str
        Thrusters that the log is sure to have, whatever drives them.

    Returns
    -------
    list of Suspect
    """
    silent = [name for name in record.units if f"{name}_rpm" not in clean and name not in strangers]
    return [s for s in everyone if s.component in silent or (record.wind is None and s.cause in _LIKE_WIND)]


def _hidden(catalogue, case):
    """Causes that are suspected nowhere."""
    there = {suspect.cause for suspect in case.suspects}
    return [suspect.cause for suspect in suspects(catalogue, case.plant) if suspect.cause not in there]


def _unknown_wind(everyone):
    """Tolerance of a force over ground, where nobody knows the wind."""
    knobs = [knob for suspect in everyone if suspect.cause == "tow" for knob in suspect.knobs]
    return {path: knob.typical for knob in knobs for path in knob.paths}


def _not_testable(case, fits):
    nothing = without_causes(fits)
    columns, groups = list(nothing.columns), []
    for suspect in case.suspects:
        for group in probes(suspect):
            groups.append((suspect, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = gram(innovations(case.base_of(columns), case.noise, case.record)).products
    return (*not_testable(case, products, columns, groups), *(() if is_testable(case) else ("clock",)))
