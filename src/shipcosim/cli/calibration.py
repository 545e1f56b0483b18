"""The command `calibrate`: what was fitted to logs of a ship that is well, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.calibration_pipeline import CalibratedShip


def print_calibration(ship: CalibratedShip, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import say_page
    from shipcosim.report.calibration.words import error_rows, moved_rows, sentence

    console = make_console(soft_wrap=True)
    refused = bool(ship.refusals)
    console.print(
        Text("refused" if refused else "calibrated", style="bold red" if refused else "bold green"),
        end=" ",
    )
    console.print(Text(sentence(ship)))
    for heading, lines in (
        ("Why", ship.refusals),
        ("Remarks", ship.remarks),
        ("Moved most", ["  ".join(row) for row in moved_rows(ship)[:8]]),
        (
            "Position error that remains: as it is, calibrated without this log, with it",
            ["  ".join(row) for row in error_rows(ship)],
        ),
    ):
        if lines:
            console.print()
            console.print(Text(heading, style="bold"))
            console.print(Text("\n".join(lines)))
    console.print()
    say_page(console, folder / "report.html")
