"""Convert values from port to port: units, linear transformations, mapping tables, types."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from shipcosim.errors import it_has
from shipcosim.ssp.flatten.ports import Port, Setting, Wire
from shipcosim.ssp.read.parameters import Transformation
from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.values import Value
from shipcosim.units import Unit, contradicts, conversion, relation, told_apart

TAKES = {
    "Real": ("Real", "Integer"),
    "Integer": ("Integer", "Enumeration"),
    "Enumeration": ("Enumeration", "Integer"),
}
"""Types that a type takes without loss; all others take their own alone."""

Items = Mapping[str, int]
"""Items of an enumeration: values by name."""


@dataclass(frozen=True)
class Flow:
    """A value under way: factor * mapping[source] + offset, in `unit`.

    Parameters
    ----------
    type : str or None
        Real, Integer, ...; None while no port has stated it.
    unit : Unit or None
        Of the value so far.
    items : mapping of str to int
        Of an enumeration.
    factor, offset : float
        So far, from the source's unit to `unit`.
    mapping : mapping or None
        Of discrete values, before factor and offset; values not in it stay as they are.
    """

    type: str | None
    unit: Unit | None = None
    items: Items = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0
    mapping: Mapping[Value, Value] | None = None

    def __call__(self, value: Value) -> Value:
        """Target's value of a source's value."""
        if self.mapping is not None:
            value = self.mapping.get(value, value)
        if self.type == "Real":
            return self.factor * value + self.offset
        return value

    def scaled(self, factor: float, offset: float) -> "Flow":
        """This flow followed by a linear step."""
        # a (f x + o) + b = (a f) x + (a o + b).
        return replace(self, factor=factor * self.factor, offset=factor * self.offset + offset)

    def in_unit(self, unit: Unit | None) -> "Flow":
        """Converted to a unit; unchanged if the unit is unknown."""
        if unit is None:
            return self
        return replace(self.scaled(*conversion(self.unit, unit)), unit=unit)


def advance(
    flow: Flow,
    wire: Wire | Setting,
    port: Port,
    what: tuple[str, tuple[str, str]],
    findings: Findings,
) -> Flow:
    """Flow after a wire or a mapping entry.

    Units are converted as late as possible, so that what comes back to its unit comes back to its value.

    Parameters
    ----------
    flow : Flow
        Before.
    wire : Wire or Setting
        Has `transformation` and `suppress_unit_conversion`.
    port : Port
        Where it leads.
    what : tuple of str and tuple of two str
        Place, and the names of source and target, for messages.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Flow
    """
    place, names = what
    # After an error take the port's type, so that one mistake gives one message.
    if (
        port.type is not None
        and flow.type is not None
        and flow.type not in TAKES.get(port.type, (port.type,))
    ):
        is_value = names[0] == "the value"
        remedy = f"Write <{port.type}>." if is_value else "Connect equal types."
        findings.error(place, f"{names[0]} is {flow.type}, {names[1]} is {port.type}.", remedy)
        return replace(flow, type=port.type)
    # Without conversion the number stays and counts in the port's unit.
    if wire.suppress_unit_conversion:
        flow = replace(flow, unit=port.unit)
    _compare_units(flow, port, place, names, findings)
    # A mapping table replaces discrete values.
    transformation = wire.transformation
    if transformation is not None and transformation.kind != "Linear":
        flow = _mapped(flow, transformation, port, place, findings)
    flow = _items_checked(flow, port, transformation, place, findings)
    # What the port does not state is carried along from before.
    flow = replace(
        flow,
        type=port.type or flow.type,
        unit=flow.unit or port.unit,
        items=port.items or flow.items,
    )
    # A linear transformation works on the number in the port's unit.
    if transformation is not None and transformation.kind == "Linear":
        if flow.type not in ("Real", None):
            findings.error(
                place,
                f"A linear transformation of {flow.type} values.",
                "It is for Real; use a mapping transformation.",
            )
        return flow.in_unit(port.unit).scaled(transformation.factor, transformation.offset)
    return flow


def _compare_units(
    flow: Flow, port: Port, place: str, names: tuple[str, str], findings: Findings
) -> None:
    if flow.unit is None or port.unit is None:
        return
    # Units may be equal, convertible, of unknown definition, or incompatible.
    related = relation(flow.unit, port.unit)
    # Where one name has two definitions, only the definitions tell what differs.
    given, wanted = told_apart(flow.unit, port.unit)
    message = f"{names[0]} is in {given}, {names[1]} in {wanted}"
    if flow.unit.name == port.unit.name and related == "convertible":
        if contradicts(flow.unit, port.unit):
            findings.remark(
                place,
                f"{message}: one name, two definitions. The value is converted from one to the other.",
                "Correct the definition that is wrong.",
            )
        return
    if related == "incompatible":
        remedy = (
            "Correct the unit."
            if names[0] == "the value"
            else "Connect like quantities or correct a unit."
        )
        findings.error(place, f"{message}; these cannot be converted.", remedy)
    elif related == "unknown":
        findings.remark(
            place,
            f"{message}: not converted, the definition of one of them is missing.",
            "Add it to Units.",
        )
    elif related == "angle":
        findings.remark(place, f"{message}: taken as equal kinds, with 1 rad = 1.")


def _mapped(
    flow: Flow, transformation: Transformation, port: Port, place: str, findings: Findings
) -> Flow:
    kind = transformation.kind
    allowed = {
        "Boolean": ("Boolean",),
        "Integer": ("Integer", "Enumeration"),
        "Enumeration": ("Enumeration",),
    }[kind]
    # A table fits discrete types of its own kind only.
    if flow.type not in (*allowed, None) or port.type not in (*allowed, None):
        findings.error(
            place,
            f"A mapping of {kind} values between {flow.type} and {port.type}.",
            "Take the one that fits.",
        )
        return flow
    table = transformation.table
    # Connections carry numbers, so names of items are translated into numbers here.
    if kind == "Enumeration":
        # Table of numbers from a table of item names.
        target = port.items or flow.items
        for names, items in ((table, flow.items), (table.values(), target)):
            for name in names:
                if name not in items:
                    findings.error(
                        place, f"The enumeration has no item '{name}'.", it_has(name, items)
                    )
        table = {
            flow.items[a]: target[b] for a, b in table.items() if a in flow.items and b in target
        }
    elif port.items:
        _check_numbers(table, flow.items, port.items, place, findings)
    # Chain the tables: what came out of the earlier one goes through this one.
    before = flow.mapping or {}
    after = {value: table.get(between, between) for value, between in before.items()}
    return replace(flow, mapping={**table, **after})


def _check_numbers(
    table: Mapping, source: Items, target: Items, place: str, findings: Findings
) -> None:
    """Check that a mapping of numbers gives items of the target."""
    # Values outside the table pass unchanged.
    made = {table.get(value, value) for value in (source.values() or table)}
    if lost := sorted(made - set(target.values())):
        message = f"The mapping gives {', '.join(map(str, lost))}, which the target's enumeration has not."
        findings.error(
            place,
            message,
            f"It has: {', '.join(f'{name} ({value})' for name, value in target.items())}.",
        )


def _items_checked(
    flow: Flow, port: Port, transformation: Transformation | None, place: str, findings: Findings
) -> Flow:
    """Check that two enumerations agree in their numbers, unless a mapping is given."""
    if not flow.items or not port.items or transformation is not None:
        return flow
    # A number must exist in the target, and mean the item of the same name.
    lost = sorted(set(flow.items.values()) - set(port.items.values()))
    if lost:
        message = f"Values {', '.join(map(str, lost))} of the source's enumeration do not exist in the target's."
        findings.error(place, message, "Add an EnumerationMappingTransformation.")
    elif any(port.items.get(name, value) != value for name, value in flow.items.items()):
        findings.error(
            place,
            "Items of the same name have different values.",
            "Add an EnumerationMappingTransformation.",
        )
    return flow
