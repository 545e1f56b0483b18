"""Units and enumerations that an SSP or FMI file defines: reading and adding."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import lxml.etree as etree

from shipcosim.ssp.xml.document import Document, Findings, children, parts_in, reporting
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
        If an exponent, factor or offset is no number, or the factor is 0.
    """
    units = {}
    for element in elements:
        # Exponents of the SI base units, with factor and offset.
        base = next(iter(parts_in(element, "BaseUnit")), None)
        name = element.get("name")
        if base is None or name is None or _says_nothing(element, base):
            continue
        exponents = tuple(int(base.get(symbol, 0)) for symbol in BASE_UNITS)
        unit = Unit(name, exponents, float(base.get("factor", 1.0)), float(base.get("offset", 0.0)))
        # No value can be converted with such numbers.
        if not unit.factor or not math.isfinite(unit.factor + unit.offset):
            raise ValueError(
                f"The unit '{name}' has the factor {unit.factor:g} and the offset {unit.offset:g}."
            )
        units[name] = unit
    return units


def _says_nothing(element: etree._Element, base: etree._Element) -> bool:
    """True if the base unit is empty although the unit's name commonly has a dimension."""
    usual = spelled_unit(element.get("name", ""))
    return not base.attrib and usual is not None and any(usual.exponents or ())


def noted_units(
    document: Document, elements: Iterable[etree._Element], findings: Findings
) -> dict[str, Unit]:
    """Units by name, as `read_units`, with remarks on their definitions.

    Parameters
    ----------
    document : Document
        The file.
    elements : iterable of lxml element
        Its Unit elements.
    findings : Findings
        Takes what is wrong.
    """
    units: dict[str, Unit] = {}
    for element in elements:
        name = element.get("name", "")
        with reporting(document, element, findings):
            for unit in read_units([element]).values():
                # The same definition twice does no harm.
                if units.setdefault(name, unit) != unit:
                    both = f"{units[name].definition} and {unit.definition}"
                    raise ValueError(f"The unit '{name}' is defined twice: {both}.")
                # The file's definition counts, also where the name commonly means something else.
                usual = None if name in AMBIGUOUS else spelled_unit(name)
                if usual is not None and contradicts(unit, usual):
                    message = f"'{name}' is defined as {unit.definition}; commonly it is {usual.definition}."
                    findings.remark(
                        document.place(element),
                        message,
                        "Correct the definition, or give the unit another name.",
                    )
        for base in parts_in(element, "BaseUnit"):
            if _says_nothing(element, base):
                message = f"The base unit of '{name}' is empty; the unit has its usual meaning."
                findings.flaw(
                    document.place(base), message, "State its exponents, or leave BaseUnit out."
                )
    return units


def read_enumerations(elements: Iterable[etree._Element]) -> dict[str, dict[str, int]]:
    """Items (name to value) of Enumeration elements of an SSP file, by the enumeration's name.

    Raises
    ------
    ValueError
        If an item's value is no whole number, or one name stands for two things.
    """
    return by_name(
        "enumeration",
        (
            (element.get("name", ""), _items_of(children(element, "ssc:Item")))
            for element in elements
        ),
    )


def _items_of(elements: Iterable[etree._Element]) -> dict[str, int]:
    return by_name(
        "item",
        ((item.get("name"), read_value("Integer", item.get("value", ""))) for item in elements),
    )


def by_name(what: str, pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Definitions of a file by their names.

    Raises
    ------
    ValueError
        If one name stands for two things. The same definition twice does no harm.
    """
    definitions: dict[str, Any] = {}
    for name, defined in pairs:
        if definitions.setdefault(name, defined) != defined:
            raise ValueError(
                f"The {what} '{name}' is defined twice: {definitions[name]} and {defined}."
            )
    return definitions


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
    for enumeration, its in defined.items():
        if its == dict(items):
            return enumeration
    free = free_name(name, defined)
    element = add(ensure(root, "ssd:Enumerations"), "ssc:Enumeration", name=free)
    for item, value in items.items():
        add(element, "ssc:Item", name=item, value=str(value))
    return free
