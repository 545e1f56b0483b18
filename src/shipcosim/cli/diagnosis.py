"""The command `diagnose`: what was found in a log, or in several, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.result import Diagnosis


def print_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import say_page, shown_path, style_of
    from shipcosim.report.diagnosis.summary import summary
    from shipcosim.report.diagnosis.words import next_steps, outcome

    console = make_console(soft_wrap=True)
    verdict = outcome(diagnosis)
    console.print(Text(verdict.word, style=style_of(diagnosis.verdict)), Text(verdict.sentence))
    for block in filter(None, summary(diagnosis)):
        # The page has every size that would have shown.
        if block.folded and block.table.rows:
            continue
        console.print()
        console.print(Text(block.heading, style="bold"))
        style = "yellow" if block.heading == "Remarks" else ""
        for line in block.lines:
            console.print(Text(line, style=style))
        print_table(console, block.table.rows, block.table.head)
    console.print()
    console.print(Text("What to do next", style="bold"))
    extension = diagnosis.extension
    extended = (
        str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    )
    for step in next_steps(diagnosis, extended):
        console.print(Text(f"- {step}"))
    console.print()
    say_page(console, folder / "report.html")
