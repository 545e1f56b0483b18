"""modelDescription.xml of an FMU class."""

import math
from xml.etree import ElementTree as xml

import shipcosim
from shipcosim.fmi.fmu import Fmu
from shipcosim.fmi.variables import Value, Variable
from shipcosim.units import fmi_unit

QUANTITIES = {
    "m": "Length",
    "m/s": "Velocity",
    "m/s2": "Acceleration",
    "rad": "Angle",
    "rad/s": "AngularVelocity",
    "rad/s2": "AngularAcceleration",
    "rpm": "RotationalSpeed",
    "kg": "Mass",
    "kg.m2": "MomentOfInertia",
    "N": "Force",
    "N.m": "Torque",
    "W": "Power",
    "s": "Time",
}
DISPLAYED = {"rad": "deg", "rad/s": "deg/s"}
LOG_CATEGORIES = {
    "logStatusOk": "what the component tells",
    "logStatusWarning": "what may be wrong",
    "logStatusError": "what is wrong: why the component stopped, with its traceback",
}


REQUIRED = " (required: the start value stands for none)"


def model_description(cls: type[Fmu], identifier: str, guid: str) -> bytes:
    """Model description as bytes; the same class gives the same bytes.

    Parameters
    ----------
    cls : type of Fmu
        Subclass of `Fmu`, of this package or of the copy that an FMU carries.
    identifier : str
        Name of the FMU and of its binary.
    guid : str
        Links the description to its binary.

    Returns
    -------
    bytes

    Raises
    ------
    ValueError
        A unit cannot be read; the text names the variable.
    """
    # Attributes of the FMU, with this version of shipcosim as its tool.
    attributes = dict(
        fmiVersion="2.0",
        modelName=identifier,
        guid=guid,
        description=summary(cls),
        author=cls.author,
        version=cls.version or shipcosim.__version__,
        license=cls.licence,
        generationTool=f"shipcosim {shipcosim.__version__}",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    # Elements in the order that the schema requires.
    root = xml.Element("fmiModelDescription", attributes)
    _co_simulation(root, identifier)
    units = sorted({variable.unit for variable in cls.variables if variable.type == "Real"})
    if units:
        _unit_definitions(root, cls.variables, units)
        _type_definitions(root, units)
    categories = xml.SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        xml.SubElement(categories, "Category", name=name, description=text)
    xml.SubElement(
        root, "DefaultExperiment", startTime="0.0", stepSize=repr(float(cls.default_step_size))
    )
    # The value reference is the position in the list.
    listed = xml.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(cls.variables):
        listed.append(_scalar_variable(reference, variable))
    _structure(root, cls.variables)
    xml.indent(root)
    return xml.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def summary(cls: type[Fmu]) -> str:
    """First paragraph of the class's docstring in one line."""
    return " ".join((cls.__doc__ or "").strip().split("\n\n")[0].split())


def _co_simulation(root, identifier):
    xml.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=identifier,
        needsExecutionTool="true",
        canHandleVariableCommunicationStepSize="true",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )


def _unit_definitions(root, variables, units):
    # Each unit with its exponents of SI base units; degrees for display.
    definitions = xml.SubElement(root, "UnitDefinitions")
    for unit in units:
        try:
            defined = fmi_unit(unit)
        except ValueError as error:
            users = ", ".join(variable.name for variable in variables if variable.unit == unit)
            raise ValueError(f"{users}: {error}") from None
        element = xml.SubElement(definitions, "Unit", name=unit)
        xml.SubElement(element, "BaseUnit", defined.base_unit_attributes)
        if unit in DISPLAYED:
            xml.SubElement(element, "DisplayUnit", name=DISPLAYED[unit], factor=repr(180 / math.pi))


def _type_definitions(root, units):
    # Types name the physical quantity of common units.
    named = [unit for unit in units if unit in QUANTITIES]
    if named:
        definitions = xml.SubElement(root, "TypeDefinitions")
        for unit in named:
            simple = xml.SubElement(definitions, "SimpleType", name=QUANTITIES[unit])
            xml.SubElement(
                simple, "Real", dict(quantity=QUANTITIES[unit], unit=unit) | _displayed(unit)
            )


def _displayed(unit: str) -> dict[str, str]:
    return {"displayUnit": DISPLAYED[unit]} if unit in DISPLAYED else {}


def _scalar_variable(reference: int, variable: Variable) -> xml.Element:
    # Causality and variability as FMI defines them.
    element = xml.Element(
        "ScalarVariable",
        name=variable.name,
        valueReference=str(reference),
        description=full_text(variable) + (REQUIRED if variable.required else ""),
        causality=variable.causality,
        variability=_variability(variable),
    )
    # Type, unit and bounds; outputs are calculated and have no start value.
    value = {}
    if variable.type == "Real":
        if variable.unit in QUANTITIES:
            value["declaredType"] = QUANTITIES[variable.unit]
        value |= {"unit": variable.unit} | _displayed(variable.unit)
    if variable.type in ("Real", "Integer"):
        bounds = {"min": variable.minimum, "max": variable.maximum}
        number = float if variable.type == "Real" else int
        value |= {key: text_of(number(bound)) for key, bound in bounds.items() if bound is not None}
    if variable.causality == "output":
        element.set("initial", "calculated")
    else:
        value["start"] = text_of(variable.start)
    if variable.causality == "parameter":
        element.set("initial", "exact")
    xml.SubElement(element, variable.type, value)
    # Tolerance, "required" and "optional" are ours: they go into an annotation.
    about = {"tolerance": repr(float(variable.tolerance))} if variable.tolerance else {}
    about |= {mark: "true" for mark in ("required", "optional") if getattr(variable, mark)}
    if about:
        tool = xml.SubElement(xml.SubElement(element, "Annotations"), "Tool", name="shipcosim")
        xml.SubElement(tool, "Quantity", about)
    return element


def full_text(variable: Variable) -> str:
    """Description of a variable, and where its value comes from."""
    return (
        f"{variable.description} ({variable.origin})" if variable.origin else variable.description
    )


def _variability(variable: Variable) -> str:
    if variable.causality == "parameter":
        return "tunable" if variable.tunable else "fixed"
    return "continuous" if variable.type == "Real" else "discrete"


def text_of(value: Value) -> str:
    """A value as text of a model description."""
    return (
        str(value).lower()
        if isinstance(value, bool)
        else value
        if isinstance(value, str)
        else repr(value)
    )


def _structure(root, variables):
    # Outputs depend on no input within a step; at the start they may depend on all.
    structure = xml.SubElement(root, "ModelStructure")
    indices = [
        str(index) for index, variable in enumerate(variables, 1) if variable.causality == "output"
    ]
    for kind in ("Outputs", "InitialUnknowns") if indices else ():
        unknowns = xml.SubElement(structure, kind)
        for index in indices:
            # a step computes the outputs: an input that is set shows after it, so no algebraic loop goes through an FMU
            dependencies = {"dependencies": ""} if kind == "Outputs" else {}
            xml.SubElement(unknowns, "Unknown", {"index": index, **dependencies})
