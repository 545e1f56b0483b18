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
        if all(is_structured(one.name) for one in exposed)
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
    for reference, one in enumerate(exposed, start=1):
        variables.append(_scalar_variable(reference, one, system, types))
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
    used = sorted({one.unit for one in exposed if one.unit and one.variable.kind == "Real"})
    if not used:
        return
    definitions = xml.SubElement(root, "UnitDefinitions")
    for name in used:
        # An FMU has one definition per unit name; two definitions in its parts cannot be merged.
        found = {c.fmu.units[name] for c in system.components.values() if name in c.fmu.units}
        if len({(unit.exponents, unit.factor, unit.offset) for unit in found}) > 1:
            text = f"The unit {name} is defined in two ways by its FMUs."
            raise error_at(system.name, text, "An FMU can have one definition of a unit.")
        element = xml.SubElement(definitions, "Unit", name=name)
        for unit in found:
            xml.SubElement(element, "BaseUnit", unit.base_unit_attributes)
            break


def _add_types(root, exposed):
    """Write the enumerations under new names; return the names by items."""
    # Equal enumerations of different FMUs become one type.
    kinds = dict.fromkeys(
        tuple(one.variable.items.items()) for one in exposed if one.variable.items
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
    names = {one.name for one in exposed}
    return next(name for name in ("time", "simulation_time", "_time") if name not in names)


def _scalar_variable(reference, one, system, types):
    variable = one.variable
    element = xml.Element(
        "ScalarVariable", name=one.name, valueReference=str(reference), causality=one.causality
    )
    if one.description:
        element.set("description", one.description)
    element.set("variability", _variability(one))
    # FMI 2.0 table of causality, variability and initial: outputs are calculated, others are exact.
    if one.causality != "input":
        element.set("initial", "calculated" if one.causality == "output" else "exact")
    values = (
        {"start": text_of(one.start)} if one.start is not None and one.causality != "output" else {}
    )
    name, own = one.ends[0]
    kind = (
        "Enumeration"
        if variable.items
        else FMI2_TYPES[str(library_type(system.components[name].fmu, own))]
    )
    # Attributes by type, as the schema allows them.
    if kind == "Enumeration":
        values["declaredType"] = types[tuple(variable.items.items())]
    if kind == "Real" and one.unit:
        values["unit"] = one.unit
    if kind in ("Real", "Integer", "Enumeration"):
        number = float if kind == "Real" else int
        bounds = {"min": variable.minimum, "max": variable.maximum}
        values |= {key: repr(number(bound)) for key, bound in bounds.items() if bound is not None}
    xml.SubElement(element, kind, values)
    return element


def _variability(one):
    if one.causality == "parameter":
        return "tunable" if one.variable.variability == "tunable" else "fixed"
    return (
        "continuous"
        if one.variable.kind == "Real" and one.variable.variability == "continuous"
        else "discrete"
    )


def _add_structure(root, exposed):
    structure = xml.SubElement(root, "ModelStructure")
    # Indices count from 1, and the first variable is time.
    indices = [
        str(index) for index, one in enumerate(exposed, start=2) if one.causality == "output"
    ]
    for kind in ("Outputs", "InitialUnknowns") if indices else ():
        unknowns = xml.SubElement(structure, kind)
        for index in indices:
            xml.SubElement(unknowns, "Unknown", index=index)
