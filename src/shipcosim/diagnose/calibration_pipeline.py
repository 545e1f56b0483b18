"""From logs of a ship that is well to her own parameter set, and the reference that other logs are compared with."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.compared_log import learned_from, surely_taught
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.inference.thresholds import FORM_COST
from shipcosim.diagnose.log.runs import LogSource
from shipcosim.diagnose.log_faults.corrections import corrected
from shipcosim.diagnose.numerics import root_mean_square
from shipcosim.diagnose.pipeline import (
    AnySystem,
    Progress,
    causes_in,
    given_system,
    problem_of,
    read_measurements,
)
from shipcosim.diagnose.reference.calibration import (
    calibrated_to,
    causes_beside,
    numbers_of,
    reference_of,
)
from shipcosim.diagnose.reference.joint_fit import JointFit
from shipcosim.diagnose.reference.learned_reference import learned_reference
from shipcosim.diagnose.reference.log_errors import LogErrors, errors_by_models
from shipcosim.diagnose.reference.parameter_set import FILE as SET
from shipcosim.diagnose.reference.parameter_set import write_parameter_set
from shipcosim.diagnose.reference.reference import FILE, KnownNumber, Reference, ReferenceLog
from shipcosim.diagnose.reference.remaining_errors import remaining_errors
from shipcosim.diagnose.reference.several_logs import SeveralLogs, is_of_day
from shipcosim.diagnose.reference.thresholds import AT_EDGE, BEYOND, NOT_WELL
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.ssp import AnyPath, System

READING = "are the logs right?"

_ANOTHER_CRAFT = (
    "The craft differs far from her file, so her numbers are learned from the accelerations that the logs show. These "
    "logs cannot say whether she was in good condition."
)
_ALL_LEARNED = (
    "All numbers of the craft were assumed from her length or learned from these logs. They make no reference: such a "
    "rough craft cannot show whether she has a fault, now or later."
)
_KINDS_OF_THE_LOG = ("slow", "with the heading", "periodic", "in a channel")


@dataclass(frozen=True)
class CalibratedLog:
    """One of the logs that a ship was calibrated to.

    Attributes
    ----------
    name : str
    faults : tuple of Finding
        Of the log, repaired before.
    weather : dict of str to float
        Current and forces of its day that were fitted beside the ship: numbers in SI, by ``place.name``.
    errors : LogErrors or None
        Of the calibrated ship; None where no stretch of the log is whole.
    unmodelled : dict of str to float
        Gain of unmodelled errors that are left, by kind. [nats]
    """

    name: str
    faults: tuple[Finding, ...]
    weather: dict[str, float]
    errors: LogErrors | None
    unmodelled: dict[str, float]


@dataclass(frozen=True)
class CalibratedShip:
    """A ship calibrated to logs in which she is said to be well.

    Attributes
    ----------
    reference : Reference
    logs : tuple of CalibratedLog
    refusals : tuple of str
        Why these logs make no reference; empty where they do.
    remarks : tuple of str
        What to know before it is trusted.
    """

    reference: Reference
    logs: tuple[CalibratedLog, ...]
    refusals: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def untold(self) -> tuple[KnownNumber, ...]:
        """Numbers on which the logs have almost no information."""
        scale = self.reference.tolerance_scale
        return tuple(
            number
            for number in self.reference.numbers
            if number.std > 0.8 * scale * number.tolerance
        )


def steps_of(logs: Sequence[LogSource]) -> dict[str, float]:
    """Steps that `calibrate` reports to its progress function, in order, with their typical times. [s]"""
    many = len(logs)
    return {
        READING: 2.5 * many,
        "fitting the ship's numbers": 3.5 * many,
        "is she well?": 4.0 * many,
        "what does the calibrated ship get wrong?": 1.0 * many,
    }


def calibrate(
    logs: Sequence[LogSource],
    system: AnySystem,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    is_assumed: bool = False,
) -> CalibratedShip:
    """Fit a ship's numbers to logs in which she is known to be well.

    Parameters
    ----------
    logs : sequence of path or xarray.Dataset
        Measured data, one or several logs of the same ship.
    system : path, SystemStructure or System
        The ship.
    channels : path, optional
        Channel file, the same for all.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.
    out : path, optional
        Folder that gets calibrated.ssv, and reference.json of a known ship, unless the logs are refused.
    is_assumed : bool
        Whether all numbers of the ship are guesses: they are learned, and no cause in her is sought.

    Returns
    -------
    CalibratedShip

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    given = given_system(system).given
    with threadpool_limits(1):
        problems = problems_of(logs, given, channels, causes, say)
        # Faults of the logs first; logs that may be misread make no reference. A guessed ship shows none by her response.
        identified = (
            problems if is_assumed else {n: corrected(problem) for n, problem in problems.items()}
        )
        _check_usable(identified)
        # A craft far from the file's is learned by regression instead.
        if is_assumed or any(problem.comparison.started_craft for problem in identified.values()):
            say("fitting the ship's numbers")
            return _calibrated_craft(identified, given, out, is_assumed)
        # Fit all logs together: common numbers of the ship, weather by log.
        several = SeveralLogs(
            {name: problem.problem for name, problem in identified.items()}, is_well=True
        )
        say("fitting the ship's numbers")
        fitted = calibrated_to(several)
        # Look for causes that the fit may have absorbed: beside it, and in each log by itself.
        say("is she well?")
        suspects = causes_beside(fitted)
        named = {name: _named_in(problem) for name, problem in problems.items()}
        say("what does the calibrated ship get wrong?")
        errors = remaining_errors(fitted)
    ship = next(iter(identified.values())).ship
    # Unmodelled errors that such logs have anyway: later logs must exceed them.
    ordinary = {
        kind: max(gains[kind] for gains in fitted.unmodelled.values()) for kind in _KINDS_OF_THE_LOG
    }
    reference = reference_of(fitted, ship, ordinary, _reference_logs(identified), given.name)
    each = tuple(
        CalibratedLog(
            name,
            identification.faults,
            _weather(fitted.fit, name),
            errors[name],
            fitted.unmodelled[name],
        )
        for name, identification in identified.items()
    )
    # A reference is only written if nothing speaks against it.
    refusals, remarks = _judged(reference, fitted, suspects)
    refusals = (*_reasons_not_to_trust(each, named), *refusals)
    return _written(CalibratedShip(reference, each, refusals, remarks), given, out)


def _calibrated_craft(
    identified: Mapping[str, Identification], given: System, out: AnyPath | None, is_assumed: bool
) -> CalibratedShip:
    """A craft that is not the file's by far, as the logs teach her; refused where she predicts no better.

    Raises
    ------
    ShipcosimError
        Where she predicts logs, or parts of a single one, that were held out no better than the system for sure.
    """
    first = next(iter(identified.values()))
    ship = first.comparison.given(first.ship)
    compared = [
        (identification.repaired, identification.comparison)
        for identification in identified.values()
    ]
    if is_assumed:
        craft, what = surely_taught(compared, ship)
        right = ""
    else:
        craft = learned_from(compared, ship)
        what = "Numbers learned from the others do not clearly predict a log, or a part of it, better than the system."
        right = "Give more logs, with turns and with thrust ahead and astern."
    if craft is None:
        raise error_at(", ".join(identified), what, right)
    reference = learned_reference(craft, ship, _reference_logs(identified), given.name)
    # With several logs each is predicted by what the others taught (cross-validation).
    each = craft.each_without or (craft,)
    logs = []
    for others, (name, problem) in zip(each, identified.items(), strict=True):
        model = problem.comparison.given(problem.problem.model)
        names = [other for other in identified if other != name]
        # Predictions by the system, by the craft without this log, and by the craft with all logs.
        models = {"before": model, "after": others.on(model), "floor": craft.on(model)}
        errors = errors_by_models(problem.problem.record, models, names)
        logs.append(CalibratedLog(name, problem.faults, {}, errors, {}))
    refusals = tuple(_reasons_not_to_trust(logs, {}))
    remark = _ALL_LEARNED if is_assumed else _ANOTHER_CRAFT
    result = CalibratedShip(reference, tuple(logs), refusals, (remark,))
    return _written(result, given, out, is_assumed)


def _check_usable(identified: dict[str, Identification]) -> None:
    """Raise ShipcosimError where a log cannot show a ship that is well, or a system is wrong by far."""
    problems = []
    for name, identification in identified.items():
        for fault in (fault for fault in identification.faults if fault.alternatives):
            problems.append(
                Problem(
                    name, f"{fault.sentence}.", "Correct the channel file, and calibrate again."
                )
            )
        comparison = identification.comparison
        problems += [Problem(name, why) for why in comparison.obstacles]
    if problems:
        raise ShipcosimError(problems)


def log_names(logs: Sequence[LogSource]) -> list[str]:
    """Names of logs, each its own: those of their files, with a number where two are alike."""
    if not logs:
        raise error_at("logs", "There are none.", "Give at least one log.")
    stems = [_stem(log, k) for k, log in enumerate(logs, start=1)]
    return [
        stem if stems.count(stem) == 1 else f"{stem}-{k}" for k, stem in enumerate(stems, start=1)
    ]


def _stem(log, number):
    if isinstance(log, str | os.PathLike):
        return Path(Path(log).name.removesuffix(".gz")).stem.replace("|", "_")
    return f"log-{number}"


def problems_of(
    logs: Sequence[LogSource],
    system: System,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    reference: Reference | None = None,
) -> dict[str, Identification]:
    """Several logs by their names, each as an identification problem; all that cannot be used is reported at once."""
    identified = {}
    problems = []
    names = log_names(logs)
    for done, (name, log) in enumerate(zip(names, logs, strict=True)):
        if progress:
            progress(READING, done, len(names))
        try:
            identified[name] = problem_of(
                read_measurements(log, system, channels, causes, reference)
            )
        except ShipcosimError as error:
            problems += [problem for problem in error.problems if problem not in problems]
    if problems:
        raise ShipcosimError(problems)
    return identified


def _reference_logs(identified: Mapping[str, Identification]) -> list[ReferenceLog]:
    """Entry of a reference on the logs that it was made from."""
    logs = []
    for name, identification in identified.items():
        time = identification.log["time"].values
        span = (float(time[0]), float(time[-1]))
        sha256 = identification.log.encoding.get("sha256", "")
        logs.append(ReferenceLog(name=name, sha256=sha256, rows=int(time.size), span_s=span))
    return logs


def _written(
    result: CalibratedShip, given: System, out: AnyPath | None, is_assumed: bool = False
) -> CalibratedShip:
    """Write the files of a calibration; nothing is written unless asked, or if the logs are refused.

    A craft of whom all was guessed is no reference: her form is too rough for causes to be named beside it.
    """
    if out is not None and not result.refusals:
        write_parameter_set(given, result.reference, Path(out) / SET)
        if not is_assumed:
            result.reference.write(Path(out) / FILE)
    return result


def _weather(fit: JointFit, name: str) -> dict[str, float]:
    part = fit.parts[name]
    return {path: float(value) for path, value in part.values.items() if path.startswith("water.")}


def _named_in(problem: Identification) -> list[Finding]:
    """Causes in the ship, none of the day's weather, that a diagnosis names in a log."""
    diagnosis = causes_in(problem, problem.ship, lambda *_: None)
    of_day = {
        hypothesis.label for hypothesis in problem.problem.hypotheses if is_of_day(hypothesis)
    }
    return [finding for finding in diagnosis.physics if finding.label not in of_day]


def _reasons_not_to_trust(
    logs: Sequence[CalibratedLog], named: Mapping[str, Sequence[Finding]]
) -> list[str]:
    """Why a fit to these logs makes no reference: a cause in the ship is named, or it predicts no better than before.

    A wide enough tolerance makes a number of the ship out of every cause, so the logs are diagnosed as any others.
    """
    reasons = [
        f"{name}: a diagnosis of it names {finding.label.replace('_', ' ')} ({100.0 * finding.probability:.0f} %): "
        "the ship was not well. "
        "Diagnose the log, mend the ship or the system, and calibrate on logs without it."
        for name, findings in named.items()
        for finding in findings
    ]
    # Over all logs, each alike, on rows that the numbers were not fitted on.
    errors = [log.errors for log in logs if log.errors]
    if not errors:
        return reasons
    before = root_mean_square(np.array([error.position["before"][-1] for error in errors]))
    after = root_mean_square(np.array([error.position["after"][-1] for error in errors]))
    if after > before:
        reasons.append(
            f"On rows that it was not fitted on, the calibrated ship misses the log by {after:.2g} m. The ship as the "
            f"system has her misses it by {before:.2g} m. Log more, with larger moves, turns and thrust ahead and astern."
        )
    return reasons


def _judged(reference, calibrated, suspects):
    """Reasons why these logs make no reference, and remarks on the reference that they make."""
    refusals = []
    remarks = []
    # Unbounded moves of the numbers, to compare with the bounded estimates.
    names, _, by, _ = numbers_of(calibrated.fit)
    moved = dict(zip(names, by, strict=True))
    # Causes that still gain beside the calibrated ship.
    for label, gain in suspects.items():
        text = f"The logs still look like {label.replace('_', ' ')} beside the calibrated ship ({gain:.0f} nats)"
        if gain > NOT_WELL:
            refusals.append(
                f"{text}: she is not well, or the system is wrong there. Diagnose these logs first."
            )
        else:
            remarks.append(
                f"{text}. If the ship has this fault, later logs will be compared with a faulty ship."
            )
    # Numbers at their bounds refuse the reference; those at the edge of their tolerances get a
    # remark.
    for number in reference.numbers:
        wanted = number.nominal + moved[number.name]
        if abs(wanted - number.estimate) > BEYOND * number.std:
            refusals.append(f"{number.name} would be {wanted:g} {number.unit}, beyond its bounds.")
        elif (
            abs(number.estimate - number.nominal)
            > AT_EDGE * reference.tolerance_scale * number.tolerance
        ):
            off = abs(number.estimate - number.nominal) / number.tolerance
            remarks.append(
                f"{number.name} is {off:.1f} of its tolerances off: is its value right, and the tolerance?"
            )
    for name, kinds in calibrated.unmodelled.items():
        for kind, gain in kinds.items():
            if gain > NOT_WELL:
                refusals.append(
                    f"{name}: the calibrated ship does not fit it ({kind}, {gain:.0f} nats)."
                )
    if reference.tolerance_scale > 1.0:
        remarks.append(
            f"It takes {reference.tolerance_scale:g} times the stated tolerances to explain the logs. The ship is of "
            "another form than the model, or her numbers are less well known than the system says."
        )
    if reference.form_scale > 0.0 and calibrated.form_gain < FORM_COST:
        remarks.append(
            "These logs do not tell whether her loads have the form of the model's. Drag along the hull, wind over the "
            "angle, damping and added mass stay as uncertain as is usual. A log with moves, turns and thrust both ways "
            "would tell."
        )
    elif reference.form_scale > 0.0:
        remarks.append(
            f"She is of another form than the model, by {reference.form_scale:g} times what is usual. Drag along the "
            "hull, wind over the angle, damping and added mass are fitted as functions. The reference has all of them, "
            "calibrated.ssv those that the system has numbers for."
        )
    return tuple(refusals), tuple(remarks)
