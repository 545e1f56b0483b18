"""The files of a run: all three are there afterwards, or none of them has changed."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem, ShipcosimError

if TYPE_CHECKING:
    import xarray

    from shipcosim.scenario import Scenario, Verdict
    from shipcosim.ssp import System

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
        Names of files that an earlier run may have left: those that are not written again are removed.
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
            written = list(stage.iterdir())
            for file in written:
                os.replace(file, folder / file.name)
        for name in set(replaced) - {file.name for file in written}:
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


def _at_home(problem: Problem, stage: Path, folder: Path) -> Problem:
    """The problem with the name that the file would have had."""
    return replace(problem, where=problem.where.replace(str(stage), str(folder)))
