"""Visit the nested elements of an SSD and collect them in a Hierarchy."""

from dataclasses import replace

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.ssp.flatten.array_elements import element_connectors, element_links
from shipcosim.ssp.flatten.bindings import take_bindings
from shipcosim.ssp.flatten.dictionaries import dictionaries_of, join_dictionaries, take_reference
from shipcosim.ssp.flatten.fmu_component import take_fmu
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy, Surroundings
from shipcosim.ssp.flatten.ports import Key, Port
from shipcosim.ssp.flatten.swapped import take_swapped
from shipcosim.ssp.flatten.wires import wire_of
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.structure import (
    FMU,
    SSD,
    SSP,
    Binding,
    ComponentElement,
    DictionaryReference,
    Structure,
    SystemElement,
)

MOST_SYSTEMS = 10_000  # a few files that include each other can describe more than any memory holds

OuterBindings = tuple[tuple[tuple[Binding, ...], Surroundings], ...]
"""Parameter bindings of a component that is a system of its own, with the surroundings that their addresses are in."""


def take_in(tree: Hierarchy, structure: Structure, package: Package) -> None:
    """Collect the outermost system of an SSD and everything in it.

    Parameters
    ----------
    tree : Hierarchy
        Takes what is found and what is wrong.
    structure : Structure
        The SSD.
    package : Package
        Where its files are.

    Raises
    ------
    ShipcosimError
        If it has more systems than any memory holds.
    """
    tree.library.packages.append(package)
    system = structure.system
    _take_system(tree, system, (), Surroundings(structure, package, (), (system.place,)), ())
    join_dictionaries(tree)
    take_swapped(tree)


def _take_system(
    tree: Hierarchy,
    element: SystemElement,
    path: ElementPath,
    place: Surroundings,
    outer_bindings: OuterBindings,
) -> None:
    tree.systems[path] = element
    # Files that include each other may describe an endless hierarchy.
    if len(tree.systems) > MOST_SYSTEMS:
        too_many = Problem(
            element.place, f"There are more than {MOST_SYSTEMS} systems.", "Take some away."
        )
        raise ShipcosimError([*dict.fromkeys(tree.findings.errors), too_many])
    # Dictionaries of this system come before those of outer ones.
    place = replace(
        place, dictionaries=(dictionaries_of(tree, element, path, place), *place.dictionaries)
    )
    connectors, tree.arrays[path] = element_connectors(element.connectors, {}, tree.findings)
    # Ports of the system first, then its elements, then the connections between them.
    for connector in connectors:
        fields = (connector.kind, connector.type, "system", connector.unit, connector.items)
        port = Port(*fields, description=connector.description, place=connector.place)
        tree.ports[Key(path, connector.name)] = port
    for part in element.elements:
        inner = (*path, part.name)
        if isinstance(part, SystemElement):
            _take_system(tree, part, inner, place, ())
        elif isinstance(part, DictionaryReference):
            take_reference(tree, part, inner, place)
        else:
            _take_component(tree, part, inner, place)
    for link in element.links:
        # Wires of a connection; one per element for arrays.
        owners = [
            tree.arrays.get(path if owner is None else (*path, owner), {}) for owner, _ in link.ends
        ]
        start, end = (
            connectors.get(name, ())
            for connectors, (_, name) in zip(owners, link.ends, strict=True)
        )
        for single in element_links(link, start, end, tree.findings):
            wire = wire_of(single, element, path, tree)
            tree.wires += [] if wire is None else [wire]
    # Bindings from the inside out: outer values are applied later and win.
    take_bindings(tree, element.bindings, path, place)
    for bindings, outer in outer_bindings:
        take_bindings(tree, bindings, path, outer)


def _take_component(
    tree: Hierarchy, element: ComponentElement, path: ElementPath, place: Surroundings
) -> None:
    if element.type in (SSD, SSP):
        _take_other_file(tree, element, path, place)
    elif element.type == FMU:
        take_fmu(tree, element, path, place)
    else:
        tree.findings.error(
            element.place,
            f"Components of type '{element.type}' are not known.",
            f"Known are {FMU}, {SSD}, {SSP}.",
        )
        tree.components[path] = element, None


def _take_other_file(
    tree: Hierarchy, element: ComponentElement, path: ElementPath, place: Surroundings
) -> None:
    """Treat a component that is a system elsewhere as if it stood here."""
    target = _system_of(tree, element, place)
    # A file that contains itself would never end.
    if target is not None and target[1].place in place.around:
        tree.findings.error(
            element.place, f"'{element.source}' contains itself.", "Break the circle."
        )
        target = None
    if target is None:
        tree.components[path] = element, None
        return
    structure, system, package = target
    # The inner system keeps its own file for addresses, but sees the outer dictionaries.
    inner = Surroundings(structure, package, place.dictionaries, (*place.around, system.place))
    _take_system(tree, system, path, inner, ((element.bindings, place),))


def _system_of(
    tree: Hierarchy, element: ComponentElement, place: Surroundings
) -> tuple[Structure, SystemElement, Package] | None:
    """System that a component stands for, with its SSD and package; None with an error."""
    # An address without a file means a system in this SSD, by its id.
    uri, _, fragment = (element.source or "").partition("#")
    if not uri:
        system = _with_id(place.structure.system, fragment)
        if system is None:
            tree.findings.error(
                element.place, f"No system in this file has the id '{fragment}'.", "Give it one."
            )
        return system and (place.structure, system, place.package)
    file = tree.library.file(element, uri, place)
    if file is None:
        return None
    package = place.package
    # An SSP is an archive of its own with an SSD inside.
    name = file
    if element.type == SSP:
        shown = place.package.show(file)
        address = f"{file}#{fragment}" if fragment else file
        package = tree.library.package(address, place.package.fmus, shown)
        if package is None:
            return None
        name = package.folder / package.ssd
    structure = tree.library.structure(package, name)
    return structure and (structure, structure.system, package)


def _with_id(system: SystemElement, wanted: str) -> SystemElement | None:
    if system.id == wanted:
        return system
    inner = (_with_id(part, wanted) for part in system.elements if isinstance(part, SystemElement))
    return next((candidate for candidate in inner if candidate is not None), None)
