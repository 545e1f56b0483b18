"""Several logs of one ship in one diagnosis: common causes by the evidence of all logs, weather by that of each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.calibration_pipeline import log_names
from shipcosim.diagnose.pipeline import Progress, find_causes
from shipcosim.diagnose.reference.joint_verdict import JointVerdict, judged_jointly, untestable_jointly
from shipcosim.diagnose.reference.several_logs import SeveralLogs
from shipcosim.diagnose.result import SCHEMA, Candidate, Diagnosis, Estimate, Finding

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.reference.reference import Reference
    from shipcosim.ssp import System

__all__ = ["JointDiagnosis", "combined", "find_common_causes"]


@dataclass(frozen=True)
class JointDiagnosis:
    """What several logs of one ship say together, and each by itself.

    Attributes
    ----------
    verdict : str
        As of one log.
    findings : tuple of Finding
        Causes in the ship; weather has the log's name as its component.
    candidates, indistinguishable : tuple of Candidate
    not_testable : tuple of str
        Causes that all logs together could not have shown.
    logs : dict of str to Diagnosis
        Each log by itself: its faults, its errors, its own verdict.
    """

    verdict: str
    findings: tuple[Finding, ...]
    candidates: tuple[Candidate, ...]
    indistinguishable: tuple[Candidate, ...]
    not_testable: tuple[str, ...]
    logs: dict[str, Diagnosis]

    def as_json(self) -> dict:
        """The content of diagnosis.json, with an entry for each log under `logs`."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "findings": [self._entry(finding.as_json()) for finding in self.findings],
            "candidates": [self._entry(asdict(candidate)) for candidate in self.candidates],
            "indistinguishable": [self._entry(asdict(candidate)) for candidate in self.indistinguishable],
            "not_testable": list(self.not_testable),
            "prescription": None,
            "discrepancies": [],
            "baseline": None,
            "gain": None,
            "logs": [{"name": name, **_of_log(one)} for name, one in self.logs.items()],
        }

    def _entry(self, entry: dict) -> dict:
        """An entry in which a cause of the day has its log by name, instead of a component."""
        if entry["component"] in self.logs:
            return entry | {"component": None, "log": entry["component"]}
        return entry


def _of_log(diagnosis: Diagnosis) -> dict:
    """What diagnosis.json has of one of several logs."""
    content = diagnosis.as_json()
    return {key: content[key] for key in ("verdict", "findings", "discrepancies", "baseline", "not_testable")}


def find_common_causes(
    logs: Sequence[str | os.PathLike | xarray.Dataset],
    system: System,
    channels: str | os.PathLike | None = None,
    causes: str | os.PathLike | None = None,
    progress: Progress | None = None,
    reference: str | os.PathLike | Reference | None = None,
) -> JointDiagnosis:
    """Diagnose several logs of one ship together.

    Parameters
    ----------
    logs : sequence of path or xarray.Dataset
    system : System
        The ship that the logs are held against.
    channels : path, optional
        Channel file, the same for all.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.
    reference : path or Reference, optional
        What logs in which the ship was well say of her.

    Returns
    -------
    JointDiagnosis

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    alone = {}
    for name, log in zip(log_names(logs), logs, strict=True):
        say(f"{name} by itself")
        alone[name] = find_causes(log, system, channels, causes, reference=reference)
    say("all logs together")
    identified = {name: one.basis.explained.identification for name, one in alone.items() if one.basis}
    widest = max(one.problem.model.form_scale for one in identified.values())
    problems = {name: _with_form(one.problem, widest) for name, one in identified.items()}
    with threadpool_limits(1):
        found = judged_jointly(SeveralLogs(problems))
        untestable = untestable_jointly(found)
    unknown = found.judgement.verdict == "unknown"
    crude = {
        name: (*one.comparison.findings, *(one.comparison.found_without(one.causes) if unknown else ()))
        for name, one in identified.items()
        if one.comparison
    }
    return _stated(found, combined(crude, len(alone)), untestable, alone)


def _with_form(problem, scale):
    """The problem of a ship whose form may differ by some scale, as in the log that says most of it."""
    from shipcosim.diagnose.inference.form import of_scale

    return problem if problem.model.form_scale == scale or problem.model.directions else of_scale(problem, scale)


def _stated(
    found: JointVerdict, crude: Sequence[Finding], untestable: Sequence[str], alone: dict[str, Diagnosis]
) -> JointDiagnosis:
    judgement = found.judgement
    of_data = any(finding.kind == "data" for one in alone.values() for finding in one.findings)
    verdict = "named" if (crude or of_data) and judgement.verdict == "consistent" else judgement.verdict
    seen = {one.label for one in (*judgement.candidates, *judgement.findings)} | {one.cause for one in crude}
    return JointDiagnosis(
        verdict,
        (*crude, *judgement.findings),
        judgement.candidates,
        judgement.indistinguishable,
        tuple(name for name in untestable if name not in seen),
        alone,
    )


def combined(findings: Mapping[str, Iterable[Finding]], logs: int) -> tuple[Finding, ...]:
    """Findings that stand beyond doubt in single logs, as one of all: those of half of the logs at least.

    Parameters
    ----------
    findings : mapping of str to iterable of Finding
        By name of the log.
    logs : int
        How many logs there are.

    Returns
    -------
    tuple of Finding
        Each parameter is the mean weighted by information; its standard deviation is at least what the logs differ by.
    """
    by_label: dict[str, list[Finding]] = {}
    for own in findings.values():
        for finding in own:
            by_label.setdefault(finding.label, []).append(finding)
    shared = [same for same in by_label.values() if 2 * len(same) >= logs]
    return tuple(replace(same[0], parameters=_together([one.parameters for one in same])) for same in shared)


def _together(parameters: Sequence[Mapping[str, Estimate]]) -> dict[str, Estimate]:
    found = {}
    for name, first in parameters[0].items():
        values = np.array([one[name].estimate for one in parameters])
        weights = 1.0 / np.maximum([one[name].std for one in parameters], 1e-12) ** 2
        mean = float((weights * values).sum() / weights.sum())
        within = 1.0 / weights.sum()
        between = (weights * (values - mean) ** 2).sum() / weights.sum() / max(values.size - 1, 1)
        found[name] = Estimate(mean, float(np.sqrt(max(within, between))), first.unit)
    return found
