"""Add connectors to elements of an SSD, with the units and enumerations that they need."""

from collections.abc import Mapping

import lxml.etree as etree

from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.xml.definitions import define_enumeration, define_unit
from shipcosim.ssp.xml.markup import add, ensure
from shipcosim.ssp.xml.values import SSP_1_TYPES
from shipcosim.units import Unit, find_unit


def declare_variable(
    element: etree._Element, variable: Variable, fmu: FmuDescription, root: etree._Element
) -> None:
    """Give a component a connector for a variable of its FMU.

    Parameters
    ----------
    element : lxml element
        The component.
    variable : Variable
        Of the FMU.
    fmu : FmuDescription
        Whose units and enumerations the SSD gets, as far as the connector needs them.
    root : lxml element
        Of the SSD.
    """
    kind = variable.causality.replace(" ", "")
    unit = find_unit(variable.unit, fmu.units) if variable.kind == "Real" else None
    items = variable.name, variable.items
    declare(element, variable.name, kind, variable.kind, unit, items, variable.description, root)


def declare(
    element: etree._Element,
    name: str,
    kind: str,
    type_name: str,
    unit: Unit | None,
    items: tuple[str, Mapping[str, int]],
    description: str,
    root: etree._Element,
) -> None:
    """Give a component or system a connector.

    Parameters
    ----------
    element : lxml element
        The component or system.
    name, kind, type_name, description : str
        Of the connector. One of a type that SSP 1.0 does not have is declared without a type.
    unit : Unit or None
        Of a Real.
    items : tuple of str and mapping
        Of an Enumeration: its name, and values by the items' names.
    root : lxml element
        Of the SSD, which gets the definitions of the unit and the enumeration.
    """
    # The connector itself; types that SSP 1.0 lacks stay undeclared.
    listed = ensure(element, "ssd:Connectors")
    connector = add(listed, "ssd:Connector", name=name, kind=kind, description=description or None)
    if type_name not in SSP_1_TYPES:
        return
    typed = add(connector, f"ssc:{type_name}")
    # The unit must be defined in the SSD before a connector refers to it.
    if unit is not None and define_unit(root, "ssd:Units", unit):
        typed.set("unit", unit.name)
    if type_name == "Enumeration":
        typed.set("name", define_enumeration(root, *items))
