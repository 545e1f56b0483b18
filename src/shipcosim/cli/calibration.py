"""The command `calibrate`: what was fitted to logs of a ship that is well, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.calibration_pipeline import CalibratedShip


def print_calibration(ship: CalibratedShip, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import say_page
    from shipcosim.report.calibration.words import errors_by_log, moved_rows, sentence
    from shipcosim.report.diagnosis.by_log import error_table

    console = make_console(soft_wrap=True)
    refused = bool(ship.refusals)
    console.print(
        Text("refused" if refused else "calibrated", style="bold red" if refused else "bold green"),
        end=" ",
    )
    console.print(Text(sentence(ship)))
    errors = error_table(errors_by_log(ship), "calibrated")
    for heading, lines in (
        ("Why", ship.refusals),
        ("Remarks", ship.remarks),
        ("Moved most", ["  ".join(row) for row in moved_rows(ship)[:8]]),
    ):
        if lines:
            console.print()
            console.print(Text(heading, style="bold"))
            console.print(Text("\n".join(lines)))
    if errors.rows:
        console.print()
        console.print(Text("Errors by log", style="bold"))
        print_table(console, errors.rows, errors.head)
    console.print()
    say_page(console, folder / "report.html")
