"""Compare compiled steps with the same steps in Python, from the same numbers."""

from __future__ import annotations

import copy
import ctypes
from typing import Any

import numpy as np

from shipcosim.native.number_rows import text_of
from shipcosim.native.source import DONE
from shipcosim.native.symbols import Untraceable
from shipcosim.native.trace import STANDS, shape_of

STEPS = 20
"""Steps that are compared."""

LARGEST = 1e-9
"""Difference of a number, over its size or 1, above which compiled code is refused; rounding is 1000 times less."""


def refuse_other_results(compiled: Any, time: float, step_size: float) -> None:
    """Take steps with random inputs in Python and in compiled code.

    Parameters
    ----------
    compiled : CompiledStep
        Its memory has the numbers at the start again afterwards.
    time, step_size : float
        Of the first step. [s, s]

    Raises
    ------
    Untraceable
        A number differs; with its name, the step and both values.
    """
    # A fixed seed: the same component is accepted or refused in every run.
    random = np.random.default_rng(1)
    # The memory is restored at the end, so that the comparison leaves no trace in the run.
    before = compiled.memory.copy()
    function = ctypes.CFUNCTYPE(ctypes.c_int, *[ctypes.c_void_p] * 4)(compiled.function.value)
    call = ctypes.cast(compiled.call, ctypes.c_void_p)
    python = _copy(compiled.fmu)
    try:
        for number in range(STEPS):
            # Both sides start each step from the same state. An error therefore cannot build up
            # over the steps, and its step is known.
            _give_inputs(python, compiled, random)
            compiled.memory[:-2] = shape_of(python).numbers
            compiled.memory[-2:] = time + number * step_size, step_size
            pointers = (array.ctypes.data for array in (compiled.memory, compiled.kept))
            status = function(*pointers, call, None)
            # Compiled code that gives up is safe: Python then takes the step. Only the opposite is
            # an error: C finishes a step that Python refuses.
            try:
                python.step(time + number * step_size, step_size)
            except Exception:
                if status == DONE:
                    raise Untraceable(
                        f"in step {number} Python fails and compiled code does not"
                    ) from None
                # A failed step may leave a half-changed object; go on from a fresh copy.
                python = _copy(compiled.fmu)
                continue
            # A step that the code gave up has changed nothing, so there is nothing to compare.
            if status == DONE:
                _compare(compiled, shape_of(python), number)
    finally:
        compiled.memory[:] = before
        # NaN differs from every argument, so the cached results are computed again in the run.
        compiled.kept[:] = np.nan


def _copy(fmu):
    """Copy a component with its state."""
    # Copy without a new start: the attributes of the base class one by one, all others deeply.
    made = object.__new__(type(fmu))
    for name in STANDS:
        setattr(made, name, copy.copy(getattr(fmu, name)))
    vars(made).update(copy.deepcopy(vars(fmu)))
    return made


def _give_inputs(fmu, compiled, random):
    """Draw inputs near those at the start; flags change seldom."""
    for variable in fmu.variables:
        if variable.causality != "input":
            continue
        value = getattr(compiled.fmu, variable.name)
        if variable.type == "Real":
            # 10 % of the start value, or 0.1 where it is small: large enough to move the state,
            # small enough to stay in the model's range. The declared bounds are kept.
            drawn = value + 0.1 * random.standard_normal() * max(abs(value), 1.0)
            setattr(fmu, variable.name, within_bounds(variable, drawn))
        elif variable.type == "Boolean":
            # One flag in ten is inverted, so that most steps run as the system does.
            setattr(fmu, variable.name, bool(value) ^ bool(random.random() < 0.1))


def within_bounds(variable: Any, value: float) -> float:
    """The value, moved into the declared bounds of a variable."""
    low, high = variable.bounds
    return float(min(max(value, low), high))


def _compare(compiled, shape, number):
    expected = np.array(shape.numbers, dtype=float)
    if len(expected) != len(compiled.memory) - 2:
        raise Untraceable(
            f"in step {number} its state has another shape than compiled code gives it"
        )
    # NaN on both sides is no difference: a comparison with NaN is false.
    with np.errstate(invalid="ignore"):
        off = np.abs(compiled.memory[:-2] - expected) > LARGEST * np.maximum(np.abs(expected), 1.0)
    if off.any():
        place = int(np.argmax(off))
        # Report the first number that differs, by the name of its variable.
        name = text_of(shape.flat.leaves[place].path)
        result = compiled.memory[place]
        raise Untraceable(
            f"in step {number} compiled code gives {name} = {result:.9g}, Python {expected[place]:.9g}"
        )
