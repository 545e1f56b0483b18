"""Access to the variables of an FMU by the value references of a call."""

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from shipcosim.fmi.failures import FmuError
from shipcosim.fmi.variables import Variable

Getter = Callable[[Mapping[str, Any]], tuple]


class Found(NamedTuple):
    """Variables of the value references in one call.

    Attributes
    ----------
    names : tuple of str
        Names of the variables.
    fixed : str
        Name of a fixed parameter among them, or "".
    values : callable
        Takes their values from a mapping, as a tuple.
    """

    names: tuple[str, ...]
    fixed: str
    values: Getter


class Access(dict):
    """`Found` by value references, made at the first call with these references.

    Parameters
    ----------
    variables : sequence of Variable
        All variables of the FMU, in the order of their value references.
    kind : str
        Type of FMI that the calls are for: "Real", "Integer", "Boolean" or "String".
    """

    def __init__(self, variables: Sequence[Variable], kind: str):
        super().__init__()
        self.variables = variables
        self.kind = kind

    def __missing__(self, references: tuple[int, ...]) -> Found:
        # Each reference must exist, and have the type of the call.
        variables = []
        for reference in references:
            if (
                not 0 <= reference < len(self.variables)
                or self.variables[reference].type != self.kind
            ):
                raise FmuError(f"there is no {self.kind} variable with value reference {reference}")
            variables.append(self.variables[reference])
        # Fixed parameters cannot be set during the run: remember one for the message.
        fixed = [
            variable.name
            for variable in variables
            if variable.causality == "parameter" and not variable.tunable
        ]
        names = tuple(variable.name for variable in variables)
        # Kept for the next call with the same references.
        self[references] = Found(names, fixed[0] if fixed else "", getter(names))
        return self[references]


def getter(names: Sequence[str]) -> Getter:
    """Make a function that takes the values of some names from a mapping, as a tuple.

    Parameters
    ----------
    names : sequence of str
        The names.

    Returns
    -------
    callable
    """
    # itemgetter returns a bare value for one name.
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return operator.itemgetter(*names) if names else lambda values: ()


def refuse_not_finite_outputs(names: Sequence[str], values: Mapping[str, Any]) -> None:
    """Raise for the first output that is not a finite number.

    Parameters
    ----------
    names : sequence of str
        Real outputs.
    values : mapping of str to any
        Values by name.

    Raises
    ------
    FmuError
        The output has no value, or one that is no finite number.
    """
    for name in names:
        value = values.get(name)
        try:
            right = math.isfinite(value)  # pyright: ignore[reportArgumentType]
        except (TypeError, ValueError):
            right = False
        if not right:
            raise FmuError(f"output '{name}' is {value!r}, not a finite number")


def refuse_not_finite_inputs(
    variables: Sequence[Variable], names: Sequence[str], values: Sequence[float]
) -> None:
    """Raise for the first variable that the host has set to NaN or infinity.

    Parameters
    ----------
    variables : sequence of Variable
        All variables of the FMU.
    names : sequence of str
        Variables that were set.
    values : sequence of float
        Their values.

    Raises
    ------
    FmuError
        A value is no finite number.
    """
    kinds = {variable.name: variable.causality for variable in variables}
    for name, value in zip(names, values, strict=True):
        if not math.isfinite(value):
            raise FmuError(f"{kinds[name]} '{name}' was set to {value}, not a finite number")


def whole_number(name: str, value: Any) -> int:
    """Convert a value to FMI's 32-bit integer.

    Parameters
    ----------
    name : str
        Name of its variable.
    value : any
        The value.

    Returns
    -------
    int

    Raises
    ------
    FmuError
        The value is no whole number, or one that 32 bits cannot hold.
    """
    try:
        whole = operator.index(value)
    except TypeError:
        raise FmuError(f"'{name}' is {value!r}, not a whole number") from None
    if not -(2**31) <= whole < 2**31:
        raise FmuError(f"'{name}' is {whole}, which FMI's 32-bit integers cannot hold")
    return whole
