"""Replace connectors, connections and values of arrays by those of their elements.

A connection joins two arrays of one shape element by element, or, with indices at an end, single elements.

Reference: SSP 2.0, sections on Dimension and Connection.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import prod

from shipcosim.ssp.fmu.arrays import MOST_ELEMENTS, element_names, shape_text
from shipcosim.ssp.read.parameters import ParameterValue
from shipcosim.ssp.read.structure import Connector, Link
from shipcosim.ssp.xml.document import Findings

Dimensions = tuple[int, ...]
"""Sizes of an array; empty for a scalar."""


def element_connectors(
    connectors: Iterable[Connector], arrays: Mapping[str, Dimensions], findings: Findings
) -> tuple[list[Connector], dict[str, Dimensions]]:
    """Connectors, with elements in place of arrays.

    Parameters
    ----------
    connectors : iterable of Connector
        As written.
    arrays : mapping of str to tuple of int
        Dimensions of the arrays, where the FMU knows them.
    findings : Findings
        Takes what does not fit.

    Returns
    -------
    (list of Connector, dict of str to tuple of int)
        And the dimensions of the arrays among them.
    """
    scalar_connectors = []
    dimensions_of = {}
    for connector in connectors:
        # The FMU's sizes win over those in the SSD, which may leave sizes open.
        written = connector.dimensions
        given = arrays.get(connector.name, written)
        dimensions = tuple(size for size in given if size is not None)
        is_open = len(dimensions) < len(given)
        # A limit protects the memory from a typing error in a size.
        if dimensions and not is_open and (min(dimensions) < 1 or prod(dimensions) > MOST_ELEMENTS):
            remedy = f"Arrays have from 1 to {MOST_ELEMENTS} elements."
            findings.error(connector.place, f"The connector is {shape_text(dimensions)}.", remedy)
        # Sizes stay open, or contradict the FMU.
        elif written and (is_open or not _fits(written, dimensions)):
            shown = "x".join("?" if size is None else str(size) for size in written)
            remedy = (
                f"Write {shape_text(arrays[connector.name])}."
                if connector.name in arrays
                else "Give its sizes."
            )
            findings.error(connector.place, f"The connector is an array of {shown}.", remedy)
        elif dimensions:
            dimensions_of[connector.name] = dimensions
            # An array becomes one connector for each element, named as FMI does.
            names = element_names(connector.name, dimensions)
            scalar_connectors += [replace(connector, name=name, dimensions=()) for name in names]
        else:
            scalar_connectors.append(connector)
    return scalar_connectors, dimensions_of


def _fits(written: tuple[int | None, ...], dimensions: tuple[int | None, ...]) -> bool:
    pairs = zip(written, dimensions, strict=False)
    return len(written) == len(dimensions) and all(size in (None, right) for size, right in pairs)


def element_links(link: Link, start: Dimensions, end: Dimensions, findings: Findings) -> list[Link]:
    """Connections of elements that a connection joins.

    Parameters
    ----------
    link : Link
        As written.
    start, end : tuple of int
        Dimensions of the two connectors; empty for scalars.
    findings : Findings
        Takes what does not fit.

    Returns
    -------
    list of Link
    """
    # The usual case: no arrays and no indices.
    if not (start or end or link.start_indices or link.end_indices):
        return [link]
    names = [
        _end_names(name, indices, dimensions, link, findings)
        for name, indices, dimensions in (
            (link.start_connector, link.start_indices, start),
            (link.end_connector, link.end_indices, end),
        )
    ]
    if None in names:
        return []
    # An index picks one element, which is a scalar. Shapes must be equal then.
    shapes = [() if link.start_indices else start, () if link.end_indices else end]
    if shapes[0] != shapes[1]:
        findings.error(
            link.place,
            f"{shape_text(shapes[0])} cannot be connected to {shape_text(shapes[1])}.",
            "Both must have the same shape; startIndices and endIndices name an element.",
        )
        return []
    # Join element by element, in row-major order.
    bare = replace(link, start_indices=(), end_indices=())
    return [replace(bare, start_connector=a, end_connector=b) for a, b in zip(*names, strict=True)]


def _end_names(
    name: str, indices: tuple[int, ...], dimensions: Dimensions, link: Link, findings: Findings
) -> list[str] | None:
    """Names of the elements at one end, or None."""
    if not indices:
        return element_names(name, dimensions) if dimensions else [name]
    # SSP counts indices from 1.
    inside = [1 <= index <= size for index, size in zip(indices, dimensions, strict=False)]
    if len(indices) != len(dimensions) or not all(inside):
        shown = ",".join(map(str, indices))
        findings.error(
            link.place,
            f"{name}[{shown}] does not exist: {name} is {shape_text(dimensions)}.",
            "Count from 1.",
        )
        return None
    return [f"{name}[{','.join(map(str, indices))}]"]


def element_values(value: ParameterValue, findings: Findings) -> list[ParameterValue]:
    """Parameter values of an array's elements; a scalar's value itself.

    Parameters
    ----------
    value : ParameterValue
        As the parameter set has it.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    list of ParameterValue, empty with an error where their number does not fit
    """
    if not value.dimensions:
        return [value]
    if min(value.dimensions) < 1 or prod(value.dimensions) != len(value.value):
        findings.error(
            value.place,
            f"{value.name} is {shape_text(value.dimensions)}, but has {len(value.value)} values.",
            f"Give {prod(value.dimensions)}.",
        )
        return []
    pairs = zip(element_names(value.name, value.dimensions), value.value, strict=True)
    return [replace(value, name=name, value=element, dimensions=()) for name, element in pairs]
