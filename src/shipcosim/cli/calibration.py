"""The command `calibrate`: what was fitted to logs of a ship that is well, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.console import print_found

if TYPE_CHECKING:
    from shipcosim.diagnose.calibration_pipeline import CalibratedShip


def print_calibration(ship: CalibratedShip, folder: Path) -> None:
    """Print the result of a calibration."""
    from shipcosim.report.calibration.words import blocks, outcome

    print_found(outcome(ship), blocks(ship), folder / "report.html")
