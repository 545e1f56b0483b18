"""A component with compiled steps: its memory of numbers, and its Python object."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from shipcosim.native.blocks import typed
from shipcosim.native.checking import refuse_other_results
from shipcosim.native.compiler import libraries
from shipcosim.native.error_texts import line_of
from shipcosim.native.number_rows import Flat, attributes_like, made_like
from shipcosim.native.record_cache import (
    Record,
    keep_record,
    kept_record,
    key_of,
    record_of,
    refusal_of,
)
from shipcosim.native.source import source_of
from shipcosim.native.symbols import Untraceable
from shipcosim.native.trace import Shape, shape_of, trace

CALL = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_int,
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
)


class CompiledStep:
    """The compiled step of one component.

    Parameters
    ----------
    fmu : Fmu
        The Python object, after its start. Its numbers are those of the memory after `give_back`.
    shape : Shape
        Its numbers and its structure.
    record : Record
        What belongs to the code.
    library : CDLL
        The compiled code.

    Attributes
    ----------
    memory : (n + 2,) array
        All numbers, time and step size.
    kept : (m,) array
        Results of functions that stay in Python, each behind the arguments that it belongs to.
    function : c_void_p
        The code.
    call : ctypes function
        Computes what stays in Python.
    places : dict of str to int
        Where the variables lie in the memory.
    """

    def __init__(self, fmu: Any, shape: Shape, record: Record, library: ctypes.CDLL):
        self.fmu = fmu
        self._shape = shape
        self._record = record
        self._library = library
        # The address of the C function: the master calls it without Python in between.
        self.function = ctypes.cast(library.step, ctypes.c_void_p)
        # Layout of the memory: the numbers of the state, then time and step size.
        self.memory = np.zeros(len(shape.numbers) + 2)
        self.memory[:-2] = shape.numbers
        # Each function that stays in Python has its arguments, then its results. NaN arguments
        # differ from all others and force the first call.
        self.kept = np.full(
            max(1, sum(len(call.changing) + call.size for call in record.calls)), np.nan
        )
        self.call = CALL(self._called)
        self.places = shape.flat.places

    def take(self) -> None:
        """Copy the object's numbers to the memory. Raises Untraceable if its shape differs."""
        shape = shape_of(self.fmu)
        if not shape.flat.same_shape(self._shape.flat):
            raise Untraceable(
                f"its state changes its shape: {self._shape.flat.difference(shape.flat)}"
            )
        self.memory[:-2] = shape.numbers

    def take_anew(self, time: float, step_size: float) -> bool:
        """Copy the numbers after another start; true if the compiled code also holds for them."""
        try:
            shape = shape_of(self.fmu)
        except Untraceable:
            return False
        # The C text has fixed places; another shape needs another record.
        if not shape.flat.same_shape(self._shape.flat):
            return False
        # Integers may be part of the code (guards). The record must be the one that these values
        # select.
        if (
            kept_record(key_of(self.fmu, shape), [*shape.numbers, time, step_size])
            is not self._record
        ):
            return False
        # Restart with the new numbers, and forget the results cached for the old ones.
        self.memory[:-2] = shape.numbers
        self.kept[:] = np.nan
        return True

    def give_back(self) -> None:
        """Copy the numbers to the Python object."""
        values = vars(self.fmu)
        shape = self._shape
        # C has doubles only; integers and flags get their Python type again.
        numbers = [
            typed(number, leaf.kind)
            for number, leaf in zip(self.memory.tolist(), shape.flat.leaves, strict=False)
        ]
        # Build the attributes from the numbers; those that no step changes keep their objects.
        made = attributes_like(values, numbers, shape.constant, shape.unchanging)
        fixed = shape.constant | shape.unchanging
        values.update({name: value for name, value in made.items() if name not in fixed})

    def _called(self, _, number, arguments, kept):
        """Compute a function that stays in Python. After an error Python takes the step."""
        call = self._record.calls[number]
        try:
            # The arguments are those of the recording; only the changing ones come from C.
            example = self._record.examples[number]
            numbers = list(example.numbers)
            leaves = example.leaves
            for place, changing in enumerate(call.changing):
                numbers[changing] = typed(arguments[place], leaves[changing].kind)
            result = call.function(*made_like(call.arguments, iter(numbers)))
            values = result.ravel() if isinstance(result, np.ndarray) else Flat(result).numbers
            # Results go in place: C reads them behind the arguments.
            np.ctypeslib.as_array(kept, (call.size,))[:] = values
        except Exception:
            # No exception can pass through C. The status makes the code give up; Python repeats the
            # step.
            return 1
        return 0


def compiled_steps(
    fmus: Sequence[Any], time: float, step_size: float
) -> list[CompiledStep | Untraceable]:
    """Compiled steps of components, or why there are none.

    Parameters
    ----------
    fmus : sequence of Fmu
        After their start.
    time, step_size : float
        Of the first step. [s, s]

    Raises
    ------
    ShipcosimError
        The compiler is missing or fails, or the cache cannot be written.
    """
    with _ONE_AT_A_TIME:
        # First record all components, then compile all sources at once: the compiler runs in
        # parallel.
        recorded = [_recorded(fmu, time, step_size) for fmu in fmus]
        made = iter(
            libraries(record.record.source for record in recorded if isinstance(record, _Recorded))
        )
        return [
            _checked(record, next(made), time, step_size)
            if isinstance(record, _Recorded)
            else record
            for record in recorded
        ]


_ONE_AT_A_TIME = threading.Lock()
"""Lock, so that runs in several threads record and compile shared code only once."""


class _Recorded(NamedTuple):
    """A component with its record; `key` is empty if the record comes from the cache."""

    fmu: Any
    shape: Shape
    record: Record
    key: str


def _recorded(fmu, time, step_size) -> _Recorded | Untraceable:
    """Record a component, or take its record from the cache."""
    try:
        shape = shape_of(fmu)
        key = key_of(fmu, shape)
    except Exception as error:
        return Untraceable(_why(error))
    numbers = [*shape.numbers, time, step_size]
    if (record := kept_record(key, numbers)) is not None:
        if record.refusal:
            return Untraceable(record.refusal)
        # It was compared with Python when it was made: no key, no new comparison.
        return _Recorded(fmu, shape, record, "")
    try:
        step = trace(fmu, shape, time, step_size)
        return _Recorded(fmu, shape, record_of(step, source_of(step), numbers), key)
    except Exception as error:  # whatever a model says to a symbol in place of a number
        if isinstance(error, Untraceable):
            keep_record(key, refusal_of(_why(error), numbers))
        return Untraceable(_why(error))


def _why(error: Exception) -> str:
    """Why a component cannot be recorded, with the place in its code."""
    name = "" if isinstance(error, Untraceable) else f"{type(error).__name__}: "
    return f"{line_of(error)}{name}{error}"


def _checked(recorded: _Recorded, library, time, step_size) -> CompiledStep | Untraceable:
    """Build the compiled step; compare a new record with Python before it is cached."""
    compiled = CompiledStep(recorded.fmu, recorded.shape, recorded.record, library)
    if recorded.key:
        try:
            refuse_other_results(compiled, time, step_size)
        except Untraceable as reason:
            return reason
        keep_record(recorded.key, recorded.record)
    return compiled
