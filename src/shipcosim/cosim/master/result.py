"""The table of a run, and the facts needed to repeat it."""

import hashlib
import json
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from shipcosim import __version__
from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.scenario import Scenario
from shipcosim.ssp import System
from shipcosim.ssp.read.structure import End

Column = tuple[str, np.ndarray, str, str]
"""Name, (n,) values, unit and long name of a signal."""


def recorded_rows(plan: Plan, kind: str) -> tuple[list[int], list[int]]:
    """External values and inputs of a kind that the table shows.

    They are the inputs of the system, and the components' inputs that no output determines.
    """
    layout = plan.layouts[kind]
    # Connected inputs equal their source and would only repeat it.
    external = [i for i, end in enumerate(layout.external) if end[0] is None]
    inputs = [
        i
        for i, end in enumerate(layout.inputs)
        if end not in plan.connected or end in plan.modified
    ]
    return external, inputs


def recorded_ends(plan: Plan, kind: str) -> list[End]:
    """Ends that a recorded row of a kind has: outputs, external values, inputs."""
    layout = plan.layouts[kind]
    external, inputs = recorded_rows(plan, kind)
    names = list(layout.external)
    return [*layout.outputs, *(names[i] for i in external), *(layout.inputs[i] for i in inputs)]


def columns_of(
    plan: Plan, n_rows: int, recorded: Mapping[str, Sequence[np.ndarray]]
) -> list[Column]:
    """Columns of the table of a run.

    Parameters
    ----------
    plan : Plan
        Of the run.
    n_rows : int
        Rows of the table.
    recorded : dict of str to list of (n_rows,) array
        By kind: outputs, external values and inputs as the recorder has them.

    Returns
    -------
    list of Column
    """
    values = {}
    for kind, arrays in recorded.items():
        columns = (a.astype(bool) if kind == "Boolean" else a for a in arrays)
        values |= zip(recorded_ends(plan, kind), columns, strict=True)
    return [*_connectors(plan, values), *_variables(plan, values, n_rows)]


def _connectors(plan, values):
    """Columns of the outermost system's inputs and outputs."""
    for name, signal in plan.system.inputs.items():
        if (None, name) in values:
            yield name, values[None, name], signal.unit or "", signal.description
    # An output of the system shows its source, through mapping and transformation.
    for connection in plan.system.connections:
        if connection.target[0] is None and (source := values.get(connection.source)) is not None:
            signal = plan.system.outputs.get(connection.target[1])
            if signal is not None:
                yield (
                    signal.name,
                    _passed_on(source, connection),
                    signal.unit or "",
                    signal.description,
                )


def _passed_on(values, connection):
    if connection.mapping is not None:
        values = np.array(
            [connection.mapping.get(v, v) for v in values.tolist()], dtype=values.dtype
        )
    if connection.is_linear:
        values = connection.factor * values + connection.offset
    return values


def _variables(plan, values, n):
    """Columns of the components' outputs and external values, in the order of system and FMUs."""
    for component, variable in plan.system.all_variables():
        end = (component.name, variable.name)
        kind = plan.kind(variable)
        column = values.get(end)
        # An input that nothing feeds is constant: its start value.
        if column is None and kind and variable.causality == "input" and end not in plan.connected:
            start = component.start_value(variable.name) or 0
            column = np.full(n, start, dtype=bool if kind == "Boolean" else BUFFER_TYPES[kind])
        if column is not None and variable.causality in ("input", "output", "parameter"):
            yield label(end), column, variable.unit or "", variable.description


def start_values(system: System) -> dict:
    """Start values of all parameters, and of everything else that the system sets, by signal."""
    return {
        label((component.name, variable.name)): component.start_value(variable.name)
        for component, variable in system.all_variables()
        if variable.causality == "parameter" or variable.name in component.start
    }


def hashes(system: System) -> dict[str, str]:
    """SHA-256 of each component's FMU file."""
    # Components may share a file, so each file is read once.
    paths = {component.fmu.path for component in system.components.values()}
    digests = {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}
    return {component.name: digests[component.fmu.path] for component in system.components.values()}


def attributes_of(system: System, scenario: Scenario) -> dict:
    """Facts needed to repeat a run, as texts and numbers."""
    # NetCDF attributes are texts and numbers, so structures are stored as JSON.
    starts = start_values(system)
    starts |= {
        name: signal.start for name, signal in system.inputs.items() if signal.start is not None
    }
    digests = hashes(system)
    fmus = {
        c.name: {"file": c.fmu.path.name, "sha256": digests[c.name]}
        for c in system.components.values()
    }
    return {
        "scenario": scenario.name,
        "description": scenario.description,
        "system": system.name,
        "system_sha256": fingerprint(system),
        "step_size": scenario.step_size,
        "stop_time": scenario.stop_time,
        "output_interval": scenario.output_interval or scenario.step_size,
        "shipcosim_version": __version__,
        "fmpy_version": version("fmpy"),
        "numpy_version": version("numpy"),
        "python_version": platform.python_version(),
        "start_values": json.dumps(starts, default=str),
        "seeds": json.dumps(
            {name: value for name, value in starts.items() if name.endswith("seed")}
        ),
        "events": json.dumps([event.model_dump() for event in scenario.events]),
        "fmus": json.dumps(fmus),
        "swapped": json.dumps({name: Path(file).name for name, file in system.swapped.items()}),
    }


def fingerprint(system: System) -> str:
    """SHA-256 of a system's wiring: components, connections, connectors; without start values."""
    wiring = {
        "components": [
            (c.name, c.step_size, *_interface_asked_for(c)) for c in system.components.values()
        ],
        "connections": [
            (c.source, c.target, c.factor, c.offset, list((c.mapping or {}).items()), c.initial)
            for c in system.connections
        ],
        "inputs": [(s.name, s.type, s.unit) for s in system.inputs.values()],
        "outputs": [(s.name, s.type, s.unit) for s in system.outputs.values()],
    }
    return hashlib.sha256(json.dumps(wiring, default=str).encode()).hexdigest()


def _interface_asked_for(component):
    return () if component.implementation == "any" else (component.implementation,)
