"""Connections from variable to variable, through nested systems and dictionaries."""

from collections.abc import Mapping
from dataclasses import dataclass

from shipcosim.ssp.flatten.conversions import Flow, advance
from shipcosim.ssp.flatten.hierarchy import Hierarchy
from shipcosim.ssp.flatten.ports import Key, Wire
from shipcosim.ssp.read.structure import End, label
from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.values import Value


@dataclass(frozen=True)
class Connection:
    """The value of a component's variable or of a system output, and its source.

    Values: ``target = factor * mapping.get(source, source) + offset``; factor and offset for a real target alone.
    Several connections into one target add up, in their order: a Sum of OSP. SSP has none.

    Parameters
    ----------
    source : tuple of (str or None, str)
        Component and variable; None and the name for an input of the outermost system.
    target : tuple of (str or None, str)
        Component and variable; None and the name for an output of the outermost system.
    factor, offset : float
        Unit conversions and linear transformations on the way, together.
    mapping : mapping or None
        Discrete values that change on the way: by number for enumerations.
    initial : bool
        Whether the target is a parameter: the value goes over once, at the start.
    place : str
        Where its last part stands, for messages.
    """

    source: End
    target: End
    factor: float = 1.0
    offset: float = 0.0
    mapping: Mapping[Value, Value] | None = None
    initial: bool = False
    place: str = ""

    @property
    def arrow(self) -> str:
        """The names of both ends, for messages."""
        return f"{label(self.source)} -> {label(self.target)}"

    @property
    def is_linear(self) -> bool:
        """Whether factor and offset change values; where not, they stay exact to the last bit."""
        return (self.factor, self.offset) != (1.0, 0.0)


def connect(tree: Hierarchy, findings: Findings) -> tuple[Connection, ...]:
    """Connections of a hierarchy.

    Parameters
    ----------
    tree : Hierarchy
        Ports and wires.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    tuple of Connection
    """
    # The wire into each port: SSP allows one source per input.
    incoming = {}
    for wire in tree.wires:
        if wire.target in incoming:
            first = incoming[wire.target]
            message = f"A second connection into {wire.target}. It gets {first.source} already ({first.place})."
            findings.error(wire.place, message, "Remove one of them.")
        else:
            incoming[wire.target] = wire
    # Trace back from each place where a value is used to where it comes from.
    connections = []
    for key, port in tree.ports.items():
        # A value is used at inputs of components and outputs of the root; elsewhere it is passed on.
        is_end = port.owner == "component" or (port.owner == "system" and key.path == ())
        if key in incoming and is_end:
            wires = _way(key, incoming, findings)
            # Nested connectors and dictionaries disappear: one connection from first source to last
            # target.
            if wires and (source := _source(wires[0].source, tree)) is not None:
                connections.append(_connection(wires, source, tree, findings))
    return tuple(connections)


def _way(key: Key, incoming: Mapping[Key, Wire], findings: Findings) -> list[Wire]:
    """Wires that lead to a port, the first one first; empty if they form a circle."""
    wires = []
    seen = set()
    # Go against the flow; a port seen twice is a circle without any component.
    while key in incoming:
        seen.add(key)
        wires.append(incoming[key])
        key = incoming[key].source
        if key in seen:
            findings.error(
                wires[0].place,
                "The connections go in a circle without a component.",
                "Remove one of them.",
            )
            return []
    return wires[::-1]


def _source(key: Key, tree: Hierarchy) -> End | None:
    """Component (None: the outermost system) and name of a source; None if there is no source."""
    port = tree.ports[key]
    if port.owner == "component":
        return ".".join(key.path), key.name
    return (None, key.name) if port.owner == "system" and key.path == () else None


def _connection(wires: list[Wire], source: End, tree: Hierarchy, findings: Findings) -> Connection:
    # Convert from wire to wire, then into the unit of the FMU's variable.
    first = tree.ports[wires[0].source]
    last = tree.ports[wires[-1].target]
    flow = Flow(first.type, first.variable_unit or first.unit, first.items)
    for wire in wires:
        what = wire.place, (str(wire.source), str(wire.target))
        flow = advance(flow, wire, tree.ports[wire.target], what, findings)
    flow = flow.in_unit(last.variable_unit or last.unit)
    key = wires[-1].target
    target = (".".join(key.path) if last.owner == "component" else None, key.name)
    # A connection into a parameter acts once, at the start.
    initial = last.owner == "component" and last.kind in ("parameter", "structuralParameter")
    return Connection(
        source, target, flow.factor, flow.offset, flow.mapping, initial, wires[-1].place
    )
