"""Units and enumerations that an SSP or FMI file defines: reading and adding."""

from collections.abc import Iterable, Mapping

import lxml.etree as etree

from shipcosim.ssp.xml.document import Document, Findings, children, local
from shipcosim.ssp.xml.markup import add, ensure, free_name
from shipcosim.ssp.xml.values import read_value
from shipcosim.units import AMBIGUOUS, BASE_UNITS, Unit, contradicts, relation, spelled_unit


def read_units(elements: Iterable[etree._Element]) -> dict[str, Unit]:
    """Units by name from Unit elements; those without a base unit are left out.

    An empty base unit is ignored if the unit's common spelling has a dimension: some tools write it
    everywhere.

    Raises
    ------
    ValueError
        If an exponent, factor or offset is no number.
    """
    units = {}
    for element in elements:
        # Exponents of the SI base units, with factor and offset.
        base = next((part for part in element if local(part) == "BaseUnit"), None)
        if (
            base is not None
            and element.get("name") is not None
            and not _says_nothing(element, base)
        ):
            exponents = tuple(int(base.get(name, 0)) for name in BASE_UNITS)
            scale = float(base.get("factor", 1.0)), float(base.get("offset", 0.0))
            units[element.get("name")] = Unit(element.get("name"), exponents, *scale)
    return units


def _says_nothing(element: etree._Element, base: etree._Element) -> bool:
    """True if the base unit is empty although the unit's name commonly has a dimension."""
    known = spelled_unit(element.get("name", ""))
    return not base.attrib and known is not None and any(known.exponents or ())


def note_units(document: Document, elements: Iterable[etree._Element], findings: Findings) -> None:
    """Report units with an empty base unit, which get their common meaning, and units that are defined as others."""
    for element in elements:
        _note_contradiction(document, element, findings)
        for base in (part for part in element if local(part) == "BaseUnit"):
            if _says_nothing(element, base):
                found = f"The base unit of '{element.get('name')}' says nothing; the unit is what it is commonly."
                findings.flaw(
                    document.place(base), found, "State its exponents, or leave BaseUnit out."
                )


def _note_contradiction(document: Document, element: etree._Element, findings: Findings) -> None:
    """Remark a unit whose definition is not what its name commonly means; the file's definition counts."""
    name = element.get("name", "")
    known = None if name in AMBIGUOUS else spelled_unit(name)
    try:
        defined = read_units([element]).get(name)
    except ValueError:
        return  # numbers that cannot be read are reported where all units are read
    if known is not None and defined is not None and contradicts(defined, known):
        found = f"'{name}' is defined as {defined.definition}; commonly it is {known.definition}."
        findings.remark(
            document.place(element), found, "Correct the definition, or give the unit another name."
        )


def read_enumerations(elements: Iterable[etree._Element]) -> dict[str, dict[str, int]]:
    """Items (name to value) of Enumeration elements of an SSP file, by the enumeration's name.

    Raises
    ------
    ValueError
        If an item's value is no whole number.
    """
    return {
        element.get("name", ""): {
            item.get("name"): read_value("Integer", item.get("value", ""))
            for item in children(element, "ssc:Item")
        }
        for element in elements
    }


def define_unit(root: etree._Element, tag: str, unit: Unit) -> bool:
    """Define a unit in a file if it is missing; false if its name means another unit there.

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
    # An existing definition must mean the same unit.
    if unit.name in defined:
        return relation(unit, defined[unit.name]) in ("same", "unknown")
    if unit.exponents is not None:
        element = add(ensure(root, tag), "ssc:Unit", name=unit.name)
        add(element, "ssc:BaseUnit", **unit.base_unit_attributes)
    return True


def define_enumeration(root: etree._Element, name: str, items: Mapping[str, int]) -> str:
    """Name of an enumeration with these items in an SSD; one is added if it is missing.

    Parameters
    ----------
    root : lxml element
        Of the SSD.
    name : str
        Wanted name of a new one; it gets a number behind it where it is taken.
    items : mapping of str to int
        Values by the items' names.
    """
    defined = read_enumerations(children(root, "ssd:Enumerations", "ssc:Enumeration"))
    # The same items serve under any name.
    for known, its in defined.items():
        if its == dict(items):
            return known
    free = free_name(name, defined)
    element = add(ensure(root, "ssd:Enumerations"), "ssc:Enumeration", name=free)
    for item, value in items.items():
        add(element, "ssc:Item", name=item, value=str(value))
    return free
