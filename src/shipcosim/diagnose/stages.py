"""What is known of a log after each stage of its diagnosis; `pipeline` leads from one of these values to the next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.comparison.compared import LogComparison
    from shipcosim.diagnose.extension.extend import Extension
    from shipcosim.diagnose.extension.extended_system import Change
    from shipcosim.diagnose.hypotheses.catalogue import Cause
    from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
    from shipcosim.diagnose.inference.verdict import Judgement
    from shipcosim.diagnose.result import Finding
    from shipcosim.diagnose.ship.model import ShipModel
    from shipcosim.diagnose.validation.gain import Comparison
    from shipcosim.diagnose.validation.missing_force import MissingForce
    from shipcosim.ssp import System, SystemStructure

__all__ = [
    "CheckedLog",
    "ComparedLog",
    "ExplainedLog",
    "ExtendedSystem",
    "Identification",
    "JudgedLog",
    "PredictedLog",
    "ReadLog",
    "SimulatedLog",
]


@dataclass(frozen=True)
class ReadLog:
    """A log as read, and what it is held against.

    Attributes
    ----------
    log : xarray.Dataset
        Every row of the file, in the units of the roles.
    ship : ShipModel
        The system's ship, with every cause neutral.
    causes : dict of str to Cause
        The catalogue.
    """

    log: xarray.Dataset
    ship: ShipModel
    causes: dict[str, Cause]


@dataclass(frozen=True)
class CheckedLog(ReadLog):
    """A log of which is known what is wrong with it by its own channels alone.

    Attributes
    ----------
    faults : tuple of Finding
        Of kind ``"data"``.
    repaired : xarray.Dataset
        The log on even rows, these faults put right or cut out.
    """

    faults: tuple[Finding, ...]
    repaired: xarray.Dataset


@dataclass(frozen=True)
class ComparedLog(CheckedLog):
    """A checked log held against the simulation; what is grossly wrong is put right, in the log and in the ship.

    Attributes
    ----------
    comparison : LogComparison
    """

    comparison: LogComparison


@dataclass(frozen=True)
class Identification(CheckedLog):
    """A checked log as an identification problem; the faults grow by those that only the ship's response shows.

    Attributes
    ----------
    problem : IdentificationProblem
        Of the repaired log: noise and linearisation about the ship without a cause.
    misconnections : tuple of Finding
        Connections of the system that the log contradicts; `ship` has them put right.
    comparison : LogComparison or None
        Of simulated with measured, commanded with felt.
    """

    problem: IdentificationProblem
    misconnections: tuple[Finding, ...] = ()
    comparison: LogComparison | None = None


@dataclass(frozen=True)
class ExplainedLog:
    """An identified log with the sets of causes that explain it.

    Attributes
    ----------
    identification : Identification
    fits : tuple of Fit
        One for each set of causes that was fitted, best first; that without a cause is among them.
    is_healthy : bool
        Whether the best set is empty and no unmodelled error stands out beside it.
    change_point : float or None
        Since when the causes act, where they began during the log; `identification` is then of the rows after. [s]
    """

    identification: Identification
    fits: tuple[Fit, ...]
    is_healthy: bool
    change_point: float | None = None


@dataclass(frozen=True)
class JudgedLog:
    """An explained log with the verdict on its causes.

    Attributes
    ----------
    explained : ExplainedLog
    judgement : Judgement
    unmodelled : dict of str to float
        Gain of unmodelled errors beside the causes of the judgement, by kind. [nats]
    null_gains : dict of str to float
        Gain of its causes on simulated healthy logs, by label; not computed where the real gain is far larger. [nats]
    """

    explained: ExplainedLog
    judgement: Judgement
    unmodelled: dict[str, float]
    null_gains: dict[str, float]

    @property
    def problem(self) -> IdentificationProblem:
        """The identification problem that the verdict is on."""
        return self.explained.identification.problem

    @property
    def fits(self) -> tuple[Fit, ...]:
        """The sets of causes that were fitted, best first."""
        return self.explained.fits

    @property
    def fit(self) -> Fit:
        """The set of causes that the verdict rests on; empty where nothing is named."""
        return self.judgement.fit


@dataclass(frozen=True)
class PredictedLog:
    """A judged log with predictions on rows that nothing was fitted on, in array form.

    Attributes
    ----------
    judged : JudgedLog
    is_named : bool
        Whether causes were named that predictions are made with; else only the plain model is compared.
    comparison : Comparison or None
        On the rows that were held out in time; None where there are too few.
    held_out : dict of str to Comparison
        By condition that was held out of the fit wherever in the log it is.
    force : MissingForce
        What the model lacks.
    """

    judged: JudgedLog
    is_named: bool
    comparison: Comparison | None
    held_out: dict[str, Comparison]
    force: MissingForce


@dataclass(frozen=True)
class ExtendedSystem:
    """A system with the named causes in it.

    Attributes
    ----------
    given : System
        That the log was held against.
    source : path or SystemStructure
        What is extended.
    extension : Extension or None
        None where no cause of the physics was named, or it could not be made.
    system : System or None
        The extended system, which can be simulated.
    changes : tuple of Change
        Every number that differs.
    remarks : tuple of str
        Why it could not be made.
    """

    given: System
    source: SystemStructure | str
    extension: Extension | None = None
    system: System | None = None
    changes: tuple[Change, ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class SimulatedLog:
    """Predictions as co-simulations of the given and the extended system, or in array form where that was not possible.

    Attributes
    ----------
    errors : xarray.Dataset or None
        As of a `Comparison`; None where the log has too few rows.
    held_out : dict of str to xarray.Dataset
        By condition that was held out of the fit.
    is_simulated : bool
    remarks : tuple of str
        Why they were not co-simulated.
    """

    errors: xarray.Dataset | None
    held_out: dict[str, xarray.Dataset]
    is_simulated: bool
    remarks: tuple[str, ...] = ()
