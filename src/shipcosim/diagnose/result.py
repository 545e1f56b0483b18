"""What a diagnosis says: causes with their parameters, verdict and gain, as diagnosis.json holds them."""

from dataclasses import asdict, dataclass, field

import xarray

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre
from shipcosim.diagnose.explanation.summary import Evidence, LoadForm
from shipcosim.diagnose.explanation.verdict import JudgedLog
from shipcosim.diagnose.extension.extend import Extension
from shipcosim.diagnose.extension.extended_system import NumberChange
from shipcosim.diagnose.finding import Candidate, Discrepancy, Finding, VisibleSize
from shipcosim.diagnose.hypotheses.catalogue import Cause
from shipcosim.diagnose.validation.healthy_errors import HealthyErrors
from shipcosim.diagnose.validation.missing_force import MissingForce
from shipcosim.diagnose.validation.summary import PredictionErrors
from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.ssp import System

SCHEMA = "shipcosim-diagnosis/1"


@dataclass(frozen=True)
class LogSummary:
    """A log as it was read and as it was used.

    Attributes
    ----------
    name : str
        Of its file.
    measured, repaired : xarray.Dataset
        As read; and with its faults corrected, over even times, with the coordinate `logged_time`.
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
    """Result for a log or several: the content of diagnosis.json, and all that the page shows.

    Attributes
    ----------
    verdict : str
        ``"consistent"``, ``"form"`` (no cause, and loads of another form than the model's), ``"named"``,
        ``"ambiguous"`` or ``"unknown"``.
    findings : tuple of Finding
        Most certain first.
    candidates, indistinguishable : tuple of Candidate
    not_testable : tuple of str
        Causes that this log could not have shown.
    smallest_visible : tuple of VisibleSize
        Of the other causes that were not found: what would have shown. Empty where no cause can be named.
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
    changes : tuple of NumberChange
        Every number in which it differs.
    system : System or None
        That the log was compared with.
    remarks : tuple of str
        What did not work.
    discrepancies : tuple of Discrepancy
        In what simulation and log differ at first sight, largest first.
    form : LoadForm or None
        How far the form of her loads differs from the model's; None where it is the model's, or a reference's.
    healthy : HealthyErrors or None
        How far off the simulation of a healthy ship would be on the same rows; None unless it was asked whether the
        system predicts the log.
    obstacles : tuple of str
        Why no cause can be named from the log, whatever it shows, and what would do.
    craft : LearnedCraft or None
        What the log teaches of a craft that is not the file's, with what that gains on parts that were held out.
    is_assumed : bool
        Whether all numbers of the ship were guesses, so that she is learned and no cause in her is sought.
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
    changes: tuple[NumberChange, ...] = ()
    system: System | None = field(default=None, repr=False)
    remarks: tuple[str, ...] = ()
    discrepancies: tuple[Discrepancy, ...] = ()
    form: LoadForm | None = None
    healthy: HealthyErrors | None = None
    obstacles: tuple[str, ...] = ()
    craft: LearnedCraft | None = None
    is_assumed: bool = False
    smallest_visible: tuple[VisibleSize, ...] = field(default=(), repr=False)
    basis: JudgedLog | None = field(default=None, repr=False)
    folder: object = field(default=None, repr=False, compare=False)

    @property
    def name(self) -> str:
        """Name of the log's file."""
        return self.log.name if self.log else "a log"

    @property
    def is_named(self) -> bool:
        """Whether causes of the physics are named, and nothing else is wrong."""
        return self.verdict == "named" and bool(self.physics)

    @property
    def physics(self) -> list[Finding]:
        """The causes that are named; the other findings are faults of the log."""
        return [finding for finding in self.findings if finding.kind == "physics"]

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
            "smallest_visible": [asdict(size) for size in self.smallest_visible],
            "prescription": asdict(self.prescription) if self.prescription else None,
            "discrepancies": [discrepancy.as_json() for discrepancy in self.discrepancies],
            "form": asdict(self.form) if self.form else None,
            "craft": self.craft.as_json() if self.craft else None,
            "baseline": self.baseline,
            "healthy_errors": self.healthy.as_json() if self.healthy else None,
            "gain": self.gain,
        }
