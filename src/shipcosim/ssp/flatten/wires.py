"""Turn connection elements into wires: find the connectors and the direction of the value."""

from collections.abc import Mapping
from typing import NamedTuple

from shipcosim.errors import it_has, suggestion
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy
from shipcosim.ssp.flatten.ports import (
    FREE,
    SOURCES_INSIDE,
    SOURCES_OUTSIDE,
    Key,
    Wire,
    variable_port,
)
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.structure import KIND_NAMES, Link, SystemElement, label
from shipcosim.ssp.xml.document import Findings

FEEDS = {
    "parameter": ("parameter", "structuralParameter", "calculatedParameter", "constant"),
    "structuralParameter": ("structuralParameter", "constant"),
    "calculatedParameter": ("parameter", "structuralParameter", "calculatedParameter", "constant"),
    "constant": ("constant",),
}
"""Kinds that may feed a kind, where not all may. SSP 2.0, table of allowed connections."""


class End(NamedTuple):
    """One end of a connection: element (None: the system), connector, and its port."""

    element: str | None
    name: str
    key: Key

    def __str__(self) -> str:
        return label((self.element, self.name))

    def gives(self, kind: str) -> bool:
        """True if this kind gives a value: an element's output or the system's input."""
        return (kind in SOURCES_OUTSIDE) == (self.element is not None)


def wire_of(link: Link, system: SystemElement, path: ElementPath, tree: Hierarchy) -> Wire | None:
    """Wire of a connection.

    Parameters
    ----------
    link : Link
        As written.
    system : SystemElement
        That it is in.
    path : tuple of str
        Of the system.
    tree : Hierarchy
        With the ports of the system and its elements; takes what is wrong, and ports that only the FMU knew.

    Returns
    -------
    Wire, or None with an error
    """
    ends = [
        End(element, name, Key(path if element is None else (*path, element), name))
        for element, name in link.ends
    ]
    # Both ends are checked before returning, so that both are reported.
    exist = [_exists(end, ends, link, system, tree) for end in ends]
    if not all(exist):
        return None
    kinds = {end: tree.ports[end.key].kind for end in ends}
    if any(kind not in KIND_NAMES for kind in kinds.values()):
        return None  # the schema has said so
    # SSP lets connections be written either way round: the kinds decide the direction.
    directed = _directed(ends, kinds, link, tree.findings)
    if directed is None:
        return None
    source, target = directed
    return Wire(
        source.key, target.key, link.transformation, link.suppress_unit_conversion, link.place
    )


def _directed(
    ends: list[End], kinds: Mapping[End, str], link: Link, findings: Findings
) -> tuple[End, End] | None:
    """Source and target, or None with an error."""
    start, end = ends
    # Try both directions. Kinds without a direction (inout) fit either way.
    for source, target in ((start, end), (end, start)):
        gives = kinds[source] in FREE or source.gives(kinds[source])
        takes = kinds[target] in FREE or not target.gives(kinds[target])
        feeding = FEEDS.get(kinds[target], KIND_NAMES)
        if gives and takes and kinds[source] not in (*FREE, *feeding):
            findings.error(
                link.place,
                f"{source} ({kinds[source]}) cannot feed {target} ({kinds[target]}).",
                f"Feed it from one of: {', '.join(feeding)}.",
            )
            return None
        if gives and takes:
            return source, target
    which = (
        "give a value, and neither takes one"
        if start.gives(kinds[start])
        else "take a value, and neither gives one"
    )
    findings.error(
        link.place,
        f"{start} ({kinds[start]}) and {end} ({kinds[end]}): both {which}.",
        "Connect an output to an input.",
    )
    return None


def _exists(end: End, ends: list[End], link: Link, system: SystemElement, tree: Hierarchy) -> bool:
    """True if an end's port exists; else an error, unless its FMU is missing anyway."""
    if end.key in tree.ports:
        return True
    names = [part.name for part in system.elements]
    if end.element is not None and end.element not in names:
        tree.findings.error(
            link.place,
            f"There is no element '{end.element}' in {system.name}.",
            suggestion(end.element, names),
        )
        return False
    # The FMU may have the variable although the SSD declares no connector: accept it.
    component, fmu = tree.components.get(end.key.path, (None, None))
    if fmu is not None and end.name in fmu.variables:
        port = variable_port(fmu.variables[end.name], fmu, link.place)
        tree.ports[end.key] = port
        tree.findings.remark(
            link.place,
            f"{end} is not declared as a connector; it is taken from {fmu.path.name}.",
            f'Add <Connector name="{end.name}" kind="{port.kind}"/>.',
        )
        return True
    if component is None or fmu is not None:
        wanted, there = _wanted(end, ends, fmu, tree)
        owner = end.element or system.name
        tree.findings.error(
            link.place, f"{owner} has no {wanted} '{end.name}'.", it_has(end.name, there)
        )
    return False


def _wanted(
    end: End, ends: list[End], fmu: FmuDescription | None, tree: Hierarchy
) -> tuple[str, list[str]]:
    """Kind of connector that is missing at an end, from the other end, and the available names of this kind."""
    other = ends[0] if end is ends[1] else ends[1]
    seeks_source = end is ends[0]
    if other.key in tree.ports:
        seeks_source = not other.gives(tree.ports[other.key].kind)
    kinds = SOURCES_OUTSIDE if seeks_source == (end.element is not None) else SOURCES_INSIDE
    have = {key.name: port.kind for key, port in tree.ports.items() if key.path == end.key.path}
    have |= (
        {}
        if fmu is None
        else {name: variable.causality for name, variable in fmu.variables.items()}
    )
    for wanted in kinds:
        if names := [name for name, kind in have.items() if kind == wanted]:
            return wanted, names
    return "connector", list(have)
