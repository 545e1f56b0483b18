"""Repeat a run from the facts in its table."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cosim.master.inputs import digest
from shipcosim.cosim.master.result import fingerprint, hashes
from shipcosim.cosim.master.run import run
from shipcosim.errors import Problem, error_at, raise_errors
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.series import read_table
from shipcosim.ssp import System, read_system, with_values

if TYPE_CHECKING:
    import xarray


def repeat(
    table: xarray.Dataset | str | os.PathLike,
    system: System | str | os.PathLike | None = None,
    *,
    inputs: xarray.Dataset | None = None,
    fmus: tuple = (),
) -> xarray.Dataset:
    """Repeat a run of our engine: every start value, event and time comes from the attributes of its table.

    On the machine of the first run the table is the same, to the last digit.

    Parameters
    ----------
    table : Dataset or path
        Result of `simulate`.
    system : System or path, optional
        That ran, with any start values; where it is not given, the folder of its name in ssp/.
    inputs : Dataset, optional
        The table that fed the system's inputs.
    fmus : tuple of path
        Folders searched for FMUs that are not beside the SSD; build/fmus where it is not given.

    Raises
    ------
    ShipcosimError
        If system, FMUs or inputs are others than those of the run, or it was continued from a snapshot.
    """
    facts = read_table(table).attrs if isinstance(table, str | os.PathLike) else table.attrs
    if "system_sha256" not in facts:
        raise error_at("repeat", "The table does not say how it came about.", "Give a result.nc.")
    # Read the system again, with the FMUs that were swapped in the run.
    if not isinstance(system, System):
        folders = [Path(folder) for folder in fmus or [Path("build") / "fmus"]]
        # The first folder that has a file; its name alone if none has.
        swapped = {
            name: next((f / file for f in folders if (f / file).is_file()), Path(file))
            for name, file in json.loads(facts.get("swapped", "{}")).items()
        }
        system = read_system(
            system or Path("ssp") / facts["system"], fmus=folders, components=swapped
        )
    # Everything must be the same: wiring, FMUs and inputs. Start values are set below.
    raise_errors(_differences(facts, system, inputs))
    # The table holds all start values, so the system's own do not matter.
    starts = {
        name: value
        for name, value in json.loads(facts["start_values"]).items()
        if value is not None
    }
    about = {
        key: facts[key] for key in ("description", "stop_time", "step_size", "output_interval")
    }
    # NetCDF gives numbers of NumPy's types.
    plain = {key: value if isinstance(value, str) else float(value) for key, value in about.items()}
    scenario = Scenario.model_validate(plain | {"events": json.loads(facts["events"])})
    start_time = float(facts["start_time"])
    until = facts.get("until")
    engine = str(facts["engine"])
    order = str(facts["order"])
    options = RunOptions(
        engine=engine, inputs=inputs, order=order, start_time=start_time, until=until
    )
    again = run(with_values(system, starts, "repeat"), scenario, options)
    # What the run was called, changed and did not reach is no part of the scenario that is made here.
    about_run = ("scenario", "changed", "not_reached", "judged_on", "remarks")
    return again.assign_attrs({name: facts[name] for name in about_run if name in facts})


def _differences(facts, system, inputs):
    if "continued_from" in facts:
        yield Problem(
            "repeat", f"The run was continued from a snapshot at {facts['continued_from']:g} s."
        )
    # Compare by fingerprints: wiring, then the content of each FMU, then the input table.
    if fingerprint(system) != facts["system_sha256"]:
        yield Problem("repeat", f"{system.name} is not wired as {facts['system']} was in the run.")
    wanted = json.loads(facts["fmus"])
    present = hashes(system)
    for name in sorted(wanted.keys() & present.keys()):
        if wanted[name]["sha256"] != present[name]:
            yield Problem(
                "repeat",
                f"{name}: {wanted[name]['file']} is another FMU than in the run.",
                "Build that one.",
            )
    fed = facts.get("inputs_sha256")
    if fed != (None if inputs is None else digest(inputs)):
        yield Problem(
            "repeat",
            "inputs: The table is not the one that fed the run."
            if fed
            else "inputs: The run had no table.",
        )
