"""Co-simulation: `simulate` runs a system through a scenario and returns the table of all signals."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cosim.engines import ecos, libcosim
from shipcosim.cosim.export.fmu import export_fmu
from shipcosim.cosim.master.inputs import interpolated
from shipcosim.cosim.master.run import Interrupted, RunError, run
from shipcosim.cosim.master.snapshot import Snapshot, read_snapshot, write_snapshot
from shipcosim.cosim.repeat import repeat
from shipcosim.cosim.replay import replay
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import Scenario, check_scenario
from shipcosim.ssp import System, read_system, with_values

if TYPE_CHECKING:
    import xarray

__all__ = [
    "ENGINES",
    "Interrupted",
    "RunError",
    "Snapshot",
    "engines_missing",
    "export_fmu",
    "interpolated",
    "read_snapshot",
    "repeat",
    "replay",
    "simulate",
    "write_snapshot",
]

ENGINES = {"fmpy": run, "libcosim": libcosim.run, "ecos": ecos.run}
"""Functions from a checked system and a scenario to a table."""


TIMEOUT = 60.0
"""How long a component in its own process may take for an answer, if nothing else is said. [s]"""


def engines_missing() -> dict[str, Problem]:
    """Engines that are not installed, with what to install."""
    missing = {}
    for name, module in {"libcosim": libcosim, "ecos": ecos}.items():
        try:
            module.check_installed()
        except ShipcosimError as error:
            missing[name] = error.problems[0]
    return missing


def simulate(
    system: System | str | os.PathLike,
    scenario: Scenario,
    *,
    engine: str = "fmpy",
    inputs: xarray.Dataset | None = None,
    progress: Callable[[int, int], None] | None = None,
    order: str = "jacobi",
    start_time: float = 0.0,
    until: float | None = None,
    resume: Snapshot | str | os.PathLike | None = None,
    store: Callable[[Snapshot], None] | str | os.PathLike | None = None,
    isolate: bool = False,
    timeout: float = TIMEOUT,
) -> xarray.Dataset:
    """Run a system through a scenario.

    Parameters
    ----------
    system : System or path
        What runs; a path is read with the scenario's parameter sets.
    scenario : Scenario
        Steps, start values, events.
    engine : str
        A key of ENGINES.
    inputs : Dataset, optional
        Feeds inputs of the system, by their names. A variable's attribute ``interpolation`` says what it does between
        its rows: ``"held"``, the default, or ``"linear"``, angles the shorter way round. The table's attribute
        ``max_gap`` is the longest time between two rows that is not taken for lost data. [s]
    progress : callable, optional
        Called with (steps done, steps in all) some ten times a second.
    order : str
        ``"jacobi"``: every component steps with what the others had put out at the start of the step, as in libcosim.
        ``"gauss-seidel"``: with what those before it have just put out.
    start_time : float
        Time at the start, which the FMUs are told and the scenario's times are on. [s]
    until : float, optional
        Where the run ends, if not at the scenario's stop time. [s]
    resume : Snapshot or path, optional
        Where the run continues from: the scenario may have other events and another stop time from there on, and what
        was overridden then stays so. What happens before that time in the scenario is not done again.
    store : callable or path, optional
        Gets the state of the whole system at the end of the run.
    isolate : bool
        Each component runs in a process of its own: one that crashes or hangs ends the run like one that fails.
    timeout : float
        How long a component in its own process may take for an answer. [s]

    Returns
    -------
    Dataset
        One row per output interval from the start or the snapshot to the end: outputs of all components, inputs that
        nothing feeds or an event changes, inputs and outputs of the system. Its attributes say what is needed to
        repeat the run.

    Raises
    ------
    ShipcosimError
        If system and scenario do not fit together. As RunError, with the rows so far, if the run fails on its way.
    Interrupted
        On Ctrl-C, with the rows so far.
    """
    if engine not in ENGINES:
        raise ShipcosimError(f"There is no engine '{engine}'. {suggestion(engine, ENGINES)}")
    if not isinstance(system, System):
        system = read_system(system, scenario.parameter_paths, fmus=[scenario.project / "build" / "fmus"])
    system = with_values(system, scenario.set, str(scenario.path or "scenario"))
    if errors := [problem for problem in check_scenario(scenario, system) if problem.severity == "error"]:
        raise ShipcosimError(errors)
    course = _course(start_time, until, resume, store, _limit(timeout) if isolate else None)
    if course and engine != "fmpy":
        remedy = "The engine 'fmpy' does."
        raise ShipcosimError(Problem(f"engine '{engine}'", f"It does not know {', '.join(course)}.", remedy))
    return ENGINES[engine](system, scenario, inputs=inputs, progress=progress, order=order, **course)


def _limit(timeout):
    if not 0.0 < timeout < float("inf"):
        raise ShipcosimError(Problem("timeout", f"{timeout:g} s is no time limit.", "Give a positive number."))
    return timeout


def _course(start_time, until, resume, store, isolate):
    """What differs from a whole run from time 0 on, as the engine's arguments; files are read and written."""
    if resume is not None and not isinstance(resume, Snapshot):
        resume = read_snapshot(resume)
    if store is not None and not callable(store):
        if not Path(store).absolute().parent.is_dir():
            found = "There is no such folder to store the state in."
            raise ShipcosimError(Problem(str(store), found, "Make it first."))
        store = partial(write_snapshot, path=store)
    course = {"start_time": start_time or None, "until": until, "resume": resume, "store": store, "isolate": isolate}
    return {name: value for name, value in course.items() if value is not None}
