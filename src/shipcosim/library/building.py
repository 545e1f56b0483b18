"""Built FMUs: those of a project in its build/, those that came with a wheel in the user's cache."""

import functools
import hashlib
import os
from pathlib import Path

from shipcosim import __version__
from shipcosim.errors import AnyPath, error_at
from shipcosim.library.names import fmu_sources
from shipcosim.library.places import CACHE, PACKAGE, cache, project_of, shipped
from shipcosim.temporary import temporary_folder

IN_EVERY_FMU = ("interfaces", "models", "angles.py", "fmi", "units.py")
"""Parts of this package that travel in FMUs or build them."""


def fmus(near: AnyPath | None = None, build: bool = True) -> list[Path]:
    """Folders in which a system finds the FMUs that are not beside it.

    Parameters
    ----------
    near : path, optional
        The system or scenario; the working folder without.
    build : bool
        Build the project's FMUs that are missing or out of date, which runs their source. Those that came with a
        wheel are always built.

    Returns
    -------
    list of Path
        Those of the project around, then those that the package ships. Empty for a path outside of any project, so
        that an FMU that somebody's system lacks is missing rather than one of ours.
    """
    project = project_of(os.fspath(near).partition("#")[0] if near is not None else None)
    if project is None:
        return [] if near is not None else [_shipped_fmus(build)]
    ours = _shipped_fmus(build)
    if project == shipped():
        return [ours]
    of_project = build_stale(project) if build else built_fmus(project)
    return [of_project, ours]


def built_fmus(project: Path) -> Path:
    """Folder of a project's built FMUs."""
    return project / "build" / "fmus"


def build_stale(project: Path) -> Path:
    """Build the FMUs of a project that are missing or older than what goes into them.

    Parameters
    ----------
    project : Path
        With fmus/.

    Returns
    -------
    Path
        Folder with the FMUs.
    """
    from shipcosim.fmi.export.builder import build_fmu

    out = built_fmus(project)
    shared = max(_newest(PACKAGE / part) for part in IN_EVERY_FMU)
    for name, folder in fmu_sources(project).items():
        fmu = out / f"{name}.fmu"
        if not fmu.is_file() or fmu.stat().st_mtime < max(shared, _newest(folder)):
            build_fmu(folder, out)
    return out


def built_fmu(source: Path, build: bool = True) -> Path:
    """File of one FMU by the folder of its source; built where it is missing or out of date, unless told not to."""
    project = source.parents[1]
    if source.parent == shipped() / "fmus":
        folder = _shipped_fmus(build)
    else:
        folder = build_stale(project) if build else built_fmus(project)
    return folder / f"{source.name}.fmu"


def build_if_stale(fmu: Path) -> None:
    """Build an FMU again where it is one of a project's built FMUs and older than its source."""
    fmu = fmu.resolve()
    project = fmu.parents[2] if len(fmu.parents) > 2 else fmu.parent
    if fmu.parent == built_fmus(project) and fmu.stem in fmu_sources(project):
        build_stale(project)


def _shipped_fmus(build: bool) -> Path:
    """Folder of the FMUs that the package ships: in a repository its build/, else in the user's cache."""
    root = shipped()
    if not root.is_relative_to(PACKAGE):
        return build_stale(root) if build else built_fmus(root)
    folder = cache() / "fmus" / f"{__version__}-{_digest(root)}"
    if not folder.is_dir():
        _build_into_cache(root, folder)
    return folder


def _build_into_cache(root: Path, folder: Path) -> None:
    """Build all FMUs beside the folder and rename: it is there whole or not at all, whoever builds at the same time."""
    from shipcosim.fmi.export.builder import build_all

    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        stage = temporary_folder(folder.parent, unfinished=True)
    except OSError as error:
        raise error_at(
            str(folder),
            f"cannot be written: {error.strerror}.",
            f"Set {CACHE} to a folder that can be written to.",
        ) from None
    with stage as name:
        made = Path(name, "fmus")
        made.mkdir()
        build_all(root / "fmus", out=made)
        try:
            made.rename(folder)
        except OSError:
            if not folder.is_dir():  # else another process was first, with the same FMUs
                raise


@functools.cache
def _digest(root: Path) -> str:
    """Digest of everything that goes into the shipped FMUs."""
    from importlib.metadata import version

    digest = hashlib.sha256(version("pythonfmu").encode())
    for path in (root / "fmus", *(PACKAGE / part for part in IN_EVERY_FMU)):
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file() and file.suffix != ".pyc":
                content = file.read_bytes()
                digest.update(
                    f"{file.relative_to(PACKAGE).as_posix()} {len(content)}\n".encode() + content
                )
    return digest.hexdigest()[:16]


def _newest(path: Path) -> float:
    """Time of the last change of a file, or of the files in a folder."""
    files = path.rglob("*") if path.is_dir() else [path]
    # A folder is as new as the compiled code that Python puts into it, so only files count.
    sources = (file for file in files if file.is_file() and file.suffix != ".pyc")
    return max((file.stat().st_mtime for file in sources), default=0.0)
