"""The files of a run, and whether results can be written at all."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.staging import staged

if TYPE_CHECKING:
    import xarray

    from shipcosim.scenario import Scenario, Verdict
    from shipcosim.ssp import System

PARTIAL = ("result-partial.nc", "result-partial.csv", "result-partial.html")
PREDICTIONS = "predictions.csv"


def save(
    table: xarray.Dataset,
    folder: str | os.PathLike[str],
    stem: str,
    *,
    scenario: Scenario,
    system: System,
    verdicts: Sequence[Verdict] = (),
) -> Path:
    """Write table, page, and predictions where there are; a complete run takes away what an interrupted one left.

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
    from shipcosim.report.run.predictions import make_predictions, write_predictions
    from shipcosim.series import write_table

    page = "report.html" if stem == "result" else f"{stem}.html"
    with staged(Path(folder), (*PARTIAL, PREDICTIONS) if stem == "result" else ()) as stage:
        for suffix in (".nc", ".csv"):
            write_table(table, stage / f"{stem}{suffix}")
        if stem == "result" and len(predictions := make_predictions(table)):
            write_predictions(predictions, stage / PREDICTIONS)
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
