"""From a row of a study to its run: simulated again with its page, by number or by a click on the page of the study."""

from __future__ import annotations

import json
from pathlib import Path

from shipcosim.cli.console import shown_path
from shipcosim.cli.runs import simulated_and_saved
from shipcosim.cli.studies.sweeping import write_page
from shipcosim.cosim import system_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.options import RunOptions
from shipcosim.staging import REPLACING
from shipcosim.sweep import Plan, Swept, run_study

__all__ = ["run_again", "serve"]


def run_again(plan: Plan, number: int, out: Path, engine: str, command: str) -> bool:
    """Simulate one run of a study with its page in a folder of its own; the page of the study, if there, leads to it.

    Parameters
    ----------
    plan : Plan
    number : int
        Of the run.
    out : Path
        Folder of the study's results; that of the run is ``run-N`` in it.
    engine : str
    command : str
        What makes the study, for its page.

    Returns
    -------
    bool
        Whether all that the scenario expects holds.

    Raises
    ------
    ShipcosimError
        If there is no such run, or it fails.
    """
    if not 0 <= number < len(plan):
        remedy = f"Runs are numbered from 0 to {len(plan) - 1}."
        raise ShipcosimError(Problem("--run", f"There is no run {number} in {plan.study.name}.", remedy))
    if plan.study.tune and _is_of(plan, out, engine):
        run_study(plan, out, engine=engine, at_most=0)  # what a search proposed follows from what is done
    token = REPLACING.set(True)  # what it replaces is the same run
    try:
        passed = _simulate(plan, number, out, engine)
    finally:
        REPLACING.reset(token)
    if _is_of(plan, out, engine):
        write_page(run_study(plan, out, engine=engine, at_most=0), command)
    return passed


def _simulate(plan: Plan, number: int, out: Path, engine: str) -> bool:
    """Simulate a run and write all that `shipcosim run` writes."""
    scenario = plan.alone(number)
    changed = [f"{name} {value}" for name, value in plan.run(number).columns.items()]
    said = [f"run {number} of the study {plan.study.name}", *changed]
    options = RunOptions(engine=engine)
    _, verdicts = simulated_and_saved(system_of(scenario), scenario, out / f"run-{number}", options, changed=said)
    return all(verdict.passed for verdict in verdicts)


def _is_of(plan: Plan, folder: Path, engine: str) -> bool:
    """Whether the results in a folder are those of this plan, and not of another one."""
    try:
        about = json.loads((folder / "study.json").read_text(encoding="utf-8"))
        return about["plan"] == plan.digest(engine) and (folder / "runs.parquet").is_file()
    except (OSError, ValueError, KeyError, TypeError):
        return False


def serve(swept: Swept, engine: str, port: int = 0) -> None:
    """Show the page of a study, where a click on a row simulates it, until Ctrl-C.

    Parameters
    ----------
    swept : Swept
    engine : str
    port : int
        0: one that is free.

    Raises
    ------
    ShipcosimError
        If the port cannot be used.
    """
    from rich.console import Console

    from shipcosim.report.study.server import study_server

    numbers = [int(number) for number in swept.runs["run"]]
    server = study_server(swept.folder, numbers, lambda run: _simulate(swept.plan, run, swept.folder, engine), port)
    text = f"{shown_path(swept.folder)} is shown at {server.url} on this machine; Ctrl-C ends it."
    Console(highlight=False, soft_wrap=True).print(text, markup=False)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
