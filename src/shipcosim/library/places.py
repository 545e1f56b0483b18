"""Where things are: a user's project, what the package ships, the user's cache."""

import os
from pathlib import Path

from shipcosim.errors import AnyPath, error_at

PACKAGE = Path(__file__).resolve().parents[1]
FOLDERS = (
    "fmus",
    "ssp",
    "scenarios",
    "studies",
    "ships",
)  # each makes the folder around it a project
CACHE = "SHIPCOSIM_CACHE"  # environment variable: folder of the cache, in place of the platform's


def project_of(start: AnyPath | None = None) -> Path | None:
    """Nearest folder at or above a path that holds fmus/, ssp/, scenarios/, studies/ or ships/; None without one.

    Parameters
    ----------
    start : path, optional
        The working folder without.
    """
    nearest = Path(start or ".").resolve()
    return next((folder for folder in (nearest, *nearest.parents) if _is_project(folder)), None)


def _is_project(folder: Path) -> bool:
    """Our own ships lie in ssp/ships, which makes no project of ssp/."""
    return any(
        (folder / name).is_dir() for name in FOLDERS if (folder.name, name) != ("ssp", "ships")
    )


def shipped() -> Path:
    """Folder of what the package ships: in it where it was installed from a wheel, else the repository around it."""
    inside = PACKAGE / "shipped"
    return inside if inside.is_dir() else PACKAGE.parents[1]


def roots(start: AnyPath | None = None) -> list[Path]:
    """Folders in which names are looked up: the project around a path, where there is one, and what is shipped."""
    return list(dict.fromkeys(filter(None, (project_of(start), shipped()))))


def cache() -> Path:
    """Folder of what is made on first use: SHIPCOSIM_CACHE, else where the platform keeps such things.

    Raises
    ------
    ShipcosimError
        If the variable names a file, or a place in one.
    """
    from platformdirs import user_cache_path

    named = os.environ.get(CACHE)
    if not named:
        return user_cache_path("shipcosim", appauthor=False)
    folder = Path(named)
    if file := next((place for place in (folder, *folder.parents) if place.is_file()), None):
        raise error_at(
            named,
            f"cannot be written: {file} is a file.",
            f"Set {CACHE} to a folder that can be written to.",
        )
    return folder
