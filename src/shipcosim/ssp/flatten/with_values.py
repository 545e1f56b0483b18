"""A system with other start values, each checked against its variable or connector."""

from collections.abc import Mapping
from dataclasses import replace

from shipcosim.errors import ShipcosimError, raise_errors
from shipcosim.ssp.flatten.start_values import check_bounds
from shipcosim.ssp.flatten.system import Signal, System, alias_remarks
from shipcosim.ssp.fmu.description import Variable
from shipcosim.ssp.read.structure import label
from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.values import Value
from shipcosim.units import Unit, UnitError, is_amount, is_finite, number_in


def with_values(system: System, values: Mapping[str, Value], where: str = "") -> System:
    """System with other start values, e.g. from a scenario or the command line.

    Parameters
    ----------
    system : System
        As read.
    values : mapping of str to value
        By signal (``"vessel.mass"``): a number in the FMU's unit, or a text with another one (``"550 t"``); items of
        enumerations by name or number.
    where : str
        Where the values come from, for messages.

    Returns
    -------
    System

    Raises
    ------
    ShipcosimError
        With every name that does not exist and every value that does not fit.
    """
    findings = Findings()
    starts = {name: dict(component.start) for name, component in system.components.items()}
    inputs = dict(system.inputs)
    # A value on a connected input would be overwritten at once, so it is an error.
    feeding = system.feeding
    # Go through all values before raising, to report every problem.
    for signal, value in values.items():
        place = f"{where}: {signal}" if where else signal
        try:
            component, name = system.split(signal, place)
        except ShipcosimError as error:
            findings.problems += error.problems
            continue
        if (component, name) in feeding:
            source = label(feeding[component, name])
            findings.error(
                place,
                f"It is connected: {source} gives its value.",
                "Set what feeds it, or hold it with an event (override).",
            )
        elif component is not None:
            variable = system.components[component].variables[name]
            unit = system.unit_of(component, name)
            _set(starts[component], variable, _number(value, variable.kind, unit), place, findings)
        elif name in inputs:
            value = _number(value, inputs[name].type, system.unit_of(None, name))
            if _fits(value, inputs[name], inputs[name].type, place, findings):
                inputs[name] = replace(inputs[name], start=value)
        else:
            findings.error(
                place, "It is no input of the system.", f"Inputs: {', '.join(inputs) or 'none'}."
            )
    raise_errors(findings.errors)
    # Of two names of one variable the last that is set holds, so the order of start values counts too.
    changed = {
        name: replace(component, start=starts[name])
        for name, component in system.components.items()
        if list(starts[name].items()) != list(component.start.items())
    }
    # Two names of one variable may have got two values, or no longer have them.
    earlier = {name: system.components[name] for name in changed}
    before = alias_remarks(earlier, system.connections)
    kept = [remark for remark in system.remarks if remark not in before]
    remarks = (*kept, *alias_remarks(changed, system.connections))
    components = {**system.components, **changed}
    return replace(system, components=components, inputs=inputs, remarks=remarks)


TYPES_OF = {
    "Real": (int, float),
    "Integer": (int,),
    "Boolean": (bool,),
    "String": (str,),
    "Enumeration": (int,),
}
WANTED = {
    "Real": "Give a number, with a decimal point",
    "Integer": "Give a whole number",
    "Boolean": "Give true or false",
}
LARGEST = 2**31  # FMI's integers have 32 bits


def _number(value: Value, kind: str | None, unit: Unit | None) -> Value | UnitError:
    """An amount converted to a unit, or the error; other values unchanged."""
    if kind != "Real" or not is_amount(value):
        return value
    try:
        return number_in(value, unit)
    except UnitError as error:
        return error


def _set(
    start: dict[str, Value], variable: Variable, value: Value, place: str, findings: Findings
) -> None:
    """Put a value into `start`, checked and in the variable's type."""
    # Items of enumerations may be given by name.
    if variable.items and isinstance(value, str):
        value = variable.items.get(value, value)
    if not _fits(value, variable, variable.kind, place, findings):
        return
    if not variable.settable:
        findings.error(
            place,
            f"It is of causality {variable.causality}, a value that the FMU calculates.",
            "Set parameters and inputs.",
        )
    elif check_bounds(value, variable, place, variable.name, findings):
        # In the order of setting: of two names of one variable the last one holds.
        start.pop(variable.name, None)
        start[variable.name] = float(value) if variable.kind == "Real" else value


def _fits(
    value: Value, owner: Variable | Signal, kind: str | None, place: str, findings: Findings
) -> bool:
    """True if a value is of a kind, else an error; `owner` has the items of an enumeration."""
    if isinstance(value, UnitError):
        findings.error(place, value.found, value.remedy)
        return False
    # In Python True is an integer; it must not pass as a number.
    right = kind is None or isinstance(value, TYPES_OF.get(kind, (bytes,)))
    if not right or (isinstance(value, bool) and kind not in ("Boolean", None)):
        remedy = f"Items: {', '.join(owner.items)}." if owner.items else _wanted(kind, owner.unit)
        findings.error(place, f"{value!r:.60} is no {kind}.", remedy)
        return False
    # JSON and TOML can hold NaN and infinity; models cannot start from them.
    if isinstance(value, (int, float)) and not is_finite(value):
        findings.error(
            place, f"{str(value):.60} is not a finite number.", _wanted(kind, owner.unit)
        )
        return False
    if kind == "Integer" and not -LARGEST <= value < LARGEST:
        findings.error(
            place,
            f"{value} is too large for an Integer.",
            f"Give one from {-LARGEST} to {LARGEST - 1}.",
        )
        return False
    return True


def _wanted(kind: str | None, unit: str | None) -> str:
    return (
        f"{WANTED[kind]}{f', in {unit}' if kind == 'Real' and unit else ''}."
        if kind in WANTED
        else ""
    )
