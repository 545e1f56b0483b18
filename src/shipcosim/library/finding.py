"""What a user means: a path, or a name that is looked up; where there is no such thing, what there is."""

import os
from difflib import get_close_matches
from pathlib import Path

from shipcosim.errors import AnyPath, error_at, suggestion
from shipcosim.library.building import build_if_stale, built_fmu
from shipcosim.library.names import KINDS, SYSTEM_STRUCTURE, in_root, names
from shipcosim.library.places import roots

SYSTEMS = (".ssp", ".ssd", ".xml")
STRUCTURES = (SYSTEM_STRUCTURE, "OspSystemStructure.xml")
WHAT = {
    "scenario": "scenario file",
    "study": "study",
    "system": "system",
    "ship": "ship",
    "fmu": "FMU",
    "example": "file of measured data",
}


def find(
    kind: str, given: AnyPath, option: str = "", near: AnyPath | None = None, build: bool = True
) -> Path:
    """Path of the thing that a name or path means.

    Parameters
    ----------
    kind : str
        ``"scenario"``, ``"study"``, ``"system"``, ``"ship"``, ``"fmu"`` or ``"example"``.
    given : path or str
        A path, or a name in the project around or in what the package ships.
    option : str
        Where it was given, for messages: ``"--system"``.
    near : path, optional
        In the project; the working folder without.
    build : bool
        Build an FMU that is missing or out of date, which runs its source.

    Returns
    -------
    Path
        Of an FMU the built one. ``X.ssp#Variant.ssd`` stays so.

    Raises
    ------
    ShipcosimError
        If there is none; says which there are.
    """
    text = os.fspath(given)
    _check_kind(kind, text)
    path = Path(text.partition("#")[0])
    by_name = names(kind, near)
    is_plain = text in by_name and not _is_one(kind, path)
    if (
        path.exists()
        and not is_plain
        and (kind not in ("scenario", "study", "fmu") or path.is_file())
    ):
        if build and path.suffix == ".fmu":
            build_if_stale(path)
        return Path(text)
    if text in by_name:
        return built_fmu(by_name[text], build) if kind == "fmu" else by_name[text]
    where = f"{option} {text}" if option else text
    raise error_at(
        where, f"There is no such {WHAT[kind]}.", suggestion(text.removesuffix(".toml"), by_name)
    )


def find_any(given: str) -> str:
    """Path of a thing of any kind, as for `find`; a scenario comes before a system of the same name.

    Raises
    ------
    ShipcosimError
        If there is no such file, folder or name.
    """
    if Path(given.partition("#")[0]).exists():
        return given
    kinds = [kind for kind in KINDS if given in names(kind)]
    if kinds:
        return str(find(kinds[0], given))
    close = get_close_matches(given, [name for kind in KINDS for name in names(kind)], n=1)
    remedy = (
        f"Did you mean '{close[0]}'?"
        if close
        else "Give the path of one, or a name of `shipcosim list`."
    )
    raise error_at(given, "There is no such file or folder.", remedy)


def scenarios(given: str) -> dict[str, Path]:
    """Scenario files of a folder by their names in it: a path, or the name of a folder of scenarios.

    Of a project's folder those in its `scenarios`, with all folders in there. Empty if it is no folder.

    Raises
    ------
    ShipcosimError
        If the folder holds none.
    """
    folders = (Path(given), *(root / "scenarios" / given for root in roots()))
    folder = next((f for f in folders if f.is_dir()), None)
    if folder is None or given in names("scenario"):
        return {}
    in_project = folder / "scenarios"
    files = sorted(in_project.rglob("*.toml") if in_project.is_dir() else folder.glob("*.toml"))
    if not files:
        raise error_at(given, "There is no scenario file in this folder.", "Name a .toml file.")
    inside = in_project if in_project.is_dir() else folder
    return {file.relative_to(inside).with_suffix("").as_posix(): file for file in files}


def files_of(given: str) -> list[str]:
    """What there is to check at a path: a file, a system, a ship; or of any other folder all of these in it."""
    folder = Path(given)
    if not folder.is_dir() or any(_is_one(kind, folder) for kind in ("system", "ship")):
        return [given]
    kinds = ("scenario", "study", "system", "ship")
    paths = [path for kind in kinds for _, path in in_root(kind, folder)]
    return [str(path) for path in paths or sorted(folder.glob("*.toml"))] or [given]


def find_parameters(given: Path, system: AnyPath) -> Path:
    """Parameter set: a path, or the name of one in the system's resources."""
    named = Path(system) / "resources" / f"{given.name}.ssv"
    return named if not given.exists() and named.is_file() else given


def check_is_system(given: str) -> None:
    """Raise ShipcosimError where what should be a system has the ending of something else."""
    suffix = Path(given).suffix.lower()
    if suffix == ".toml":
        raise error_at(
            given, "This is no system.", f"If it is a scenario, `shipcosim run {given}` runs it."
        )


def _check_kind(kind: str, text: str) -> None:
    """Raise ShipcosimError where a file is there and is of another kind."""
    if not Path(text.partition("#")[0]).exists():
        return
    if kind == "system":
        check_is_system(text)
    if kind == "scenario" and Path(text).suffix.lower() in SYSTEMS:
        raise error_at(
            text, "This is a system, not a scenario.", f"`shipcosim simulate {text}` runs it."
        )


def _is_one(kind: str, path: Path) -> bool:
    """Whether a path is a thing of a kind, so that it goes before a name; an empty folder of this name does not."""
    holds = {"system": STRUCTURES, "ship": ("ship.toml",)}.get(kind, ())
    return path.is_file() or any((path / name).is_file() for name in holds)
