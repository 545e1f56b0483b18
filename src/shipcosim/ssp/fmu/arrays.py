"""Scalar elements of an FMU's arrays, ``A[1,2]``, counted from 1, the last index fastest.

Reference: FMI 3.0.1, section 2.4.7.5.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from math import prod

from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.xml.document import Findings

MOST_ELEMENTS = 100_000


def element_names(name: str, dimensions: Iterable[int]) -> list[str]:
    """Names of an array's elements, in the order of their values.

    Examples
    --------
    >>> element_names("A", (2, 2))
    ['A[1,1]', 'A[1,2]', 'A[2,1]', 'A[2,2]']
    """
    places = product(*(range(1, size + 1) for size in dimensions))
    return [f"{name}[{','.join(map(str, place))}]" for place in places]


def without_arrays(
    fmu: FmuDescription, place: str, findings: Findings, sizes: Mapping[str, int] | None = None
) -> FmuDescription:
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

    Returns
    -------
    FmuDescription
    """
    # Arrays with the sizes that structural parameters give them.
    whole = {v.name: _with_sizes(v, sizes or {}) for v in fmu.variables.values() if v.dimensions}
    if not whole:
        return fmu
    # A few digits in a file can ask for more elements than memory holds.
    if sum(prod(variable.dimensions) for variable in whole.values()) > MOST_ELEMENTS:
        findings.error(
            place, f"{fmu.path.name} has arrays of more than {MOST_ELEMENTS} elements in all."
        )
        return replace(fmu, variables={n: v for n, v in fmu.variables.items() if n not in whole})
    # Elements take the place of their array, so that the order stays.
    variables = {}
    for name, variable in fmu.variables.items():
        variables |= (
            {part.name: part for part in _elements(whole[name])}
            if name in whole
            else {name: variable}
        )
    return replace(
        fmu, variables=variables, arrays={name: v.dimensions for name, v in whole.items()}
    )


def _with_sizes(variable: Variable, sizes: Mapping[str, int]) -> Variable:
    """An array resized by structural parameters; its start values are then unknown."""
    pairs = zip(variable.sizes, variable.dimensions, strict=True)
    dimensions = tuple(
        max(sizes.get(name, size) if isinstance(name, str) else size, 0) for name, size in pairs
    )
    return (
        variable
        if dimensions == variable.dimensions
        else replace(variable, dimensions=dimensions, start=None)
    )


def _elements(variable: Variable) -> Iterator[Variable]:
    """Elements of an array as variables."""
    names = element_names(variable.name, variable.dimensions)
    starts = variable.start if isinstance(variable.start, tuple) else (variable.start,)
    starts = (
        starts if len(starts) == len(names) else starts[:1] * len(names)
    )  # one value for all of them
    for number, (name, start) in enumerate(zip(names, starts, strict=True)):
        yield replace(variable, name=name, start=start, dimensions=(), whole=variable, place=number)


def shape_text(dimensions: Iterable[int]) -> str:
    """Dimensions in words: ``an array of 2x3``, ``a scalar``."""
    return f"an array of {'x'.join(map(str, dimensions))}" if dimensions else "a scalar"
