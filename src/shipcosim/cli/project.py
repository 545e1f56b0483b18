"""Where things are in a project, and what has to be built before a run."""

import os
from collections.abc import Callable, Collection
from pathlib import Path

import shipcosim
from shipcosim.errors import Problem, ShipcosimError, suggestion

SYSTEMS = (".ssp", ".ssd", ".xml")
IN_EVERY_FMU = ("models", "angles.py", "fmi", "units.py")  # of this package: what travels in FMUs, what builds them


def find_project(start: str | os.PathLike[str]) -> Path | None:
    """Nearest folder at or above a path that holds fmus/ or ssp/, or None."""
    nearest = Path(start).resolve()
    folders = [nearest, *nearest.parents]
    return next((f for f in folders if (f / "fmus").is_dir() or (f / "ssp").is_dir()), None)


def built_fmus(project: Path) -> Path:
    """Folder of a project's built FMUs."""
    return project / "build" / "fmus"


def find_scenario(given: str) -> Path:
    """Scenario file: a path, or a name in the project's scenarios/.

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    project = find_project(Path.cwd()) or Path.cwd()
    named = project / "scenarios" / f"{given}.toml"
    if Path(given).suffix.lower() in SYSTEMS and Path(given).exists():
        remedy = f"`shipcosim simulate {given}` runs it."
        raise ShipcosimError(Problem(given, "This is a system, not a scenario.", remedy))
    for path in (Path(given), named):
        if path.is_file():
            return path
    folder = project / "scenarios"
    known = [path.relative_to(folder).with_suffix("").as_posix() for path in sorted(folder.rglob("*.toml"))]
    remedy = f"In {folder} there{suggestion(given.removesuffix('.toml'), known).removeprefix('There')}"
    raise ShipcosimError(Problem(given, "There is no such scenario file.", remedy))


def find_scenarios(given: str) -> list[Path]:
    """Scenario files of a folder: a path, or a name in the project's scenarios/; empty if it is no folder.

    Raises
    ------
    ShipcosimError
        If the folder holds none.
    """
    project = find_project(Path.cwd()) or Path.cwd()
    folder = next((f for f in (Path(given), project / "scenarios" / given) if f.is_dir()), None)
    if folder is None:
        return []
    found = sorted(folder.glob("*.toml"))
    if not found:
        raise ShipcosimError(Problem(given, "There is no scenario file in this folder.", "Name a .toml file."))
    return found


def check_is_system(given: str) -> None:
    """Raise ShipcosimError where what should be a system has the ending of something else."""
    suffix = Path(given).suffix.lower()
    if suffix == ".toml":
        remedy = f"If it is a scenario, `shipcosim run {given}` runs it."
        raise ShipcosimError(Problem(given, "This is no system.", remedy))
    if suffix == ".fmu":
        remedy = f"Connect it in a system (.ssp, .ssd). `shipcosim check {given}` says what is in it."
        raise ShipcosimError(Problem(given, "This is one FMU, not a system.", remedy))


def find_system(given: str, option: str = "the argument SYSTEM") -> str:
    """Path of a system: a path, or a name in the project's ssp/; `option` says it, for messages.

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    if Path(given.partition("#")[0]).exists():
        check_is_system(given)
        return given
    folder = (find_project(Path.cwd()) or Path.cwd()) / "ssp"
    if (folder / given / "SystemStructure.ssd").is_file():
        return str(folder / given)
    known = [path.parent.name for path in sorted(folder.glob("*/SystemStructure.ssd"))]
    there = f"In {folder} there{suggestion(given, known).removeprefix('There')}"
    raise ShipcosimError(Problem(given, "There is no such system.", there if known else f"Give one with {option}."))


def find_parameters(given: Path, system: str) -> Path:
    """Parameter set: a path, or the name of one in the system's resources."""
    named = Path(system) / "resources" / f"{given.name}.ssv"
    return named if not given.exists() and named.is_file() else given


def build_named(
    project: Path, names: Collection[str], out: Path, progress: Callable[[int, int], None] | None = None
) -> list[Path]:
    """Build FMUs and pack systems.

    Parameters
    ----------
    project : Path
        With fmus/ and ssp/.
    names : collection of str
        Of FMUs and systems; all if empty.
    out : Path
        Gets fmus/ and ssp/.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    list of Path
        What was built.

    Raises
    ------
    ShipcosimError
        With all problems; what has none is built nevertheless.
    """
    fmus, systems = _fmus(project), _systems(project)
    known = [*fmus, *systems]
    problems = [Problem(n, "There is no such FMU or system.", suggestion(n, known)) for n in names if n not in known]
    jobs = [(_build, path, out) for name, path in fmus.items() if not names or name in names]
    jobs += [(_pack, path, out) for name, path in systems.items() if not names or name in names]
    built = []
    for done, (job, path, target) in enumerate(jobs, start=1):
        try:
            built.append(job(path, target))
        except ShipcosimError as error:
            problems += error.problems
        if progress:
            progress(done, len(jobs))
    if problems:
        raise ShipcosimError(problems)
    return built


def build_stale(project: Path) -> Path:
    """Build the project's FMUs that are missing or older than what goes into them.

    Parameters
    ----------
    project : Path
        With fmus/.

    Returns
    -------
    Path
        Folder with the FMUs.
    """
    package = Path(shipcosim.__file__).parent
    shared = max(_newest(package / part) for part in IN_EVERY_FMU)
    for name, folder in _fmus(project).items():
        fmu = built_fmus(project) / f"{name}.fmu"
        if not fmu.is_file() or fmu.stat().st_mtime < max(shared, _newest(folder)):
            _build(folder, project / "build")
    return built_fmus(project)


def _fmus(project: Path) -> dict[str, Path]:
    """Folders of FMUs by name, in the order of their names."""
    return {f.name: f for f in sorted((project / "fmus").glob("*")) if (f / f"{f.name}.py").is_file()}


def _systems(project: Path) -> dict[str, Path]:
    return {f.name: f for f in sorted((project / "ssp").glob("*")) if (f / "SystemStructure.ssd").is_file()}


def _build(folder: Path, out: Path) -> Path:
    from shipcosim.fmi.export.builder import build_fmu

    return build_fmu(folder, out / "fmus")


def _pack(folder: Path, out: Path) -> Path:
    from shipcosim.ssp import pack

    target = out / "ssp" / f"{folder.name}.ssp"
    pack(folder, [out / "fmus"], target)
    return target


def _newest(path: Path) -> float:
    """Time of the last change of a file, or of the files in a folder."""
    files = path.rglob("*") if path.is_dir() else [path]
    return max((file.stat().st_mtime for file in files if file.suffix != ".pyc"), default=0.0)
