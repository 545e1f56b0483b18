"""Connectors of the outermost system as signals: type, unit and start value."""

from collections.abc import Iterable, Mapping

from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.flatten.hierarchy import Hierarchy
from shipcosim.ssp.flatten.ports import Key
from shipcosim.ssp.flatten.system import Component, Signal
from shipcosim.ssp.fmu.description import Variable
from shipcosim.ssp.xml.values import Value


class OuterSignals:
    """Connectors of the outermost system, completed from their connections.

    Parameters
    ----------
    tree : Hierarchy
        Has the connectors as ports.
    components : mapping of str to Component
        By full name.
    connections : iterable of Connection
        Between variables and the connectors.
    start : mapping of str to value
        Values set on the connectors, in their units.
    """

    def __init__(
        self,
        tree: Hierarchy,
        components: Mapping[str, Component],
        connections: Iterable[Connection],
        start: Mapping[str, Value],
    ):
        self.tree = tree
        self.components = components
        self.start = start
        self.connections = tuple(connections)

    def of(self, *kinds: str) -> dict[str, Signal]:
        """Signals of these kinds of connector, by name."""
        keys = [
            key
            for key, port in self.tree.ports.items()
            if key.path == () and port.owner == "system"
        ]
        return {key.name: self._signal(key) for key in keys if self.tree.ports[key].kind in kinds}

    def _signal(self, key: Key) -> Signal:
        port = self.tree.ports[key]
        # What the SSD leaves open is taken from the variables behind the connector.
        near = (None, key.name)
        pairs = [(c.target, c) for c in self.connections if c.source == near]
        pairs += [(c.source, c) for c in self.connections if c.target == near]
        ends = [
            (self.components[name].variables[variable], c) for (name, variable), c in pairs if name
        ]
        unit = (
            port.unit.name if port.unit else next((end.unit for end, _ in ends if end.unit), None)
        )
        start = self.start.get(key.name)
        if start is None and port.kind == "input":
            start = self._derived(ends)
        kind = port.type or next((end.kind for end, _ in ends), None)
        return Signal(key.name, kind, unit, port.description, start, port.items)

    def _derived(self, ends: list[tuple[Variable, Connection]]) -> Value | None:
        """Start of an input without one: that of the variables behind it, if they agree."""
        starts = set()
        for _, connection in ends:
            name, variable = connection.target
            # Invert the connection, source = (target - offset) / factor; a mapping cannot be
            # inverted.
            value = self.components[name or ""].start_value(variable)
            if value is None or connection.mapping is not None or connection.factor == 0.0:
                return None
            starts.add(
                (value - connection.offset) / connection.factor if connection.is_linear else value
            )
        return starts.pop() if len(starts) == 1 else None
