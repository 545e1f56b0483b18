"""What `import shipcosim` offers, in one place."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Unpack

from pydantic import ValidationError

from shipcosim.cosim import simulate as _simulate
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.options import RunKeywords, RunOptions
from shipcosim.scenario import Scenario, check_times, judge, read_scenario
from shipcosim.series import read_table, write_table
from shipcosim.ssp import System, SystemStructure, new, osp_file, parameter, read, read_system, write_ssv

if TYPE_CHECKING:
    import xarray

__all__ = [
    "Problem",
    "Scenario",
    "ShipcosimError",
    "System",
    "SystemStructure",
    "judge",
    "new",
    "parameter",
    "read",
    "read_scenario",
    "read_table",
    "simulate",
    "write_ssv",
    "write_table",
]


def simulate(
    system: SystemStructure | System | str | os.PathLike[str] | None = None,
    scenario: Scenario | str | os.PathLike[str] | None = None,
    *,
    stop_time: float | None = None,
    step_size: float | None = None,
    output_interval: float | None = None,
    set: Mapping[str, object] | None = None,
    events: Iterable[Mapping[str, object]] = (),
    start_time: float | None = None,
    **options: Unpack[RunKeywords],
) -> xarray.Dataset:
    """Run a system and return the table of all signals.

    Parameters
    ----------
    system : SystemStructure, System or path, optional
        What runs; the scenario's system if not given.
    scenario : Scenario or path, optional
        What happens; the keywords add to it and go before it.
    stop_time, step_size, output_interval : float, optional
        Where nobody says anything, the system's default experiment does, and every step is a row. [s]
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    events : iterable of mapping
        As in a scenario file: ``{"time": 10.0, "override": {"vessel.tau_X_5": 1e4}}``.
    start_time : float, optional
        As in `shipcosim.options.RunOptions`; where nobody says anything, the system's default experiment does. [s]
    engine, inputs, progress, order, until, resume, store, isolate, timeout
        As in `shipcosim.options.RunOptions`: `until` and `store` stop at a time and keep the state of the whole
        system, `resume` continues from there; `isolate` has each component run in a process of its own.

    Returns
    -------
    Dataset
        One row per output interval, `time` in s; variables are named ``component.connector``.

    Raises
    ------
    ShipcosimError
        If something does not fit together, or the run fails.
    """
    if scenario is not None and not isinstance(scenario, Scenario):
        scenario = read_scenario(scenario)
    system = _system(system, scenario)
    if start_time is None:
        continues = options.get("resume") is not None
        start_time = system.experiment.start_time if scenario is None and not continues else 0.0
    keys = {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    keys = {name: value for name, value in keys.items() if value is not None}
    scenario = _scenario(scenario, system.experiment, keys | {"set": set or {}, "events": list(events)})
    return _simulate(system, scenario, RunOptions(start_time=start_time, **options))


def _system(system, scenario):
    """The checked system that a user means, or the scenario's where none is given."""
    if system is None:
        system = scenario.system_path if scenario is not None else _missing("system", "Give a system or a scenario.")
    if isinstance(system, System):
        return system
    parameters = () if scenario is None else scenario.parameter_paths
    if not isinstance(system, SystemStructure) and osp_file(system):
        return read_system(system, parameters)
    structure = system if isinstance(system, SystemStructure) else read(system)
    return structure.checked(parameters)


def _scenario(given, experiment, keys):
    """Scenario of keys, over those of another one or over the system's default experiment; checked."""
    if given is None:
        default = {"stop_time": experiment.stop_time, "step_size": experiment.step_size}
        keys = {name: value for name, value in default.items() if value is not None} | keys
    else:
        had = given.model_dump(exclude_defaults=True)
        keys["set"] = had.get("set", {}) | keys["set"]
        keys["events"] = [*had.get("events", ()), *keys["events"]]
        keys = had | keys
    try:
        scenario = Scenario.model_validate(keys)
    except ValidationError as error:
        raise ShipcosimError([_problem(finding) for finding in error.errors()]) from None
    problems = [problem for problem in check_times(scenario) if problem.severity == "error"]
    if problems:
        raise ShipcosimError(problems)
    return scenario if given is None else given.model_copy(update={name: getattr(scenario, name) for name in keys})


def _missing(name, remedy):
    raise ShipcosimError(Problem("simulate", f"{name} is missing.", remedy))


def _problem(finding):
    """One of pydantic's findings in our words."""
    name = ".".join(map(str, finding["loc"]))
    if finding["type"] == "missing":
        return Problem("simulate", f"{name} is missing.", "Give it in s: the system has no default.")
    text = finding["msg"].removeprefix("Value error, ").removesuffix(".")
    return Problem("simulate", f"{name} = {finding['input']!r}.", f"{text}.")
