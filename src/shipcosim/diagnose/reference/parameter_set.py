"""The numbers of a reference as a parameter set of its system: the ship as she is known to be well."""

from pathlib import Path

from shipcosim.diagnose.extension.extend import structure_of
from shipcosim.diagnose.extension.extended_system import ExtendedSystem
from shipcosim.diagnose.reference.reference import KnownNumber, Reference, is_same
from shipcosim.ssp import AnyPath, System, parameter, write_ssv

FILE = "calibrated.ssv"
"""Name of the set in the folder that a calibration leaves."""


def write_parameter_set(system: System, reference: Reference, path: AnyPath) -> dict[str, float]:
    """Write a parameter set with the numbers of a reference that the system has.

    Not all of it is true: numbers that the logs cannot tell apart share what they explain.

    Parameters
    ----------
    system : System
        That the reference was made with.
    reference : Reference
    path : path
        The .ssv, to be bound to the system.

    Returns
    -------
    dict of str to float
        What the set holds, in the units of the FMUs.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    # Numbers that are variables of the system; others, such as those of the water, have none.
    values = {}
    for number in reference.numbers:
        variable = _variable(system, number)
        if variable is not None:
            unit = None if variable.unit in (None, "1") else variable.unit
            text = f"{variable.description}; calibrated to {len(reference.logs)} logs, {number.nominal:g} before"
            values[number.name] = parameter(
                number.name, number.estimate, unit, text, tolerance=number.std
            )
    write_ssv(path, "calibrated", values.values())
    return {name: value.value for name, value in values.items()}


def _variable(system: System, number: KnownNumber):
    """Variable of the system that holds a number; None if it has none, or a different number."""
    component, _, name = number.name.rpartition(".")
    part = system.components.get(component)
    if part is None or name not in part.variables:
        return None
    start = part.start_value(name)
    # The system must hold the number before or after calibration; else it is another number.
    is_same_number = isinstance(start, int | float) and any(
        is_same(start, value) for value in (number.nominal, number.estimate)
    )
    return part.variables[name] if is_same_number else None


def with_calibrated_numbers(
    given: ExtendedSystem, reference: Reference, folder: AnyPath
) -> ExtendedSystem:
    """A system with the numbers of a reference bound, to be extended by what has changed since.

    Parameters
    ----------
    given : ExtendedSystem
        Not extended yet.
    reference : Reference
    folder : path
        Gets calibrated.ssv, which must stay there until the system is written.

    Returns
    -------
    ExtendedSystem
    """
    structure = structure_of(given.source)
    write_parameter_set(given.given, reference, Path(folder) / FILE)
    structure.bind(Path(folder) / FILE)
    return ExtendedSystem(structure.checked(), structure)
