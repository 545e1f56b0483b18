"""The command `build`: FMUs and packed systems of a project."""

from collections.abc import Callable, Collection
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

from shipcosim import library
from shipcosim.cosim.processes.pool import end_pool, new_pool, submitted
from shipcosim.errors import Problem, ShipcosimError, raise_errors, suggestion
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.native.export.packing import build_native_fmu
from shipcosim.native.export.targets import targets_of
from shipcosim.native.symbols import Untraceable
from shipcosim.ssp import pack, read_system
from shipcosim.temporary import temporary_folder


def build_named(
    project: Path,
    names: Collection[str],
    out: Path,
    progress: Callable[[int, int], None] | None = None,
) -> list[Path]:
    """Build FMUs and pack systems of a project.

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
    sources = library.fmu_sources(project)
    systems = {
        f.parent.name: f.parent for f in sorted((project / "ssp").glob("*/SystemStructure.ssd"))
    }
    choices = [*sources, *systems]
    problems = [
        Problem(n, "There is no such FMU or system.", suggestion(n, choices))
        for n in names
        if n not in choices
    ]
    fmus = out / "fmus"
    jobs = [(build_fmu, path, fmus) for name, path in sources.items() if not names or name in names]
    jobs += [(_pack, path, out) for name, path in systems.items() if not names or name in names]
    built = []
    for done, (job, path, target) in enumerate(jobs, start=1):
        try:
            built.append(job(path, target))
        except ShipcosimError as error:
            problems += error.problems
        if progress:
            progress(done, len(jobs))
    raise_errors(problems)
    return built


def build_native(
    project: Path,
    names: Collection[str],
    out: Path,
    targets: str,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[list[Path], list[Problem]]:
    """Build FMUs with their models in C, as far as that can be.

    Parameters
    ----------
    project : Path
        With fmus/ and ssp/.
    names : collection of str
        Of FMUs; all if empty.
    out : Path
        Folder for them.
    targets : str
        Platforms, by commas; this one's where it is empty.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    list of Path
        What was built.
    list of Problem
        What stays in Python, and why.

    Raises
    ------
    ShipcosimError
        With all problems; what has none is built nevertheless.
    """
    sources = library.fmu_sources(project)
    platforms = targets_of(targets)
    problems = [
        Problem(n, "There is no such FMU.", suggestion(n, [*sources]))
        for n in names
        if n not in sources
    ]
    jobs = {name: path for name, path in sources.items() if not names or name in names}
    examples = _parameters_in_systems(project) if jobs else {}
    # Recording takes one core, so each core has a process.
    results = {}
    with temporary_folder() as folder:
        pool = new_pool(folder)
        try:
            futures = {
                submitted(pool, _built_native, path, out, examples.get(name, ()), platforms): name
                for name, path in jobs.items()
            }
            for done, future in enumerate(as_completed(futures), start=1):
                results[futures[future]] = future.result()
                if progress:
                    progress(done, len(jobs))
        finally:
            end_pool(pool)
    built = []
    left = []
    for name in jobs:
        path, reason, others = results[name]
        problems += others
        if path:
            built.append(path)
        if reason:
            left.append(Problem(name, f"stays in Python: {reason}."))
            (out / f"{name}.fmu").unlink(missing_ok=True)
    raise_errors(problems)
    return built, left


def _built_native(*job: Any) -> tuple[Path | None, str, list[Problem]]:
    """The FMU that is built; or why it stays in Python, or its problems."""
    try:
        return build_native_fmu(*job), "", []
    except Untraceable as reason:
        return None, str(reason), []
    except ShipcosimError as error:
        return None, "", error.problems


def _parameters_in_systems(project: Path) -> dict[str, list[dict[str, Any]]]:
    """Sets of parameters that systems give their components, by FMU. A system that cannot be read gives none.

    An FMU that is in no system has what all components of a system have together, by the names of parameters.
    """
    sets: dict[str, list[dict[str, Any]]] = {}
    together: list[dict[str, Any]] = []
    folders = library.fmus(project)
    for path in library.names("system", project).values():
        try:
            system = read_system(path, fmus=folders)
        except ShipcosimError:
            continue
        together.append({})
        for component in system.components.values():
            kinds = component.variables
            given = {
                name: value
                for name, value in component.start.items()
                if kinds[name].causality == "parameter"
            }
            sets.setdefault(component.fmu.path.stem, []).append(given)
            together[-1] = given | together[-1]
    return {name: sets.get(name, together) for name in library.fmu_sources(project)}


def _pack(folder: Path, out: Path) -> Path:
    target = out / "ssp" / f"{folder.name}.ssp"
    pack(folder, [out / "fmus", *library.fmus(folder, build=False)], target)
    return target
