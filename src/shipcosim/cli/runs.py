"""A run on the terminal: its remarks, its progress, how it went."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from shipcosim.cli.console import print_problems, print_summary, progress_of
from shipcosim.cli.exits import FAILED, INTERRUPTED
from shipcosim.cosim import Interrupted, RunError

if TYPE_CHECKING:
    from shipcosim.calls.runs import PreparedRun
    from shipcosim.results.run import Run


def run_and_print(prepared: PreparedRun, out: Path, force: bool = False) -> Run:
    """Run, write the results, and say how it went.

    Parameters
    ----------
    prepared : PreparedRun
    out : Path
        Folder of the results; made if needed.
    force : bool
        Replace earlier results.

    Raises
    ------
    typer.Exit
        If a component fails on the way, which is a finding and not unusable input; if the run was interrupted.
    ShipcosimError
        If the input cannot be used or the results cannot be written.
    """
    print_problems(prepared.remarks)
    label = prepared.scenario.name or prepared.system.name
    try:
        with progress_of(label, prepared.scenario.stop_time) as progress:
            shown = replace(prepared, options=replace(prepared.options, progress=progress))
            result = shown.run(out, force=force)
    except Interrupted as stop:
        _print_part(prepared, stop, out)
        raise typer.Exit(INTERRUPTED) from None
    except RunError as error:
        _print_part(prepared, error, out)
        has_started = prepared.options.isolate or error.table.sizes["time"]
        if not has_started:
            raise
        print_problems(error.problems)
        raise typer.Exit(FAILED) from None
    print_summary(result, out / "report.html")
    return result


def _print_part(prepared: PreparedRun, stop: Interrupted | RunError, out: Path) -> None:
    """Say what there is of a run that did not get to its end, unless it did not even start."""
    page = out / "result-partial.html"
    if stop.table.sizes["time"] and page.is_file():
        print_summary(prepared.part(stop.table), page, to_stderr=True)


def exit_if_failed(result: Run) -> None:
    """End with exit code 1 where an expectation does not hold."""
    if not result.passed:
        raise typer.Exit(FAILED)
