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
    """The vessel whose capability is computed.

    Parameters
    ----------
    system : path or name
        As for `library.find`.
    parameters : sequence of path or name
        Parameter sets, or names of sets in the system's resources.
    ship : str, optional
        Folder of the ship, or its name in ships or ssp/ships; the one whose name the last parameter set has without.

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
        A path, or a name in ships or ssp/ships.
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
        names = [Path(path).stem for path in reversed([*bound, *map(str, sets)])]
    given = [Path(ship)] if ship else []
    for folder in (*given, *(place / name for name in names for place in ships)):
        if (folder / "ship.toml").is_file():
            return folder
    ship_names = [file.parent.name for place in ships for file in sorted(place.glob("*/ship.toml"))]
    message = f"There is no ship '{ship}'." if ship else "Nothing says which ship this is."
    raise error_at(
        "--ship", message, f"Give her folder. {suggestion(ship or '', ship_names)}".strip()
    )


def _ships(system: Path) -> list[Path]:
    """Folders of ships above a system, then above the working folder: `ships` of a project, and `ssp/ships`."""
    above = [*system.resolve().parents, Path.cwd(), *Path.cwd().parents]
    places = [folder / name for folder in above for name in ("ships", "ssp/ships")]
    return list(dict.fromkeys(place for place in places if place.is_dir()))
