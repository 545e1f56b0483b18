"""Ports (connectors at their place in the hierarchy), wires between them and values set on them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from shipcosim.ssp.fmu.description import Variable
from shipcosim.ssp.read.parameters import ParameterValue, Transformation
from shipcosim.units import Unit, find_unit

SOURCES_OUTSIDE = ("output", "calculatedParameter", "local", "constant")
SOURCES_INSIDE = ("input", "parameter", "structuralParameter")
FREE = ("inout", "unspecified")


class Key(NamedTuple):
    """Which port: names of the elements around it from the outermost system's inside, and its own."""

    path: tuple[str, ...]
    name: str

    def __str__(self):
        return ".".join((*filter(None, self.path), self.name))


@dataclass(frozen=True)
class Port:
    """A connector at its place.

    Parameters
    ----------
    kind, type, unit, items
        As in Connector, with what the FMU says filled in.
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
    items: Mapping = field(default_factory=dict)
    variable: Variable | None = None
    variable_unit: Unit | None = None
    description: str = ""
    place: str = ""


@dataclass(frozen=True)
class Wire:
    """A connection in the direction that values go."""

    source: Key
    target: Key
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    place: str = ""


@dataclass(frozen=True)
class Setting:
    """A value for a name within a system or component; settings come in the order in which they are applied.

    `near` says whether the set was bound to a component itself, so that all its names should be known.
    """

    path: tuple[str, ...]
    name: str
    value: ParameterValue
    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False
    near: bool = False


def variable_port(variable, fmu, place):
    """Port of an FMU's variable as the FMU describes it."""
    unit = find_unit(variable.unit, fmu.units)
    fields = (variable.causality, variable.kind, "component", unit, variable.items, variable, unit)
    return Port(*fields, variable.description, place)
