"""The command `capability`: from a system and a ship's files to the numbers, the tables and the page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from shipcosim import library
from shipcosim.capability import Capability, as_json, capability_of, dataset, notation, numbers_table, read_vessel
from shipcosim.capability.result import SIMULATOR
from shipcosim.cli.console import shown_path
from shipcosim.cli.requests import system_of
from shipcosim.cli.results import check_targets, staged
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.ships import read_ship
from shipcosim.ssp import osp_file, read


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

    given = str(library.find("system", system))
    sets = [library.find_parameters(path, given) for path in parameters]
    whole = system_of(given, sets)
    found = ship_folder(ship, given, sets)
    folder = out or Path("results") / f"capability-{found.name}"
    check_targets(folder)
    result = capability_of(read_vessel(whole, read_ship(found)), groups)
    with staged(folder) as stage:
        write_file(stage / "capability.csv", numbers_table(result).encode())
        write_table(dataset(result), stage / "capability.nc")
        write_capability(result, stage / "report.html")
    return result, folder


def ship_folder(ship: str | None, system: str, sets: Sequence[Path]) -> Path:
    """Folder of the ship: the one that is given, else the one whose name the last parameter set has.

    Parameters
    ----------
    ship : str or None
        A path, or a name in ssp/ships.
    system : str
        Path of the system.
    sets : sequence of Path
        Parameter sets over the system's own.

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    ships = _ships(Path(system.partition("#")[0]))
    if ship is not None:
        names = [ship]
    else:
        bound = [] if osp_file(system) is not None else read(system).parameter_sets
        names = [Path(one).stem for one in reversed([*bound, *map(str, sets)])]
    for folder in (Path(ship), *(ships / name for name in names)) if ship else (ships / name for name in names):
        if (folder / "ship.toml").is_file():
            return folder
    known = [file.parent.name for file in sorted(ships.glob("*/ship.toml"))]
    found = f"There is no ship '{ship}'." if ship else "Nothing says which ship this is."
    raise ShipcosimError(Problem("--ship", found, f"Give her folder. {suggestion(ship or '', known)}".strip()))


def _ships(system: Path) -> Path:
    """Nearest folder of ships above a system, else above the working folder."""
    above = [*system.resolve().parents, Path.cwd(), *Path.cwd().parents]
    return next(
        (folder / "ssp" / "ships" for folder in above if (folder / "ssp" / "ships").is_dir()), Path("ssp/ships")
    )


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
