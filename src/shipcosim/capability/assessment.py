"""From the names that people give to a vessel: the system, its parameter sets, the ship's files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from shipcosim import library
from shipcosim.capability.vessel import Vessel, read_vessel
from shipcosim.errors import error_at, suggestion
from shipcosim.ships import read_ship
from shipcosim.ssp import AnyPath, osp_file, read, read_system


def vessel_of(
    system: AnyPath,
    parameters: Sequence[AnyPath] = (),
    ship: str | None = None,
) -> Vessel:
    """The vessel of a system whose capability is asked for.

    Parameters
    ----------
    system : path or name
        As for `library.find`.
    parameters : sequence of path or name
        Parameter sets, or names of sets in the system's resources.
    ship : str, optional
        Folder of the ship, or its name in ssp/ships; the one whose name the last parameter set has without.

    Raises
    ------
    ShipcosimError
        With everything that is missing or cannot be.
    """
    given = str(library.find("system", system))
    # Sets may be files or names of sets that the system brings along.
    sets = [library.find_parameters(Path(path), given) for path in parameters]
    whole = read_system(given, sets, fmus=library.fmus(given))
    return read_vessel(whole, read_ship(ship_folder(ship, given, sets)))


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
    # The name of the system may carry the id of a part after '#'; the folder lies before it.
    ships = _ships(Path(system.partition("#")[0]))
    if ship is not None:
        names = [ship]
    # Without a name: the parameter sets usually carry the ship's name. The last one set wins.
    else:
        bound = [] if osp_file(system) is not None else read(system).parameter_sets
        names = [Path(one).stem for one in reversed([*bound, *map(str, sets)])]
    for folder in (
        (Path(ship), *(ships / name for name in names))
        if ship
        else (ships / name for name in names)
    ):
        if (folder / "ship.toml").is_file():
            return folder
    known = [file.parent.name for file in sorted(ships.glob("*/ship.toml"))]
    found = f"There is no ship '{ship}'." if ship else "Nothing says which ship this is."
    raise error_at("--ship", found, f"Give her folder. {suggestion(ship or '', known)}".strip())


def _ships(system: Path) -> Path:
    """Nearest folder of ships above a system, else above the working folder."""
    above = [*system.resolve().parents, Path.cwd(), *Path.cwd().parents]
    return next(
        (folder / "ssp" / "ships" for folder in above if (folder / "ssp" / "ships").is_dir()),
        Path("ssp/ships"),
    )
