"""Diagnoses of one log and of several: what was found, and how it shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.errors import error_at
from shipcosim.results.shown import Check, HtmlPage, Picture, SavedResult

if TYPE_CHECKING:
    from shipcosim.report.notebook.card import Card


class _ShownDiagnosis(SavedResult, Diagnosis):
    """What the diagnoses of one log and of several show in the same way."""

    json_name = "diagnosis.json"

    def page(self) -> HtmlPage:
        """The page of the diagnosis, as `shipcosim diagnose` writes it."""
        from shipcosim.report.diagnosis.page import render

        return HtmlPage(f"Diagnosis of {self.name}", render(self))

    @property
    def checks(self) -> tuple[Check, ...]:
        """That simulation and log agree, and each finding."""
        from shipcosim.report.diagnosis.words import finding_text

        findings = () if self.passed else self.findings
        each = (
            Check(f"no {finding.label}", "failed", finding_text(finding, self.causes))
            for finding in findings
        )
        return (*super().checks, *each)

    def _card(self) -> Card:
        from shipcosim.report.notebook.diagnosis_card import diagnosis_card

        return diagnosis_card(self)


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisOfLog(_ShownDiagnosis):
    """What `shipcosim.diagnose` gives back of one log: a `Diagnosis` with a card, its page and its track.

    To start with: ``.verdict``, ``.findings``, ``.gain``, ``.extended`` (the system with the causes in it, which
    `shipcosim.simulate` runs; None where nothing was put in), ``.as_json()``.
    """

    def track(self) -> Picture:
        """The log beside predictions of it, each from the measured state, before and after the causes went in.

        Raises
        ------
        ShipcosimError
            If there was too little data to predict.
        """
        from shipcosim.report.notebook.diagnosis_card import tracks_svg

        if self.tracks is None:
            raise error_at(
                self.name,
                "There are no predictions of this log to draw.",
                "`shipcosim.read_log(...).track()` draws the log.",
            )
        return Picture(f"track of {self.name}", tracks_svg(self.tracks, f"track of {self.name}"))


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisOfLogs(_ShownDiagnosis, JointDiagnosis):
    """What `shipcosim.diagnose` gives back of several logs: a `JointDiagnosis` with a card and its page."""
