"""Plain objects as rows of numbers, and back; separates numbers from structure."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Set
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from shipcosim.native.symbols import Symbol, SymbolArray, Untraceable, kind_of

STRUCTURE = (str, bytes, type(None), type)
WHOLE = (bool, int, np.integer, np.bool_)
FRACTIONAL = (float, np.floating)
NUMBERS = (*WHOLE, *FRACTIONAL)


class Leaf(NamedTuple):
    """A number in an object.

    Parameters
    ----------
    path : tuple
        Where it lies: keys, indices, names of attributes.
    kind : str
        As of a `Symbol`.
    """

    path: tuple
    kind: str


class Flat:
    """The numbers of an object, their places, and the rest of it.

    Parameters
    ----------
    value : any
        Numbers, texts, None; arrays, tuples, lists, dicts and dataclasses of them.
    constant : set of str
        Keys of the outermost dict whose values belong to the structure, whatever they are.
    unchanging : set of str
        Keys of the outermost dict in whose values flags belong to the structure: choices.

    Attributes
    ----------
    numbers : list
        All numbers, or symbols.
    leaves : list of Leaf
        Where they lie.
    structure : list of (path, description)
        All else.
    """

    def __init__(
        self, value: Any, constant: Set[str] = frozenset(), unchanging: Set[str] = frozenset()
    ):
        self.numbers: list[Any] = []
        self.leaves: list[Leaf] = []
        self.structure: list[tuple[tuple, Any]] = []
        if constant or unchanging:
            for name, part in value.items():
                if name in constant:
                    self.structure.append(((name,), part))
                else:
                    self._add((name,), part, name in unchanging)
        else:
            self._add((), value, False)

    @cached_property
    def places(self) -> dict[str, int]:
        """Places of the numbers that are attributes themselves."""
        return {
            leaf.path[0]: place for place, leaf in enumerate(self.leaves) if len(leaf.path) == 1
        }

    def same_shape(self, other: Flat) -> bool:
        """True if two objects differ only in their numbers."""
        # Shapes are cached, so most comparisons are of an object with itself.
        if self is other:
            return True
        places = [leaf.path for leaf in self.leaves], [leaf.path for leaf in other.leaves]
        return places[0] == places[1] and self.structure == other.structure

    def difference(self, other: Flat) -> str:
        """The first place where two structures differ, as text."""
        for (path, value), (other_path, another) in zip(
            self.structure, other.structure, strict=False
        ):
            # The first different entry explains the rest, which is shifted.
            if path != other_path or value != another:
                return f"{text_of(path)} was {str(value)[:40]}, then {text_of(other_path)} was {another}"
        # Equal structures: then some numbers exist in one of them only.
        ours, theirs = ({leaf.path for leaf in flat.leaves} for flat in (self, other))
        return (
            ", ".join(text_of(path) for path in sorted(ours ^ theirs, key=str)[:3])
            + " is not always there"
        )

    def _add(self, path, value, fixed):
        # An array without dimensions is a number.
        value = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
        # A flag of unchanging parameters selects code: it is structure, not a number.
        if isinstance(value, Symbol) or (
            isinstance(value, NUMBERS) and not (fixed and kind_of(value) == "b")
        ):
            self._number(path, value)
        elif isinstance(value, (WHOLE, STRUCTURE)):
            self.structure.append((path, value))
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fibO":
            # The shape is structure, the elements are numbers.
            self.structure.append((path, value.shape))
            elements = value.ravel().tolist()
            self.numbers += elements
            self.leaves += [
                Leaf((*path, index), kind_of(element)) for index, element in enumerate(elements)
            ]
        else:
            # Containers: note the type, then take the parts apart.
            self.structure.append((path, type(value).__qualname__))
            for key, part in _parts(path, value):
                self._add((*path, key), part, fixed)

    def _number(self, path, value):
        self.numbers.append(value)
        self.leaves.append(Leaf(path, kind_of(value)))


def numbers_of(
    values: dict[str, Any], constant: Set[str], unchanging: Set[str]
) -> tuple[list[Any], tuple]:
    """The numbers of attributes as in `Flat`, and the rest, which is equal for equal shapes.

    Ten times faster than a `Flat`.
    """
    numbers: list[Any] = []
    rest: list[Any] = []
    for name, value in values.items():
        rest.append(name)
        # Constants belong to the structure with type and value: 1, 1.0 and True are equal in
        # Python.
        if name in constant:
            rest += (type(value), value)
        elif name in unchanging:
            _take_once(value, numbers, rest)
        else:
            _take(value, False, numbers, rest)
    return numbers, tuple(rest)


def _take_once(value, numbers, rest):
    """Take a value apart that never changes, once: frozen parameters or tuples of floats."""
    # The cache goes by identity. It keeps the object too, so that its id cannot be used again.
    taken_apart = _TAKEN.get(id(value))
    if taken_apart is None or taken_apart[0] is not value:
        taken = []
        others = []
        # A tuple is a table of numbers; other unchanging values are parameters, with fixed flags.
        if isinstance(value, tuple):
            for part in value:
                _take(part, False, taken, others)
        else:
            _take(value, True, taken, others)
        # Simple limit of the memory: forget everything, then fill the cache again.
        if len(_TAKEN) >= MOST_TAKEN:
            _TAKEN.clear()
        taken_apart = _TAKEN[id(value)] = value, taken, tuple(others)
    numbers += taken_apart[1]
    rest.append(taken_apart[2])


_TAKEN: dict[int, tuple[Any, list, tuple]] = {}
MOST_TAKEN = 500
"""Objects that are remembered: of components in a process, as a rule."""
LONG = 16
"""Smallest length of a tuple that is cached."""


def _is_table(value):
    """True for a long tuple of tuples of floats, which cannot change."""
    if type(value) is not tuple or len(value) < LONG:
        return False
    return all(type(row) is tuple and set(map(type, row)) == {float} for row in value)


def _take(value, fixed, numbers, rest):
    kind = type(value)
    made = type(value).__qualname__
    # The frequent types come first: this function runs for each attribute of each component.
    if kind is float:
        numbers.append(value)
        rest.append("d")
    elif isinstance(value, (tuple, list)):
        rest += (made, len(value))
        # A row of floats is taken as a whole, without a call for each element.
        if set(map(type, value)) == {float}:
            numbers += value
            rest.append("d")
        elif id(value) in _TAKEN or _is_table(value):
            _take_once(value, numbers, rest)
        else:
            for part in value:
                _take(part, fixed, numbers, rest)
    elif kind is np.ndarray and value.ndim and value.dtype.kind in "fib":
        numbers += value.ravel().tolist()
        rest += (value.dtype.kind, value.shape)
    elif isinstance(value, dict) or (
        dataclasses.is_dataclass(value) and not isinstance(value, type)
    ):
        parts = value if isinstance(value, dict) else vars(value)
        rest += (made, *parts)
        for key, part in parts.items():
            # The marker for symbols is no part of the data.
            if key != "maths" or kind is dict:
                _take(part, fixed, numbers, rest)
    else:
        # Rare types take the slow and general way, so that both ways agree.
        flat = Flat({"": value}, unchanging={""} if fixed else set())
        numbers += flat.numbers
        rest += (tuple(flat.leaves), *((path, type(leaf), leaf) for path, leaf in flat.structure))


def made_like(value: Any, numbers: Iterator[Any]) -> Any:
    """Build an object of the same structure from other numbers.

    Parameters
    ----------
    value : any
        Whose structure is taken.
    numbers : iterator
        The numbers, in the order of `Flat`.
    """
    if isinstance(value, (Symbol, *FRACTIONAL, *WHOLE)):
        return next(numbers)
    if isinstance(value, STRUCTURE):
        return value
    if isinstance(value, np.ndarray):
        numbers_of_array = [next(numbers) for _ in range(value.size)]
        # Arrays with symbols have the type object; other arrays get their element type back.
        if any(isinstance(element, Symbol) for element in numbers_of_array):
            return np.array(numbers_of_array, dtype=object).reshape(value.shape).view(SymbolArray)
        return np.array(
            numbers_of_array, dtype=float if value.dtype == object else value.dtype
        ).reshape(value.shape)
    # A named tuple takes its fields as arguments, other sequences take a list.
    if isinstance(value, (tuple, list)):
        made = [made_like(part, numbers) for part in value]
        return type(value)(*made) if hasattr(value, "_fields") else type(value)(made)
    if isinstance(value, dict):
        return {key: made_like(part, numbers) for key, part in value.items()}
    # Copy a dataclass without its constructor: derived fields are among the numbers.
    made = object.__new__(type(value))
    made.__dict__.update({key: made_like(part, numbers) for key, part in vars(value).items()})
    return made


def attributes_like(
    values: dict[str, Any], numbers: Iterable[Any], constant: Set[str], unchanging: Set[str]
) -> dict[str, Any]:
    """Build attributes of the same structure from other numbers; see `Flat`."""
    rest = iter(numbers)
    return {
        name: value
        if name in constant
        else _keeping_flags(value, rest)
        if name in unchanging
        else made_like(value, rest)
        for name, value in values.items()
    }


def text_of(path: tuple) -> str:
    """A path as readable text."""
    return ".".join(map(str, path))


def _keeping_flags(value, numbers):
    """Like `made_like`, but flags keep their values."""
    # Flags of unchanging parameters are structure: `Flat` gave no number for them.
    flat = Flat(value)
    keeps = [kind_of(number) == "b" and not isinstance(number, Symbol) for number in flat.numbers]
    return made_like(
        value,
        iter(
            [
                number if keep else next(numbers)
                for keep, number in zip(keeps, flat.numbers, strict=True)
            ]
        ),
    )


def _parts(path, value) -> Iterator[tuple[Any, Any]]:
    """The parts of an object, by key or index."""
    if isinstance(value, (tuple, list)):
        yield from enumerate(value)
    elif isinstance(value, dict):
        yield from value.items()
    elif dataclasses.is_dataclass(value):
        yield from ((name, part) for name, part in vars(value).items() if name != "maths")
    else:
        raise Untraceable(f"it keeps a {type(value).__name__} in {text_of(path)}")
