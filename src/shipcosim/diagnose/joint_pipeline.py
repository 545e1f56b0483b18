"""Several logs of one ship in one diagnosis: common causes by the evidence of all logs, weather by that of each.

From the logs to their common verdict, `find_common_causes`:

    problems_of        Identification  each log as an identification problem
    causes_in          Diagnosis       each log by itself
    common_faults      Finding         faults of the data that the logs have in common
    ratio_of_logs      RatioOfLogs     one ratio of thrust to inertia, unless the logs contradict each other
    about_common       Identification  each log with what is common corrected, where it was not by itself
    judged_jointly     JointVerdict    causes by the evidence of all logs

From the verdict to the gain, `diagnose_jointly`: the system with the common causes in it, and each log co-simulated
with what the other logs say of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

from threadpoolctl import threadpool_limits

from shipcosim.diagnose.calibration_pipeline import READING, log_names, problems_of
from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.compared_log import compared, learned_from
from shipcosim.diagnose.comparison.gains import CommonRatio
from shipcosim.diagnose.comparison.thresholds import GROSS, PLAIN
from shipcosim.diagnose.craft.learned import ratio_findings
from shipcosim.diagnose.experiment.design import ExperimentDesign, design_experiment, manoeuvre_of
from shipcosim.diagnose.experiment.testability import not_testable, visible_sizes
from shipcosim.diagnose.explanation.form import of_scale, with_learnt_form
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.extension.extended_system import extended_by
from shipcosim.diagnose.finding import Finding, ParameterEstimate, label_of
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.log.runs import LogSource
from shipcosim.diagnose.log_faults.corrections import corrected
from shipcosim.diagnose.pipeline import (
    AnySystem,
    Progress,
    causes_in,
    prepared_system,
    problem_of,
    ship_by,
)
from shipcosim.diagnose.reference.change_since_reference import with_sizes_at_reference
from shipcosim.diagnose.reference.common_findings import (
    common_discrepancies,
    common_faults,
    is_of_thrusters,
    leans_to,
    ratio_of_logs,
    with_right_labels,
)
from shipcosim.diagnose.reference.held_out import (
    SizesOfLogs,
    errors_by_log,
    sizes_by_log,
    sizes_without,
    weather_of,
)
from shipcosim.diagnose.reference.joint_fit import JointFit
from shipcosim.diagnose.reference.joint_gain import joint_baseline, joint_gain
from shipcosim.diagnose.reference.joint_result import JointBasis, JointDiagnosis
from shipcosim.diagnose.reference.joint_verdict import joint_excitation, judged_jointly
from shipcosim.diagnose.reference.reference import Reference
from shipcosim.diagnose.reference.several_logs import SeveralLogs, is_in_one_log
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import with_thrust
from shipcosim.ssp import AnyPath, System


def steps_of(logs: Sequence[LogSource]) -> dict[str, float]:
    """Steps that `diagnose_jointly` reports to its progress function, in order, with their typical times. [s]"""
    names = log_names(logs)
    return {
        READING: 2.5 * len(names),
        **{f"{name} by itself": 8.0 for name in names},
        "what the logs have in common": 0.5 * len(names),
        "all logs together": 8.0 * len(names),
        "extending the system": 0.5,
        **{f"{name} again, by co-simulation": 3.0 for name in names},
    }


def diagnose_jointly(
    logs: Sequence[LogSource],
    system: AnySystem,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    reference: AnyPath | Reference | None = None,
) -> JointDiagnosis:
    """Diagnose several logs of one ship together: what they have in common, the system with it, what that gains.

    Parameters
    ----------
    logs, system, channels, causes, progress, reference
        As for `find_common_causes`; the system as for `diagnose`, too.
    out : path, optional
        Folder that gets extended.ssp and extended.ssv, where a common cause of the physics is named; a temporary one
        that is there as long as the diagnosis if not given.

    Returns
    -------
    JointDiagnosis

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    given, reference, out, folder = prepared_system(system, reference, out)
    joint = find_common_causes(logs, given.given, channels, causes, say, reference)
    say("extending the system")
    # Causes of the ship go into the system, those of one log's weather do not.
    of_ship = [finding for finding in joint.findings if finding.component not in joint.logs]
    about = {"source": ", ".join(joint.logs), "sha256": ""}
    extended = extended_by(given, of_ship, about, joint.causes, out, joint.craft)
    errors = {}
    # Each log is predicted with what the other logs say, so that it does not judge its own fit.
    if joint.together:
        errors = errors_by_log(
            joint.together.verdict.fit,
            joint.together.verdict.logs,
            given,
            lambda name: _findings_without(joint, name),
            joint.crafts_without,
            joint.causes,
            lambda name, *done: say(f"{name} again, by co-simulation", *done),
        )
    remarks = (
        *joint.remarks,
        *extended.remarks,
        *(error.remark for error in errors.values() if error.remark),
    )
    return replace(
        joint,
        errors=errors,
        baseline=joint_baseline(errors),
        gain=joint_gain(errors),
        system=given.given,
        extension=extended.extension,
        extended=extended.system,
        changes=extended.changes,
        remarks=remarks,
        folder=folder,
    )


def _findings_without(joint: JointDiagnosis, name: str) -> tuple[list[Finding], list[Finding]]:
    """Causes in the ship with their sizes by the other logs, and those of a log's own weather."""
    basis = joint.together
    if basis is None or len(basis.verdict.logs.problems) < 2:
        return [], []
    crude = []
    fit = basis.verdict.fit
    # Size of the common ratio without this log, if the ratio was named.
    if basis.has_ratio and (ratio := basis.ratios.without(name)):
        crude = list(ratio_findings(ratio.ratio, ratio.std, joint.causes))
    labels = {finding.label for finding in joint.findings}
    named = [hypothesis for hypothesis in fit.hypotheses if hypothesis.label in labels]
    if not named:
        return crude, []
    # Causes of the ship sized by the other logs, those of the weather by the log itself.
    of_ship = sizes_without(basis.verdict.logs, name, named, fit.values)
    return [*crude, *of_ship], weather_of(fit, name, named)


def find_common_causes(
    logs: Sequence[LogSource],
    system: System,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    reference: Reference | None = None,
) -> JointDiagnosis:
    """Diagnose several logs of one ship together.

    Parameters
    ----------
    logs : sequence of path or xarray.Dataset
    system : System
        The ship that the logs are compared with.
    channels : path, optional
        Channel file, the same for all.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.
    reference : Reference, optional
        What logs in which the ship was well say of her.

    Returns
    -------
    JointDiagnosis
        Without the errors of predictions and the extended system, which `diagnose_jointly` adds.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    ship = ship_by(system, reference)
    with threadpool_limits(1):
        problems = problems_of(logs, system, channels, causes, say, reference=reference)
        # Each log is diagnosed by itself before the logs are compared.
        alone = {}
        for name, problem in problems.items():
            say(f"{name} by itself")
            alone[name] = causes_in(problem, ship, lambda *_: None, reference)
    say("what the logs have in common")
    identified = {name: _identification(diagnosis) for name, diagnosis in alone.items()}
    # Logs that cannot tell causes, or whose channels may be misread, are left out.
    left_out = {name: why for name, diagnosis in alone.items() if (why := _unusable(diagnosis))}
    joint = JointDiagnosis(
        "ambiguous"
        if any(diagnosis.verdict == "ambiguous" for diagnosis in alone.values())
        else "unknown",
        tuple(common_faults({name: diagnosis.findings for name, diagnosis in alone.items()})),
        logs=alone,
        discrepancies=tuple(
            common_discrepancies(
                {name: diagnosis.discrepancies for name, diagnosis in alone.items()}
            )
        ),
        left_out=left_out,
        causes=next(iter(identified.values())).causes,
    )
    usable = {name: diagnosis for name, diagnosis in identified.items() if name not in left_out}
    if not usable:
        return replace(joint, remarks=tuple(remarks_on(joint)))
    with threadpool_limits(1):
        joint = _together(joint, usable, ship, say)
    if reference is None:
        return joint
    return replace(
        joint,
        findings=with_sizes_at_reference(joint.findings, ship, reference, joint.causes),
    )


def _identification(diagnosis: Diagnosis) -> Identification:
    if diagnosis.basis is None:
        raise ValueError("a diagnosis that does not know its log")
    return diagnosis.basis.explained.identification


def _unusable(diagnosis: Diagnosis) -> str:
    """Reason why a log gives no evidence on the ship; empty if it does."""
    if any(finding.alternatives for finding in diagnosis.findings):
        return "Its channels may be misread, and it does not tell which."
    return " ".join(_identification(diagnosis).comparison.obstacles)


def _together(
    joint: JointDiagnosis, usable: dict[str, Identification], ship: ShipModel, say: Progress
) -> JointDiagnosis:
    """Joint result of the usable logs."""
    # Labels that other logs show are corrected in logs that do not tell; these are compared anew.
    relabelled = _relabelled(joint.findings, usable)
    read = {
        name: replace(_as_read(usable[name], ship), log=with_right_labels(usable[name].log, faults))
        for name, faults in relabelled.items()
    }
    stages = {name: (log.repaired, log.comparison) for name, log in usable.items()}
    for name, log in read.items():
        again = compared(checked(log))
        stages[name] = again.repaired, again.comparison
    comparisons = {name: comparison for name, (_, comparison) in stages.items()}
    # One ratio of thrust to inertia, put into the ship where it is far off.
    ratios = ratio_of_logs(
        {name: comparison.ratio for name, comparison in comparisons.items() if comparison.ratio}
    )
    start = ratios.common if ratios.common is not None and ratios.common.differs(GROSS) else None
    about = {name: _about_common(log, read.get(name), ship, start) for name, log in usable.items()}
    say("all logs together")
    # The problems of a ship whose form may differ by one scale: that of the log that says most of it.
    problems = {name: log.problem for name, log in about.items()}
    widest = max(problem.model.form_scale for problem in problems.values())
    of_one_form = {
        name: problem
        if problem.model.form_scale == widest or problem.model.directions
        else of_scale(problem, widest)
        for name, problem in problems.items()
    }
    verdict = judged_jointly(SeveralLogs(of_one_form))
    # Whether a common ratio is named: where it is gross, or where no cause explains the logs.
    has_ratio = ratios.common is not None and ratios.common.differs(
        GROSS if verdict.judgement.verdict != "unknown" else PLAIN
    )
    # Where no cause explains the logs, or the craft is another beyond doubt, they teach her together.
    craft = None
    if verdict.judgement.verdict == "unknown" or start is not None:
        craft = learned_from(list(stages.values()), ship)
    basis = JointBasis(verdict, ratios, has_ratio)
    faults = {name: tuple(faults) for name, faults in relabelled.items()}
    return _stated(replace(joint, together=basis, relabelled=faults, craft=craft), basis)


def _relabelled(
    faults: Sequence[Finding], usable: Mapping[str, Identification]
) -> dict[str, list[Finding]]:
    """Faults of the thrusters' labels that other logs show, by the logs that are corrected after them."""
    by_log: dict[str, list[Finding]] = {}
    for fault in (finding for finding in faults if is_of_thrusters(finding)):
        for name in (name for name in usable if name not in fault.logs):
            if leans_to(usable[name].comparison.labels, fault):
                by_log.setdefault(name, []).append(fault)
    return by_log


def _as_read(log: Identification, ship: ShipModel) -> ReadLog:
    """A log as it was read, to be diagnosed again."""
    return ReadLog(log.log, ship, log.causes)


def _about_common(
    log: Identification, read: ReadLog | None, ship: ShipModel, ratio: CommonRatio | None
) -> Identification:
    """A log as an identification problem about what all logs have in common: labels, and thrust over inertia."""
    if read is None and ratio is None:
        return log
    read = read or _as_read(log, ship)
    if ratio is not None:
        read = replace(read, ship=with_thrust(ship, ratio.ratio, ratio.std))
    return with_learnt_form(corrected(problem_of(read)))


def _stated(joint: JointDiagnosis, basis: JointBasis) -> JointDiagnosis:
    """The result for all logs together."""
    judgement = basis.verdict.judgement
    ratios = basis.ratios
    # Ratios that contradict each other, one of them far off, keep any common cause from being
    # named.
    is_split = ratios.common is None and any(ratio.differs(GROSS) for ratio in ratios.each.values())
    common = ratios.common if basis.has_ratio else None
    crude = ratio_findings(common.ratio, common.std, joint.causes) if common else ()
    causes = () if is_split else judgement.findings
    logs = basis.verdict.logs
    labels = {hypothesis.label: hypothesis for hypothesis in logs.hypotheses}
    sizes = _sizes(basis, crude, causes)
    design = None if is_split else _prescription(basis)
    # Findings of the data, the common ratio, and causes by all logs that can show them.
    put_right = joint.relabelled.items()
    findings = (
        *(
            replace(
                finding, put_right=tuple(name for name, faults in put_right if finding in faults)
            )
            for finding in joint.findings
        ),
        *(replace(finding, logs=tuple(ratios.each)) for finding in crude),
        *(
            replace(
                cause, logs=tuple(n for n in logs.problems if logs.within(n, labels[cause.label]))
            )
            for cause in causes
        ),
    )
    seen = {finding.label for finding in (*judgement.candidates, *causes)} | {
        finding.cause for finding in crude
    }
    named = {finding.label for finding in findings}
    excitation = joint_excitation(basis.verdict)
    verdict = "unknown" if is_split else judgement.verdict
    of_data = joint.findings or any(
        finding.kind == "data" for log in joint.logs.values() for finding in log.findings
    )
    return replace(
        joint,
        verdict="named" if (crude or of_data) and verdict == "consistent" else verdict,
        findings=tuple(
            replace(finding, by_log=sizes.get(finding.label, {})) for finding in findings
        ),
        candidates=judgement.candidates,
        indistinguishable=() if is_split else judgement.indistinguishable,
        not_testable=tuple(name for name in not_testable(excitation) if name not in seen),
        smallest_visible=tuple(
            size
            for size in visible_sizes(excitation)
            if label_of(size.cause, size.component) not in named
        ),
        prescription=design,
        manoeuvre=manoeuvre_of(design, _longest(basis)[1]),
        remarks=(*joint.remarks, *remarks_on(joint)),
    )


def _sizes(basis: JointBasis, crude: Sequence[Finding], causes: Sequence[Finding]) -> SizesOfLogs:
    """How large each log by itself would have what is common."""
    # The ratio by each log, then the causes fitted to each log by itself.
    each = basis.ratios.each
    sizes = {
        cause.label: {
            name: dict.fromkeys(cause.parameters, ParameterEstimate(of.ratio, of.std, "1"))
            for name, of in each.items()
        }
        for cause in crude
    }
    if not causes:
        return sizes
    fit = basis.verdict.fit
    labels = {cause.label for cause in causes}
    named = [hypothesis for hypothesis in fit.hypotheses if hypothesis.label in labels]
    return sizes | sizes_by_log(basis.verdict.logs, named, fit.values)


def _prescription(basis: JointBasis) -> ExperimentDesign | None:
    """A manoeuvre that tells apart what all logs together cannot, planned about the longest of them."""
    judgement = basis.verdict.judgement
    name, problem = _longest(basis)
    # With third-party FMUs no manoeuvre can be prescribed.
    if not judgement.rivals or problem.model.third_party:
        return None
    of_ship = [fit for fit in judgement.rivals if not all(map(is_in_one_log, fit.hypotheses))]
    parts = [cast(JointFit, fit).parts[name] for fit in of_ship]
    best = basis.verdict.fit
    return design_experiment(problem, best.parts[name], parts) if parts else None


def _longest(basis: JointBasis) -> tuple[str, IdentificationProblem]:
    """The log with most rows: its name and problem."""
    problems = basis.verdict.logs.problems
    return max(problems.items(), key=lambda entry: entry[1].record.time.size)


def remarks_on(joint: JointDiagnosis) -> list[str]:
    """Remarks on logs that differ from the others or are not usable."""
    basis = joint.together
    remarks = [f"{name} says nothing of the ship. {why}" for name, why in joint.left_out.items()]
    for name, faults in joint.relabelled.items():
        what = "; ".join(fault.sentence for fault in faults)
        remarks.append(
            f"{name} is read as the other logs show ({what}). This log alone does not show it."
        )
    if basis is None:
        return remarks
    if basis.ratios.contradiction:
        remarks.append(basis.ratios.contradiction)
    for name in basis.ratios.apart if basis.has_ratio else ():
        of_log = basis.ratios.each[name]
        remarks.append(
            f"{name} by itself says {of_log.ratio:.2f} ± {of_log.std:.2f} of thrust over inertia, far from all others. "
            "The common ratio is that much less certain."
        )
    return remarks
