"""A run from the command line: simulated, judged, written to its folder, and summed up on the terminal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from shipcosim.cli.console import print_problems, print_summary, progress_of
from shipcosim.cli.exits import FAILED, INTERRUPTED
from shipcosim.cli.results import check_targets, save
from shipcosim.cosim import Interrupted, RunError, RunOptions, Snapshot, simulate, write_snapshot
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario, Verdict, check_scenario, judge, units_of, with_numbers, within_run
from shipcosim.ssp import System, with_values
from shipcosim.staging import set_file_aside

if TYPE_CHECKING:
    import xarray


def simulate_and_save(
    system: System,
    scenario: Scenario,
    out: Path,
    options: RunOptions,
    store: Path | None = None,
    changed: Sequence[str] = (),
) -> None:
    """Run, judge, write, and say how it went; arguments and errors as for `simulated_and_saved`.

    Raises
    ------
    typer.Exit
        If an expectation does not hold, too.
    """
    _, verdicts = simulated_and_saved(system, scenario, out, options, store, changed)
    if not all(verdict.passed for verdict in verdicts):
        raise typer.Exit(FAILED)


def simulated_and_saved(
    system: System,
    scenario: Scenario,
    out: Path,
    options: RunOptions,
    store: Path | None = None,
    changed: Sequence[str] = (),
) -> tuple[xarray.Dataset, list[Verdict]]:
    """Run, judge, write, and say how it went.

    Parameters
    ----------
    system : System
        What runs.
    scenario : Scenario
        What happens, and what must hold.
    out : Path
        Folder of the results; made if needed.
    options : RunOptions
        How it is run; the progress is shown here.
    store : Path, optional
        File for the state of the whole system at the end.
    changed : sequence of str
        What the command line changes, for the page.

    Returns
    -------
    xarray.Dataset
        The run.
    list of Verdict
        On what was expected of it.

    Raises
    ------
    typer.Exit
        If a component fails in its own process, which is a finding and not unusable input; if the run was interrupted.
    ShipcosimError
        If the input cannot be used or the results cannot be written.
    """
    from shipcosim.report.run.expectations import claims

    check_targets(out, store)
    print_problems(problem for problem in system.remarks if problem.where not in system.components)
    problems = check_scenario(scenario, with_values(system, scenario.set, str(scenario.path or "scenario")))
    if errors := [problem for problem in problems if problem.severity == "error"]:
        raise ShipcosimError(errors)
    print_problems(problems)
    snapshots: list[Snapshot] = []
    if store:
        options = replace(options, store=snapshots.append)
    table = _simulated(system, scenario, out, options, changed)
    reached, late = within_run(scenario, table)
    beyond = with_numbers(scenario.model_copy(update={"expect": late}), units_of(system)).expect
    scenario = scenario.model_copy(update={"expect": reached})
    table = table.assign_attrs(not_reached=json.dumps(claims(beyond, table)))
    verdicts = judge(table, with_numbers(scenario, units_of(system)))
    page = save(table, out, "result", scenario=scenario, verdicts=verdicts, system=system)
    print_summary(table, verdicts, page)
    if store:
        for snapshot in snapshots:
            set_file_aside(store)
            write_snapshot(snapshot, store)
    return table, verdicts


def _simulated(
    system: System, scenario: Scenario, out: Path, options: RunOptions, changed: Sequence[str]
) -> xarray.Dataset:
    """Table of the run; what there is of a run that does not get to its end is saved."""
    try:
        with progress_of(scenario.name or system.name, scenario.stop_time) as progress:
            table = simulate(system, scenario, replace(options, progress=progress))
            return table.assign_attrs(changed=json.dumps(list(changed)))
    except Interrupted as stop:
        _save_partial(stop.table.assign_attrs(changed=json.dumps(list(changed))), out, scenario, system)
        raise typer.Exit(INTERRUPTED) from None
    except RunError as error:
        try:
            _save_partial(error.table.assign_attrs(changed=json.dumps(list(changed))), out, scenario, system)
        except ShipcosimError as another:
            error.problems += another.problems
        if not options.isolate:
            raise
        print_problems(error.problems)
        raise typer.Exit(FAILED) from None


def _save_partial(table: xarray.Dataset, out: Path, scenario: Scenario, system: System) -> None:
    """Save the rows of a run that did not get to its end, unless it did not even start."""
    if table.sizes["time"]:
        page = save(table, out, "result-partial", scenario=scenario, system=system)
        print_summary(table, (), page, to_stderr=True)
