"""What a diagnosis says: causes with their parameters, verdict and gain, as diagnosis.json holds them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre
    from shipcosim.diagnose.extension.extend import Extension
    from shipcosim.diagnose.extension.extended_system import Change
    from shipcosim.diagnose.hypotheses.catalogue import Cause
    from shipcosim.diagnose.inference.summary import Evidence
    from shipcosim.diagnose.stages import JudgedLog
    from shipcosim.diagnose.validation.missing_force import MissingForce
    from shipcosim.diagnose.validation.summary import PredictionErrors
    from shipcosim.diagnose.validation.tracks import Tracks
    from shipcosim.ssp import System

__all__ = [
    "SCHEMA",
    "Candidate",
    "Diagnosis",
    "Discrepancy",
    "Estimate",
    "Finding",
    "ExperimentDesign",
    "FormNumber",
    "LoadForm",
    "LogSummary",
    "label_of",
]

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
    alternatives : tuple of str
        Other readings that explain the log alike, one sentence each. Where there are any, `note` is only the likeliest
        of them, and nothing was put right.
    at_reference : dict of str to Estimate
        What the parameters were when a reference was made; empty without one, and of what it does not hold.
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
    alternatives: tuple[str, ...] = ()
    at_reference: dict[str, Estimate] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)

    @property
    def sentence(self) -> str:
        """The note, with what explains the log alike."""
        if not self.alternatives:
            return self.note
        return f"{'; or '.join([self.note, *self.alternatives])}: the log does not tell, nothing is put right"

    def as_json(self) -> dict:
        """The finding as an entry of diagnosis.json; what does not apply is left out."""
        entry = {key: getattr(self, key) for key in ("cause", "component", "kind", "probability")}
        entry["parameters"] = {name: asdict(value) for name, value in self.parameters.items()}
        if self.at_reference:
            entry["at_reference"] = {name: asdict(value) for name, value in self.at_reference.items()}
        if self.kind == "data":
            entry["segments"] = [list(segment) for segment in self.segments]
            entry["channels"] = list(self.channels)
        if self.onset is not None:
            entry["onset"] = self.onset
        if self.note:
            entry["note"] = self.note
        if self.alternatives:
            entry["alternatives"] = list(self.alternatives)
        return entry


@dataclass(frozen=True)
class Discrepancy:
    """Something in which simulation and log differ, before any cause is sought.

    Attributes
    ----------
    what : str
        In words, with its size.
    component, axis : str or None
        Thruster, and ``"surge"``, ``"sway"`` or ``"yaw"``, where it is of one.
    estimate, std : float
    unit : str
    share : float
        Of the error that it explains.
    """

    what: str
    component: str | None
    axis: str | None
    estimate: float
    std: float
    unit: str
    share: float


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
class FormNumber:
    """A number of the form of the ship's loads, which the log has moved off the model's.

    Attributes
    ----------
    number : str
        ``place.name``.
    what : str
        In words.
    model, estimate, std : float
    unit : str
    """

    number: str
    what: str
    model: float
    estimate: float
    std: float
    unit: str


@dataclass(frozen=True)
class LoadForm:
    """How far the form of the ship's loads differs from the model's, as far as the log tells.

    Attributes
    ----------
    scale : float
        Over what is usual between a ship and her model; 0 is the model's form. [1]
    differs : dict of str to float
        By function, in words: root mean square of what it differs by, as a share of the model's. [1]
    numbers : tuple of FormNumber
        Those that differ by more than twice their standard deviations, most certain first.
    hides : tuple of str
        Causes that the log could have shown on a ship of the model's form: another form of her loads does the same.
    """

    scale: float
    differs: dict[str, float]
    numbers: tuple[FormNumber, ...] = ()
    hides: tuple[str, ...] = ()


@dataclass(frozen=True)
class LogSummary:
    """A log as it was read and as it was used.

    Attributes
    ----------
    name : str
        Of its file.
    measured, repaired : xarray.Dataset
        As read; and with its faults put right, over even times, with the coordinate `logged_time`.
    step : float
        Time from row to row as used. [s]
    remarks : tuple of str
        What could not be known from it.
    handled : tuple of str
        What is ordinary in a log and was handled without being a fault.
    """

    name: str
    measured: xarray.Dataset
    repaired: xarray.Dataset
    step: float
    remarks: tuple[str, ...] = ()
    handled: tuple[str, ...] = ()


@dataclass(frozen=True)
class Diagnosis:
    """What there is to say of a log: the content of diagnosis.json, and all that the page shows.

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
        What to sail next, in short; `manoeuvre` has it step by step.
    baseline, gain : dict or None
        As in the contract; None where there was too little data.
    manoeuvre : Manoeuvre or None
    causes : dict of str to Cause
        The catalogue.
    facts : dict of str to float or None
        What the log has of motion, thrust astern and wind, as from `log_facts`.
    log : LogSummary or None
    evidence : Evidence or None
    predictions : PredictionErrors or None
        None where there was too little data.
    tracks : Tracks or None
        The log predicted piece by piece, by the ship as she was modelled and with the named causes.
    force : MissingForce or None
    extension : Extension or None
        What was put into the system; None where no cause of the physics was named.
    extended : System or None
        The system with it, which can be simulated.
    changes : tuple of Change
        Every number in which it differs.
    system : System or None
        That the log was held against.
    remarks : tuple of str
        What did not work.
    discrepancies : tuple of Discrepancy
        In what simulation and log differ at first sight, largest first.
    form : LoadForm or None
        How far the form of her loads differs from the model's; None where it is the model's, or a reference's.
    obstacles : tuple of str
        Why no cause can be named from the log, whatever it shows, and what would do.
    basis : JudgedLog or None
        What the findings rest on, for further work: the log, the identification problem, the fits.
    folder : TemporaryDirectory or None
        Keeps the files of the extended system where nobody said where they go.
    """

    verdict: str
    findings: tuple[Finding, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    indistinguishable: tuple[Candidate, ...] = ()
    not_testable: tuple[str, ...] = ()
    prescription: ExperimentDesign | None = None
    baseline: dict | None = None
    gain: dict | None = None
    manoeuvre: Manoeuvre | None = None
    causes: dict[str, Cause] = field(default_factory=dict, repr=False)
    facts: dict[str, float | None] = field(default_factory=dict)
    log: LogSummary | None = field(default=None, repr=False)
    evidence: Evidence | None = field(default=None, repr=False)
    predictions: PredictionErrors | None = field(default=None, repr=False)
    tracks: Tracks | None = field(default=None, repr=False)
    force: MissingForce | None = field(default=None, repr=False)
    extension: Extension | None = None
    extended: System | None = field(default=None, repr=False)
    changes: tuple[Change, ...] = ()
    system: System | None = field(default=None, repr=False)
    remarks: tuple[str, ...] = ()
    discrepancies: tuple[Discrepancy, ...] = ()
    form: LoadForm | None = None
    obstacles: tuple[str, ...] = ()
    basis: JudgedLog | None = field(default=None, repr=False)
    folder: object = field(default=None, repr=False, compare=False)

    @property
    def is_named(self) -> bool:
        """Whether causes of the physics are named, and nothing else is the matter."""
        return self.verdict == "named" and any(finding.kind == "physics" for finding in self.findings)

    @property
    def has_crude(self) -> bool:
        """Whether a cause is among the findings that only a comparison of commanded with felt force finds."""
        causes = self.basis.explained.identification.causes if self.basis else self.causes
        return any(one.cause in causes and causes[one.cause].sought_in == "comparison" for one in self.findings)

    @property
    def notes(self) -> tuple[str, ...]:
        """What could not be known from this log, and what did not work."""
        return (*(self.log.remarks if self.log else ()), *self.obstacles, *self.remarks)

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
            "discrepancies": [asdict(discrepancy) for discrepancy in self.discrepancies],
            "form": asdict(self.form) if self.form else None,
            "baseline": self.baseline,
            "gain": self.gain,
        }
