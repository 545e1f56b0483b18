"""Variables of a container FMU: the system's connectors and its components' variables."""

import re
from dataclasses import dataclass

from shipcosim.cosim.master.plan import End, label
from shipcosim.errors import Problem
from shipcosim.ssp import FmuDescription, System, Variable

LIBRARY_TYPES = {"Real": "Float64", "Integer": "Int32"}
"""What the container's library calls types of FMI 2.0."""

FMI2_TYPES = {"Float64": "Real", "Int32": "Integer", "Boolean": "Boolean", "String": "String"}
"""Types of FMI 2.0 for the library's."""


@dataclass(frozen=True)
class ContainerVariable:
    """A variable of the container.

    Parameters
    ----------
    name, causality : str
        Causality is ``"input"``, ``"output"`` or ``"parameter"``.
    variable : Variable
        Of a component, which type, variability and bounds are taken from.
    ends : tuple of End
        Variables that get its value, or the one that gives it.
    start : value or None
        Start value.
    unit, description : str or None
        As outside.
    """

    name: str
    causality: str
    variable: Variable
    ends: tuple[End, ...]
    start: object = None
    unit: str | None = None
    description: str = ""


def library_type(fmu: FmuDescription, name: str) -> str | None:
    """The library's name for a variable's type, or None."""
    variable = fmu.variables[name]
    if variable.whole is not None or variable.dimensions or variable.kind in ("Binary", "Clock"):
        return None
    # Enumerations are Int64 in FMI 3.0 and 32-bit integers before.
    if variable.kind == "Enumeration":
        return "Int64" if fmu.fmi_version.startswith("3") else "Int32"
    return LIBRARY_TYPES.get(variable.type, variable.type)


def exposed_variables(
    system: System, connectors_only: bool, problems: list[Problem]
) -> list[ContainerVariable]:
    """Variables of the container, in the order of the system.

    Parameters
    ----------
    system : System
        As read.
    connectors_only : bool
        Whether to leave out what is no connector of the system.
    problems : list of Problem
        Takes what a connector cannot be, and remarks on what is left out.
    """
    # A connector that cannot be shown is an error: the user asked for it.
    exposed = [
        entry
        for entry in _connectors(system, problems)
        if _is_shown(entry, system, problems, "error")
    ]
    if connectors_only:
        return exposed
    # Then the variables of the components, except inputs that something feeds already.
    names = {entry.name for entry in exposed}
    fed = {end for entry in exposed if entry.causality != "output" for end in entry.ends}
    fed |= system.feeding.keys()
    for shown in _variables(system, fed):
        if shown.name in names:
            message = f"A connector of the system and a variable of a component are both called {shown.name}."
            problems.append(Problem(system.name, message, "Rename the connector."))
        # Variables that FMI 2.0 cannot show are left out with a remark.
        elif _is_shown(shown, system, problems, "remark"):
            exposed.append(shown)
    return exposed


def _connectors(system, problems):
    """Connectors of the outermost system."""
    for signal, causality, ends in _signals(system):
        if not ends:
            message = f"The {causality} {signal.name} is connected to nothing and is left out."
            problems.append(Problem(system.name, message, severity="remark"))
            continue
        # Type and bounds come from the first variable that the connector leads to.
        component, name = ends[0]
        variable = system.components[component].fmu.variables[name]
        # FMI wants a start value for inputs and parameters; without one, the components' values
        # must agree.
        start = signal.start
        if start is None and causality != "output":
            start = _common_start(system, signal, ends, problems)
        shown = start if causality != "output" else None
        description = signal.description or (variable.description if len(ends) == 1 else "")
        yield ContainerVariable(
            signal.name, causality, variable, ends, shown, signal.unit, description
        )


def _signals(system):
    for signal in system.inputs.values():
        yield signal, "input", _ends(system.connections, signal, "source")
    for signal in system.parameters.values():
        yield signal, "parameter", _ends(system.given, signal, "source")
    for signal in system.outputs.values():
        yield signal, "output", _ends(system.connections, signal, "target")


def _ends(connections, signal, near):
    far = {"source": "target", "target": "source"}[near]
    ends = (getattr(c, far) for c in connections if getattr(c, near) == (None, signal.name))
    return tuple(end for end in ends if end[0] is not None)


def _common_start(system, signal, ends, problems):
    starts = {system.components[name].start_value(variable) for name, variable in ends}
    if len(starts) > 1:
        message = f"{signal.name} has no start value, and {', '.join(map(label, ends))} start with different ones."
        problems.append(
            Problem(system.name, message, "Set a start value for it: an FMU has to state one.")
        )
    return starts.pop()


def _variables(system, fed):
    """Outputs and parameters of the components, and inputs that nothing feeds."""
    for component, variable in system.all_variables():
        end = component.name, variable.name
        if variable.causality in ("input", "parameter") and end not in fed:
            start = component.start_value(variable.name)
        elif variable.causality == "output":
            start = None
        else:
            continue
        yield ContainerVariable(
            label(end),
            variable.causality,
            variable,
            (end,),
            start,
            variable.unit,
            variable.description,
        )


def _is_shown(entry, system, problems, severity):
    """True if FMI 2.0 has a type for a variable; otherwise note a problem."""
    name, variable = entry.ends[0]
    kind = library_type(system.components[name].fmu, variable)
    if kind in FMI2_TYPES:
        return True
    what = (
        "an element of an array"
        if entry.variable.whole is not None
        else f"of type {entry.variable.type}"
    )
    message = f"{entry.name} is {what}, which FMI 2.0 has not"
    message += "; it is left out." if severity == "remark" else "."
    problems.append(Problem(system.name, message, severity=severity))
    return False


def is_structured(name: str) -> bool:
    """True if a name follows FMI's structured naming convention."""
    part = r"(?:[A-Za-z_][A-Za-z0-9_]*|'[^']+')(?:\[[0-9]+(?:,[0-9]+)*\])?"
    return re.fullmatch(rf"{part}(?:\.{part})*", name) is not None
