"""Sound XML of systems made to go on for ever: few files or connectors that lead to ever more, or round in a circle."""

from conformance.texts import SPACES

HEAD = f'<ssd:SystemStructureDescription version="1.0" name="endless" {SPACES}><ssd:System name="endless">'
TAIL = "</ssd:System></ssd:SystemStructureDescription>"
BINDING = """<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
<ssv:ParameterSet version="1.0" name="values"><ssv:Parameters>
<ssv:Parameter name="s0.a"><ssv:Real value="1"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"""


def endless_systems(rng):
    """SSDs each of which contains the next one twice; the last one the first one, a missing one or none."""
    depth, last = rng.choice((3, 12, 30)), rng.choice(("SystemStructure.ssd", "missing.ssd", None))
    names = ["SystemStructure.ssd", *(f"s{i}.ssd" for i in range(1, depth)), last]
    return {name: _containing(inner) for name, inner in zip(names, names[1:], strict=False)}


def _containing(inner):
    parts = [
        f'<ssd:Component name="{n}" type="application/x-ssp-definition" source="{inner}"/>'
        for n in "ab"
    ]
    text = f"<ssd:Elements>{''.join(parts)}</ssd:Elements>" if inner else ""
    return f"{HEAD}{text}{TAIL}".encode()


def endless_connections(rng):
    """File of systems whose connectors fork and join again, perhaps in a circle, with a value set at the start."""
    depth, is_circle = rng.choice((5, 40, 400)), rng.random() < 0.5
    kind = rng.choice(("parameter", "input", "inout"))
    systems = "".join(_forking(f"s{i}", kind) for i in range(depth))
    links = "".join(
        f'<ssd:Connection startElement="s{i}" startConnector="{a}" endElement="s{(i + 1) % depth}" endConnector="{b}"/>'
        for i in range(depth if is_circle else depth - 1)
        for a, b in ("ca", "cb", "da", "db")
    )
    elements = f"<ssd:Elements>{systems}</ssd:Elements><ssd:Connections>{links}</ssd:Connections>"
    return {"SystemStructure.ssd": f"{HEAD}{BINDING}{elements}{TAIL}".encode()}


def _forking(name, kind):
    kinds = {"a": kind, "b": kind, "c": "output", "d": "output"}
    connectors = "".join(f'<ssd:Connector name="{n}" kind="{kind}"/>' for n, kind in kinds.items())
    pairs = ("ac", "ad", "bc", "bd")
    links = "".join(f'<ssd:Connection startConnector="{a}" endConnector="{b}"/>' for a, b in pairs)
    inside = (
        f"<ssd:Connectors>{connectors}</ssd:Connectors><ssd:Connections>{links}</ssd:Connections>"
    )
    return f'<ssd:System name="{name}">{inside}</ssd:System>'
