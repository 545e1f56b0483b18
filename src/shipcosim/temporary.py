"""Temporary folders; the next process removes those of a killed one.

Results move from such a folder into their place. A process that is killed meanwhile leaves the list of the moves, and
the next one makes those that are missing.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_NAME = re.compile(r"(?:\.unfinished|shipcosim)-(?P<host>.+)-(?P<process>\d+)-[^-]+")

_MOVES = "moves.json"
"""In a folder of results on their way: the names of the files that move. It is there only while they move."""


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
    clear_killed(parent)
    prefix = _prefix(".unfinished" if unfinished else "shipcosim")
    return tempfile.TemporaryDirectory(prefix=prefix, dir=parent, ignore_cleanup_errors=True)


def replace_file(path: Path, content: bytes) -> None:
    """Write a file as `replacement` does; the folder is made if needed.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacement(path) as new:
        new.write_bytes(content)
        new.chmod(0o644)  # others may read it, whatever the umask is


@contextmanager
def replacement(path: Path) -> Iterator[Path]:
    """Path of a file to write, which then takes its place: nobody reads half of it, and no half of it stays.

    Of a link the file that it leads to is replaced. A device or a pipe is written into: it must not become a file.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    is_device = path.exists() and not (path.is_file() or path.is_dir())
    place = path if is_device else Path(os.path.realpath(path))
    with temporary_folder(None if is_device else place.parent, unfinished=True) as folder:
        new = Path(folder, place.name)
        yield new
        if is_device:
            place.write_bytes(new.read_bytes())
        else:
            os.replace(new, place)


def exchange(stage: Path, folder: Path, names: Iterable[str], *, keep: bool) -> None:
    """Replace earlier files by new ones: all of them or, on failure, none.

    Parameters
    ----------
    stage : Path
        A temporary folder in `folder`. The new files are in its folder ``new``, which may be missing.
    folder : Path
        Their place.
    names : iterable of str
        Files and folders in `folder` that are no longer true. Where the new ones have a name of these, they replace it.
    keep : bool
        Whether the earlier ones move into a numbered folder beside `folder`; else they are removed.

    Raises
    ------
    OSError
        If one of them cannot be moved.
    """
    new = stage / "new"
    new.mkdir(exist_ok=True)
    (stage / "earlier").mkdir()
    written = sorted(path.name for path in new.iterdir())
    outdated = sorted(name for name in {*names, *written} if os.path.lexists(folder / name))
    # With this list complete the moves are decided: whoever finds it makes those that are missing.
    draft = stage / "draft.json"
    moves = {"earlier": outdated, "new": written, "keep": keep}
    draft.write_text(json.dumps(moves), encoding="utf-8")
    os.replace(draft, stage / _MOVES)
    try:
        _move(stage, folder)
    except BaseException:
        try:
            _move_back(stage, folder)
        except OSError:
            # Under another name nobody removes it now: the next process makes the moves.
            os.rename(stage, f"{stage}_")
        raise


def _move(stage: Path, folder: Path) -> None:
    """Make the moves of a list that are not made yet, the earlier files first."""
    moves = json.loads((stage / _MOVES).read_text(encoding="utf-8"))
    earlier = stage / "earlier"
    # Without this folder all moves are made.
    if not earlier.is_dir():
        return
    for name in moves["earlier"]:
        if not os.path.lexists(earlier / name):
            os.replace(folder / name, earlier / name)
    for name in moves["new"]:
        if os.path.lexists(stage / "new" / name):
            os.replace(stage / "new" / name, folder / name)
    if moves["keep"] and moves["earlier"]:
        aside = numbered(folder.resolve())
        os.rename(earlier, aside)
        say_kept(aside)
    else:
        (stage / _MOVES).unlink()


def _move_back(stage: Path, folder: Path) -> None:
    """Undo moves in reverse, so that a kill in between leaves a state that the moves pass through too."""
    if not (stage / "earlier").is_dir():
        return  # all are made, only the message is not out
    moves = json.loads((stage / _MOVES).read_text(encoding="utf-8"))
    for name in reversed(moves["new"]):
        if not os.path.lexists(stage / "new" / name):
            os.replace(folder / name, stage / "new" / name)
    for name in reversed(moves["earlier"]):
        if os.path.lexists(stage / "earlier" / name):
            os.replace(stage / "earlier" / name, folder / name)
    (stage / _MOVES).unlink()


def numbered(path: Path) -> Path:
    """The path with the number after the highest that is taken."""
    suffix = path.suffix if path.is_file() else ""
    stem = path.name.removesuffix(suffix)
    others = (
        re.fullmatch(rf"{re.escape(stem)}-(\d+){re.escape(suffix)}", file.name)
        for file in path.parent.glob("*")
    )
    numbers = [int(match[1]) for match in others if match]
    return path.with_name(f"{stem}-{max(numbers, default=0) + 1}{suffix}")


def say_kept(aside: Path) -> None:
    """Say where earlier results are."""
    here = Path.cwd()
    shown = aside.relative_to(here) if aside.is_relative_to(here) else aside
    print(
        f"Earlier results are kept in {shown} (--force, force=True replaces them).", file=sys.stderr
    )


def clear_killed(parent: Path) -> None:
    """Remove folders of processes of this machine that have ended, after the moves that these had begun."""
    with suppress(OSError):
        for path in parent.iterdir():
            named = _NAME.fullmatch(path.name)
            if named and named["host"] == _host() and not _is_alive(int(named["process"])):
                _finish(path)


def _finish(path: Path) -> None:
    # Two processes may find it; the name of this one takes it from the other.
    claimed = path.with_name(f"{_prefix('.unfinished')}{path.name.rpartition('-')[2]}")
    with suppress(OSError, ValueError):
        os.rename(path, claimed)
        if (claimed / _MOVES).exists():
            _move(claimed, path.parent)
        shutil.rmtree(claimed, ignore_errors=True)


def _prefix(kind: str) -> str:
    return f"{kind}-{_host()}-{os.getpid()}-"


def _host() -> str:
    return re.sub(r"\W", "_", os.uname().nodename if hasattr(os, "uname") else "windows")


def _is_alive(process: int) -> bool:
    if os.name != "posix":
        return True  # asking would end it there
    try:
        os.kill(process, 0)
        # One that has ended stays in the list until its parent asks how; in many containers nobody does.
        return ") Z " not in Path(f"/proc/{process}/stat").read_text(errors="replace")
    except ProcessLookupError:
        return False
    except OSError:
        return True
