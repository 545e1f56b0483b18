"""Section 1 of the page: is the log right?"""

from dataclasses import dataclass

from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.diagnose.result import Diagnosis, LogSummary
from shipcosim.report.diagnosis.log_figures import log_figures, track_figure
from shipcosim.report.diagnosis.words import title, told, where
from shipcosim.report.theme.views import Figure, Table


@dataclass(frozen=True)
class LogSection:
    """Faults of the log, what is remarkable in it, and its channels.

    Attributes
    ----------
    found : str
        The result in a few words.
    faults : Table
    notes, handled : tuple of str
        What could not be known; what is ordinary in a log and was handled.
    figures : tuple of Figure
    """

    found: str
    faults: Table
    notes: tuple[str, ...]
    figures: tuple[Figure, ...]
    handled: tuple[str, ...]


def log_section(diagnosis: Diagnosis, log: LogSummary) -> LogSection:
    """Section 1 of the page for the template."""
    findings = diagnosis.findings
    faults = [f for f in findings if f.kind == "data"]
    # Each fault with its channels, place, and what was done about it.
    rows = [
        (
            title(f.cause),
            ", ".join(f.channels) or "all",
            where(f),
            f.sentence or told(f),
            "nothing" if f.alternatives else read_faults()[f.cause].repair,
        )
        for f in faults
    ]
    track = track_figure(log.repaired)
    return LogSection(
        found=f"{len(faults)} fault{'s' * (len(faults) != 1)}" if faults else "no fault found",
        faults=Table(rows, head=("Fault", "Channels", "Where", "What", "Done about it")),
        notes=diagnosis.notes,
        figures=(*([track] if track else []), *log_figures(log.measured, log.repaired, findings)),
        handled=log.handled,
    )
