"""The command `capability`: the numbers of a ship, on the terminal."""

from __future__ import annotations

from pathlib import Path

from shipcosim.capability import Capability, notation
from shipcosim.capability.result import SIMULATOR
from shipcosim.cli.console import say_page
from shipcosim.cli.terminal import make_console


def print_capability(capability: Capability, folder: Path) -> None:
    """The notation and where the page is, on stdout."""
    from rich.text import Text

    console = make_console(soft_wrap=True)
    console.print(
        Text(notation(capability), style="bold"), f"of {capability.vessel.name}, by DNV's formulae"
    )
    if any(len(case.failed) > 1 for case in capability.cases):
        *_, c, d = capability.elements(most_lost=1)
        console.print(f"Where only one thruster is lost, C and D are {c} and {d}")
    simulated = ", ".join(map(str, capability.elements(SIMULATOR)))
    console.print(f"The same four by the simulator's own models: {simulated}")
    say_page(console, folder / "report.html")
