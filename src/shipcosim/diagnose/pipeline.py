"""The diagnosis from end to end: a log goes in, findings come out."""

from dataclasses import dataclass, replace
from typing import Any

from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.design import prescribe
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue, suspects
from shipcosim.diagnose.inference.change_point import from_onset
from shipcosim.diagnose.inference.evidence import gram
from shipcosim.diagnose.inference.fitting import probes
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.null_distribution import null_gains
from shipcosim.diagnose.inference.problem import prepare
from shipcosim.diagnose.inference.search import explain, without_causes
from shipcosim.diagnose.inference.unmodelled import FORCES, unexplained
from shipcosim.diagnose.inference.verdict import STRANGE, gained, judge, not_testable
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log_faults.clock import is_testable
from shipcosim.diagnose.log_faults.corrections import (
    rewired,
    with_right_clock,
    with_right_drivers,
    with_right_sensors,
    with_right_wind,
)
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.model import plant_of

__all__ = ["Details", "diagnose"]

_FAULTS = 2  # of the drivers' channels, at most
_WITHOUT_WIND = 40.0  # nats more that a cause has to gain where the wind could be it (assumed)
_BLIND = 25.0  # nats, that a cause may gain by chance where that cannot be tried (assumed)
_SURE = 100.0  # nats, far above what any healthy log gained


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
        faults, clean, case = with_right_sensors(log, faults, clean, case, plant, catalogue)
        faults, clean, case = with_right_clock(log, faults, clean, case, plant, catalogue)
        faults, clean, case = with_right_wind(log, faults, clean, case, plant, catalogue)
        wrong, plant, case = rewired(clean, plant, catalogue, case)
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


def _looked_closer(clean, case, fits, plant, catalogue):
    """Where something is wrong: whether channels of the drivers are wrong instead, or it began during the log.

    Returns
    -------
    tuple
        Log, case and fits with that put right; faults of the data; time from which on causes act, or None. [s]
    """
    faults, began, healthy = [], None, _is_healthy(case, fits[0])
    while len(faults) < _FAULTS and not healthy:
        better = with_right_drivers(clean, case, fits, plant, catalogue)
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


def _hidden(catalogue, case):
    """Causes that are suspected nowhere."""
    there = {suspect.cause for suspect in case.suspects}
    return [suspect.cause for suspect in suspects(catalogue, case.plant) if suspect.cause not in there]


def _not_testable(case, fits):
    nothing = without_causes(fits)
    columns, groups = list(nothing.columns), []
    for suspect in case.suspects:
        for group in probes(suspect):
            groups.append((suspect, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = gram(innovations(case.base_of(columns), case.noise, case.record)).products
    return (*not_testable(case, products, columns, groups), *(() if is_testable(case) else ("clock",)))
