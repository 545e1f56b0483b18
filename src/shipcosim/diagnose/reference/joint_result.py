"""What several logs of one ship say together: the content of the diagnosis.json of a joint diagnosis."""

from dataclasses import asdict, dataclass, field
from typing import Any

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.extension.extend import Extension
from shipcosim.diagnose.extension.extended_system import NumberChange
from shipcosim.diagnose.finding import (
    Candidate,
    Discrepancy,
    Finding,
    VisibleSize,
    estimates_as_json,
)
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.reference.common_findings import RatioOfLogs, Shared
from shipcosim.diagnose.reference.held_out import LogErrors, SizesOfLogs
from shipcosim.diagnose.reference.joint_gain import joint_baseline, joint_gain
from shipcosim.diagnose.reference.joint_verdict import JointVerdict
from shipcosim.diagnose.result import SCHEMA, Diagnosis
from shipcosim.ssp import System


@dataclass(frozen=True)
class JointBasis:
    """What a joint diagnosis rests on.

    Attributes
    ----------
    verdict : JointVerdict
        With the logs as identification problems.
    ratios : RatioOfLogs
        Of thrust to inertia.
    has_ratio : bool
        Whether the common one is named.
    """

    verdict: JointVerdict
    ratios: RatioOfLogs
    has_ratio: bool = False


@dataclass(frozen=True)
class JointDiagnosis:
    """What several logs of one ship say together, and each by itself.

    Attributes
    ----------
    verdict : str
        As of one log.
    findings : tuple of Shared
        Faults of the data that logs have in common, then causes in the ship; weather has the log's name as component.
    candidates, indistinguishable : tuple of Candidate
    not_testable : tuple of str
        Causes that all logs together could not have shown.
    smallest_visible : tuple of VisibleSize
        Of causes that were not found: what all logs together would have shown.
    logs : dict of str to Diagnosis
        Each log by itself: its faults, its errors, its own verdict.
    discrepancies : tuple of Shared
        Those of half of the logs, two at least, largest first.
    prescription : ExperimentDesign or None
    left_out : dict of str to str
        Logs that say nothing of the ship, and why.
    relabelled : dict of str to tuple of Finding
        Logs that are read as other logs show, and with which faults of labels put right.
    sizes : dict of str to dict
        By cause and log: the parameters of a common cause by that log alone.
    errors : dict of str to LogErrors
        By log.
    craft : LearnedCraft or None
        What the logs together teach of a craft that is not the file's.
    causes : dict of str to Cause
        The catalogue.
    system : System or None
        That the logs were held against.
    extension : Extension or None
        The common causes in the system; None where none was named.
    changes : tuple of NumberChange
        Every number in which it differs.
    remarks : tuple of str
    basis : JointBasis or None
        None where no log says anything of the ship.
    folder : TemporaryDirectory or None
        Keeps the files of the extended system where nobody said where they go.
    """

    verdict: str
    findings: tuple[Shared[Finding], ...] = ()
    candidates: tuple[Candidate, ...] = ()
    indistinguishable: tuple[Candidate, ...] = ()
    not_testable: tuple[str, ...] = ()
    logs: dict[str, Diagnosis] = field(default_factory=dict)
    discrepancies: tuple[Shared[Discrepancy], ...] = ()
    prescription: ExperimentDesign | None = None
    left_out: dict[str, str] = field(default_factory=dict)
    relabelled: dict[str, tuple[Finding, ...]] = field(default_factory=dict)
    sizes: SizesOfLogs = field(default_factory=dict)
    errors: dict[str, LogErrors] = field(default_factory=dict)
    craft: LearnedCraft | None = None
    causes: dict[str, Cause] = field(default_factory=dict, repr=False)
    system: System | None = field(default=None, repr=False)
    extension: Extension | None = None
    changes: tuple[NumberChange, ...] = ()
    remarks: tuple[str, ...] = ()
    smallest_visible: tuple[VisibleSize, ...] = field(default=(), repr=False)
    basis: JointBasis | None = field(default=None, repr=False)
    folder: object = field(default=None, repr=False, compare=False)

    def of_kind(self, kind: str) -> list[Finding]:
        """What the common findings of a kind, ``"data"`` or ``"physics"``, name."""
        return [one.what for one in self.findings if one.what.kind == kind]

    @property
    def crafts_without(self) -> dict[str, LearnedCraft]:
        """By log, the craft as the others teach her."""
        if self.basis is None or self.craft is None or not self.craft.each_without:
            return {}
        return dict(zip(self.basis.verdict.logs.problems, self.craft.each_without, strict=True))

    def own_faults(self, name: str) -> list[Finding]:
        """Faults of the data that are one log's own."""
        common = {(one.what.cause, one.what.channels) for one in self.findings if name in one.logs}
        return [
            f
            for f in self.logs[name].findings
            if f.kind == "data" and (f.cause, f.channels) not in common
        ]

    def as_json(self) -> dict[str, Any]:
        """The content of diagnosis.json, with an entry for each log under `logs`."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "findings": [self._finding(one) for one in self.findings],
            "candidates": [self._entry(asdict(candidate)) for candidate in self.candidates],
            "indistinguishable": [
                self._entry(asdict(candidate)) for candidate in self.indistinguishable
            ],
            "not_testable": list(self.not_testable),
            "smallest_visible": [asdict(one) for one in self.smallest_visible],
            "prescription": asdict(self.prescription) if self.prescription else None,
            "discrepancies": [
                asdict(one.what) | {"logs": list(one.logs)} for one in self.discrepancies
            ],
            "craft": self.craft.as_json() if self.craft else None,
            "baseline": joint_baseline(self.errors),
            "gain": joint_gain(self.errors),
            "remarks": list(self.remarks),
            "logs": [self._log(name) for name in self.logs],
        }

    def _finding(self, one: Shared[Finding]) -> dict[str, Any]:
        entry = self._entry(one.what.as_json()) | {"logs": list(one.logs)}
        if one.put_right:
            entry["put_right_in"] = list(one.put_right)
        if own := self.sizes.get(one.what.label):
            entry["by_log"] = {
                name: estimates_as_json(parameters) for name, parameters in own.items()
            }
        return entry

    def _entry(self, entry: dict[str, Any]) -> dict[str, Any]:
        """An entry in which a cause of the day has its log by name, instead of a component."""
        if entry["component"] in self.logs:
            return entry | {"component": None, "log": entry["component"]}
        return entry

    def _log(self, name: str) -> dict[str, Any]:
        """The entry of one log."""
        content = self.logs[name].as_json()
        of_log = ("verdict", "findings", "discrepancies", "baseline", "not_testable")
        errors = self.errors[name].as_json() if name in self.errors else None
        used = self.left_out.get(name)
        return {
            "name": name,
            **{key: content[key] for key in of_log},
            "errors": errors,
            "left_out": used,
        }
