"""A component with an FMU: its connectors, compared with the FMU's variables."""

from dataclasses import replace

from shipcosim.errors import it_has
from shipcosim.ssp.flatten.array_elements import element_connectors
from shipcosim.ssp.flatten.bindings import take_bindings
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy, Surroundings
from shipcosim.ssp.flatten.ports import Key, Port, variable_port
from shipcosim.ssp.flatten.swapped import has_connector
from shipcosim.ssp.fmu.arrays import without_arrays
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.read.structure import KIND_NAMES, ComponentElement, Connector
from shipcosim.ssp.xml.document import Findings
from shipcosim.units import find_unit, relation, told_apart

CAUSALITIES = {
    "calculatedParameter": "calculated parameter",
    "structuralParameter": "structural parameter",
}
"""Kinds of connectors that are two words."""


def take_fmu(
    tree: Hierarchy, element: ComponentElement, path: ElementPath, place: Surroundings
) -> None:
    """Collect an FMU component: ports of its connectors, and values bound to it.

    Parameters
    ----------
    tree : Hierarchy
        Takes what is found and what is wrong.
    element : ComponentElement
        The component.
    path : tuple of str
        Its place.
    place : Surroundings
        Its surroundings.
    """
    fmu = _fmu_of(tree, element, path, place)
    tree.components[path] = element, fmu
    tree.arrays[path] = {} if fmu is None else dict(fmu.arrays)
    # Arrays of the FMU are laid out first; the SSD may declare further sizes.
    connectors, declared = element_connectors(element.connectors, tree.arrays[path], tree.findings)
    tree.arrays[path] |= declared
    swapped = ".".join(path) in tree.swapped
    # A swapped FMU may lack connectors. Whether they are needed is checked when all wires are
    # known.
    for connector in connectors:
        lacking = fmu is not None and swapped and not has_connector(fmu, connector)
        tree.ports[Key(path, connector.name)] = (
            _port(connector, None, tree.findings)
            if lacking
            else _port(connector, fmu, tree.findings)
        )
    if fmu is not None:
        # Note where an FMU does not offer what is asked of it: co-simulation, model exchange or either.
        wanted = element.implementation
        forms = ("CoSimulation", "ModelExchange") if wanted == "any" else (wanted,)
        if not any(form in fmu.interfaces for form in forms):
            tree.findings.error(
                element.place,
                f"{fmu.path.name} offers no {' and no '.join(forms)}.",
                f"It offers {', '.join(fmu.interfaces)}.",
            )
    # The component's own bindings come first: those of outer systems replace them.
    take_bindings(tree, element.bindings, path, place, near=True, fmu=fmu)


def _fmu_of(
    tree: Hierarchy, element: ComponentElement, path: ElementPath, place: Surroundings
) -> FmuDescription | None:
    if element.source is None:
        tree.findings.error(
            element.place, "It has no source: there is nothing to run.", "Name an FMU or a system."
        )
        return None
    # A swapped FMU takes the place of the component's own.
    file = tree.swapped.get(".".join(path)) or tree.library.file(element, element.source, place)
    fmu = tree.library.fmu(file, place.package) if file else None
    return fmu and without_arrays(fmu, element.place, tree.findings, tree.sizes.get(".".join(path)))


def _port(connector: Connector, fmu: FmuDescription | None, findings: Findings) -> Port:
    """Port of a component's connector, checked against the FMU."""
    variable = None if fmu is None else fmu.variables.get(connector.name)
    if fmu is None or variable is None:
        if fmu is not None:
            message = f"{fmu.path.name} has no {CAUSALITIES.get(connector.kind, connector.kind)} '{connector.name}'."
            names = fmu.named(connector.kind) or list(fmu.variables)
            findings.error(connector.place, message, it_has(connector.name, names))
        fields = (connector.kind, connector.type, "component", connector.unit, connector.items)
        return Port(*fields, place=connector.place)
    # The SSD may state its own unit and description; the FMU fills the gaps.
    _compare(connector, variable, fmu, findings)
    port = variable_port(variable, fmu, connector.place)
    description = connector.description or variable.description
    unit = connector.unit or port.unit
    items = connector.items or port.items
    return replace(port, unit=unit, items=items, description=description)


def _compare(
    connector: Connector, variable: Variable, fmu: FmuDescription, findings: Findings
) -> None:
    """Report a connector whose kind, type or unit differs from its variable's."""
    name = fmu.path.name
    place = connector.place
    if connector.kind in KIND_NAMES and connector.kind != variable.causality:
        message = f"The connector is of kind {connector.kind}, the variable in {name} of causality {variable.causality}."
        findings.error(place, message, f'Write kind="{variable.causality}".')
    if connector.type not in (None, variable.kind):
        message = f"The connector is of type {connector.type}, but in {name} the variable is {variable.type}."
        findings.error(place, message, f"Write <{variable.type}>, or leave the type out.")
    # Another unit is allowed if it can be converted; the conversion is noted.
    own_unit = find_unit(variable.unit, fmu.units)
    if own_unit is None or connector.unit is None:
        return
    related = relation(connector.unit, own_unit)
    given, wanted = told_apart(connector.unit, own_unit)
    message = f"The connector is in {given}, the variable in {name} in {wanted}"
    if related == "incompatible":
        findings.error(
            place, f"{message}; these cannot be converted.", f'Write unit="{own_unit.name}".'
        )
    elif related != "same":
        how = (
            "not converted, a definition is missing"
            if related == "unknown"
            else "values are converted"
        )
        findings.remark(place, f"{message}: {how}.")
