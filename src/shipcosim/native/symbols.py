"""Numbers that record what is computed with them; models run on them instead of floats.

A `Symbol` is one value in a `Recording`. Arithmetic with it adds a value to the recording. Where Python asks whether a
symbol is true, the recording forks: the model runs once for either answer.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Sequence
from typing import Any, cast

import numpy as np


class Untraceable(Exception):
    """A component does something that cannot be compiled; the text says what."""


SAID = "\x01"
"""Stands before and after a value in a text, which is known only when the code runs."""


def _binary(op, kind=None):
    def forward(self, other):
        # NumPy takes over for arrays, element by element.
        if isinstance(other, np.ndarray):
            return NotImplemented
        return self.combined(op, self, other, kind)

    def backward(self, other):
        return self.combined(op, other, self, kind)

    return forward, backward


def _unary(op, kind="d"):
    return lambda self: self.function(op, kind)


class Symbol:
    """One value of a recording.

    Attributes
    ----------
    recording : Recording
        That it is a value of.
    number : int
        In its recording.
    op : str
        What computes it.
    kind : str
        "d" a float, "i" a whole number, "b" a truth value.
    operands : tuple
        Symbols and numbers.
    block : int
        Number of the block that computes it.
    """

    __slots__ = ("recording", "number", "op", "kind", "operands", "block")

    def __init__(
        self, recording: Any, number: int, op: str, kind: str, operands: tuple, block: int
    ):
        self.recording = recording
        self.number = number
        self.op = op
        self.kind = kind
        self.operands = operands
        self.block = block

    @property
    def maths(self) -> type[Maths]:
        """The elementary functions of symbols, which models find by this name."""
        return Maths

    def combined(self, op: str, a: Any, b: Any, kind: str | None = None) -> Any:
        """Record an operation with two operands."""
        # Python repeats a sequence by `*`; the count must be a whole number known now.
        if op == "*" and (isinstance(a, (tuple, list)) or isinstance(b, (tuple, list))):
            count, repeated = cast("tuple[Any, Any]", (a, b) if isinstance(a, Symbol) else (b, a))
            return operator.index(count) * repeated
        if not isinstance(a, NUMBERS) or not isinstance(b, NUMBERS):
            raise Untraceable(
                f"it computes with a {type(b if isinstance(a, NUMBERS) else a).__name__}"
            )
        a = plain(a)
        b = plain(b)
        # Whole numbers stay whole, except in a division or a power.
        if kind is None:
            kind = "i" if op not in ("/", "**") and kind_of(a) != "d" and kind_of(b) != "d" else "d"
        return self.recording.value(op, kind, a, b)

    def sources(self) -> Iterator[Symbol]:
        """This value and all values that it is computed from."""
        due: list[Any] = [self]
        seen: set[int] = set()
        while due:
            value = due.pop()
            if isinstance(value, Symbol) and value.number not in seen:
                seen.add(value.number)
                yield value
                due.extend(value.operands)

    def function(self, op: str, kind: str = "d") -> Symbol:
        """Record a function of this value."""
        return self.recording.value(op, kind, self)

    __add__, __radd__ = _binary("+")
    __sub__, __rsub__ = _binary("-")
    __mul__, __rmul__ = _binary("*")
    __truediv__, __rtruediv__ = _binary("/")
    __floordiv__, __rfloordiv__ = _binary("//")
    __mod__, __rmod__ = _binary("%")
    __pow__, __rpow__ = _binary("**")
    __lt__, _ = _binary("<", "b")
    __le__, _ = _binary("<=", "b")
    __gt__, _ = _binary(">", "b")
    __ge__, _ = _binary(">=", "b")
    __eq__, _ = _binary("==", "b")  # pyright: ignore[reportAssignmentType]
    __ne__, _ = _binary("!=", "b")  # pyright: ignore[reportAssignmentType]
    __and__, __rand__ = _binary("&", "b")
    __or__, __ror__ = _binary("|", "b")
    __xor__, __rxor__ = _binary("^", "b")

    __hash__ = None  # pyright: ignore[reportAssignmentType]  # what is remembered by its arguments knows no symbols

    def __neg__(self):
        return self.function("neg", "d" if self.kind == "d" else "i")

    def __pos__(self):
        return self

    def __abs__(self):
        return self.function("abs", "d" if self.kind == "d" else "i")

    __invert__ = _unary("not", "b")
    __floor__ = _unary("floor", "i")
    __ceil__ = _unary("ceil", "i")

    def __round__(self, digits: int | None = None):
        return self.recording.value("round", "i" if digits is None else "d", self, digits or 0)

    def __bool__(self):
        return self.recording.decide(self)

    def __float__(self):
        raise Untraceable("it asks for a value as a float: use number(...) of models.core.maths")

    def __index__(self):
        return self.recording.guarded(self)

    __int__ = __index__

    def __getitem__(self, key):
        return np.array(self, dtype=object)[key]

    def item(self) -> Symbol:
        """This symbol, as NumPy's arrays without dimensions give their number."""
        return self

    def __iter__(self):
        raise Untraceable("it goes through a single value as if it were several")

    def __repr__(self):
        return f"v{self.number}"

    # The value is unknown now: leave a mark in the text that C later replaces.
    def __format__(self, how: str) -> str:
        self.recording.named[self.number] = self
        return f"{SAID}{self.number}:{how}{SAID}"

    def __str__(self):
        return format(self, "")

    # what NumPy's functions call on the elements of an array of objects

    sin = _unary("sin")
    cos = _unary("cos")
    tan = _unary("tan")
    exp = _unary("exp")
    log = _unary("log")
    log1p = _unary("log1p")
    sqrt = _unary("sqrt")
    tanh = _unary("tanh")
    floor = _unary("floor")

    def arctan2(self, other: Any) -> Symbol:
        return self.combined("atan2", self, other, "d")

    def astype(self, kind: type) -> Symbol:
        """This value as a whole number or float."""
        return Maths.number(self) if kind is float else Maths.whole(self)


NUMBERS = (Symbol, int, float, np.number, np.bool_)


def plain(value: Any) -> Any:
    """A NumPy number as a Python number."""
    return value.item() if isinstance(value, np.generic) else value


def kind_of(value: Any) -> str:
    """Kind of a number, as in `Symbol.kind`."""
    if isinstance(value, Symbol):
        return value.kind
    return (
        "b"
        if isinstance(value, (bool, np.bool_))
        else "i"
        if isinstance(value, (int, np.integer))
        else "d"
    )


def first_symbol(*values: Any) -> Symbol | None:
    """The first symbol among values, in arrays, sequences, dicts and objects."""
    for value in values:
        if isinstance(value, Symbol):
            return value
        if isinstance(value, np.ndarray) and value.dtype == object:
            for element in value.flat:
                if isinstance(element, Symbol):
                    return element
        # Search containers, and only those objects that are marked as holding symbols.
        inside = value if isinstance(value, (tuple, list)) else ()
        inside = (
            value.values()
            if isinstance(value, dict)
            else vars(value).values()
            if hasattr(value, "maths")
            else inside
        )
        if (symbol := first_symbol(*inside)) is not None:
            return symbol
    return None


def _elementwise(function: Callable) -> Callable:
    """A function of numbers that also takes arrays."""

    def call(*values):
        if any(isinstance(value, np.ndarray) for value in values):
            return as_symbols(np.frompyfunc(function, len(values), 1)(*values))
        return function(*values)

    return staticmethod(call)


def _of_one(op: str, of_float: Callable, kind: str = "d") -> Callable:
    return _elementwise(lambda x: x.function(op, kind) if isinstance(x, Symbol) else of_float(x))


def _where(condition, a, b):
    # A known condition chooses now, without a value in the recording.
    symbol = first_symbol(condition, a, b)
    if symbol is None or not isinstance(condition, Symbol):
        return a if condition else b
    if a is b:
        return a
    a = plain(a)
    b = plain(b)
    # Two kinds mix to a float, as C has one type for the result.
    kinds = {kind_of(a), kind_of(b)}
    return symbol.recording.value("where", kinds.pop() if len(kinds) == 1 else "d", condition, a, b)


def _atan2(y, x):
    symbol = first_symbol(y, x)
    return np.arctan2(y, x) if symbol is None else symbol.combined("atan2", y, x, "d")


def _first(*values):
    symbol = first_symbol(*values)
    assert symbol is not None
    return symbol


class Maths:
    """Elementary functions of symbols and arrays of them; `models.core.maths` calls these."""

    sin = _of_one("sin", np.sin)
    cos = _of_one("cos", np.cos)
    tan = _of_one("tan", np.tan)
    exp = _of_one("exp", np.exp)
    log = _of_one("log", np.log)
    sqrt = _of_one("sqrt", np.sqrt)
    tanh = _of_one("tanh", np.tanh)
    floor = _of_one("floor", np.floor)
    number = _of_one("number", float)
    whole = _of_one("whole", int, "i")
    atan2 = _elementwise(_atan2)
    where = _elementwise(_where)

    @staticmethod
    def kept(function: Callable, arguments: tuple) -> Any:
        """See `Recording.kept`."""
        symbol = first_symbol(*arguments)
        return (
            function(*arguments) if symbol is None else symbol.recording.kept(function, arguments)
        )

    @staticmethod
    def repeat(going: Callable, turn: Callable, state: Any) -> Any:
        """See `Recording.repeat`."""
        symbol = first_symbol(state)
        if symbol is None:
            raise Untraceable("it repeats what begins with numbers alone")
        return symbol.recording.repeat(going, turn, state)

    @staticmethod
    def choose(condition: Symbol, then: Callable, otherwise: Callable) -> Any:
        """See `Recording.choose`."""
        return condition.recording.choose(condition, then, otherwise)

    @staticmethod
    def acts(value: Any, neutral: float) -> bool:
        """True if a parameter can have an effect; always true if it is fixed in the code."""
        symbol = first_symbol(value)
        if symbol is None or not symbol.recording.stands_alone:
            return True
        return symbol.recording.acts(value, neutral)

    @staticmethod
    def repeat_of(fmu: Any, going: Callable, turn: Callable) -> None:
        """Record a loop over the attributes of a component; see `Recording.repeat`."""
        # Parameters cannot change in a loop, so they need not be carried.
        fixed = {variable.name for variable in fmu.variables if variable.causality == "parameter"}
        fixed |= {group.name for group in fmu.groups}
        values = vars(fmu)

        def with_state(function, state):
            values.update(state)
            return function()

        # Record one turn only to see which attributes it changes. These are the state of the loop.
        before = dict(values)
        changed = set()

        def noticed():
            with_state(turn, before)
            changed.update(
                name for name, value in values.items() if value is not before.get(name, before)
            )

        condition = with_state(going, before)
        condition.recording.record(noticed, condition.recording.block)
        # Sorted, so that the recording is the same each time.
        names = sorted(changed - fixed)

        def turned(state):
            with_state(turn, {**before, **state})
            return {name: values[name] for name in names}

        start = {name: before[name] for name in names}
        # Record the loop on that state alone; all other attributes keep their values.
        after = condition.recording.repeat(lambda state: with_state(going, state), turned, start)
        values.update({**before, **after})

    copysign = _elementwise(lambda x, y: _first(x, y).combined("copysign", x, y, "d"))
    stack = staticmethod(np.stack)
    concatenate = staticmethod(np.concatenate)

    @staticmethod
    def minimum(a: Any, b: Any) -> Any:
        """The smaller of two values."""
        return Maths.where(operator.lt(a, b), a, b)

    @staticmethod
    def maximum(a: Any, b: Any) -> Any:
        """The larger of two values."""
        return Maths.where(operator.gt(a, b), a, b)

    @staticmethod
    def interp(x: Any, xs: Sequence[float], ys: Sequence[float]) -> Any:
        """Linear interpolation, as `models.core.interpolation.interp` for a float."""
        if isinstance(x, np.ndarray):
            return np.array(
                [Maths.interp(element, xs, ys) for element in x.flat], dtype=object
            ).reshape(x.shape)
        if first_symbol(xs, ys) is not None:
            # Linear interpolation in a short table of values in memory.
            # Start left of the table, then take the last interval whose start is not beyond x.
            result = ys[0]
            for k in range(len(xs) - 1):
                between = ys[k] + (ys[k + 1] - ys[k]) * (x - xs[k]) / (xs[k + 1] - xs[k])
                result = Maths.where(x >= xs[k], between, result)
            return Maths.where(x >= xs[len(xs) - 1], ys[len(xs) - 1], result)
        # Constant points become tables of the C text, and the search runs there.
        recording = x.recording
        first = recording.table(np.asarray(xs))
        second = recording.table(np.asarray(ys))
        return recording.value("interp", "d", x, first, second, len(xs))

    @staticmethod
    def row_of(table: Any, index: Symbol) -> Any:
        """See `Recording.row_of`."""
        return index.recording.row_of(table, index)

    @staticmethod
    def mapped(function: Callable, columns: Sequence[Any]) -> list[Any]:
        """See `Recording.mapped`."""
        return _first(*columns).recording.mapped(function, columns)


def primitive(
    symbol: Symbol, name: str, shape: tuple[int, ...], arguments: Sequence[Any]
) -> np.ndarray:
    """Call a function of the C runtime; its result is an array of symbols.

    Parameters
    ----------
    symbol : Symbol
        Any of the recording.
    name : str
        Of the function.
    shape : tuple of int
        Of its result.
    arguments : sequence of float or Symbol
        What it is given.
    """
    size = int(np.prod(shape, dtype=int))
    recording = symbol.recording
    # The primitive is one value, an array in C. Each element is a value that reads it.
    made = recording.value("primitive", "d", name, size, *arguments)
    parts = [recording.value("part", "d", made, place) for place in range(size)]
    # Fill an array made before: NumPy would try to read the symbols as sequences.
    result = np.empty(size, dtype=object)
    result[:] = parts
    return result.reshape(shape).view(SymbolArray)


class SymbolArray(np.ndarray):
    """An array that may hold symbols: comparisons and extremes are symbols too."""

    @property
    def maths(self) -> Any:
        """See `Symbol.maths`; None for numbers without symbols."""
        return None if first_symbol(self) is None else Maths

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **named: Any) -> Any:
        # Plain arrays avoid that NumPy calls this method again.
        given = [
            operand.view(np.ndarray) if isinstance(operand, SymbolArray) else operand
            for operand in inputs
        ]
        named.pop("out", None)
        # Without this, NumPy would ask each comparison for its truth and so fork the recording.
        if method == "__call__" and ufunc.__name__ in COMPARISONS:
            named["dtype"] = object
        elif method == "__call__" and ufunc.__name__ in FUNCTIONS:
            return as_symbols(FUNCTIONS[ufunc.__name__](*given))
        # Large products become one C primitive. Written out they would be thousands of values.
        elif (
            ufunc is np.matmul
            and min(operand.ndim for operand in given) > 1
            and given[0].shape[-1] > 3
        ):
            symbol = first_symbol(*given)
            if symbol is not None and symbol.recording.stands_alone:
                return _products(symbol, *given)
        # Extremes as symbols: a comparison by NumPy would fork for each element.
        elif ufunc in _EXTREMES:
            ufunc = _EXTREMES[ufunc]
            named = {key: value for key, value in named.items() if key == "axis"}
        result = getattr(ufunc, method)(*given, **named)
        return (
            result.item()
            if isinstance(result, np.ndarray) and result.ndim == 0
            else as_symbols(result)
        )


def _products(symbol, a, b):
    """Product of matrices over the last two axes."""
    stack = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    if stack:
        a, b = (np.broadcast_to(matrix, (*stack, *matrix.shape[-2:])) for matrix in (a, b))
        return np.stack(
            [_products(symbol, first, other) for first, other in zip(a, b, strict=True)]
        ).view(SymbolArray)
    sizes = [*a.shape, b.shape[1]]
    return primitive(
        symbol,
        "multiplied",
        (a.shape[0], b.shape[1]),
        [*sizes, *a.ravel().tolist(), *b.ravel().tolist()],
    )


COMPARISONS = {"greater", "greater_equal", "less", "less_equal", "equal", "not_equal"}
FUNCTIONS = {
    name: getattr(Maths, name)
    for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "floor")
}
FUNCTIONS["arctan2"] = Maths.atan2
_EXTREMES = {
    np.maximum: np.frompyfunc(Maths.maximum, 2, 1),
    np.minimum: np.frompyfunc(Maths.minimum, 2, 1),
}


def as_symbols(value: Any) -> Any:
    """Arrays of objects as `SymbolArray`, also in tuples and lists; other values unchanged."""
    if isinstance(value, np.ndarray) and value.dtype == object:
        return value.view(SymbolArray)
    if type(value) is tuple:
        return tuple(map(as_symbols, value))
    return [as_symbols(part) for part in value] if type(value) is list else value
