"""Connections of the extended system that carry a cause: with a factor or an offset, to a neighbour, or as named."""

from collections.abc import Iterable
from math import dist
from typing import Any

from shipcosim.diagnose.extension.draft import AXES, Estimated, ExtensionDraft, converted
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.cause import ExtensionRule, OnConnections
from shipcosim.diagnose.ship.third_party_fmu import DRIVES, third_party_fmu_of
from shipcosim.series import conversion
from shipcosim.ssp import Connection, System, SystemStructure


def put_on_connections(
    draft: ExtensionDraft,
    finding: Finding,
    component: str,
    estimate: ParameterEstimate,
    rule: OnConnections,
) -> None:
    """Put a factor on the loads of a component, or an offset on what drives it, since its FMU has no such parameter.

    Parameters
    ----------
    draft : ExtensionDraft
        Changed; a remark says what its connections have.
    finding : Finding
    component : str
    estimate : ParameterEstimate
    rule : OnConnections
    """
    system = draft.structure.checked()
    # Lost thrust: scale the connections of the component's loads to the ship.
    if rule.of == "loads":
        kept = 1.0 + rule.sign * converted(estimate, "1").value
        wanted = [
            c for c in system.connections if c.source[0] == component and c.target[0] == draft.ship
        ]
        new = [(c, kept * c.factor, kept * c.offset) for c in wanted]
        change = f"factor {kept:.3f} on the connections of its loads"
    else:
        # Error of an order: shift what the connection gives to the thruster's input, in the unit of
        # the input.
        off = rule.sign * converted(estimate, DRIVES[rule.of]).value
        fmu = third_party_fmu_of(system, component, draft.ship)
        links = {link.variable: link for link in fmu.links if link.quantity == rule.of}
        wanted = [
            c for c in system.connections if c.target[0] == component and c.target[1] in links
        ]
        new = [(c, c.factor, c.offset + links[c.target[1]].factor * off) for c in wanted]
        change = f"offset of {off:.4g} {DRIVES[rule.of]} on the connection of its {rule.of}"
    # A connection inside a nested system cannot be replaced from here.
    pairs = set(draft.structure.connections)
    if not new or any(_ends(c) not in pairs for c, *_ in new):
        draft.remark(
            finding, f"the connections of '{component}' are not in one system, so it is not carried"
        )
        return
    for fmu in new:
        _rejoin(draft.structure, system, *fmu)
    draft.remark(finding, f"carried as {change}")


def _ends(connection: Connection) -> tuple[str, str]:
    """Names of what a connection joins."""
    first, second = (
        name if owner is None else f"{owner}.{name}"
        for owner, name in (connection.source, connection.target)
    )
    return first, second


def _rejoin(
    structure: SystemStructure, system: System, connection: Connection, factor: float, offset: float
) -> None:
    """Connect the same ends with another factor and offset, conversion of units included."""
    source, target = _ends(connection)
    # The file's factor and offset come after the conversion of units: divide it out.
    per, zero = conversion(_unit(system, connection.source), _unit(system, connection.target))
    structure.disconnect(source, target)
    structure.connect(source, target, factor=factor / per, offset=offset - factor / per * zero)


def _unit(system: System, end: tuple[str | None, str]) -> str | None:
    owner, name = end
    return (
        system.inputs[name].unit if owner is None else system.components[owner].variables[name].unit
    )


def _number(value: Any) -> float:
    """A value of a parameter that has to be a number."""
    if not isinstance(value, (int, float)):
        raise ValueError(f"{value!r} is no number")
    return value


def connect_neighbours(
    draft: ExtensionDraft, finding: Finding, rule: ExtensionRule, units: Iterable[str]
) -> None:
    """Give each thruster the place of its neighbour, and its speed and angle: the connected neighbour, else the nearest.

    Parameters
    ----------
    draft : ExtensionDraft
        Changed.
    finding : Finding
    rule : ExtensionRule
        With `neighbour_inputs` and `neighbour_place`.
    units : iterable of str
        The thrusters.
    """
    values = draft.structure.parameters
    wired = set(draft.structure.connections)
    feeds = {target for _, target in wired}
    units = list(units)
    # Sort the other thrusters: the one wired to this unit first, then by distance.
    place = {unit: (_number(values[f"{unit}.x"]), _number(values[f"{unit}.y"])) for unit in units}
    for unit in units:
        here = place[unit]
        inputs = {f"{unit}.{name}" for name in rule.neighbour_inputs}
        fed = {source.rpartition(".")[0] for source, target in wired if target in inputs}
        others = sorted(
            (o for o in units if o != unit), key=lambda o: (o not in fed, dist(place[o], here))
        )
        if not others:
            draft.remark(finding, f"'{unit}' has no neighbour")
            continue
        # Only inputs that nothing feeds yet are connected.
        for into, output in rule.neighbour_inputs.items():
            if f"{unit}.{into}" not in feeds:
                draft.structure.connect(f"{others[0]}.{output}", f"{unit}.{into}")
        for name, there in zip(rule.neighbour_place or (), place[others[0]], strict=False):
            if values[f"{unit}.{name}"] != there:
                draft.put(
                    finding, f"{unit}.{name}", Estimated(there), "m", note=f"where {others[0]} is"
                )


def rewire(draft: ExtensionDraft, name: str) -> None:
    """Connect a thruster's loads to the ship, and its inputs to the system's, as their names say."""
    structure = draft.structure
    loads = {f"{name}.tau_{axis}" for axis in AXES}
    # All loads of the thruster on the ship: each axis is connected again to the slot that most of
    # them use.
    wrong = [
        pair
        for pair in structure.connections
        if pair[0] in loads and pair[1].startswith(f"{draft.ship}.tau_")
    ]
    slots = [target.rpartition("_")[2] for _, target in wrong]
    for pair in wrong:
        structure.disconnect(*pair)
    for axis in AXES if wrong else ():
        structure.connect(
            f"{name}.tau_{axis}", f"{draft.ship}.tau_{axis}_{max(slots, key=slots.count)}"
        )
    # Inputs of the same kind from the system, but named after another thruster.
    for source, target in structure.connections:
        kind = target.removeprefix(f"{name}.").removesuffix("_in")
        if target == f"{name}.{kind}_in" and source.endswith(f"_{kind}") and "." not in source:
            structure.disconnect(source, target)
            structure.connect(f"{name}_{kind}", target)
