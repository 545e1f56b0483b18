"""One FMU as a system: one component with the file's name; its inputs are system inputs."""

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from math import inf
from pathlib import Path
from urllib.parse import quote

import lxml.etree as etree

from shipcosim.errors import Problem
from shipcosim.ssp.flatten.assemble import assemble_package, parameter_sets
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.parameters import ParameterSet, ParameterSets
from shipcosim.ssp.xml.document import AnyPath, Document, Findings, qualified
from shipcosim.ssp.xml.markup import add
from shipcosim.ssp.xml.values import Value
from shipcosim.units import UnitError, seconds, steps_in, value_of, whole_steps

IN_TABLES = ("Real", "Integer", "Boolean", "Enumeration")
"""Kinds of inputs that a table can feed; the others keep their start value, which can be set."""

STEPS = 500
"""Steps of a run whose FMU does not say how long a step is, as other tools have it."""


def single_fmu(path: AnyPath) -> Path | None:
    """Path of an FMU that is used as a system, or None."""
    path = Path(path)
    return path if path.suffix.lower() == ".fmu" and path.is_file() else None


def assemble_fmu(
    path: Path,
    parameters: ParameterSets,
    fmus: Iterable[AnyPath],
    findings: Findings,
    swapped: Swapped = None,
) -> System | None:
    """System of one FMU, or None.

    Parameters
    ----------
    path : Path
        Of the FMU.
    parameters : path or ParameterSet, or iterable of them
        With names as in the FMU, alone or behind the component's: ``"tank.level"``.
    fmus : iterable of path
        Not needed.
    findings : Findings
        Takes what is wrong.
    swapped : mapping of str to Path, optional
        FMU that runs in place of this one, with its inputs.
    """
    # Build an SSD around the FMU in memory, and read it as any other.
    if not path.name.isprintable():
        findings.error(str(path), "Its file name has control characters.", "Rename the file.")
        return None
    described = Findings()
    fmu = describe_fmu(path, described)
    if fmu is None:
        findings.problems += described.problems
        return None
    root = _structure(path, fmu)
    package = Package(path.parent, str(path.parent), f"{path.stem}.ssd", tuple(map(Path, fmus)))
    package.held[(package.folder / package.ssd).resolve()] = Document(str(path), root, path.parent)
    sets = [
        _for_component(parameter_set, path.stem, fmu)
        for parameter_set in parameter_sets(parameters, findings)
    ]
    return assemble_package(package, sets, str(path), findings, swapped=swapped)


def _for_component(given: ParameterSet, name: str, fmu: FmuDescription) -> ParameterSet:
    """The set with the component's name before each of the FMU's own names, except those of inputs."""
    of_system = {v for v in fmu.named("input") if fmu.variables[v].kind in IN_TABLES}
    values = (
        replace(value, name=f"{name}.{value.name}")
        if value.name in fmu.variables and value.name not in of_system
        else value
        for value in given.values
    )
    return replace(given, values=tuple(values))


def settings_for(system: System, settings: Mapping[str, Value]) -> dict[str, Value]:
    """Start values by the names that a system has.

    Parameters
    ----------
    system : System
    settings : mapping of str to value
        By full name; in a system of one FMU with or without the component's. Where a name has ``=`` in it, as in
        ``a=b=7``, the rest of it may stand before the value: the longest name that there is wins.
    """
    is_one = system.file.lower().endswith(".fmu")
    signals = {*system.inputs, *system.parameters}
    for component in system.components.values():
        names = set(component.variables)
        signals |= {f"{component.name}.{name}" for name in names} | (names if is_one else set())
    named = {}
    for signal, value in settings.items():
        if isinstance(value, str) and "=" in value:
            signal, value = _longest_name(f"{signal}={value}", signals) or (signal, value)
        # Inputs of one FMU belong to the system, all other variables to the component.
        prefix = f"{next(iter(system.components))}." if is_one else ""
        variable = signal.removeprefix(prefix)
        signal = f"{prefix}{variable}" if f"{prefix}{variable}" in signals else signal
        named[variable if variable in system.inputs else signal] = value
    return named


def _longest_name(setting: str, names: Container[str]) -> tuple[str, Value] | None:
    """Name and value of ``name=value`` by the last sign that ends a name that there is."""
    parts = setting.split("=")
    for count in range(len(parts) - 1, 0, -1):
        name = "=".join(parts[:count]).strip()
        if name in names:
            return name, value_of("=".join(parts[count:]))
    return None


def _structure(path: Path, fmu: FmuDescription) -> etree._Element:
    """System structure of one component, with a connector for each input of the FMU."""
    root = etree.Element(
        qualified("ssd:SystemStructureDescription"), {"version": "2.0", "name": path.stem}
    )
    system = add(root, "ssd:System", name=path.stem)
    # Inputs that a table can feed become inputs of the system.
    inputs = [
        fmu.variables[name] for name in fmu.named("input") if fmu.variables[name].kind in IN_TABLES
    ]
    connectors = add(system, "ssd:Connectors") if inputs else None
    component = add(
        add(system, "ssd:Elements"), "ssd:Component", name=path.stem, source=quote(path.name)
    )
    if connectors is not None:
        owners = (connectors, add(component, "ssd:Connectors"))
        connections = add(system, "ssd:Connections")
        # The same connector on the system and on the component, and a connection between them.
        for variable in inputs:
            for owner in owners:
                connector = add(owner, "ssd:Connector", name=variable.name, kind="input")
                for size in variable.dimensions:
                    add(connector, "ssc:Dimension", size=str(size))
            ends = {
                "startConnector": variable.name,
                "endElement": path.stem,
                "endConnector": variable.name,
            }
            add(connections, "ssd:Connection", **ends)
    _add_experiment(root, fmu.experiment)
    return root


def _add_experiment(root: etree._Element, given: Mapping[str, float]) -> None:
    """Times of a run as the FMU suggests them."""
    start = given.get("startTime", 0.0)
    stop = given.get("stopTime")
    step = given.get("stepSize")
    if stop is not None and stop > start:
        element = add(root, "ssd:DefaultExperiment", startTime=repr(start), stopTime=repr(stop))
        annotation = add(
            add(element, "ssd:Annotations"), "ssc:Annotation", type="com.opensimulationplatform"
        )
        fixed = etree.SubElement(annotation, "FixedStepAlgorithm")
        fixed.set("baseStepSize", repr(_dividing_step(step, stop - start)))


def default_step_size(system: System, start_time: float, stop_time: float | str) -> float | None:
    """Step size of a run between two times if none is given. [s]

    Of one FMU its own step, where that divides the run, or the nearest that does; 500 steps where it has none. Of any
    other system the step of its default experiment, or None.

    Parameters
    ----------
    system : System
        That runs.
    start_time, stop_time : float
        Of the run; the stop time may be an amount such as ``"10 min"``. [s]
    """
    if not system.file.lower().endswith(".fmu"):
        return system.experiment.step_size
    try:
        duration = (seconds(stop_time) if isinstance(stop_time, str) else stop_time) - start_time
    except UnitError:
        return system.experiment.step_size  # the check of the scenario refuses the stop time
    return _dividing_step(_step_asked(system), duration)


def step_remarks(system: System, start_time: float, stop_time: float) -> list[Problem]:
    """A remark where `default_step_size` is not the step that the FMU asks for."""
    step_of_fmu = _step_asked(system) if system.file.lower().endswith(".fmu") else None
    step = default_step_size(system, start_time, stop_time)
    is_run = stop_time > start_time  # what ends before it starts is refused elsewhere
    if step_of_fmu is None or step is None or not is_run or step == step_of_fmu:
        return []
    run = stop_time - start_time
    message = f"Its step of {step_of_fmu:.9g} s does not divide the run's {run:.9g} s; it takes {step:.9g} s."
    (name,) = system.components
    return [Problem(name, message, "Give a step size or another stop time.", "remark")]


def _step_asked(system: System) -> float | None:
    (component,) = system.components.values()
    return component.fmu.experiment.get("stepSize")


def _dividing_step(wanted: float | None, duration: float) -> float:
    """A step that divides a run evenly: the one asked for, or the nearest; 500 steps where none is asked for. [s]"""
    if wanted is None or not 0.0 < wanted < inf or duration <= 0.0:
        return abs(duration or 1.0) / STEPS
    if whole_steps(duration, wanted):
        return wanted
    return duration / max(1, round(steps_in(duration, wanted)))
