"""What common causes gain in each log: the system extended by what the other logs say, co-simulated over this one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.extension.extended_system import ExtendedSystem
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, paths_of
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.inference.fitting import IdentificationProblem, fitted
from shipcosim.diagnose.reference.joint_fit import JointFit, fitted_jointly
from shipcosim.diagnose.reference.log_errors import LogErrors, errors_on
from shipcosim.diagnose.reference.several_logs import SeveralLogs, is_in_one_log, values_in
from shipcosim.diagnose.reference.thresholds import MOST_PIECES
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.validation.cosimulation import Replayed
from shipcosim.diagnose.validation.gain import calibrated
from shipcosim.diagnose.validation.replays import findings_of
from shipcosim.diagnose.validation.tracks import (
    Tracks,
    fitting_horizon,
    misses_at_end,
    tracks_by_models,
    tracks_by_systems,
)
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_system
from shipcosim.temporary import temporary_folder

SizesOfLogs = dict[str, dict[str, dict[str, ParameterEstimate]]]
"""Sizes by log, cause and parameter."""


def sizes_without(
    logs: SeveralLogs, name: str, hypotheses: Sequence[Hypothesis], values: Mapping[str, float]
) -> list[Finding]:
    """Causes in the ship with their sizes by all logs but one, as findings."""
    # Fit the causes to the other logs alone, each with
    # its own weather, and return those in the ship.
    others = SeveralLogs(
        {other: problem for other, problem in logs.problems.items() if other != name}
    )
    others_hypotheses = [
        hypothesis
        for hypothesis in hypotheses
        if not is_in_one_log(hypothesis) or hypothesis.component in others.problems
    ]
    start = {path: value for path, value in values.items() if path in paths_of(others_hypotheses)}
    fit = fitted_jointly(others, others_hypotheses, start, rounds=3)
    of_ship = {
        hypothesis.label for hypothesis in others_hypotheses if not is_in_one_log(hypothesis)
    }
    return [finding for finding in findings_of(fit) if finding.label in of_ship]


def sizes_by_log(
    logs: SeveralLogs, hypotheses: Sequence[Hypothesis], values: Mapping[str, float]
) -> SizesOfLogs:
    """How large each log by itself would have the causes in the ship: by label, log and parameter.

    Parameters
    ----------
    logs : SeveralLogs
    hypotheses : sequence of Hypothesis
        Named, those of the weather among them.
    values : mapping of str to float
        By all logs, to start from.
    """
    # Fit each log by itself, with the causes that it has something to say of.
    by_label: SizesOfLogs = {}
    for name, problem in logs.problems.items():
        of_log = [hypothesis for _, hypothesis in logs.all_within(name, hypotheses)]
        start = {p: v for p, v in values_in(name, values).items() if p in paths_of(of_log)}
        fit = fitted(problem, of_log, start, rounds=3)
        for finding, hypothesis in zip(findings_of(fit), of_log, strict=True):
            # The standard deviation includes the tolerance of each parameter.
            tolerances = {of.name: of.tolerance * of.factor for of in hypothesis.parameters}
            by_label.setdefault(finding.label, {})[name] = {
                key: replace(
                    size, std=float(np.hypot(size.std, tolerances[key]))
                )  # as of a finding
                for key, size in finding.parameters.items()
            }
    of_ship = {hypothesis.label for hypothesis in hypotheses if not is_in_one_log(hypothesis)}
    return {label: sizes for label, sizes in by_label.items() if label in of_ship}


def weather_of(fit: JointFit, name: str, hypotheses: Sequence[Hypothesis]) -> list[Finding]:
    """Causes that belong to the day of one log, from the fit of all logs."""
    of_log = {hypothesis.cause for hypothesis in hypotheses if hypothesis.component == name}
    return [
        finding
        for finding in findings_of(fit.parts[name])
        if finding.cause in of_log and finding.component is None
    ]


def errors_by_log(
    fit: JointFit,
    logs: SeveralLogs,
    given: ExtendedSystem,
    findings: Callable[[str], tuple[list[Finding], list[Finding]]],
    crafts: Mapping[str, LearnedCraft],
    causes: Mapping[str, Cause],
    progress: Callable[[str, int, int], None],
) -> dict[str, LogErrors]:
    """The errors of each log by co-simulation, before and after.

    All logs are predicted over the same times: the shortest that fit one of them.

    Parameters
    ----------
    fit : JointFit
        Of the common causes to all logs.
    logs : SeveralLogs
    given : ExtendedSystem
        Not extended yet.
    findings : callable
        From the name of a log to causes in the ship, sized without that log, and those of its own weather.
    crafts : mapping of str to LearnedCraft
        By log, the craft as the other logs teach her, where they do.
    causes : mapping of str to Cause
    progress : callable
        Called with the name of a log, how many pieces of it are done, and of how many.
    """
    by_log = {}
    # One horizon for all logs, so that their errors can be compared.
    horizon = min(fitting_horizon(each.record, each.model) for each in logs.problems.values())
    # Each log is predicted with causes that the other logs have sized, and with its own weather.
    for name, problem in logs.problems.items():
        of_ship, of_day = findings(name)
        craft = crafts.get(name)
        others = tuple(other for other in logs.problems if other != name)
        others = others if of_ship or craft else ()
        fitted_to_it = calibrated(fit.parts[name])
        about = _Judged(name, problem, fitted_to_it, horizon, of_ship, of_day, others, craft)
        by_log[name] = _log_errors(about, given, causes, progress)
    return {name: errors for name, errors in by_log.items() if errors is not None}


@dataclass(frozen=True)
class _Judged:
    """A log whose errors are wanted: over which horizon [s], with which causes, sized by which other logs."""

    name: str
    problem: IdentificationProblem
    fitted_to_it: ShipModel
    horizon: float
    of_ship: list[Finding]
    own: list[Finding]
    others: tuple[str, ...]
    craft: LearnedCraft | None = None


def _log_errors(
    log: _Judged,
    given: ExtendedSystem,
    causes: Mapping[str, Cause],
    progress: Callable[[str, int, int], None],
) -> LogErrors | None:
    """The errors of one log; None if it has no complete stretch."""
    # Predict by co-simulation. If it fails, at least the
    # errors of the unchanged system, by the array model.
    remark = ""
    try:
        tracks = _cosimulated(log, given, causes, progress)
    except ShipcosimError as error:
        remark = f"{log.name} was not co-simulated: {'; '.join(map(str, error.problems))}"
        log = replace(log, own=[], others=())
        try:
            tracks = tracks_by_models(
                log.problem.record, {"before": log.problem.model}, log.horizon
            )
        except ShipcosimError:
            return None
    return replace(
        errors_on(tracks, log.others),
        own=tuple(finding.cause for finding in log.own),
        remark=remark,
        misses=_misses(log, tracks) if "after" in tracks.predicted else None,
    )


def _cosimulated(log, given, causes, progress) -> Tracks:
    """Predictions by the system, and by the one with the causes in it."""
    # The system as it is, and extended by the findings, along the same track.
    record = log.problem.record
    model = log.problem.model
    systems = {"before": Replayed(given.given)}
    with temporary_folder() as folder:
        if log.of_ship or log.own or log.craft:
            about = {"span": model.span, "source": ", ".join(log.others)}
            made = extend(
                given.source,
                [*log.of_ship, *log.own],
                folder,
                log.craft,
                log_attributes=about,
                catalogue=causes,
            )
            systems["after"] = Replayed(read_system(str(made.ssp)), made.signals)
        each = lambda done, of: progress(log.name, done, of)  # noqa: E731
        return tracks_by_systems(record, model, systems, log.horizon, each, MOST_PIECES)


def _misses(log: _Judged, tracks: Tracks) -> np.ndarray:
    """Errors of each prediction: before, after, and in array form by the ship that was fitted to this log too."""
    # The noise floor: the ship fitted to this log too.
    floor = tracks_by_models(log.problem.record, {"floor": log.fitted_to_it}, log.horizon)
    # Predictions of both kinds start at different rows; take those of the floor that match.
    starts, before = misses_at_end(tracks, "before")
    all_starts, least = misses_at_end(floor, "floor")
    return np.stack(
        [before, misses_at_end(tracks, "after")[1], least[np.searchsorted(all_starts, starts)]]
    )
