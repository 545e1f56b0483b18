"""Ports (connectors in the hierarchy), the wires between them, and values set on them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.read.parameters import ParameterValue, Transformation
from shipcosim.units import Unit, find_unit

SOURCES_OUTSIDE = ("output", "calculatedParameter", "local", "constant")
"""Kinds of an element's connectors that give a value to what is around the element."""

SOURCES_INSIDE = ("input", "parameter", "structuralParameter")
"""Kinds of a system's connectors that give a value to what is inside the system."""

FREE = ("inout", "unspecified")
"""Kinds of connectors without a direction."""


class Key(NamedTuple):
    """Name of a port: the elements that contain it, without the outermost system, and its own."""

    path: tuple[str, ...]
    name: str

    def __str__(self) -> str:
        return ".".join((*filter(None, self.path), self.name))


@dataclass(frozen=True)
class Port:
    """A connector at its place in the hierarchy.

    Parameters
    ----------
    kind, type, unit, items
        As in Connector; what the SSD leaves open is taken from the FMU.
    owner : str
        ``"component"``, ``"system"``, ``"reference"`` or ``"dictionary"``.
    variable : Variable or None
        The FMU's, on a component.
    variable_unit : Unit or None
        The FMU's unit, which can be another than the connector's.
    description, place : str
        One line; where it stands.
    """

    kind: str
    type: str | None
    owner: str
    unit: Unit | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    variable: Variable | None = None
    variable_unit: Unit | None = None
    description: str = ""
    place: str = ""


@dataclass(frozen=True)
class Wire:
    """A connection in the direction of its value.

    Parameters
    ----------
    source, target : Key
        The ports that it joins.
    transformation : Transformation or None
        Of the value on its way.
    suppress_unit_conversion : bool
        Leave the value as it is even if units differ.
    place : str
        Where it stands, for messages.
    """

    source: Key
    target: Key
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    place: str = ""


@dataclass(frozen=True)
class Setting:
    """A value for a name in a system or component; settings are in the order of application.

    Parameters
    ----------
    path : tuple of str
        Place of the system or component.
    name : str
        Of the parameter, seen from there.
    value : ParameterValue
        As the parameter set has it.
    transformation, suppress_unit_conversion
        Of the parameter mapping that renamed it.
    near : bool
        Whether the set was bound to a component itself, so that all its names should be known.
    """

    path: tuple[str, ...]
    name: str
    value: ParameterValue
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    near: bool = False


def variable_port(variable: Variable, fmu: FmuDescription, place: str) -> Port:
    """Port of a component, as its FMU describes the variable.

    Parameters
    ----------
    variable : Variable
        Of the FMU.
    fmu : FmuDescription
        Has the definition of its unit.
    place : str
        Where it is used, for messages.

    Returns
    -------
    Port
    """
    unit = find_unit(variable.unit, fmu.units)
    fields = (variable.causality, variable.kind, "component", unit, variable.items, variable, unit)
    return Port(*fields, variable.description, place)
