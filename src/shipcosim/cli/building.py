"""The command `build`: FMUs and packed systems of a project."""

from collections.abc import Callable, Collection
from pathlib import Path

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.ssp import pack


def build_named(
    project: Path, names: Collection[str], out: Path, progress: Callable[[int, int], None] | None = None
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
    sources, systems = library.fmu_sources(project), _systems(project)
    known = [*sources, *systems]
    problems = [Problem(n, "There is no such FMU or system.", suggestion(n, known)) for n in names if n not in known]
    jobs = [(_build, path, out) for name, path in sources.items() if not names or name in names]
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


def _systems(project: Path) -> dict[str, Path]:
    return {f.parent.name: f.parent for f in sorted((project / "ssp").glob("*/SystemStructure.ssd"))}


def _build(folder: Path, out: Path) -> Path:
    return build_fmu(folder, out / "fmus")


def _pack(folder: Path, out: Path) -> Path:
    target = out / "ssp" / f"{folder.name}.ssp"
    pack(folder, [out / "fmus", *library.fmus(folder, build=False)], target)
    return target
