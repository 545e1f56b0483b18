"""Temporary folders that do not stay where a process is killed: the next one clears them away."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

_NAME = re.compile(r"(?:\.unfinished|shipcosim)-(?P<host>.+)-(?P<process>\d+)-[^-]+")


def temporary_folder(
    parent: Path | None = None, *, unfinished: bool = False
) -> tempfile.TemporaryDirectory[str]:
    """A temporary folder, after clearing away those of processes that are no longer there.

    Parameters
    ----------
    parent : Path, optional
        Where it is made; else where the system has its temporary files.
    unfinished : bool
        Whether it holds results on their way, so that it is hidden.
    """
    parent = Path(tempfile.gettempdir()) if parent is None else parent
    _clear(parent)
    kind = ".unfinished" if unfinished else "shipcosim"
    prefix = f"{kind}-{_host()}-{os.getpid()}-"
    return tempfile.TemporaryDirectory(prefix=prefix, dir=parent, ignore_cleanup_errors=True)


def replace_file(path: Path, content: bytes) -> None:
    """Write a file beside its place, then rename it: nobody reads half of it, and no half of it stays.

    Parameters
    ----------
    path : Path
        Its place; the folder is made if needed.
    content : bytes
        All of it.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_folder(path.parent, unfinished=True) as folder:
        new = Path(folder, path.name)
        new.write_bytes(content)
        new.chmod(0o644)  # others may read it, whatever the umask is
        os.replace(new, path)


def _clear(parent: Path) -> None:
    """Remove folders of processes of this machine that have ended."""
    with suppress(OSError):
        for path in parent.iterdir():
            named = _NAME.fullmatch(path.name)
            if named and named["host"] == _host() and not _is_alive(int(named["process"])):
                shutil.rmtree(path, ignore_errors=True)


def _host() -> str:
    return re.sub(r"\W", "_", os.uname().nodename if hasattr(os, "uname") else "windows")


def _is_alive(process: int) -> bool:
    if os.name != "posix":
        return True  # asking would end it there
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
