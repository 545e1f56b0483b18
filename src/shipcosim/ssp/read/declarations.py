"""Connectors, units and enumerations of an SSD, as an FMU's variables have them."""

from shipcosim.ssp.read.parameters import read_enumerations
from shipcosim.ssp.xml.document import children
from shipcosim.ssp.xml.markup import add, ensure
from shipcosim.ssp.xml.units import BASE, find_unit, read_units, relation

TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
"""Types of SSP 1.0; the kinds of the others (FMI 3.0) are among them but for clocks."""


def declare_variable(element, variable, fmu, root):
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


def declare(element, name, kind, type_name, unit, items, description, root):
    """Give an element a connector; `unit` is a Unit or None, `items` the name of an enumeration and its items."""
    listed = ensure(element, "ssd:Connectors")
    connector = add(listed, "ssd:Connector", name=name, kind=kind, description=description or None)
    if type_name not in TYPES:
        return
    typed = add(connector, f"ssc:{type_name}")
    if unit is not None and define_unit(root, "ssd:Units", unit):
        typed.set("unit", unit.name)
    if type_name == "Enumeration":
        typed.set("name", define_enumeration(root, *items))


def define_unit(root, tag, unit):
    """Define a unit in a file, if it is not; false where its name means another unit there.

    Parameters
    ----------
    root : lxml element
        Of an SSD or SSV.
    tag : str
        The list of units there: ``"ssd:Units"``, ``"ssv:Units"``.
    unit : Unit
        One that is defined nowhere stays so.
    """
    defined = read_units(children(root, tag, "ssc:Unit"))
    if unit.name in defined:
        return relation(unit, defined[unit.name]) in ("same", "unknown")
    if unit.exponents is None:
        return True
    element = add(ensure(root, tag), "ssc:Unit", name=unit.name)
    powers = {name: str(power) for name, power in zip(BASE, unit.exponents, strict=True) if power}
    base = add(element, "ssc:BaseUnit", **powers)
    for name, neutral in (("factor", 1.0), ("offset", 0.0)):
        if getattr(unit, name) != neutral:
            base.set(name, repr(getattr(unit, name)))
    return True


def define_enumeration(root, name, items):
    """Name of an enumeration with these items in an SSD, defined there if there is none."""
    defined = read_enumerations(children(root, "ssd:Enumerations", "ssc:Enumeration"))
    for known, its in defined.items():
        if its == dict(items):
            return known
    free = unused(name, defined)
    element = add(ensure(root, "ssd:Enumerations"), "ssc:Enumeration", name=free)
    for item, value in items.items():
        add(element, "ssc:Item", name=item, value=str(value))
    return free


def unused(name, taken):
    """The name, with a number behind it where it is taken: ``line``, ``line_2``."""
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free
