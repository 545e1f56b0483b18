"""What a diagnosis says: causes with their parameters, verdict and gain, as diagnosis.json holds them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shipcosim.diagnose.stages import JudgedLog

__all__ = ["SCHEMA", "Candidate", "Diagnosis", "Estimate", "Finding", "ExperimentDesign", "label_of"]

SCHEMA = "shipcosim-diagnosis/1"


def label_of(cause: str, component: str | None) -> str:
    """A cause with its place, in words: ``thrust_loss of port``."""
    return f"{cause} of {component}" if component else cause


@dataclass(frozen=True)
class Estimate:
    """A parameter of a cause, with its standard deviation, both in `unit`."""

    estimate: float
    std: float
    unit: str


@dataclass(frozen=True)
class Finding:
    """One cause that is present.

    Attributes
    ----------
    cause : str
        Name of the cause as in the catalogue.
    component : str or None
        Component of the system that it sits in, where there are several.
    kind : str
        ``"data"``: the log is wrong, or ``"physics"``: the model is.
    probability : float
        That it is right to name it.
    parameters : dict of str to Estimate
        In the units of the catalogue.
    segments : tuple of (float, float)
        Where in the log, from and to; empty is all of it. [s]
    channels : tuple of str
        Roles of the channels that a fault of the data is in.
    onset : float or None
        From when on a cause of the physics acts; None from the start. [s]
    note : str
        What else there is to say, one sentence.
    """

    cause: str
    component: str | None = None
    kind: str = "physics"
    probability: float = 1.0
    parameters: dict[str, Estimate] = field(default_factory=dict)
    segments: tuple[tuple[float, float], ...] = ()
    channels: tuple[str, ...] = ()
    onset: float | None = None
    note: str = ""

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)

    def as_json(self) -> dict:
        """The finding as an entry of diagnosis.json; what does not apply is left out."""
        entry = {key: getattr(self, key) for key in ("cause", "component", "kind", "probability")}
        entry["parameters"] = {name: asdict(value) for name, value in self.parameters.items()}
        if self.kind == "data":
            entry["segments"] = [list(segment) for segment in self.segments]
            entry["channels"] = list(self.channels)
        if self.onset is not None:
            entry["onset"] = self.onset
        if self.note:
            entry["note"] = self.note
        return entry


@dataclass(frozen=True)
class Candidate:
    """A cause with the probability that it is present."""

    cause: str
    component: str | None
    probability: float

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)


@dataclass(frozen=True)
class ExperimentDesign:
    """A manoeuvre that tells causes apart which the log could not."""

    manoeuvre: str
    minutes: float
    separates: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Diagnosis:
    """Everything that diagnosis.json holds.

    Attributes
    ----------
    verdict : str
        ``"consistent"``, ``"named"``, ``"ambiguous"`` or ``"unknown"``.
    findings : tuple of Finding
        Most certain first.
    candidates, indistinguishable : tuple of Candidate
    not_testable : tuple of str
        Causes that this log could not have shown.
    prescription : ExperimentDesign or None
    baseline, gain : dict or None
        As in the contract; None where there was too little data.
    basis : JudgedLog or None
        What it rests on, for further work: the log, the identification problem, the fits.
    """

    verdict: str
    findings: tuple[Finding, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    indistinguishable: tuple[Candidate, ...] = ()
    not_testable: tuple[str, ...] = ()
    prescription: ExperimentDesign | None = None
    baseline: dict | None = None
    gain: dict | None = None
    basis: JudgedLog | None = None

    def as_json(self) -> dict:
        """The diagnosis as the content of diagnosis.json."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "findings": [finding.as_json() for finding in self.findings],
            "candidates": [asdict(candidate) for candidate in self.candidates],
            "indistinguishable": [asdict(candidate) for candidate in self.indistinguishable],
            "not_testable": list(self.not_testable),
            "prescription": asdict(self.prescription) if self.prescription else None,
            "baseline": self.baseline,
            "gain": self.gain,
        }
