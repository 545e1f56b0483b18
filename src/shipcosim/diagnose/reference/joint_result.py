"""What several logs of one ship say together: the content of the diagnosis.json of a joint diagnosis."""

from dataclasses import dataclass, field
from typing import Any

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.reference.common_findings import RatioOfLogs
from shipcosim.diagnose.reference.joint_verdict import JointVerdict
from shipcosim.diagnose.reference.log_errors import LogErrors
from shipcosim.diagnose.result import Diagnosis


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
class JointDiagnosis(Diagnosis):
    """What several logs of one ship say together, and each by itself.

    Findings and discrepancies name the logs that show them: at least two, and half of them. A cause of the weather has
    the name of its log as its component.

    Attributes
    ----------
    logs : dict of str to Diagnosis
        Each log by itself: its faults, its errors, its own verdict.
    left_out : dict of str to str
        Logs that say nothing of the ship, and why.
    relabelled : dict of str to tuple of Finding
        Logs that are read as other logs show, and with which faults of labels corrected.
    errors : dict of str to LogErrors
        By log.
    together : JointBasis or None
        None where no log says anything of the ship.
    """

    logs: dict[str, Diagnosis] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)
    relabelled: dict[str, tuple[Finding, ...]] = field(default_factory=dict)
    errors: dict[str, LogErrors] = field(default_factory=dict)
    together: JointBasis | None = field(default=None, repr=False)

    @property
    def name(self) -> str:
        """How many logs."""
        return f"{len(self.logs)} logs of one ship"

    @property
    def crafts_without(self) -> dict[str, LearnedCraft]:
        """By log, the craft as the others teach her."""
        if self.together is None or self.craft is None or not self.craft.each_without:
            return {}
        return dict(zip(self.together.verdict.logs.problems, self.craft.each_without, strict=True))

    def own_faults(self, name: str) -> list[Finding]:
        """Faults of the data that are one log's own."""
        common = {
            (finding.cause, finding.channels) for finding in self.findings if name in finding.logs
        }
        return [
            f
            for f in self.logs[name].findings
            if f.kind == "data" and (f.cause, f.channels) not in common
        ]

    def as_json(self) -> dict[str, Any]:
        """The content of diagnosis.json, with an entry for each log under `logs`."""
        content = super().as_json()
        # The form of the loads, and healthy ships, are judged of one log alone.
        del content["form"], content["healthy_errors"]
        # A cause of the day has its log by name, instead of a component.
        for key in ("findings", "candidates", "indistinguishable"):
            for entry in content[key]:
                if entry["component"] in self.logs:
                    entry |= {"component": None, "log": entry["component"]}
        return content | {
            "remarks": list(self.remarks),
            "logs": [self._log(name) for name in self.logs],
        }

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
