"""Values of a parameter set that fit another system, and remarks on those that do not."""

from __future__ import annotations

from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.flatten.with_values import with_values
from shipcosim.ssp.read.parameters import ParameterSet, ParameterValue, read_parameter_set
from shipcosim.ssp.xml.document import AnyPath, Findings, read_document
from shipcosim.ssp.xml.values import Value
from shipcosim.units import conversion, spelled_unit


def fitting_values(path: AnyPath, system: System) -> tuple[dict[str, Value], list[Problem]]:
    """Start values of a parameter set for the parameters that a system has.

    Parameters
    ----------
    path : path
        An .ssv, such as extended.ssv of a diagnosis.
    system : System

    Returns
    -------
    dict of str to value
        By signal, in the unit of the system's variable. The set's value for an input of its system is given to the only
        input of a component of that name that nothing feeds, where this system has no such input itself.
    list of Problem
        Remarks: what does not fit, and why.

    Raises
    ------
    ShipcosimError
        If the file cannot be read, or nothing in it fits.
    """
    values = {}
    remarks = []
    # Try each value alone: one that does not fit must not spoil the others.
    for value in _read(path).values:
        signal = _signal(value.name, system)
        converted = _converted(value, signal, system)
        try:
            with_values(system, {signal: converted}, str(path))
            values[signal] = converted
        except ShipcosimError as error:
            remarks += [
                Problem(p.where, f"Left out: {p.found}", p.remedy, "remark") for p in error.problems
            ]
    # A set of which nothing fits is for another system.
    if not values:
        names = ", ".join(problem.where.rpartition(": ")[2] for problem in remarks)
        raise error_at(
            str(path),
            f"Nothing of it fits {system.name}: {names}.",
            f"Components: {', '.join(system.components)}.",
        )
    return values, remarks


def _read(path: AnyPath) -> ParameterSet:
    findings = Findings()
    document = read_document(path, str(path), findings)
    values = None if document is None else read_parameter_set(document, findings)
    if findings.errors or values is None:
        raise ShipcosimError(findings.errors)
    return values


def _signal(name: str, system: System) -> str:
    """Signal that a value is for; for an input that the system lacks, the one it would feed."""
    # Full names and existing inputs stand for themselves.
    if "." in name or name in system.inputs:
        return name
    # Else the only unconnected input of this name, if there is exactly one.
    fed = system.feeding
    owners = [
        component
        for component, part in system.components.items()
        if name in part.variables
        and part.variables[name].causality == "input"
        and (component, name) not in fed
    ]
    return f"{owners[0]}.{name}" if len(owners) == 1 else name


def _converted(value: ParameterValue, signal: str, system: System) -> Value:
    """A value in the unit of its signal."""
    if value.unit is None or not isinstance(value.value, float):
        return value.value
    component, _, variable = signal.rpartition(".")
    part = system.components.get(component)
    target = system.inputs.get(signal) if part is None else part.variables.get(variable)
    unit = target.unit if target is not None else None
    factor, offset = conversion(value.unit, spelled_unit(unit) if unit else None)
    return factor * value.value + offset
