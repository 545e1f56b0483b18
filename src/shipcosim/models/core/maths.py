"""Elementary functions of the models, for Python floats, NumPy arrays and torch tensors.

Python floats take the first branch, so that a model in an FMU costs what `math` costs. torch is never imported here;
it is needed only where somebody has passed a tensor.

References
----------
Definitions of elementary functions.
"""

import math
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

Arithmetic = Any
"""A number in the arithmetic of its user: Python float, NumPy array or torch tensor. No type has the operators of all
three and leaves torch optional, hence Any."""

pi = math.pi
_TINY = 1e-30
_FEW = 256  # elements, below which a call of NumPy costs more than what it computes


def library_of(*values: Arithmetic) -> ModuleType:
    """The library for some values: torch if one of them is a tensor, else NumPy.

    Parameters
    ----------
    values : float or (...) array or tensor
        Values. [any units]

    Returns
    -------
    module
        numpy or torch; of values that bring functions of their own, as `maths`, those.
    """
    # Recorded symbols bring their own functions.
    for value in values:
        if isinstance(value, np.ndarray) and value.dtype == object and value.size:
            value = value.flat[0]
        if (maths := getattr(value, "maths", None)) is not None:
            return maths
    # Only if torch is imported already can a value be a tensor.
    torch = sys.modules.get("torch")
    if torch is not None and any(isinstance(value, torch.Tensor) for value in values):
        return torch
    return np


def sin(x: Arithmetic) -> Arithmetic:
    """Sine.

    Parameters
    ----------
    x : float or (...) array or tensor
        Angle. [rad]

    Returns
    -------
    like x
        [1]
    """
    if isinstance(x, float):
        return math.sin(x)
    return sincos(x)[0] if _many(x) else library_of(x).sin(x)


def cos(x: Arithmetic) -> Arithmetic:
    """Cosine.

    Parameters
    ----------
    x : float or (...) array or tensor
        Angle. [rad]

    Returns
    -------
    like x
        [1]
    """
    if isinstance(x, float):
        return math.cos(x)
    return sincos(x)[1] if _many(x) else library_of(x).cos(x)


def sincos(x: Arithmetic) -> tuple[Arithmetic, Arithmetic]:
    """Sine and cosine together, cheaper than separately.

    Of many angles they are t u and u - 1 with t = tan(x/2) and u = 2/(1 + t²), half-angle formulas, because NumPy's
    tangent is vectorised and its sine and cosine of doubles are not. These differ from sin x and cos x by some 1e-16.

    Parameters
    ----------
    x : float or (...) array or tensor
        Angle. [rad]

    Returns
    -------
    tuple of two, like x
        Sine, cosine. [1, 1]
    """
    if isinstance(x, float):
        return math.sin(x), math.cos(x)
    if not isinstance(x, np.ndarray):
        library = library_of(x)
        return library.sin(x), library.cos(x)
    if x.size < _FEW:
        return np.sin(x), np.cos(x)
    # Half-angle formulas: with t = tan(x/2), sin = 2t/(1+t²) and cos = 2/(1+t²) - 1. In place,
    # since the arrays are large.
    t = np.tan(0.5 * x)
    u = t * t
    u += 1.0
    np.divide(2.0, u, out=u)
    t *= u
    u -= 1.0
    return t, u


def exp(x: Arithmetic) -> Arithmetic:
    """Exponential function.

    Parameters
    ----------
    x : float or (...) array or tensor
        Exponent. [1]

    Returns
    -------
    like x
        [1]
    """
    return math.exp(x) if isinstance(x, float) else library_of(x).exp(x)


def sqrt(x: Arithmetic) -> Arithmetic:
    """Square root.

    Parameters
    ----------
    x : float or (...) array or tensor
        Not negative; above 0 for a tensor with gradient, whose derivative at 0 is infinite. [any unit]

    Returns
    -------
    like x
        [root of the unit of x]
    """
    return math.sqrt(x) if isinstance(x, float) else library_of(x).sqrt(x)


def floor(x: Arithmetic) -> Arithmetic:
    """Largest whole number not above x, as a float.

    Parameters
    ----------
    x : float or (...) array or tensor
        Number. [1]

    Returns
    -------
    like x
        [1]
    """
    return float(math.floor(x)) if isinstance(x, float) else library_of(x).floor(x)


def atan2(y: Arithmetic, x: Arithmetic) -> Arithmetic:
    """Angle of the vector (x, y) from the x axis.

    Parameters
    ----------
    y, x : float or (...) array or tensor
        Components. [any unit, the same of both]

    Returns
    -------
    like x
        In [-π, π]. [rad]
    """
    if isinstance(y, float) and isinstance(x, float):
        return math.atan2(y, x)
    library = library_of(y, x)
    if library is np:
        return np.arctan2(y, x)
    return library.atan2(*_tensors(library, y, x))


def hypot(x: Arithmetic, y: Arithmetic) -> Arithmetic:
    """Length of the vector (x, y).

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Components. [any unit, the same of both]

    Returns
    -------
    like x
        Length; of tensors with a finite derivative at 0. [the unit of x]
    """
    if isinstance(y, float) and isinstance(x, float):
        return math.sqrt(x * x + y * y)
    # A tiny number keeps the derivative finite at 0, for training with gradients.
    square = x * x + y * y
    library = library_of(x, y)
    return (square + _TINY).sqrt() if _is_torch(library) else library.sqrt(square)


def where(condition: Any, a: Arithmetic, b: Arithmetic) -> Arithmetic:
    """One value where a condition holds, another elsewhere; both are evaluated.

    Parameters
    ----------
    condition : bool or (...) array or tensor of bool
        The condition. [1]
    a, b : float or (...) array or tensor
        Value where it holds, value elsewhere. [any unit, the same of both]

    Returns
    -------
    like a and b
        [the unit of a]
    """
    # Plain truth values choose without evaluating any library.
    if condition is True:
        return a
    if condition is False:
        return b
    library = library_of(condition, a, b)
    if library is np:
        return np.where(condition, a, b)
    condition = library.as_tensor(condition) if _is_torch(library) else condition
    return library.where(condition, *_tensors(library, a, b))


def where_all(condition: Any, a: tuple, b: tuple) -> tuple:
    """`where` for each pair of values of two tuples.

    Parameters
    ----------
    condition : bool or (...) array or tensor of bool
        The condition. [1]
    a, b : tuples of n floats or (...) arrays or tensors
        Values where it holds, values elsewhere. [any units, the same of both]

    Returns
    -------
    tuple of n, like a and b
        [the units of a]
    """
    return tuple(where(condition, first, other) for first, other in zip(a, b, strict=True))


def minimum(a: Arithmetic, b: Arithmetic) -> Arithmetic:
    """The smaller of two values, element by element.

    Parameters
    ----------
    a, b : float or (...) array or tensor
        Values. [any unit, the same of both]

    Returns
    -------
    like a
        [the unit of a]
    """
    if isinstance(a, float) and isinstance(b, float):
        return a if a < b else b
    return np.minimum(a, b) if library_of(a, b) is np else where(a < b, a, b)


def maximum(a: Arithmetic, b: Arithmetic) -> Arithmetic:
    """The larger of two values, element by element.

    Parameters
    ----------
    a, b : float or (...) array or tensor
        Values. [any unit, the same of both]

    Returns
    -------
    like a
        [the unit of a]
    """
    if isinstance(a, float) and isinstance(b, float):
        return a if a > b else b
    return np.maximum(a, b) if library_of(a, b) is np else where(a > b, a, b)


def clip(x: Arithmetic, low: Arithmetic, high: Arithmetic) -> Arithmetic:
    """A value limited to the range [low, high].

    Parameters
    ----------
    x : float or (...) array or tensor
        Value. [any unit]
    low, high : like x
        Limits, low not above high. [the unit of x]

    Returns
    -------
    like x
        [the unit of x]
    """
    if isinstance(x, float) and isinstance(low, float) and isinstance(high, float):
        x = x if x > low else low
        return x if x < high else high
    return minimum(maximum(x, low), high)


def number(x: Arithmetic) -> Arithmetic:
    """A truth value or whole number as a float.

    Parameters
    ----------
    x : bool, int or float, or (...) array or tensor of them
        Value. [any unit]

    Returns
    -------
    float or (...) array or tensor
        The same value. [the unit of x]
    """
    if isinstance(x, (bool, int, float)):
        return float(x)
    maths = getattr(x, "maths", None)
    return x * 1.0 if maths is None else maths.number(x)


def is_single(x: Any) -> bool:
    """True for a single number, false for an array or tensor.

    Parameters
    ----------
    x : int or float, or (...) array or tensor
        Value. [any unit]

    Returns
    -------
    bool
        Whether it is one number. [1]
    """
    return isinstance(x, (float, int)) or hasattr(x, "maths")


def choose(condition: Any, then: Callable[[], Any], otherwise: Callable[[], Any]) -> Any:
    """The result of one of two functions; the other is not called.

    Parameters
    ----------
    condition : bool
        Whether the first is called. [1]
    then, otherwise : callable
        Without arguments and side effects; both give results of the same make. [any units]

    Returns
    -------
    any
        What the function gives. [as the functions]

    Notes
    -----
    In compiled code what follows an ``if`` stands twice, once for each answer; what follows `choose` stands once.

    Examples
    --------
    >>> choose(2 > 1, lambda: "larger", lambda: "smaller")
    'larger'
    """
    maths = getattr(condition, "maths", None)
    if maths is not None:
        return maths.choose(condition, then, otherwise)
    return then() if condition else otherwise()


def repeat(going: Callable[[Any], Any], turn: Callable[[Any], Any], state: Any) -> Any:
    """Repeat a function while a condition on its state holds; return the last state.

    Parameters
    ----------
    going : callable
        ``going(state)`` says whether there is another turn. [1]
    turn : callable
        ``turn(state)`` gives the state after it, of the same make. [as state]
    state : any
        Numbers, tuples, arrays of them. [any units]

    Returns
    -------
    like state
        The state for which the condition does not hold. [as state]

    Examples
    --------
    >>> repeat(lambda n: n < 10, lambda n: 2 * n, 3)
    12
    """
    while True:
        condition = going(state)
        # A recorded condition must become a loop in the compiled code, at whatever turn it begins.
        if (maths := getattr(condition, "maths", None)) is not None:
            return maths.repeat(going, turn, state)
        if not condition:
            return state
        state = turn(state)


def times(count: Any, turn: Callable[[Any], Any], state: Any) -> Any:
    """Apply a function to a state a number of times.

    Parameters
    ----------
    count : int or (...) array or tensor
        How many; of many counts the largest. [1]
    turn : callable
        ``turn(state)`` gives the state after it, of the same make. [as state]
    state : any
        Numbers, tuples of them. [any units]

    Returns
    -------
    like state
        The state after the last turn. [as state]

    Examples
    --------
    >>> times(3, lambda n: 2 * n, 5)
    40
    """
    # Recorded numbers may be anywhere in the state: look at the first number of each part.
    maths = getattr(count, "maths", None)
    for part in state if isinstance(state, tuple) else (state,):
        while isinstance(part, tuple):
            part = part[0]
        maths = maths or getattr(part, "maths", None)
    # The count is carried along in the state of a recorded loop.
    if maths is not None:
        return maths.repeat(
            lambda now: now[0] < count, lambda now: (now[0] + 1.0, turn(now[1])), (0.0, state)
        )[1]
    for _ in range(count if is_single(count) else int(count.max())):
        state = turn(state)
    return state


def mapped(function: Callable[..., Any], *columns: Any) -> list[Any]:
    """Apply a function to each row of some columns.

    Parameters
    ----------
    function : callable
        Of one number of each column, without side effects.
    columns : (n,) arrays or sequences
        What it is applied to. [any units]

    Returns
    -------
    list of n
        What the function gives for each row. [as the function]

    Notes
    -----
    Compiled code has one loop, where a comprehension would be written out row by row.

    Examples
    --------
    >>> mapped(lambda a, b: a + b, (1, 2, 3), (10, 20, 30))
    [11, 22, 33]
    """
    maths = library_of(*(column[0] for column in columns))
    if hasattr(maths, "mapped"):
        return maths.mapped(function, columns)
    return [function(*row) for row in zip(*columns, strict=True)]


def row_of(table: Any, index: Any) -> Any:
    """Row of a table, or element of a sequence, by number.

    Parameters
    ----------
    table : (n, ...) array, or sequence of n
        The table. [any units]
    index : int or (m,) array of int
        Number of the row, not negative. [1]

    Returns
    -------
    like table[0]
        The row; several rows for an array of numbers. [the units of table]
    """
    maths = getattr(index, "maths", None)
    return table[index] if maths is None else maths.row_of(table, index)


def _many(x):
    """True for an array so large that computing its elements costs more than some NumPy calls."""
    return isinstance(x, np.ndarray) and x.size >= _FEW


def _is_torch(library):
    return library is sys.modules.get("torch")


def _tensors(torch: Any, *values: Any) -> list[Any] | tuple[Any, ...]:
    """All values as tensors like the first tensor, or of double precision if there is none."""
    if not _is_torch(torch):
        return values
    like = next(
        (value for value in values if isinstance(value, torch.Tensor)),
        torch.zeros((), dtype=torch.float64),
    )
    return [torch.as_tensor(value, dtype=like.dtype, device=like.device) for value in values]
