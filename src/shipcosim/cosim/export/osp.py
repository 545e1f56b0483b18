"""A system and its events as files that libcosim runs by itself."""

import os
from pathlib import Path
from urllib.parse import quote

import numpy as np

from shipcosim.cosim.engines.adapter import Job
from shipcosim.cosim.engines.osp_job import event_of, structure_of, unsupported_by_libcosim
from shipcosim.cosim.master.events import SignalChange
from shipcosim.cosim.master.plan import KINDS
from shipcosim.cosim.systems import prepared
from shipcosim.errors import Problem, error_at, raise_errors
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.scenario.osp import scenario_text
from shipcosim.ssp import System
from shipcosim.ssp.xml.markup import free_name
from shipcosim.temporary import exchange, temporary_folder

STRUCTURE = "OspSystemStructure.xml"
SCENARIO = "scenario.json"
TYPES = ("Real", "Integer", "Boolean", "String")
"""Types of initial values that OSP has."""


def osp_files(
    system: System, scenario: Scenario, *, has_end: bool = True
) -> tuple[dict[str, bytes], list[Problem]]:
    """Files of a system in libcosim's form, and what they cannot express.

    Nested systems are flat in them, unit conversions and linear transformations are functions, start values initial
    values, and events on inputs of the system events on what these feed.

    Parameters
    ----------
    system : System
        As read.
    scenario : Scenario
        Its steps, start values and events.
    has_end : bool
        Whether the structure states the scenario's end.

    Returns
    -------
    files : dict of str to bytes
        By name; all belong into one folder. There is a scenario only where something happens.
    remarks : list of Problem
        What gets lost.

    Raises
    ------
    ShipcosimError
        With everything that OSP cannot express.
    """
    # Apply the scenario's values first: the files hold one system with numbers.
    system, scenario = prepared(system, scenario)
    job = Job(system, scenario, RunOptions())
    problems = [*unsupported_by_libcosim(job), *_values_problems(job)]
    raise_errors(problems)
    # FMUs get plain names in the folder, and the structure refers to them by these.
    names = _file_names(system)
    sources = {
        name: quote(names[component.fmu.path]) for name, component in system.components.items()
    }
    values = {name: _initial_values(job, name) for name in system.components}
    structure = structure_of(job, sources, values, end_time=scenario.stop_time if has_end else None)
    files = {STRUCTURE: structure.encode()}
    # A scenario file exists only if there are events. Its end lies beyond the run, so that nothing
    # is taken back.
    if events := osp_events(job):
        end = 2.0 * job.times[-1]  # all changes would be taken back at this time
        files[SCENARIO] = scenario_text(scenario.description, events, float(end)).encode()
    files |= {name: path.read_bytes() for path, name in names.items()}
    return files, list(_remarks(system, scenario))


def osp_events(job: Job) -> list[dict[str, object]]:
    """Events of OSP with the same effect as a job's events, in order of time.

    What nothing feeds is set to the value that it has from then on: libcosim knows no inputs of the system.
    """
    events = list(job.changes)
    # libcosim has no inputs of the system: each change of an external value becomes an override of
    # the inputs that it feeds.
    for end, external in job.external.items():
        # The value before each step, so that only changes become events; the first compares with
        # the start value.
        before = np.concatenate([[external.start], external.values[:-2]])
        for step in np.flatnonzero(external.values[:-1] != before).tolist():
            events.append(SignalChange(step, "override", end, external.values[step].item()))
    return [event_of(job, change) for change in sorted(events, key=lambda change: change.step)]


def _initial_values(job, name):
    variables = job.system.components[name].variables
    starts = {
        variable: (variables[variable].kind, value) for variable, value in job.starts(name).items()
    }
    types = {"Real": float, "Boolean": bool}
    return {
        v: (kind, types.get(kind, int)(value) if kind in KINDS else value)
        for v, (kind, value) in starts.items()
    }


def _values_problems(job):
    for name, component in job.system.components.items():
        for variable in component.start:
            kind = component.variables[variable].kind
            if kind not in TYPES:
                yield Problem(
                    f"{name}.{variable}",
                    f"is set and is {kind}; OSP has no initial value of this type.",
                )


def _file_names(system):
    """File names of the FMUs by their paths, each unique."""
    names = {}
    for component in system.components.values():
        path = component.fmu.path
        if path not in names:
            names[path] = (
                free_name(path.stem, {name.removesuffix(".fmu") for name in names.values()})
                + ".fmu"
            )
    return names


def _remarks(system, scenario):
    """Remarks on what the files cannot express."""
    # Connectors of the system disappear; their effect is kept by events and variables.
    lost = {
        "inputs of the system": (system.inputs, "What they feed is set instead."),
        "outputs of the system": (system.outputs, "Look at the variables that they show."),
    }
    for what, (signals, remedy) in lost.items():
        if signals:
            message = f"OSP has no {what}: {', '.join(signals)} have no name there."
            yield Problem(system.name, message, remedy, "remark")
    # libcosim reads texts in the machine's own encoding.
    for name, component in system.components.items():
        for variable, value in component.start.items():
            if isinstance(value, str) and not value.isascii():
                message = "is a text beyond ASCII, which libcosim reads in the encoding of the machine that it runs on."
                yield Problem(
                    f"{name}.{variable}", message, "Run it where that is UTF-8.", "remark"
                )
    if scenario.order != "jacobi":
        message = f"OSP has no order of stepping: {scenario.order} stays behind, and libcosim steps as jacobi."
        yield Problem(scenario.name or "scenario", message, severity="remark")
    if scenario.expect:
        message = f"OSP has no expectations: {len(scenario.expect)} stay behind."
        yield Problem(scenario.name or "scenario", message, severity="remark")


def write_osp(
    system: System,
    scenario: Scenario,
    folder: str | os.PathLike,
    *,
    has_end: bool = True,
    force: bool = True,
) -> list[Problem]:
    """Write the files of `osp_files` into a folder; complete or not at all. Arguments as there.

    Without `force` an earlier export, with all FMUs, moves into a numbered folder beside it.

    Returns
    -------
    list of Problem
        What gets lost.
    """
    files, remarks = osp_files(system, scenario, has_end=has_end)
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # Write all files beside their places, then move them: an error leaves the old export intact.
        with temporary_folder(folder, unfinished=True) as stage:
            new = Path(stage, "new")
            new.mkdir()
            for name, data in files.items():
                (new / name).write_bytes(data)
            # A scenario of an earlier export would act on this system too.
            earlier = [] if force else [STRUCTURE, *(file.name for file in folder.glob("*.fmu"))]
            exchange(Path(stage), folder, [SCENARIO, *earlier], keep=not force)
    except OSError as error:
        raise error_at(str(folder), f"Cannot be written: {error.strerror}.") from None
    return remarks
