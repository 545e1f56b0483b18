"""One FMU as a system: one component with the file's name; its inputs are system inputs."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from urllib.parse import quote

import lxml.etree as etree

from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.parameters import ParameterSets
from shipcosim.ssp.xml.document import AnyPath, Document, Findings, qualified
from shipcosim.ssp.xml.markup import add
from shipcosim.ssp.xml.values import Value

IN_TABLES = ("Real", "Integer", "Boolean", "Enumeration")
"""Kinds of inputs that a table can feed; the others keep their start value, which can be set."""

STEPS = 500
"""Steps of a run whose FMU says when it ends and not how long a step is, as other tools have it."""


def single_fmu(path: AnyPath) -> Path | None:
    """Path of an FMU that is used as a system, or None."""
    path = Path(path)
    return path if path.suffix.lower() == ".fmu" and path.is_file() else None


def assemble_fmu(
    path: Path,
    parameters: ParameterSets,
    fmus: Iterable[AnyPath],
    findings: Findings,
    swapped: Mapping[str, Path] | None = None,
) -> System | None:
    """System of one FMU, or None.

    Parameters
    ----------
    path : Path
        Of the FMU.
    parameters : path or ParameterSet, or iterable of them
        With names as in the FMU behind the component's: ``"tank.level"``.
    fmus : iterable of path
        Not needed.
    findings : Findings
        Takes what is wrong.
    swapped : mapping of str to Path, optional
        FMU that runs in place of this one, with its inputs.
    """
    # Build an SSD around the FMU in memory, and read it as any other.
    fmu = describe_fmu(path, findings)
    if fmu is None:
        return None
    root = _structure(path, fmu)
    package = Package(path.parent, str(path.parent), f"{path.stem}.ssd", tuple(map(Path, fmus)))
    package.held[(package.folder / package.ssd).resolve()] = Document(str(path), root, path.parent)
    return assemble_package(package, parameters, str(path), findings, swapped=swapped)


def settings_of_one(system: System, settings: Mapping[str, Value]) -> dict[str, Value]:
    """Start values by the names of a system of one FMU, where given by the FMU's own names.

    Parameters
    ----------
    system : System
        Of one FMU; start values of any other come back as they are.
    settings : mapping of str to value
        By the variable's name, with or without that of the component before it.
    """
    # Systems of other files keep their names.
    if not system.file.lower().endswith(".fmu"):
        return dict(settings)
    ((name, component),) = system.components.items()
    named = {}
    # Inputs belong to the system, all other variables to the component.
    for signal, value in settings.items():
        variable = signal.removeprefix(f"{name}.")
        known = variable in component.fmu.variables
        named[variable if variable in system.inputs or not known else f"{name}.{variable}"] = value
    return named


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
    # A step that divides the run evenly; without one as many steps as other tools take.
    if stop is not None and stop > start:
        element = add(root, "ssd:DefaultExperiment", startTime=repr(start), stopTime=repr(stop))
        annotation = add(
            add(element, "ssd:Annotations"), "ssc:Annotation", type="com.opensimulationplatform"
        )
        fixed = etree.SubElement(annotation, "FixedStepAlgorithm")
        steps = round((stop - start) / step) if step is not None and step > 0.0 else STEPS
        fixed.set("baseStepSize", repr((stop - start) / max(1, steps)))
