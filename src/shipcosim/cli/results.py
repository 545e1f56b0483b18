"""The files of a run: all three are there afterwards, or none of them has changed.

What an earlier run left under the same names is kept: it moves into a numbered folder beside the results, which hold
the newest. With --force it is replaced.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from shipcosim.errors import Problem, ShipcosimError

if TYPE_CHECKING:
    import xarray

    from shipcosim.scenario import Scenario, Verdict
    from shipcosim.ssp import System

REPLACING: ContextVar[bool] = ContextVar("replacing", default=False)
"""Whether the command that is running was given --force."""
PARTIAL = ("result-partial.nc", "result-partial.csv", "result-partial.html")


def save(
    table: xarray.Dataset,
    folder: str | os.PathLike[str],
    stem: str,
    *,
    scenario: Scenario,
    system: System,
    verdicts: Sequence[Verdict] = (),
) -> Path:
    """Write table and page; a complete run takes away what an interrupted one left before it.

    Parameters
    ----------
    table : xarray.Dataset
        The run.
    folder : path
        Made if needed.
    stem : str
        ``"result"``, or ``"result-partial"`` for a run that did not get to its end.
    scenario, system, verdicts
        As for `write_report`.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    ShipcosimError
        If something cannot be written.
    """
    from shipcosim.report import write_report
    from shipcosim.series import write_table

    page = "report.html" if stem == "result" else f"{stem}.html"
    with staged(Path(folder), PARTIAL if stem == "result" else ()) as stage:
        for suffix in (".nc", ".csv"):
            write_table(table, stage / f"{stem}{suffix}")
        write_report(table, stage / page, scenario=scenario, verdicts=verdicts, system=system)
    return Path(folder) / page


def check_targets(folder: Path, store: Path | None = None) -> None:
    """Whether results can be written, as far as that can be known before a long run.

    Parameters
    ----------
    folder : Path
        For the results; it need not exist yet.
    store : Path, optional
        File for the state at the end.

    Raises
    ------
    ShipcosimError
        If they cannot.
    """
    problems = [Problem(str(folder), found, "Choose another --out.") for found in _complaints(folder)]
    if store is not None:
        found = ["This is a folder."] if store.is_dir() else _complaints(store.parent, must_exist=True)
        problems += [Problem(str(store), text, "Choose another file for --store.") for text in found]
    if problems:
        raise ShipcosimError(problems)


def _complaints(folder: Path, must_exist: bool = False) -> list[str]:
    there = next(parent for parent in (Path(folder), *Path(folder).absolute().parents) if parent.exists())
    if not there.is_dir():
        return [f"{there} is a file, not a folder."]
    if must_exist and there != Path(folder):
        return ["There is no such folder to store the state in."]
    return [] if os.access(there, os.W_OK | os.X_OK) else [f"There is no permission to write in {there}."]


def write_json(content: Mapping[str, Any], path: Path) -> None:
    """Write what a command has found as JSON; a number that JSON does not have is an error."""
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


@contextmanager
def staged(folder: Path, replaced: Iterable[str] = ()) -> Iterator[Path]:
    """A folder whose files move into `folder` at the end, unless something fails.

    Parameters
    ----------
    folder : Path
        Made if needed.
    replaced : iterable of str
        Names of files that an earlier run may have left, which are no longer true.
    """
    was_there = folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".unfinished-", dir=folder) as name:
            stage = Path(name)
            try:
                yield stage
            except ShipcosimError as error:
                raise ShipcosimError([_at_home(problem, stage, folder) for problem in error.problems]) from error
            written = [file.name for file in stage.iterdir()]
            set_aside(folder, {*written, *replaced})
            for name in written:
                os.replace(stage / name, folder / name)
        for name in {*replaced} - {*written}:
            (folder / name).unlink(missing_ok=True)
    except BaseException as error:
        if not was_there:
            with suppress(OSError):
                folder.rmdir()
        if not isinstance(error, OSError):
            raise
        raise ShipcosimError(
            Problem(str(folder), f"Results cannot be written here: {error.strerror}.", "Choose another --out.")
        ) from error


def set_aside(folder: Path, names: Iterable[str]) -> None:
    """Move what there is of earlier results into a numbered folder beside theirs, and say so; nothing with --force.

    Parameters
    ----------
    folder : Path
        Of the results: those of ``results/calm`` go to ``results/calm-1``, then ``results/calm-2``, and so on.
    names : iterable of str
        Of its files and folders that will be written again.
    """
    there = sorted(name for name in names if (folder / name).exists())
    if not there or REPLACING.get():
        return
    aside = _numbered(folder.resolve())
    aside.mkdir()
    for name in there:
        os.replace(folder / name, aside / name)
    _say(aside)


def set_file_aside(path: Path) -> None:
    """The same with a single file: ``state.bin`` becomes ``state-1.bin``."""
    if path.is_file() and not REPLACING.get():
        aside = _numbered(path.resolve())
        os.replace(path, aside)
        _say(aside)


def _numbered(path: Path) -> Path:
    """The path with the number after the highest that is taken."""
    suffix = path.suffix if path.is_file() else ""
    stem = path.name.removesuffix(suffix)
    others = (re.fullmatch(rf"{re.escape(stem)}-(\d+){re.escape(suffix)}", one.name) for one in path.parent.glob("*"))
    taken = [int(match[1]) for match in others if match]
    return path.with_name(f"{stem}-{max(taken, default=0) + 1}{suffix}")


def _say(aside: Path) -> None:
    from shipcosim.cli.console import shown_path

    typer.echo(f"Earlier results are kept in {shown_path(aside)} (--force replaces them).", err=True)


def _at_home(problem: Problem, stage: Path, folder: Path) -> Problem:
    """The problem with the name that the file would have had."""
    return replace(problem, where=problem.where.replace(str(stage), str(folder)))
