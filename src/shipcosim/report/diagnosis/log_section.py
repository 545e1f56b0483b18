"""Section 1 of the page: is the log right?"""

from dataclasses import dataclass

from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.by_log import log_table
from shipcosim.report.diagnosis.log_figures import log_figures
from shipcosim.report.diagnosis.words import finding_text, title, where
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
    logs : Table
        Of several logs, what each says by itself.
    """

    found: str
    faults: Table
    notes: tuple[str, ...]
    figures: tuple[Figure, ...]
    handled: tuple[str, ...]
    logs: Table


def log_section(diagnosis: Diagnosis) -> LogSection:
    """Section 1 of the page for the template."""
    findings = diagnosis.findings
    log = diagnosis.log
    faults = [f for f in findings if f.kind == "data"]
    # Each fault with its channels, place, and what was done about it.
    rows = []
    for fault in faults:
        # Other logs than those that show it may be corrected too.
        done = read_faults()[fault.cause].repair if not fault.alternatives else "nothing"
        if fault.put_right and not fault.alternatives:
            done += f"; in {', '.join(fault.put_right)} too"
        channels = ", ".join(fault.channels) or "all"
        sentence = fault.sentence or finding_text(fault)
        rows.append((title(fault.cause), channels, where(fault), sentence, done))
    channels = log_figures(log.measured, log.repaired, findings) if log else ()
    return LogSection(
        found=f"{len(faults)} fault{'s' * (len(faults) != 1)}" if faults else "no fault found",
        faults=Table(rows, head=("Fault", "Channels", "Where", "What", "Done about it")),
        notes=diagnosis.notes,
        figures=tuple(channels),
        handled=log.handled if log else (),
        logs=log_table(diagnosis),
    )
