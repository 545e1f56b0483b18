"""The command `diagnose`: what was found in a log, or in several, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.console import print_found, shown_path

if TYPE_CHECKING:
    from shipcosim.diagnose.result import Diagnosis


def print_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Print the result of a diagnosis."""
    from shipcosim.report.diagnosis.summary import summary
    from shipcosim.report.diagnosis.words import next_steps, outcome
    from shipcosim.report.theme.views import Block

    extension = diagnosis.extension
    extended = str(shown_path(extension.ssp)) if extension and extension.values else None
    steps = Block("What to do next", lines=tuple(next_steps(diagnosis, extended)))
    print_found(outcome(diagnosis), (*summary(diagnosis), steps), folder / "report.html")
