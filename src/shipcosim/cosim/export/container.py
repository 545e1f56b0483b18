"""A whole system as one FMU: FMPy's container FMU, a native library that steps FMUs which lie in its resources.

What the library does (FMPy 0.3.32, ``native/container-fmu``): start values are set when it is instantiated; leaving the
initialisation mode passes all connections on once, in the order of its configuration; a step steps all components from
the same time and then passes all connections on once, in that order. Values are copied as they are. Nothing else is
done to them, so that what a system needs beyond this is refused here.
"""

import hashlib
import json
import re
import zipfile
from pathlib import Path

from shipcosim.cosim.export.container_description import BINARY, container_description
from shipcosim.cosim.export.container_variables import (
    ContainerVariable,
    exposed_variables,
    library_type,
)
from shipcosim.cosim.master.order import sources_first
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.errors import Problem, raise_errors
from shipcosim.ssp import System
from shipcosim.ssp.xml.archive import write_archive
from shipcosim.ssp.xml.values import text_of

VERSION = "0.1.0"
"""Version of the library's configuration."""

PLATFORMS = ("linux64", "win64", "darwin64")
"""Folders in an FMU of FMI 2.0, one a platform."""

LIBRARIES = Path(__file__).parent / "vendor" / "container_fmu.zip"
"""Libraries of FMPy 0.3.32, a folder for each platform; it lies here since FMPy 0.3.25 lacks it, see LICENSES.txt
beside it."""


def write_container(
    system: System, path: Path, step_size: float, *, connectors_only: bool = False, sweeps: int = 1
) -> list[Problem]:
    """Write a system as one FMU of FMI 2.0 co-simulation.

    Parameters
    ----------
    system, path, step_size, connectors_only
        As for `export_fmu`.
    sweeps : int
        How often the connections are passed on, at the start and after each step.

    Returns
    -------
    list of Problem
        Remarks on what the FMU does not show.

    Raises
    ------
    ShipcosimError
        With everything that the container cannot express.
    """
    # Find all problems before anything is written.
    problems = [*_problems(system, step_size), *module_clashes(system)]
    exposed = exposed_variables(system, connectors_only, problems)
    raise_errors(problems)
    # Each FMU file goes into the resources once, however many components use it.
    paths = _paths(system)
    files = {f"resources/{paths[fmu]}/{name}": data for fmu in paths for name, data in _files(fmu)}
    files |= {f"binaries/{name}": data for name, data in _files(LIBRARIES)}
    configuration = _configuration(system, exposed, paths, step_size, sweeps)
    # The token identifies the content: any change of files or wiring gives another one.
    token = _token(configuration, files)
    description = container_description(system, exposed, token, step_size)
    files["modelDescription.xml"] = description
    files["resources/container.json"] = json.dumps(
        {"instantiationToken": token, **configuration}, indent=1
    ).encode()
    write_archive(path, files)
    return problems


def _problems(system, step_size):
    """Problems that the container cannot express."""
    targets = set()
    for component in system.components.values():
        yield from _component_problems(component, step_size)
    yield from _repeated(system)
    # A second connection into one input would be a sum, so remember the inputs seen.
    for connection in system.connections:
        prefix = f"{connection.arrow}: " if connection.arrow not in connection.place else ""
        for fault in _connection_faults(connection, system, targets):
            yield Problem(
                connection.place, f"{prefix}{fault}", "The container FMU copies values as they are."
            )
        targets.add(connection.target)
    # A system parameter is set as it is; its value cannot be converted on the way.
    for connection in system.given:
        if (connection.factor, connection.offset, connection.mapping) != (1.0, 0.0, None):
            fault = f"{connection.arrow}: the parameter's value changes on its way (unit conversion or transformation)."
            yield Problem(
                connection.place or connection.arrow,
                fault,
                "Give the connector the unit of the FMU's parameter.",
            )


def _component_problems(component, step_size):
    fmu = component.fmu
    if fmu.fmi_version not in ("2.0", "3.0") or "CoSimulation" not in fmu.interfaces:
        message = f"{fmu.path.name} is no co-simulation FMU of FMI 2.0 or 3.0."
        yield Problem(component.name, message, "The container FMU steps no other FMUs.")
    elif component.implementation == "ModelExchange":
        yield Problem(
            component.name,
            "is asked for as model exchange.",
            "The container FMU does co-simulation alone.",
        )
    # Start values of array elements, binaries and clocks have no type in the library.
    for name in component.start:
        if library_type(fmu, name) is None:
            what = (
                "an element of an array"
                if fmu.variables[name].whole
                else f"of type {fmu.variables[name].type}"
            )
            message = f"{name} gets a start value and is {what}."
            yield Problem(component.name, message, "The container FMU cannot set it.")
    if component.step_size not in (None, step_size):
        message = (
            f"has a step of {component.step_size:g} s of its own; the exchange has {step_size:g} s."
        )
        yield Problem(component.name, message, "The container FMU steps all components alike.")


def _repeated(system):
    """Components that share an FMU which can be instantiated only once."""
    for component in system.components.values():
        # Components are compared by the FMU's file.
        others = [c.name for c in system.components.values() if c.fmu.path == component.fmu.path]
        if len(others) > 1 and component.fmu.capability("canBeInstantiatedOnlyOncePerProcess"):
            message = f"{component.fmu.path.name} can be instantiated only once in a process, but makes up"
            yield Problem(
                component.name,
                f"{message} {', '.join(others)}.",
                "Export it again without this limit.",
            )


def _connection_faults(connection, system, targets):
    """Sentences on what the container would do differently for a connection."""
    if connection.is_linear:
        yield (
            f"the value is multiplied by {connection.factor:g} and {connection.offset:g} added "
            "(unit conversion or linear transformation)."
        )
    if connection.mapping is not None:
        yield "values are replaced by others (mapping or enumerations with different numbers)."
    if connection.initial:
        yield "it goes into a parameter, once at the start."
    if connection.target in targets:
        yield "several connections are added up."
    if connection.source[0] is None and connection.target[0] is None:
        yield "an input of the system is its output, with no component between."
    # The library copies between variables of one type only.
    ends = [end for end in (connection.source, connection.target) if end[0] is not None]
    types = list(
        dict.fromkeys(
            library_type(system.components[name].fmu, variable) for name, variable in ends
        )
    )
    if None in types:
        yield "its type is an array, Binary or Clock."
    elif len(types) > 1:
        yield f"its ends are of different types, {' and '.join(map(str, types))}."


def _paths(system):
    """Resource folder of each FMU file, in plain letters that every FMU can read."""
    files = dict.fromkeys(component.fmu.path for component in system.components.values())
    return {
        file: f"{number:02}_{re.sub('[^A-Za-z0-9_]', '', file.stem)}"
        for number, file in enumerate(files)
    }


def _files(file):
    """Names and contents in an archive."""
    with zipfile.ZipFile(file) as archive:
        for entry in archive.infolist():
            if not entry.is_dir():
                yield entry.filename, archive.read(entry)


def _configuration(system, exposed, paths, step_size, sweeps):
    """The library's configuration, without the token."""
    # Components are addressed by number. The connections are repeated: once for each sweep that the
    # start needs.
    numbers = {name: number for number, name in enumerate(system.components)}
    return {
        "containerVersion": VERSION,
        "fixedStepSize": step_size,
        "parallelDoStep": False,
        "components": [_component(component, paths) for component in system.components.values()],
        "variables": [
            _variable(entry, system, numbers) for entry in [*exposed, *_hidden(system, exposed)]
        ],
        "connections": list(_connections(system, numbers)) * sweeps,
    }


def _component(component, paths):
    fmu = component.fmu
    return {
        "fmiMajorVersion": fmu.fmi_version[0],
        "name": component.name,
        "instantiationToken": fmu.token,
        "modelIdentifier": fmu.model_identifier,
        "path": paths[fmu.path],
    }


def _hidden(system, exposed):
    """Start values that the system sets on variables which the container does not show."""
    shown = {end for entry in exposed for end in entry.ends}
    for component in system.components.values():
        for name, value in component.start.items():
            if (component.name, name) not in shown:
                variable = component.variables[name]
                yield ContainerVariable(
                    "", "local", variable, ((component.name, name),), start=value
                )


def _variable(entry, system, numbers):
    name, variable = entry.ends[0]
    attributes = {
        "variableType": library_type(system.components[name].fmu, variable),
        "mappings": [
            {
                "component": numbers[name],
                "valueReference": system.components[name].variables[inner].value_reference,
            }
            for name, inner in entry.ends
        ],
    }
    return (
        attributes
        if entry.start is None or entry.causality == "output"
        else attributes | {"start": [text_of(entry.start)]}
    )


def _connections(system, numbers):
    """Connections between components, bundled by pair and type, sources first."""
    # The library copies values of one type between two components in one call.
    together = {}
    for connection in system.connections:
        (source, variable) = connection.source
        (target, _) = connection.target
        if source is not None and target is not None:
            kind = library_type(system.components[source].fmu, variable)
            together.setdefault((source, target, kind), []).append(connection)
    # In the order of the data flow one pass carries a value as far as possible.
    place = {name: position for position, name in enumerate(sources_first(system))}
    for source, target, kind in sorted(
        together, key=lambda key: (place[key[0]], place[key[1]], key[2])
    ):
        pairs = together[source, target, kind]
        yield {
            "variableType": kind,
            "srcComponent": numbers[source],
            "dstComponent": numbers[target],
            "srcValueReferences": [_reference(system, pair.source) for pair in pairs],
            "dstValueReferences": [_reference(system, pair.target) for pair in pairs],
            "size": len(pairs),
        }


def _reference(system, end):
    return system.components[end[0]].fmu.variables[end[1]].value_reference


def _token(configuration, files):
    """Token that is unique to the content."""
    # Sorted, so that the same content gives the same token. Contents enter by their own hash.
    content = hashlib.sha256(json.dumps([BINARY, configuration], sort_keys=True).encode())
    for name in sorted(files):
        content.update(name.encode() + hashlib.sha256(files[name]).digest())
    return f"{{{content.hexdigest()[:32]}}}"
