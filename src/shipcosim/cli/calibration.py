"""The command `calibrate`: from logs of a ship that is well to her parameter set, the reference and the page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.diagnosis import DEFAULT_SYSTEM, check_inputs
from shipcosim.cli.progress import LAST_STEP, shown_progress

if TYPE_CHECKING:
    from shipcosim.diagnose.calibration_pipeline import CalibratedShip

FILES = ("calibrated.ssv", "reference.json", "report.html")


def calibrate_ship(
    logs: Sequence[Path],
    out: Path | None,
    *,
    system: str | None = None,
    channels: str | os.PathLike | None = None,
    effects: str | os.PathLike | None = None,
) -> tuple[CalibratedShip, Path]:
    """Calibrate a ship to logs and write all that there is to say of it.

    Parameters
    ----------
    logs : sequence of Path
    out : Path or None
        Gets calibrated.ssv, reference.json and report.html; results/calibrated-SYSTEM without.
    system : str, optional
        As for `library.find`; that of `diagnose` without.
    channels, effects : path, optional
        Channel file, and folder with further causes.

    Returns
    -------
    tuple of CalibratedShip and Path
        What was found, and the folder.

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.cli.requests import system_of
    from shipcosim.cli.results import check_targets
    from shipcosim.diagnose.calibration_pipeline import calibrate, steps_of
    from shipcosim.report.calibration.page import write_calibration
    from shipcosim.staging import staged

    check_inputs(logs, channels, effects)
    ship = system_of(system or DEFAULT_SYSTEM, option="--system")
    folder = out or Path("results") / f"calibrated-{ship.name}"
    check_targets(folder)
    with shown_progress(steps_of(logs)) as show, staged(folder, FILES) as stage:
        found = calibrate(list(logs), ship, channels, effects, show, out=stage)
        show(LAST_STEP)
        write_calibration(found, stage / "report.html")
    return found, folder


def print_calibration(ship: CalibratedShip, folder: Path, as_json: bool) -> None:
    """What was found, on stdout."""
    from rich.console import Console
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.report.calibration.words import error_rows, moved_rows, sentence

    if as_json:
        print(ship.reference.as_json(), end="")
        return
    console = Console(highlight=False, soft_wrap=True)
    refused = bool(ship.refusals)
    console.print(Text("refused" if refused else "calibrated", style="bold red" if refused else "bold green"), end=" ")
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
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)
