"""The statement on a log: its diagnosis from the verdict on, and with the errors, the gain and what the page shows."""

from dataclasses import replace
from pathlib import Path

import xarray

from shipcosim.diagnose.experiment.design import design_experiment, manoeuvre_of
from shipcosim.diagnose.experiment.testability import (
    excitation_of,
    hidden_by_form,
    log_facts,
    untestable_causes,
    visible_sizes,
)
from shipcosim.diagnose.explanation.search import without_causes
from shipcosim.diagnose.explanation.summary import LoadForm, evidence_of, load_form
from shipcosim.diagnose.explanation.verdict import JudgedLog
from shipcosim.diagnose.extension.extended_system import ExtendedSystem, with_findings
from shipcosim.diagnose.extension.form_numbers import craft_of_form
from shipcosim.diagnose.finding import label_of
from shipcosim.diagnose.inference.thresholds import BESIDE_UNKNOWN
from shipcosim.diagnose.log.remarks import handled
from shipcosim.diagnose.result import Diagnosis, LogSummary
from shipcosim.diagnose.validation.conditions import PredictedLog, with_predictions
from shipcosim.diagnose.validation.gain import CHANNELS, HORIZONS, baseline, error_with, gain, rms
from shipcosim.diagnose.validation.healthy_errors import healthy_errors
from shipcosim.diagnose.validation.replays import SimulatedLog
from shipcosim.diagnose.validation.summary import prediction_errors
from shipcosim.diagnose.validation.thresholds import LEAST_GAIN, WORSE
from shipcosim.diagnose.validation.tracks import tracks_of
from shipcosim.ssp import AnyPath


def stated(log: JudgedLog) -> Diagnosis:
    """The statement on a log: faults, causes since when they act, what it could not have shown, what to sail next."""
    identification = log.explained.identification
    judgement = log.judgement
    comparison = identification.comparison
    excitation = excitation_of(log)
    # Of a log that may be misread nothing is reported of the ship.
    if any(fault.alternatives for fault in identification.faults):
        return Diagnosis(
            "ambiguous",
            identification.faults,
            not_testable=untestable_causes(log, excitation),
            baseline=comparison.errors,
            basis=log,
        )
    # Findings of the log and of connections come before causes of the ship.
    of_log = (
        *identification.faults,
        *identification.misconnections,
        *comparison.findings(identification.causes),
    )
    seen = {finding.cause for finding in (*of_log, *judgement.candidates, *judgement.findings)}
    # With third-party FMUs no manoeuvre can be prescribed.
    rivals = () if identification.ship.third_party else judgement.rivals
    named = {finding.label for finding in (*of_log, *judgement.findings)}
    untestable = untestable_causes(log, excitation)
    sizes = () if comparison.obstacles else visible_sizes(excitation)
    # How far the form of the ship's loads differs from the model's, with what that hides.
    form = load_form(log)
    form_of = replace(form, hides=hidden_by_form(log, excitation)) if form else None
    # A consistent ship with faults of the data is named; one of another form has its own verdict.
    verdict = judgement.verdict
    if verdict == "consistent" and of_log:
        verdict = "named"
    elif verdict == "consistent" and (comparison.craft or (form_of and form_of.numbers)):
        verdict = "form"
    elif comparison.is_assumed and comparison.craft:
        verdict = "form"
    return Diagnosis(
        verdict,
        (*of_log, *judgement.findings),
        judgement.candidates,
        judgement.indistinguishable,
        tuple(cause for cause in untestable if cause not in seen),
        design_experiment(log.problem, log.fit, rivals) if rivals else None,
        comparison.errors,
        discrepancies=comparison.for_verdict(judgement.verdict),
        form=form_of,
        obstacles=comparison.obstacles,
        craft=comparison.craft,
        is_assumed=comparison.is_assumed,
        smallest_visible=tuple(
            size for size in sizes if label_of(size.cause, size.component) not in named
        ),
        basis=log,
    )


def named_if_better(
    diagnosis: Diagnosis, predicted: PredictedLog
) -> tuple[Diagnosis, PredictedLog]:
    """A diagnosis without the causes that it names, where with them rows kept from the fit are predicted no better.

    Parameters
    ----------
    diagnosis : Diagnosis
    predicted : PredictedLog

    Returns
    -------
    tuple of Diagnosis and PredictedLog
        As given; or ``"unknown"`` with the causes among the candidates, and predictions by the plain ship alone.
    """
    comparison = predicted.comparison
    if not diagnosis.is_named or comparison is None:
        return diagnosis, predicted
    # On rows kept from the fit the causes must not predict worse than the plain ship, and must gain in one channel.
    errors = {
        channel: [rms(comparison.errors, channel, model) for model in ("plain", "extended")]
        for channel in ("position", "heading")
    }
    without, within = errors["position"]
    gains = any(after < LEAST_GAIN * before for before, after in errors.values())
    if within <= WORSE * without and gains:
        return diagnosis, predicted
    names = ", ".join(finding.label for finding in diagnosis.physics)
    remark = (
        f"{names}: likeliest by its evidence, but not named. On rows that it was not fitted on the ship with it misses "
        f"the log by {within:.3g} m, without it by {without:.3g} m."
    )
    doubted = replace(
        diagnosis,
        verdict="unknown",
        findings=tuple(finding for finding in diagnosis.findings if finding.kind == "data"),
        candidates=tuple(
            replace(candidate, probability=min(candidate.probability, BESIDE_UNKNOWN))
            for candidate in diagnosis.candidates
        ),
        remarks=(*diagnosis.remarks, remark),
    )
    return doubted, with_predictions(predicted.judged, False)


def verified(diagnosis: Diagnosis, predicted: PredictedLog) -> Diagnosis:
    """A diagnosis that is only consistent where its system predicts the log as well as a healthy ship's would.

    Parameters
    ----------
    diagnosis : Diagnosis
    predicted : PredictedLog

    Returns
    -------
    Diagnosis
        As given, with the errors of healthy ships; or ``"unknown"``, where the system's are larger than any of them.
    """
    if diagnosis.verdict != "consistent" or predicted.comparison is None:
        return diagnosis
    # Errors that no healthy ship reaches contradict a consistent verdict.
    healthy = healthy_errors(predicted.comparison)
    if not healthy.beyond:
        return replace(diagnosis, healthy=healthy)
    sizes = [
        f"{healthy.measured[channel]:.2g} {CHANNELS[channel]} in {channel} (at most {healthy.largest[channel]:.2g})"
        for channel in healthy.beyond
    ]
    remark = (
        f"No cause stands out, but after {HORIZONS[-1]:g} s the system misses the log by {' and '.join(sizes)}. "
        "None of the healthy ships drawn within its tolerances does so."
    )
    return replace(
        diagnosis, verdict="unknown", healthy=healthy, remarks=(*diagnosis.remarks, remark)
    )


def with_form(
    diagnosis: Diagnosis, predicted: PredictedLog, given: ExtendedSystem, folder: AnyPath
) -> tuple[Diagnosis, ExtendedSystem]:
    """A diagnosis with the verdict `form`, and the system with these numbers if it predicts the log better.

    Parameters
    ----------
    diagnosis : Diagnosis
    predicted : PredictedLog
    given : ExtendedSystem
        Not extended yet.
    folder : path
        Gets extended.ssp and extended.ssv.

    Returns
    -------
    tuple of Diagnosis and ExtendedSystem
        As given unless the verdict is ``"form"``.
    """
    comparison = predicted.comparison
    if diagnosis.verdict != "form" or diagnosis.form is None or comparison is None:
        return diagnosis, given
    # Judged by numbers that never saw the rows which they predict; written with those of the whole log.
    trained = craft_of_form(comparison.fit, given.given)
    error = error_with(comparison, trained.after)
    diagnosis = replace(diagnosis, form=replace(diagnosis.form, system_m=error))
    if error >= rms(comparison.errors, "position", "plain"):
        remark = "No system was written: with the numbers of the form that it has, it predicts other rows no better."
        return replace(diagnosis, remarks=(*diagnosis.remarks, remark)), given
    log = predicted.judged
    craft = craft_of_form(without_causes(log.fits), given.given)
    return diagnosis, with_findings(given, (), log.explained.identification, folder, craft)


def _with_errors(form: LoadForm | None, errors: xarray.Dataset) -> LoadForm | None:
    """A form with the errors of predictions without it and with it, on rows that its numbers were not fitted on."""
    if form is None:
        return None
    before, after = (rms(errors, "position", model) for model in ("plain", "calibrated"))
    return replace(form, horizon_s=float(HORIZONS[-1]), before_m=before, after_m=after)


def completed(
    diagnosis: Diagnosis, predicted: PredictedLog, extended: ExtendedSystem, simulated: SimulatedLog
) -> Diagnosis:
    """A diagnosis with errors, gain, the extended system, and all that the page shows."""
    log = predicted.judged
    errors = simulated.errors
    identification = log.explained.identification
    problem = log.problem
    craft = diagnosis.craft
    summary = LogSummary(
        Path(identification.log.encoding.get("source", "log")).name,
        identification.log,
        identification.repaired,
        problem.record.step,
        problem.record.remarks,
        tuple(handled(identification.log)),
    )
    complete = replace(
        diagnosis,
        manoeuvre=manoeuvre_of(diagnosis.prescription, problem),
        causes=identification.causes,
        facts=log_facts(problem),
        log=summary,
        evidence=evidence_of(log),
        tracks=tracks_of(log, diagnosis.is_named),
        force=predicted.force,
        extension=extended.extension,
        extended=extended.system,
        changes=extended.changes,
        system=extended.given,
        remarks=(*diagnosis.remarks, *extended.remarks, *simulated.remarks),
        gain=craft.errors.as_gain() if craft and craft.errors else None,
    )
    if errors is None or predicted.comparison is None:
        return complete
    # The error of the simulation is taken over one set of predictions, those that the gain is measured on, where the
    # craft's own times are theirs.
    measured = baseline(errors)
    earlier = diagnosis.baseline
    same_times = earlier is not None and earlier["horizon_s"] == measured["horizon_s"]
    return replace(
        complete,
        baseline=measured if same_times else earlier,
        gain=gain(errors) if diagnosis.is_named else complete.gain,
        form=_with_errors(diagnosis.form, predicted.comparison.errors),
        predictions=prediction_errors(
            predicted.comparison,
            errors,
            simulated.held_out,
            is_named=diagnosis.is_named,
            is_simulated=simulated.is_simulated,
        ),
    )
