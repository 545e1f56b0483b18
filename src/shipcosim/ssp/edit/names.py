"""Elements of an SSD by their names as users write them: ``"ship.vessel"``, ``"vessel.psi"``."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import lxml.etree as etree

from shipcosim.errors import error_at, suggestion
from shipcosim.ssp.flatten.ports import SOURCES_OUTSIDE
from shipcosim.ssp.read.structure import KIND_NAMES
from shipcosim.ssp.xml.document import child, children, local, parts_in

ELEMENTS = ("Component", "SignalDictionaryReference", "System")


class NameMatch(NamedTuple):
    """One reading of a signal's name: a connector of an element, or (None) of the system itself."""

    system: etree._Element
    element: etree._Element | None
    connector: str

    @property
    def owner(self) -> etree._Element:
        """The element that has the connector."""
        return self.system if self.element is None else self.element

    @property
    def element_name(self) -> str | None:
        """Name of the element, as in a connection; None for the system itself."""
        return None if self.element is None else self.element.get("name")

    def declared(self) -> etree._Element | None:
        """The Connector element, or None."""
        return connector_of(self.owner, self.connector)

    def gives(self) -> bool | None:
        """True if a value comes from here; None if the connector has no clear direction."""
        # Seen from inside, an input of the system is a source.
        connector = self.declared()
        kind = None if connector is None else connector.get("kind")
        if kind not in KIND_NAMES or kind in ("inout", "unspecified"):
            return None
        return (kind in SOURCES_OUTSIDE) == (self.element is not None)


def parts(system: etree._Element) -> list[etree._Element]:
    """Elements that a system consists of."""
    listed = child(system, "ssd:Elements")
    return [] if listed is None else parts_in(listed, *ELEMENTS)


def walk(system: etree._Element, name: str = "") -> Iterator[tuple[str, etree._Element]]:
    """A system and everything in it, with full names; that of the outermost system is empty."""
    yield name, system
    for part in parts(system):
        inner = ".".join(filter(None, (name, part.get("name", ""))))
        if local(part) == "System":
            yield from walk(part, inner)
        else:
            yield inner, part


def connector_of(element: etree._Element, name: str) -> etree._Element | None:
    """Connector element of an element by its own name, or None."""
    listed = children(element, "ssd:Connectors", "ssd:Connector")
    return next((part for part in listed if part.get("name") == name), None)


def find_element(system: etree._Element, name: str) -> etree._Element | None:
    """Element by its full name, or None; the empty name means the outermost system."""
    return next((element for full_name, element in walk(system) if full_name == name), None)


def find_connector(system: etree._Element, name: str) -> etree._Element | None:
    """Connector element of a full name, or None."""
    declared = (reading.declared() for reading in readings(name, system))
    return next((connector for connector in declared if connector is not None), None)


def split_owner(system: etree._Element, name: str) -> tuple[etree._Element | None, str]:
    """System that something of a full name belongs to, or None, and its own name there."""
    outer, _, short = name.rpartition(".")
    owner = find_element(system, outer)
    return (owner if owner is not None and local(owner) == "System" else None), short


def connections(system: etree._Element) -> Iterator[tuple[tuple[str, str], etree._Element]]:
    """All connections, nested ones included: the full names of the two ends, and the element."""
    for name, element in walk(system):
        for connection in children(element, "ssd:Connections", "ssd:Connection"):
            # Full names of both ends, with the systems around them.
            ends = (
                (connection.get(f"{s}Element"), connection.get(f"{s}Connector"))
                for s in ("start", "end")
            )
            start, end = (".".join(filter(None, (name, *end))) for end in ends)
            yield (start, end), connection


def attached(
    system: etree._Element, name: str, is_element: bool
) -> Iterator[tuple[etree._Element, str]]:
    """Ends of connections at an element or, else, at a connector.

    Parameters
    ----------
    system : lxml element
        The outermost one.
    name : str
        Full name of the element or connector.
    is_element : bool
        Which of the two it is.

    Returns
    -------
    iterator of (lxml element, str)
        The connection, and its attribute with the name.
    """
    # Every end of every connection, in nested systems too.
    for owner, element in walk(system):
        for connection in children(element, "ssd:Connections", "ssd:Connection"):
            for side in ("start", "end"):
                # Compare the full name of the element, or of element and connector.
                at = [owner, connection.get(f"{side}Element"), connection.get(f"{side}Connector")]
                part = at[:2] if is_element else at
                if at[1 if is_element else 2] and ".".join(filter(None, part)) == name:
                    yield connection, f"{side}{'Element' if is_element else 'Connector'}"


def readings(signal: str, system: etree._Element) -> Iterator[NameMatch]:
    """Readings of a signal's name, which is ambiguous: elements and connectors may contain dots."""
    yield NameMatch(system, None, signal)
    for part in parts(system):
        start = f"{part.get('name')}."
        if signal.startswith(start):
            yield NameMatch(system, part, signal.removeprefix(start))
            if local(part) == "System":
                yield from readings(signal.removeprefix(start), part)


def best_pair(
    source: str,
    target: str,
    system: etree._Element,
    exists: Callable[[NameMatch], bool],
    where: str,
) -> tuple[NameMatch, NameMatch]:
    """Readings of two signals that a connection can join: in one system, existing if possible.

    Parameters
    ----------
    source, target : str
        Names of the signals.
    system : lxml element
        The outermost one.
    exists : callable
        Whether a reading means something that is there.
    where : str
        For messages.

    Raises
    ------
    ShipcosimError
        If one of them names an element that is not there, or the two can only be joined through systems between them.
    """
    # Only pairs within one system can be connected.
    pairs = [
        (start, end)
        for start in readings(source, system)
        for end in readings(target, system)
        if start[0] is end[0]
    ]
    # The most likely pair; what does not exist is explained by name.
    where = f"{where}: {source} -> {target}"
    start, end = max(pairs, key=lambda pair: sum(_likely(reading, exists) for reading in pair))
    for signal, reading in ((source, start), (target, end)):
        if exists(reading):
            continue
        # The signal exists, but in another system.
        if any(exists(other) for other in readings(signal, system)):
            remedy = "A connection stays within one system: go through connectors of the systems between."
            raise error_at(where, f"{signal} is in another system than the other end.", remedy)
        # The first part of its name is no element here; the check finds all else.
        if _names_an_element(reading):
            names = [part.get("name", "") for part in parts(system)]
            element = signal.partition(".")[0]
            raise error_at(
                where,
                f"There is no element '{element}' in {system.get('name')}.",
                suggestion(element, names),
            )
    return start, end


def _likely(reading: NameMatch, exists: Callable[[NameMatch], bool]) -> int:
    return 2 if exists(reading) else 0 if _names_an_element(reading) else 1


def _names_an_element(reading: NameMatch) -> bool:
    """True if a supposed connector's name looks like one of a component that does not exist."""
    return reading.element is None and "." in reading.connector
