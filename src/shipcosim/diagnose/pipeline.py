"""The diagnosis from end to end: a log goes in, findings come out."""

from dataclasses import dataclass, replace
from typing import Any

from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.design import design_experiment
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.change_point import from_change_point
from shipcosim.diagnose.inference.evidence import gram
from shipcosim.diagnose.inference.fitting import probes
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.null_distribution import null_gains
from shipcosim.diagnose.inference.problem import prepare
from shipcosim.diagnose.inference.search import explain, without_causes
from shipcosim.diagnose.inference.unmodelled import FORCES, unexplained
from shipcosim.diagnose.inference.verdict import UNMODELLED, gained, judge, not_testable
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log_faults.clock import is_testable
from shipcosim.diagnose.log_faults.corrections import (
    rewired,
    with_right_clock,
    with_right_inputs,
    with_right_sensors,
    with_right_wind,
)
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.model import ship_model_of

__all__ = ["Details", "diagnose"]

_FAULTS = 2  # of the inputs' channels, at most
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
    problem : IdentificationProblem
    fits : list of Fit
        Best first.
    fit : Fit
        The set of causes that the verdict rests on; empty where nothing is named.
    unmodelled : dict of str to float
        Gain of errors without a name beside it, by kind. [nats]
    chance : dict of str to float
        What its causes gain on healthy logs like this one; empty where they gain far more anyway. [nats]
    """

    log: Any
    clean: Any
    problem: Any
    fits: list
    fit: Any
    unmodelled: dict
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
        model, catalogue = ship_model_of(system), read_catalogue(effects)
        say("which causes explain it?")
        problem = prepare(clean, model, catalogue)
        model = replace(model, third_party=problem.model.third_party)
        faults, clean, problem = with_right_sensors(log, faults, clean, problem, model, catalogue)
        faults, clean, problem = with_right_clock(log, faults, clean, problem, model, catalogue)
        faults, clean, problem = with_right_wind(log, faults, clean, problem, model, catalogue)
        wrong, model, problem = rewired(clean, model, catalogue, problem)
        fits = explain(problem)
        clean, problem, fits, more, began = _looked_closer(clean, problem, fits, model, catalogue)
        faults += more
        say("what do healthy ships look like?")
        judgement, unmodelled, chance = _judged(problem, fits)
        verdict = "named" if (faults or wrong) and judgement.verdict == "consistent" else judgement.verdict
        diagnosis = Diagnosis(
            verdict,
            (*faults, *wrong, *(replace(finding, onset=began) for finding in judgement.findings)),
            judgement.candidates,
            judgement.indistinguishable,
            tuple(sorted({*_not_testable(problem, fits), *_hidden(catalogue, problem)})),
            design_experiment(problem, judgement.fit, judgement.rivals)
            if judgement.rivals and not model.third_party
            else None,
        )
        return diagnosis, Details(log, clean, problem, fits, judgement.fit, unmodelled, chance)


def _looked_closer(clean, problem, fits, model, catalogue):
    """Where something is wrong: whether channels of the inputs are wrong instead, or it began during the log.

    Returns
    -------
    tuple
        Log, case and fits with that put right; faults of the data; time from which on causes act, or None. [s]
    """
    faults, began, healthy = [], None, _is_healthy(problem, fits[0])
    while len(faults) < _FAULTS and not healthy:
        better = with_right_inputs(clean, problem, fits, model, catalogue)
        if better is None or any(set(better[0].channels) & set(fault.channels) for fault in faults):
            break  # nothing, or what a channel already put right elsewhere cannot be: something else is wrong with it
        fault, clean, problem, fits = better
        faults.append(fault)
        healthy = _is_healthy(problem, fits[0])
    if not healthy:
        later = from_change_point(clean, problem, fits, lambda part: prepare(part, model, catalogue, problem.noise))
        if later is not None:
            began, clean, problem, fits = later
    return clean, problem, fits, faults, began


def _is_healthy(problem, fit):
    """Whether neither a cause nor an error without a name is in sight."""
    return not fit.hypotheses and max(unexplained(problem, fit).values()) < UNMODELLED


def _judged(problem, fits):
    """The verdict, errors without a name beside it, and what its causes would have gained by chance."""
    unmodelled, unknown_wind = {}, problem.record.wind is None

    def beside(fit):
        if fit not in unmodelled:
            unmodelled[fit] = unexplained(problem, fit)
        # where nobody knows the wind, a force that nobody explains is no surprise
        return {kind: gain for kind, gain in unmodelled[fit].items() if kind not in FORCES or not unknown_wind}

    chance = {hypothesis.label: _WITHOUT_WIND for hypothesis in problem.hypotheses if unknown_wind}
    judgement = judge(fits, beside, chance)
    if judgement.verdict == "unknown" and judge([without_causes(fits)], beside).verdict == "unknown":
        return judgement, unmodelled[judgement.fit], chance  # whatever its causes gain by chance
    more = _by_chance(problem, judgement.fit, fits)
    if more:
        chance = {label: chance.get(label, 0.0) + gain for label, gain in more.items()}
        judgement = judge(fits, beside, chance)
    return judgement, unmodelled[judgement.fit], chance


def _by_chance(problem, fit, fits):
    """What causes gain on healthy logs like this one, where that could matter: mean and three deviations.

    Where no healthy ship keeps to the log's track, as one that cannot go sideways, nobody knows: it is assumed.
    """
    if not any(gained(hypothesis, fit, fits) < _SURE for hypothesis in fit.hypotheses):
        return {}
    found = null_gains(problem, fit.motion, fit.hypotheses)
    return {
        label: float(max(values.mean() + 3.0 * values.std(), values.max())) if values.size else _BLIND
        for label, values in found.items()
    }


def _hidden(catalogue, problem):
    """Causes that are suspected nowhere."""
    there = {hypothesis.cause for hypothesis in problem.hypotheses}
    return [hypothesis.cause for hypothesis in hypotheses_of(catalogue, problem.model) if hypothesis.cause not in there]


def _not_testable(problem, fits):
    nothing = without_causes(fits)
    columns, groups = list(nothing.columns), []
    for hypothesis in problem.hypotheses:
        for group in probes(hypothesis):
            groups.append((hypothesis, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = gram(innovations(problem.base_of(columns), problem.noise, problem.record)).products
    return (*not_testable(problem, products, columns, groups), *(() if is_testable(problem) else ("clock",)))
