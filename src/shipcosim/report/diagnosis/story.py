"""What the page of a diagnosis is made from."""

from dataclasses import dataclass, field
from typing import Any

from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.log.remarks import remarks


@dataclass(frozen=True)
class Story:
    """All that a page tells of a diagnosis.

    Attributes
    ----------
    diagnosis : Diagnosis
    details : JudgedLog
        What it rests on.
    source : str
        Name of the log.
    system : System
        The ship that the log was held against.
    extension : Extension, optional
        Where a cause was put into the system.
    extended : System, optional
        The extended system.
    comparison : Comparison, optional
        Predictions with the models, where there was data for it.
    simulated : xarray.Dataset, optional
        Its errors as co-simulations.
    force, force_left : xarray.Dataset, optional
        What the plain model lacks over time, and what it lacks with the causes in it.
    remarks : tuple of str
        What else needs to be known.
    unseen : dict of str to Comparison
        By condition, predictions on it with nothing fitted on it.
    unseen_errors : dict of str to xarray.Dataset
        Their errors, as co-simulations where those were run.
    """

    diagnosis: Any
    details: Any
    source: str
    system: Any
    extension: Any = None
    extended: Any = None
    comparison: Any = None
    simulated: Any = None
    force: Any = None
    force_left: Any = None
    remarks: tuple = ()
    unseen: Any = field(default_factory=dict)
    unseen_errors: Any = field(default_factory=dict)

    @property
    def causes(self) -> dict[str, Cause]:
        """The causes by name."""
        return read_catalogue() | {one.cause: one.definition for one in self.details.problem.hypotheses}

    @property
    def notes(self):
        """What could not be known from this log, and what did not work."""
        return [*self.details.problem.record.remarks, *self.remarks]

    @property
    def handled(self):
        """What is ordinary in a log and was handled without being a fault."""
        log = self.details.explained.identification.log
        unused = ", ".join(map(str, log.attrs.get("unused_columns", ())))
        return [*remarks(log), *([f"Columns without a role are not used: {unused}."] if unused else [])]

    @property
    def errors(self):
        """Errors of predictions: as co-simulations where those were run."""
        if self.simulated is not None:
            return self.simulated
        return None if self.comparison is None else self.comparison.errors
