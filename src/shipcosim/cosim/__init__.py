"""Co-simulation: `simulate` runs a system through a scenario and returns the table of all signals."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from shipcosim.cosim.engine import Interrupted, RunError, run
from shipcosim.errors import ShipcosimError, suggestion
from shipcosim.scenario import Scenario, check_scenario
from shipcosim.ssp import System, read_system, with_values

if TYPE_CHECKING:
    import xarray

__all__ = ["ENGINES", "Interrupted", "RunError", "simulate"]

ENGINES = {"fmpy": run}
"""Functions from a checked system and a scenario to a table."""
FUTURE_ENGINES = ("libcosim", "ecos")


def simulate(
    system: System | str | os.PathLike,
    scenario: Scenario,
    *,
    engine: str = "fmpy",
    inputs: xarray.Dataset | None = None,
    progress: Callable[[int, int], None] | None = None,
    order: str = "jacobi",
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
        its rows: ``"held"``, the default, or ``"linear"``.
    progress : callable, optional
        Called with (steps done, steps in all) some ten times a second.
    order : str
        ``"jacobi"``: every component steps with what the others had put out at the start of the step, as in libcosim.
        ``"gauss-seidel"``: with what those before it have just put out.

    Returns
    -------
    Dataset
        One row per output interval from 0 to the stop time: outputs of all components, inputs that nothing feeds or an
        event changes, inputs and outputs of the system. Its attributes say what is needed to repeat the run.

    Raises
    ------
    ShipcosimError
        If system and scenario do not fit together. As RunError, with the rows so far, if the run fails on its way.
    Interrupted
        On Ctrl-C, with the rows so far.
    """
    if engine not in ENGINES:
        if engine in FUTURE_ENGINES:
            raise ShipcosimError(f"The engine '{engine}' is not there yet. Use: {', '.join(ENGINES)}.")
        raise ShipcosimError(f"There is no engine '{engine}'. {suggestion(engine, ENGINES)}")
    if not isinstance(system, System):
        system = read_system(system, scenario.parameter_paths, fmus=[scenario.project / "build" / "fmus"])
    system = with_values(system, scenario.set, str(scenario.path or "scenario"))
    if errors := [problem for problem in check_scenario(scenario, system) if problem.severity == "error"]:
        raise ShipcosimError(errors)
    return ENGINES[engine](system, scenario, inputs=inputs, progress=progress, order=order)
