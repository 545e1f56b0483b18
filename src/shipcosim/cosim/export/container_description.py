"""modelDescription.xml of a system's container FMU."""

from xml.etree import ElementTree as xml

from shipcosim import __version__
from shipcosim.cosim.export.container_variables import (
    FMI2_TYPES,
    ContainerVariable,
    is_structured,
    library_type,
)
from shipcosim.errors import error_at
from shipcosim.ssp import System
from shipcosim.ssp.xml.values import text_of

BINARY = "container_fmu"
"""modelIdentifier, which is the name of the library."""


def container_description(
    system: System, exposed: list[ContainerVariable], token: str, step_size: float
) -> bytes:
    """The model description, the same bytes for the same system.

    Parameters
    ----------
    system : System
        As read.
    exposed : list of ContainerVariable
        Its variables.
    token : str
        GUID.
    step_size : float
        Of the exchange inside. [s]
    """
    root = xml.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=system.name,
        guid=token,
        description=f"{len(system.components)} components of the system {system.name}",
        generationTool=f"shipcosim {__version__}",
        variableNamingConvention="structured"
        if all(is_structured(variable.name) for variable in exposed)
        else "flat",
        numberOfEventIndicators="0",
    )
    # The container can do what all its FMUs can.
    xml.SubElement(root, "CoSimulation", _abilities(system))
    _add_units(root, system, exposed)
    types = _add_types(root, exposed)
    _add_experiment(root, system, step_size)
    # FMI 2.0 describes time as a variable; a name must be free for it.
    variables = xml.SubElement(root, "ModelVariables")
    time = xml.SubElement(variables, "ScalarVariable", name=_time_name(exposed), valueReference="0")
    time.attrib |= {"causality": "independent", "variability": "continuous", "description": "time"}
    xml.SubElement(time, "Real")
    for reference, entry in enumerate(exposed, start=1):
        variables.append(_scalar_variable(reference, entry, system, types))
    _add_structure(root, exposed)
    xml.indent(root)
    return xml.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def _abilities(system):
    fmus = [component.fmu for component in system.components.values()]
    return {
        "modelIdentifier": BINARY,
        "needsExecutionTool": str(
            any(fmu.capability("needsExecutionTool") for fmu in fmus)
        ).lower(),
        "canHandleVariableCommunicationStepSize": "false",
        "canBeInstantiatedOnlyOncePerProcess": str(
            any(fmu.capability("canBeInstantiatedOnlyOncePerProcess") for fmu in fmus)
        ).lower(),
    }


def _add_units(root, system, exposed):
    used = sorted(
        {
            variable.unit
            for variable in exposed
            if variable.unit and variable.variable.kind == "Real"
        }
    )
    if not used:
        return
    definitions = xml.SubElement(root, "UnitDefinitions")
    for name in used:
        # An FMU has one definition per unit name; two definitions in its parts cannot be merged.
        units = {c.fmu.units[name] for c in system.components.values() if name in c.fmu.units}
        if len({(unit.exponents, unit.factor, unit.offset) for unit in units}) > 1:
            raise error_at(
                system.name,
                f"The unit {name} is defined in two ways by its FMUs.",
                "An FMU can have one definition of a unit.",
            )
        element = xml.SubElement(definitions, "Unit", name=name)
        for unit in units:
            xml.SubElement(element, "BaseUnit", unit.base_unit_attributes)
            break


def _add_types(root, exposed):
    """Write the enumerations under new names; return the names by items."""
    # Equal enumerations of different FMUs become one type.
    kinds = dict.fromkeys(
        tuple(variable.variable.items.items()) for variable in exposed if variable.variable.items
    )
    names = {items: f"Enumeration{number}" for number, items in enumerate(kinds, start=1)}
    if names:
        definitions = xml.SubElement(root, "TypeDefinitions")
    for items, name in names.items():
        element = xml.SubElement(
            xml.SubElement(definitions, "SimpleType", name=name), "Enumeration"
        )
        for item, value in items:
            xml.SubElement(element, "Item", name=item, value=str(value))
    return names


def _add_experiment(root, system, step_size):
    times = {
        "startTime": system.experiment.start_time,
        "stopTime": system.experiment.stop_time,
        "stepSize": step_size,
    }
    given = {name: repr(float(time)) for name, time in times.items() if time is not None}
    xml.SubElement(root, "DefaultExperiment", given)


def _time_name(exposed):
    names = {variable.name for variable in exposed}
    return next(name for name in ("time", "simulation_time", "_time") if name not in names)


def _scalar_variable(reference, entry, system, types):
    variable = entry.variable
    element = xml.Element(
        "ScalarVariable", name=entry.name, valueReference=str(reference), causality=entry.causality
    )
    if entry.description:
        element.set("description", entry.description)
    element.set("variability", _variability(entry))
    # FMI 2.0 table of causality, variability and initial: outputs are calculated, others are exact.
    if entry.causality != "input":
        element.set("initial", "calculated" if entry.causality == "output" else "exact")
    values = (
        {"start": text_of(entry.start)}
        if entry.start is not None and entry.causality != "output"
        else {}
    )
    name, inner = entry.ends[0]
    kind = (
        "Enumeration"
        if variable.items
        else FMI2_TYPES[str(library_type(system.components[name].fmu, inner))]
    )
    # Attributes by type, as the schema allows them.
    if kind == "Enumeration":
        values["declaredType"] = types[tuple(variable.items.items())]
    if kind == "Real" and entry.unit:
        values["unit"] = entry.unit
    if kind in ("Real", "Integer", "Enumeration"):
        number = float if kind == "Real" else int
        bounds = {"min": variable.minimum, "max": variable.maximum}
        values |= {key: repr(number(bound)) for key, bound in bounds.items() if bound is not None}
    xml.SubElement(element, kind, values)
    return element


def _variability(entry):
    if entry.causality == "parameter":
        return "tunable" if entry.variable.variability == "tunable" else "fixed"
    return (
        "continuous"
        if entry.variable.kind == "Real" and entry.variable.variability == "continuous"
        else "discrete"
    )


def _add_structure(root, exposed):
    structure = xml.SubElement(root, "ModelStructure")
    # Indices count from 1, and the first variable is time.
    indices = [
        str(index)
        for index, variable in enumerate(exposed, start=2)
        if variable.causality == "output"
    ]
    for kind in ("Outputs", "InitialUnknowns") if indices else ():
        unknowns = xml.SubElement(structure, kind)
        for index in indices:
            xml.SubElement(unknowns, "Unknown", index=index)
