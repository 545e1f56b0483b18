"""Files of results: either all are written or none changes; earlier ones are kept.

What an earlier run left under the same names moves into a numbered folder beside the results, which hold the newest,
unless it is said to be replaced.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors
from shipcosim.temporary import exchange, numbered, say_kept, temporary_folder

WRITING = "writing the page"
"""What a progress function gets at the end, where results are written."""


def check_targets(folder: Path | None, file: Path | None = None) -> None:
    """Whether results can be written, as far as that can be known before a long run.

    Parameters
    ----------
    folder : Path, optional
        For the results; it need not exist yet.
    file : Path, optional
        File for the state at the end.

    Raises
    ------
    ShipcosimError
        If they cannot.
    """
    complaints = [] if folder is None else _complaints(folder)
    problems = [Problem(str(folder), text, "Choose another folder (--out).") for text in complaints]
    if file is not None:
        complaints = (
            ["This is a folder."] if file.is_dir() else _complaints(file.parent, must_exist=True)
        )
        problems += [
            Problem(str(file), text, "Choose another file for the state (--store).")
            for text in complaints
        ]
    raise_errors(problems)


def _complaints(folder: Path, must_exist: bool = False) -> list[str]:
    above = (Path(folder), *Path(folder).absolute().parents)
    there = next(folder for folder in above if folder.exists() or folder.is_symlink())
    if not there.is_dir():
        return [f"{there} is a file, not a folder."]
    if must_exist and there != Path(folder):
        return ["There is no such folder to store the state in."]
    return (
        []
        if os.access(there, os.W_OK | os.X_OK)
        else [f"There is no permission to write in {there}."]
    )


@contextmanager
def staged(folder: Path, replaced: Iterable[str] = (), *, force: bool = False) -> Iterator[Path]:
    """A folder whose files move into `folder` at the end, unless something fails.

    Parameters
    ----------
    folder : Path
        Made if needed.
    replaced : iterable of str
        Names of files that an earlier run may have left, which are no longer true.
    force : bool
        Whether earlier results are replaced.
    """
    was_there = folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with temporary_folder(folder, unfinished=True) as name:
            stage = Path(name, "new")
            stage.mkdir()
            try:
                yield stage
            except ShipcosimError as error:
                # Each problem gets the name that the file would have had.
                raise ShipcosimError(
                    [
                        replace(problem, where=problem.where.replace(str(stage), str(folder)))
                        for problem in error.problems
                    ]
                ) from error
            exchange(Path(name), folder, replaced, keep=not force)
    except BaseException as error:
        if not was_there:
            with suppress(OSError):
                folder.rmdir()
        if not isinstance(error, OSError):
            raise
        raise error_at(
            str(folder),
            f"Results cannot be written here: {error.strerror}.",
            "Choose another folder (--out).",
        ) from error


def set_aside(folder: Path, names: Iterable[str], *, force: bool = False) -> None:
    """Move earlier results into a numbered folder and report it, unless they are replaced.

    Parameters
    ----------
    folder : Path
        Of the results: those of ``results/calm`` go to ``results/calm-1``, then ``results/calm-2``, and so on.
    names : iterable of str
        Of its files and folders that will be written again.
    force : bool
        As for `staged`.
    """
    if folder.is_dir() and not force:
        with staged(folder, names):
            pass


def set_file_aside(path: Path, *, force: bool = False) -> None:
    """Rename an earlier file: ``state.bin`` becomes ``state-1.bin``."""
    if path.is_file() and not force:
        aside = numbered(path.resolve())
        os.replace(path, aside)
        say_kept(aside)
