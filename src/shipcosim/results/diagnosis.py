"""Diagnoses of one log and of several: what was found, and how it shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.errors import error_at
from shipcosim.results.shown import Check, HtmlPage, Picture, SavedResult

if TYPE_CHECKING:
    from collections.abc import Iterable

    from shipcosim.diagnose.finding import Finding
    from shipcosim.report.notebook.card import Card


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisOfLog(SavedResult, Diagnosis):
    """What `shipcosim.diagnose` gives back of one log: a `Diagnosis` with a card, its page and its track.

    To start with: ``.verdict``, ``.findings``, ``.gain``, ``.extended`` (the system with the causes in it, which
    `shipcosim.simulate` runs; None where nothing was put in), ``.as_json()``.
    """

    json_name = "diagnosis.json"

    def track(self) -> Picture:
        """The log beside predictions of it, each from the measured state, before and after the causes went in.

        Raises
        ------
        ShipcosimError
            If there was too little data to predict.
        """
        from shipcosim.report.notebook.diagnosis_card import tracks_svg

        if self.tracks is None:
            found = "There are no predictions of this log to draw."
            raise error_at(self._name, found, "`shipcosim.read_log(...).track()` draws the log.")
        return Picture(f"track of {self._name}", tracks_svg(self.tracks, f"track of {self._name}"))

    def page(self) -> HtmlPage:
        """The page of the diagnosis, as `shipcosim diagnose` writes it."""
        from shipcosim.report.diagnosis.page import render

        return HtmlPage(f"Diagnosis of {self._name}", render(self))

    @property
    def checks(self) -> tuple[Check, ...]:
        """That simulation and log agree, and each finding."""
        return (*super().checks, *_findings(self, self.findings))

    @property
    def _name(self) -> str:
        return self.log.name if self.log is not None else "a log"

    def _card(self) -> Card:
        from shipcosim.report.notebook.diagnosis_card import diagnosis_card

        return diagnosis_card(self, f"Diagnosis of {self._name}")


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisOfLogs(SavedResult, JointDiagnosis):
    """What `shipcosim.diagnose` gives back of several logs: a `JointDiagnosis` with a card and its page."""

    json_name = "diagnosis.json"

    def page(self) -> HtmlPage:
        """The page of the diagnosis, as `shipcosim diagnose` writes it."""
        from shipcosim.report.joint.page import render

        return HtmlPage(self._name, render(self))

    @property
    def checks(self) -> tuple[Check, ...]:
        """That simulation and logs agree, and what they have in common."""
        return (*super().checks, *_findings(self, (shared.what for shared in self.findings)))

    @property
    def _name(self) -> str:
        return f"Diagnosis of {len(self.logs)} logs"

    def _card(self) -> Card:
        from shipcosim.report.notebook.diagnosis_card import joint_card

        return joint_card(self, self._name)


def _findings(
    diagnosis: DiagnosisOfLog | DiagnosisOfLogs, findings: Iterable[Finding]
) -> list[Check]:
    """Each finding with its size, as something that does not hold."""
    from shipcosim.report.diagnosis.words import told

    if diagnosis.passed:
        return []
    return [Check(f"no {one.label}", "failed", told(one, diagnosis.causes)) for one in findings]
