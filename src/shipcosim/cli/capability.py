"""The command `capability`: from a system and a ship's files to the numbers, the tables and the page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from shipcosim.capability import Capability, as_json, capability_of, dataset, notation, numbers_table, vessel_of
from shipcosim.capability.result import SIMULATOR
from shipcosim.cli.console import shown_path
from shipcosim.cli.results import check_targets
from shipcosim.staging import staged


def assess(
    system: str, parameters: Sequence[Path], ship: str | None, groups: Sequence[Sequence[str]], out: Path | None
) -> tuple[Capability, Path]:
    """Compute a capability and write all that there is to say of it.

    Parameters
    ----------
    system : str
        As for `library.find`.
    parameters : sequence of Path
        Parameter sets, or names of sets in the system's resources.
    ship : str or None
        Folder of the ship, or its name in ssp/ships.
    groups : sequence of sequence of str
        Thrusters that one failure takes out together.
    out : Path or None
        Gets report.html, capability.csv and capability.nc; results/capability-SHIP without.

    Returns
    -------
    tuple of Capability and Path
        What was found, and the folder.

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.report.capability.page import write_capability
    from shipcosim.series import write_file, write_table

    vessel = vessel_of(system, parameters, ship)
    folder = out or Path("results") / f"capability-{vessel.name}"
    check_targets(folder)
    result = capability_of(vessel, groups)
    with staged(folder) as stage:
        write_file(stage / "capability.csv", numbers_table(result).encode())
        write_table(dataset(result), stage / "capability.nc")
        write_capability(result, stage / "report.html")
    return result, folder


def print_capability(capability: Capability, folder: Path, as_json_: bool) -> None:
    """The notation and where the page is, or all numbers as JSON, on stdout."""
    if as_json_:
        print(json.dumps(as_json(capability), indent=2, ensure_ascii=False))
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False, soft_wrap=True)
    console.print(Text(notation(capability), style="bold"), f"of {capability.vessel.name}, by DNV's formulae")
    if any(len(case.failed) > 1 for case in capability.cases):
        *_, c, d = capability.elements(most_lost=1)
        console.print(f"Where only one thruster is lost, C and D are {c} and {d}")
    simulated = ", ".join(map(str, capability.elements(SIMULATOR)))
    console.print(f"The same four by the simulator's own models: {simulated}")
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)
