"""The command `sea-trials`: what a simulation gets wrong of a ship's manoeuvring trials, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.console import print_found, shown_path
from shipcosim.cli.terminal import say

if TYPE_CHECKING:
    from shipcosim.diagnose.sea_trials.study import SeaTrialStudy


def print_study(study: SeaTrialStudy, folder: Path) -> None:
    """Print the result of sea trials."""
    from shipcosim.report.sea_trials.words import blocks, outcome, trials

    say(trials(study))
    print_found(outcome(study), blocks(study), folder / "report.html")
    say(f"Numbers: {shown_path(folder / 'sea_trials.json')}")
