"""Run libcosim and ecos as their users do: each reads the file, in a process of its own.

As a script this is that process: it gets a job in JSON and leaves the values of all outputs.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.engines.adapter import EngineError
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.errors import AnyPath, error_at
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import System
from shipcosim.temporary import temporary_folder

if TYPE_CHECKING:
    import xarray

LIMIT = 600.0  # s
KINDS = ("Real", "Integer", "Boolean")


def readers(
    path: AnyPath, scenario: Scenario, *, set_name: str | None = None
) -> dict[str, Callable[[System], xarray.Dataset]]:
    """Functions that run a file in the tools that are installed and take it, by tool.

    Parameters
    ----------
    path : path
        An .ssp with its FMUs in it, or an OspSystemStructure.xml.
    scenario : Scenario
        Its steps; a tool that reads a file knows no events of ours.
    set_name : str, optional
        Of the parameter set that ecos applies.

    Returns
    -------
    dict of str to callable
        Each takes the system as we read it and returns a table of the outputs of its components.

    Raises
    ------
    ShipcosimError
        If something happens in the scenario.
    """
    # The tool reads the file alone, so nothing of our scenario reaches it.
    if scenario.events or scenario.set or scenario.components:
        message = "A tool that reads the file itself knows no events, start values or swapped FMUs of ours."
        raise error_at(scenario.name or "scenario", message, "Compare the system alone.")
    # ecos reads SSP files only.
    hosts = ["libcosim"] if Path(path).suffix == ".xml" else ["libcosim", "ecos"]
    return {host: partial(_run, host, str(path), scenario, set_name) for host in hosts}


def _run(host, path, scenario, set_name, system):
    # The outputs that a tool can return: numbers and flags of components.
    grid = time_grid_of(scenario)
    outputs = {
        f"{component.name}.{v.name}": (
            component.name,
            v.name,
            v.value_reference,
            v.kind,
            v.unit or "",
        )
        for component, v in system.all_variables()
        if v.causality == "output" and v.kind in KINDS
    }
    job = {
        "path": path,
        "step": scenario.step_size,
        "n": grid.last,
        "set": set_name,
        "ends": list(outputs.values()),
    }
    with temporary_folder() as folder:
        values = _values(host, job, Path(folder))
    # The tools return no start values, so the table begins after the first step.
    columns = [(name, values[:, i], end[-1], "") for i, (name, end) in enumerate(outputs.items())]
    return make_table(grid.times[1:], columns, {"engine": host})


def _values(host, job, folder):
    """(n, outputs) array of values after each step; the tool returns none for the start."""
    (folder / "job.json").write_text(json.dumps(job | {"host": host}))
    command = [sys.executable, "-m", __name__, str(folder)]
    # A process of its own: the tool may crash or hang without harm to this one.
    try:
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        raise error_at(host, f"does not end within {LIMIT:g} s.") from None
    # A message of the tool is a refusal; no file at all is a crash.
    if (folder / "refused.txt").exists():
        raise error_at(host, f"refuses the file. {(folder / 'refused.txt').read_text()}")
    if not (folder / "values.npy").exists():
        raise error_at(host, "crashes.")
    return np.load(folder / "values.npy")


# the process


def main(folder: str) -> None:
    """Run the job in a folder."""
    place = Path(folder)
    job = json.loads((place / "job.json").read_text())
    try:
        rows = list({"libcosim": _libcosim, "ecos": _ecos}[job["host"]](job))
    except (Exception, AssertionError) as error:
        (place / "refused.txt").write_text(
            str(error).splitlines()[0][:300] if str(error) else type(error).__name__
        )
        return
    # Rename when complete: a crash during the writing must not look like a result.
    np.save(place / "partial.npy", np.array(rows, dtype=float))
    (place / "partial.npy").rename(place / "values.npy")


def _libcosim(job):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.FATAL)
    # An OSP file has its own step size; for an SSP libcosim gets ours, in nanoseconds.
    if job["path"].endswith(".xml"):
        execution = CosimExecution.from_osp_config_file(job["path"])
    else:
        execution = CosimExecution.from_ssp_file(job["path"], round(job["step"] * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    calls = {kind: getattr(observer, f"last_{kind.lower()}_values") for kind in KINDS}
    ends = [
        (calls[kind], execution.slave_index_from_instance_name(n), r)
        for n, _, r, kind, _ in job["ends"]
    ]
    for _ in range(job["n"]):
        if not execution.step():
            raise EngineError("A step fails.")
        yield [call(slave, [reference])[0] for call, slave, reference in ends]


def _ecos(job):
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("off")
    simulation = EcosSimulation(ssp_path=job["path"], step_size=job["step"])
    if not simulation.init(parameter_set=job["set"]):
        raise EngineError(EcosLib.get_last_error())
    calls = {
        "Real": simulation.get_real,
        "Integer": simulation.get_integer,
        "Boolean": simulation.get_bool,
    }
    for _ in range(job["n"]):
        simulation.step()
        yield [calls[kind](f"{name}::{variable}") for name, variable, _, kind, _ in job["ends"]]


if __name__ == "__main__":
    main(sys.argv[1])
