"""A run on the terminal: its remarks, its progress, how it went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import typer

from shipcosim.cli.console import (
    make_console,
    print_overview,
    print_problems,
    print_summary,
    progress_of,
)
from shipcosim.cli.outcomes.exits import INTERRUPTED, Conclusion
from shipcosim.cosim import Interrupted
from shipcosim.errors import ShipcosimError
from shipcosim.native import is_installed
from shipcosim.results.run import VERDICT
from shipcosim.staging import set_aside

SLOW = 10.0
"""Seconds of a run above which it is worth to say that there is a faster way."""
FASTER = "Compiled models run faster: pip install 'shipcosim[native]'."

if TYPE_CHECKING:
    from shipcosim.calls.runs import PreparedRun
    from shipcosim.results.run import Run


def concluded(prepared: PreparedRun, out: Path, force: bool = False) -> Conclusion:
    """Run, write the results, and how it went; parameters and errors as for `run_with_progress`."""
    result = run_with_progress(prepared, out, force)
    return Conclusion(result.name, result, lambda: print_run(result, out), out)


def prepare_folder(
    files: Mapping[str, Path], options: Mapping[str, Any]
) -> tuple[dict[str, PreparedRun], dict[str, ShipcosimError]]:
    """Read and check scenarios, all before the first one runs; those that can run, and why others cannot.

    Parameters
    ----------
    files : mapping of str to Path
        By the names of the scenarios in their folder.
    options : mapping of str to object
        Keywords of `shipcosim.calls.runs.prepare_run`.

    Raises
    ------
    ShipcosimError
        With the problems of all scenarios, if none can run.
    """
    from shipcosim.calls.runs import prepare_run

    prepared = {}
    refused = {}
    for name, file in files.items():
        try:
            prepared[name] = prepare_run(file, **options)
        except ShipcosimError as error:
            # A name that is no text has "?" for what is none.
            refused[name.encode(errors="replace").decode()] = error
    if not prepared:
        raise ShipcosimError([problem for error in refused.values() for problem in error.problems])
    return prepared, refused


def run_folder(
    prepared: Mapping[str, PreparedRun],
    refused: Mapping[str, ShipcosimError],
    name: str,
    out: Path | None = None,
    force: bool = False,
) -> Conclusion:
    """Run scenarios one after another, each into a folder of its own, and write the table of all of them.

    Parameters
    ----------
    prepared : mapping of str to PreparedRun
        By the names of the scenarios in their folder.
    refused : mapping of str to ShipcosimError
        Why others of them cannot run; this is printed last, where it is seen.
    name : str
        Of the folder of the scenarios.
    out : Path, optional
        Gets the table; results/NAME without.
    force : bool
        Replace earlier results.
    """
    from shipcosim.results.scenario_runs import ScenarioRuns

    out = out or Path("results") / name
    set_aside(out, ["report.html", VERDICT, *{key.split("/")[0] for key in prepared}], force=force)
    runs = {}
    for key, planned in prepared.items():
        runs[key] = run_with_progress(planned, out / key, force)
        print_run(runs[key], out / key)
    finished = ScenarioRuns(name, runs, refused)
    finished.save(out)
    rows = [(row.name, row.digest.outcome) for row in finished.rows]

    def show() -> None:
        print_overview(finished.outcome, rows, out / "report.html")
        for error in refused.values():
            print_problems(error.problems)

    return Conclusion(name, finished, show, out)


def print_run(result: Run, out: Path) -> None:
    """Print the outcome of a run and the path of its page; errors of a failed run go to stderr."""
    page = out / result.as_json()["page"]
    print_summary(result, page, to_stderr=bool(result.errors))


def run_with_progress(prepared: PreparedRun, out: Path, force: bool = False) -> Run:
    """Run with a progress bar, and write the results.

    Parameters
    ----------
    prepared : PreparedRun
    out : Path
        Folder of the results; made if needed.
    force : bool
        Replace earlier results.

    Returns
    -------
    Run
        With `errors` where a component failed on the way, which is a finding and not unusable input.

    Raises
    ------
    typer.Exit
        If the run was interrupted.
    ShipcosimError
        If the input cannot be used, or the results cannot be written.
    """
    print_problems(prepared.remarks)
    label = prepared.scenario.name or prepared.system.name
    try:
        with progress_of(label, prepared.scenario.stop_time) as progress:
            shown = replace(prepared, options=replace(prepared.options, progress=progress))
            began = monotonic()
            result = shown.finish(out, force=force)
            is_slow = monotonic() - began > SLOW
    except Interrupted as stop:
        page = out / "result-partial.html"
        if stop.table.sizes["time"] and page.is_file():
            print_summary(prepared.part(stop), page, to_stderr=True)
        raise typer.Exit(INTERRUPTED) from None
    # Who waits and has no compiler may not know that there is a faster way.
    if is_slow and prepared.options.engine == "auto" and not is_installed():
        make_console(stderr=True).print(FASTER, markup=False)
    return result
