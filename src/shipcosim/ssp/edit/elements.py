"""Find elements, systems and connectors of an SSD by full name; add, remove and rename them."""

from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import suggestion
from shipcosim.ssp.edit.connectors import declare_variable
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.names import attached, find_connector, find_element, split_owner, walk
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.structure import FMU
from shipcosim.ssp.xml.document import children, local, parent_of
from shipcosim.ssp.xml.markup import add, add_osp, drop, ensure


def element_named(draft: Draft, name: str) -> etree._Element:
    """Element of a full name; the outermost system for an empty one.

    Parameters
    ----------
    draft : Draft
        The system.
    name : str
        Full name.

    Returns
    -------
    lxml element

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    element = find_element(draft.system, name)
    if element is None:
        raise draft.error(name, "There is no such element.", suggestion(name, _elements(draft)))
    return element


def system_for(draft: Draft, name: str) -> tuple[etree._Element, str]:
    """System that a new element belongs to by its full name, and its short name there.

    Parameters
    ----------
    draft : Draft
        The system.
    name : str
        Full name of what is new.

    Returns
    -------
    tuple of lxml element and str

    Raises
    ------
    ShipcosimError
        If there is no such system.
    """
    owner, short = split_owner(draft.system, name)
    if owner is None:
        systems = [
            full_name
            for full_name, part in walk(draft.system)
            if full_name and local(part) == "System"
        ]
        outer = name.rpartition(".")[0]
        raise draft.error(
            name, f"There is no system '{outer}' to put it into.", suggestion(outer, systems)
        )
    return owner, short


def add_element(draft: Draft, name: str, tag: str, **attributes: str | None) -> etree._Element:
    """Add an element without content.

    Parameters
    ----------
    draft : Draft
        The system.
    name : str
        Full name of the new element.
    tag : str
        Component or System.
    **attributes : str or None
        Of the element; None: left out.

    Returns
    -------
    lxml element

    Raises
    ------
    ShipcosimError
        If there is no system to put it into, or the name is taken.
    """
    owner, short = system_for(draft, name)
    if name in _elements(draft):
        raise draft.error(
            name, f"{owner.get('name')} has an element '{short}' already.", "Names must differ."
        )
    return add(ensure(owner, "ssd:Elements"), f"ssd:{tag}", name=short, **attributes)


def add_component(
    draft: Draft,
    name: str,
    file: Path,
    fmu: FmuDescription,
    kinds: tuple[str, ...],
    implementation: str | None,
    step_size: float | None,
) -> None:
    """Add a component of an FMU; see `SystemStructure.add_component`."""
    source = draft.resource(file)
    element = add_element(
        draft, name, "Component", type=FMU, source=source, implementation=implementation
    )
    for variable in fmu.variables.values():
        if variable.causality in kinds:
            declare_variable(element, variable, fmu, draft.root)
    if step_size is not None:
        add_osp(draft.root, element, "StepSizeHint", value=repr(float(step_size)))


def remove(draft: Draft, name: str) -> None:
    """Remove an element or connector with its connections; see `SystemStructure.remove`."""
    # Connections to it first, then the element, then its values in parameter sets.
    is_element = name in _elements(draft)
    named = element_named(draft, name) if is_element else _connector_named(draft, name)
    ends = attached(draft.system, name, is_element)
    for connection in dict.fromkeys(connection for connection, _ in ends):
        drop(connection)
    drop(named)
    draft.sets.rename(name, None, exact=not is_element)


def rename(draft: Draft, old: str, new: str) -> None:
    """Rename an element or a system's connector; see `SystemStructure.rename`."""
    # Connectors of components are named by their FMU.
    is_element = old in _elements(draft)
    named = element_named(draft, old) if is_element else _connector_named(draft, old)
    listed = parent_of(named)
    short = named.get("name", "")
    if local(parent_of(listed)) == "Component":
        raise draft.error(old, "It is named by the FMU.", "Connectors of systems can be renamed.")
    # The new name must be free among elements and connectors.
    full = old.removesuffix(short) + new
    if full in _elements(draft) or any(
        part.get("name") == new for part in listed if part is not named
    ):
        raise draft.error(full, "The name is taken.", "Names must differ.")
    # Connections and parameter sets follow the new name.
    for connection, attribute in attached(draft.system, old, is_element):
        connection.set(attribute, new)
    named.set("name", new)
    draft.sets.rename(old, full, exact=not is_element)


def _elements(draft: Draft) -> list[str]:
    return [name for name, _ in walk(draft.system) if name]


def _connector_named(draft: Draft, name: str) -> etree._Element:
    connector = find_connector(draft.system, name)
    if connector is None:
        connectors = [
            part.get("name") for part in children(draft.system, "ssd:Connectors", "ssd:Connector")
        ]
        choices = [*_elements(draft), *connectors]
        raise draft.error(name, "There is no such element or connector.", suggestion(name, choices))
    return connector
