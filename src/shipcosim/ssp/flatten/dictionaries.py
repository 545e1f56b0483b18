"""Signal dictionaries: their definitions, and the connectors of references to them."""

from shipcosim.errors import it_has, suggestion
from shipcosim.ssp.flatten.hierarchy import Dictionaries, ElementPath, Hierarchy, Surroundings
from shipcosim.ssp.flatten.ports import Key, Port, Wire
from shipcosim.ssp.read.parameters import read_dictionary
from shipcosim.ssp.read.structure import DictionaryReference, SystemElement


def dictionaries_of(
    tree: Hierarchy, element: SystemElement, path: ElementPath, place: Surroundings
) -> Dictionaries:
    """Signal dictionaries defined on a system.

    Parameters
    ----------
    tree : Hierarchy
        Takes what is wrong.
    element : SystemElement
        The system.
    path : tuple of str
        Its place.
    place : Surroundings
        Its surroundings.

    Returns
    -------
    Dictionaries
        By name: their place among the ports, and their entries.
    """
    dictionaries = {}
    for name, source in element.dictionaries.items():
        document = tree.library.content(source, place)
        entries = {} if document is None else tree.library.parsed(read_dictionary, document)
        dictionaries[name] = (*path, "", name), entries
    return dictionaries


def take_reference(
    tree: Hierarchy, element: DictionaryReference, path: ElementPath, place: Surroundings
) -> None:
    """Collect the ports of a dictionary reference; they are joined with the dictionary later.

    Parameters
    ----------
    tree : Hierarchy
        Takes what is found and what is wrong.
    element : DictionaryReference
        The reference.
    path : tuple of str
        Its place.
    place : Surroundings
        Has the dictionaries that it can mean; the innermost one of the name counts.
    """
    # The innermost dictionary of the name counts, as with variables in nested blocks.
    lookup = (
        around[element.dictionary] for around in place.dictionaries if element.dictionary in around
    )
    owner, entries = next(lookup, (None, None))
    if entries is None:
        visible = {name for names in place.dictionaries for name in names}
        tree.findings.error(
            element.place,
            f"There is no signal dictionary '{element.dictionary}' here or in a system around.",
            suggestion(element.dictionary, visible),
        )
    for connector in element.connectors:
        key = Key(path, connector.name)
        fields = (connector.kind, connector.type, "reference", connector.unit, connector.items)
        tree.ports[key] = Port(*fields, place=connector.place)
        if owner is None or entries is None:
            continue
        if connector.name not in entries:
            tree.findings.error(
                connector.place,
                f"The dictionary '{element.dictionary}' has no '{connector.name}'.",
                it_has(connector.name, entries),
            )
            continue
        entry = entries[connector.name]
        # The entry becomes a port itself, so that all references to it share one value.
        tree.references[key] = Key(owner, connector.name)
        tree.ports[tree.references[key]] = Port(
            "inout", entry.kind, "dictionary", entry.unit, entry.items
        )


def join_dictionaries(tree: Hierarchy) -> None:
    """Add wires between references and dictionaries.

    A reference that something flows into feeds the dictionary; from any other one the dictionary is read.
    """
    fed = {wire.target for wire in tree.wires}
    for reference, entry in tree.references.items():
        source, target = (reference, entry) if reference in fed else (entry, reference)
        tree.wires.append(Wire(source, target, place=tree.ports[reference].place))
