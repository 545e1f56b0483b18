"""Connectors and connections that other tools read differently.

Each function takes a Subject and yields (place, description); an empty text: the feature's words.
"""

from math import isclose

from shipcosim.ssp.flatten.ports import Key, Port
from shipcosim.ssp.portability.subject import Found, Subject, elements_of, types_of_2
from shipcosim.ssp.read.parameters import Transformation
from shipcosim.ssp.read.structure import label
from shipcosim.ssp.xml.document import local


def reversed_links(subject: Subject) -> Found:
    """A connection written from input to output."""
    # Compare with the direction in which values flow.
    wires = {(wire.source, wire.target) for wire in subject.tree.wires}
    for link, _, _ in subject.links:
        start = Key((link.start_element or "",), link.start_connector)
        if (Key((link.end_element or "",), link.end_connector), start) in wires:
            yield link.place, ""


def undeclared_connectors(subject: Subject) -> Found:
    """A connector that only the FMU declares."""
    # Connectors that the SSD declares; others exist in the FMU only.
    declared = {
        (part.name, connector.name)
        for part in subject.elements
        for connector in getattr(part, "connectors", ())
    }
    for link, _, _ in subject.links:
        for end in link.ends:
            if end not in declared:
                yield link.place, f"{label(end)} is not declared as a connector"


def typeless_connectors(subject: Subject) -> Found:
    """A connector without a type."""
    for part in subject.components:
        yield from (
            (connector.place, "") for connector in part.connectors if connector.type is None
        )


def connectors_of_2(subject: Subject) -> Found:
    """A connector of a type of SSP 2.0."""
    for part in elements_of(subject, "Connector"):
        yield from (
            (subject.document.place(part), f"a connector of type {name}")
            for name in types_of_2(part)
        )


def enumeration_connectors(subject: Subject) -> Found:
    """A connector that is an enumeration."""
    for part in subject.components:
        yield from (
            (connector.place, "")
            for connector in part.connectors
            if connector.type == "Enumeration"
        )


def different_types(subject: Subject) -> Found:
    """A connection between different types."""
    for link, start, end in subject.links:
        kinds = _kinds(start, end)
        if len(kinds) == 2 and kinds[0] != kinds[1]:
            yield link.place, f"a connection between {kinds[0]} and {kinds[1]}"


def _kinds(*ports: Port | None) -> list[str]:
    """Types of ports as the FMUs declare them, where they do."""
    return [port.variable.kind for port in ports if port is not None and port.variable is not None]


def enumeration_connections(subject: Subject) -> Found:
    """A connection of enumerations."""
    for link, *ports in subject.links:
        if "Enumeration" in _kinds(*ports):
            yield link.place, ""


def parameter_connections(subject: Subject) -> Found:
    """A connection into a parameter."""
    # Connections that act at initialisation only.
    initial = {(c.source, c.target): c for c in subject.system.connections if c.initial}
    for link, _, _ in subject.links:
        if link.ends in initial or link.ends[::-1] in initial:
            yield link.place, ""


def mappings(subject: Subject) -> Found:
    """A Boolean, integer or enumeration mapping."""
    for link, _, _ in subject.links:
        if link.transformation is not None and link.transformation.kind != "Linear":
            yield link.place, f"a mapping of {link.transformation.kind} values"


def linear_without_factor(subject: Subject) -> Found:
    """A linear transformation without a factor."""
    for part in elements_of(subject, "LinearTransformation"):
        if part.get("factor") is None and local(part.getparent()) == "Connection":
            yield subject.document.place(part), ""


def unit_conversions(subject: Subject) -> Found:
    """Connections whose whole transformation differs from the written one."""
    # The flat connection includes unit conversions; the written one does not.
    flat = {(c.source, c.target): c for c in subject.system.connections}
    for link, _, _ in subject.links:
        start, end = link.ends
        whole = flat.get((start, end)) or flat.get((end, start))
        how = link.transformation or Transformation()
        if whole is None or how.kind != "Linear":
            continue
        pairs = zip((how.factor, how.offset), (whole.factor, whole.offset), strict=True)
        if not all(isclose(first, other, rel_tol=1e-12) for first, other in pairs):
            yield (
                link.place,
                f"a conversion of units, {whole.factor:.6g} times the value plus {whole.offset:.6g}",
            )
