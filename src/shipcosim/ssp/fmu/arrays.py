"""Arrays taken apart: from here on there are scalar elements alone, ``A[1,2]``, counted from 1, the last index fastest.

Connectors of arrays, connections between them and their values become those of their elements. A connection joins two
arrays of one shape element by element, or, with indices at an end, single elements.

Reference: FMI 3.0.1, section 2.4.7.5; SSP 2.0, sections on Dimension and Connection.
"""

from dataclasses import replace
from itertools import product
from math import prod

MOST_ELEMENTS = 100_000


def element_names(name, dimensions):
    """Names of an array's elements, in the order of their values.

    Examples
    --------
    >>> element_names("A", (2, 2))
    ['A[1,1]', 'A[1,2]', 'A[2,1]', 'A[2,2]']
    """
    places = product(*(range(1, size + 1) for size in dimensions))
    return [f"{name}[{','.join(map(str, place))}]" for place in places]


def without_arrays(fmu, place, findings, sizes=None):
    """Description of an FMU with elements in place of its arrays, which stay known in `arrays`.

    Parameters
    ----------
    fmu : FmuDescription
        As read.
    place : str
        Where it is used, for messages.
    findings : Findings
        Takes what is wrong.
    sizes : mapping of str to int, optional
        Values of structural parameters, where they are others than the FMU's own.
    """
    whole = {v.name: _with_sizes(v, sizes or {}) for v in fmu.variables.values() if v.dimensions}
    if not whole:
        return fmu
    if sum(prod(variable.dimensions) for variable in whole.values()) > MOST_ELEMENTS:
        findings.error(place, f"{fmu.path.name} has arrays of more than {MOST_ELEMENTS} elements in all.")
        return replace(fmu, variables={n: v for n, v in fmu.variables.items() if n not in whole})
    variables = {}
    for name, variable in fmu.variables.items():
        variables |= {part.name: part for part in _elements(whole[name])} if name in whole else {name: variable}
    return replace(fmu, variables=variables, arrays={name: v.dimensions for name, v in whole.items()})


def _with_sizes(variable, sizes):
    """An array with other values of the structural parameters that size it; its start values are unknown then."""
    pairs = zip(variable.sizes, variable.dimensions, strict=True)
    dimensions = tuple(max(sizes.get(name, size), 0) for name, size in pairs)
    return variable if dimensions == variable.dimensions else replace(variable, dimensions=dimensions, start=None)


def _elements(variable):
    names = element_names(variable.name, variable.dimensions)
    starts = variable.start if isinstance(variable.start, tuple) else (variable.start,)
    starts = starts if len(starts) == len(names) else starts[:1] * len(names)  # one value for all of them
    for number, (name, start) in enumerate(zip(names, starts, strict=True)):
        yield replace(variable, name=name, start=start, dimensions=(), whole=variable, place=number)


def element_connectors(connectors, arrays, findings):
    """Connectors with elements in place of arrays.

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
    found, known = [], {}
    for connector in connectors:
        written = connector.dimensions
        dimensions = arrays.get(connector.name, written)
        if dimensions and None not in dimensions and (min(dimensions) < 1 or prod(dimensions) > MOST_ELEMENTS):
            remedy = f"Arrays have from 1 to {MOST_ELEMENTS} elements."
            findings.error(connector.place, f"The connector is {_shape(dimensions)}.", remedy)
        elif written and (None in dimensions or not _fits(written, dimensions)):
            shown = "x".join("?" if size is None else str(size) for size in written)
            remedy = f"Write {_shape(arrays[connector.name])}." if connector.name in arrays else "Give its sizes."
            findings.error(connector.place, f"The connector is an array of {shown}.", remedy)
        elif dimensions:
            known[connector.name] = dimensions
            names = element_names(connector.name, dimensions)
            found += [replace(connector, name=name, dimensions=()) for name in names]
        else:
            found.append(connector)
    return found, known


def _fits(written, dimensions):
    pairs = zip(written, dimensions, strict=False)
    return len(written) == len(dimensions) and all(size in (None, right) for size, right in pairs)


def element_links(link, start, end, findings):
    """Connections of the elements that a connection joins.

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
    shapes = [() if link.start_indices else start, () if link.end_indices else end]
    if shapes[0] != shapes[1]:
        found = f"{_shape(shapes[0])} cannot be connected to {_shape(shapes[1])}."
        findings.error(link.place, found, "Both must have the same shape; startIndices and endIndices name an element.")
        return []
    bare = replace(link, start_indices=(), end_indices=())
    return [replace(bare, start_connector=a, end_connector=b) for a, b in zip(*names, strict=True)]


def _end_names(name, indices, dimensions, link, findings):
    """Names of the elements at one end, or None."""
    if not indices:
        return element_names(name, dimensions) if dimensions else [name]
    inside = [1 <= index <= size for index, size in zip(indices, dimensions, strict=False)]
    if len(indices) != len(dimensions) or not all(inside):
        shown = ",".join(map(str, indices))
        findings.error(link.place, f"{name}[{shown}] does not exist: {name} is {_shape(dimensions)}.", "Count from 1.")
        return None
    return [f"{name}[{','.join(map(str, indices))}]"]


def element_values(value, findings):
    """Parameter values of the elements, where one is an array; else the value itself."""
    if not value.dimensions:
        return [value]
    if min(value.dimensions) < 1 or prod(value.dimensions) != len(value.value):
        found = f"{value.name} is {_shape(value.dimensions)}, but has {len(value.value)} values."
        findings.error(value.place, found, f"Give {prod(value.dimensions)}.")
        return []
    pairs = zip(element_names(value.name, value.dimensions), value.value, strict=True)
    return [replace(value, name=name, value=one, dimensions=()) for name, one in pairs]


def _shape(dimensions):
    return f"an array of {'x'.join(map(str, dimensions))}" if dimensions else "a scalar"


RESIZE = "Set it in the SSD or in a parameter set."
"""What would be right instead of what `resized` finds."""


def resized(component):
    """Sentences on start values that would change the size of arrays, whose elements are laid out already."""
    for variable in component.fmu.variables.values():
        if variable.whole is not None and variable.place == 0:
            for name, size in zip(variable.sizes, variable.whole.dimensions, strict=True):
                wanted = component.start_value(name) if isinstance(name, str) else size
                if wanted != size:
                    yield f"{name} is {wanted}, but {variable.whole.name} has been laid out for {size}."


def sizes_wanted(components):
    """Values of the structural parameters that the system sets and that give sizes, by component and name."""
    wanted = {}
    for name, component in components.items():
        structural = {size for variable in component.fmu.variables.values() for size in variable.sizes}
        values = {size: component.start[size] for size in structural & set(component.start)}
        wanted |= {name: values} if values else {}
    return wanted
