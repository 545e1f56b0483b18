"""Add and remove connections of an SSD."""

from shipcosim.errors import suggestion
from shipcosim.ssp.edit.connectors import declare_variable
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.names import NameMatch, best_pair, connections
from shipcosim.ssp.xml.markup import add, drop, ensure


def connect(
    draft: Draft, source: str, target: str, transformation: dict[str, float | None], suppress: bool
) -> None:
    """Connect two connectors of one system; see `SystemStructure.connect`.

    Parameters
    ----------
    draft : Draft
        The system.
    source, target : str
        Full names of the connectors.
    transformation : dict of str to float or None
        ``factor`` and ``offset`` of a linear transformation; None: not given.
    suppress : bool
        Whether units are not converted.
    """
    # A name can be read in several ways: take the pair of ends that exist in one system.
    ends = best_pair(
        source,
        target,
        draft.system,
        lambda end: _exists(draft, end),
        draft.package.show(draft.path),
    )
    # The FMU may have a variable that the SSD does not declare yet.
    for end in ends:
        _declare(draft, end)
    # From output to input, in whichever order the ends were given.
    start, end = reversed(ends) if ends[0].gives() is False or ends[1].gives() else ends
    names = {
        "startElement": start.element_name,
        "startConnector": start.connector,
        "endElement": end.element_name,
        "endConnector": end.connector,
        "suppressUnitConversion": "true" if suppress else None,
    }
    connection = add(ensure(start.system, "ssd:Connections"), "ssd:Connection", **names)
    texts = {
        name: repr(float(number)) for name, number in transformation.items() if number is not None
    }
    if texts:
        add(connection, "ssc:LinearTransformation", **texts)


def disconnect(draft: Draft, source: str, target: str | None) -> None:
    """Remove connections; see `SystemStructure.disconnect`."""
    # Connections that contain the given end or ends; suggest similar ones if there are none.
    wanted = {source, target} - {None}
    there = list(connections(draft.system))
    matching = [element for ends, element in there if wanted <= set(ends)]
    if not matching:
        near = [" -> ".join(ends) for ends, _ in there if wanted & set(ends)]
        shown = " -> ".join(filter(None, (source, target)))
        choices = near or [" -> ".join(ends) for ends, _ in there]
        raise draft.error(shown, "There is no such connection.", suggestion(shown, choices))
    for element in matching:
        drop(element)


def _exists(draft: Draft, end: NameMatch) -> bool:
    """True if a connector is declared, or its FMU has the variable."""
    fmu = None if end.element is None else draft.fmu_of(end.element)
    return end.declared() is not None or (fmu is not None and end.connector in fmu.variables)


def _declare(draft: Draft, end: NameMatch) -> None:
    """Declare the connector that a connection needs, if its FMU has the variable."""
    if end.element is None or end.declared() is not None:
        return
    fmu = draft.fmu_of(end.element)
    if fmu is not None and end.connector in fmu.variables:
        declare_variable(end.element, fmu.variables[end.connector], fmu, draft.root)
