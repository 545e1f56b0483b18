"""Python's math functions and number types, replaced so that modules can run on symbols."""

from __future__ import annotations

import functools
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np

from shipcosim.native.export.arrays import NumPy
from shipcosim.native.symbols import Maths, Symbol, first_symbol

NAMED = (
    "sin",
    "cos",
    "tan",
    "exp",
    "log",
    "sqrt",
    "tanh",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "log10",
)


def _of(original: Callable, of_symbols: Callable) -> Callable:
    def call(*values):
        return original(*values) if first_symbol(*values) is None else of_symbols(*values)

    return call


class _AsType(type):
    """A number type whose constructor maps symbols to symbols."""

    def __call__(cls, *values: Any) -> Any:
        if values and isinstance(values[0], np.ndarray) and values[0].ndim == 0:
            values = (values[0].item(),)
        if values and isinstance(values[0], Symbol):
            return cls.of_symbol(values[0])  # pyright: ignore[reportAttributeAccessIssue]
        return cls.original(*values)  # pyright: ignore[reportAttributeAccessIssue]

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, cls.original)  # pyright: ignore[reportAttributeAccessIssue]


class _Int(metaclass=_AsType):
    original = int
    of_symbol = staticmethod(Maths.whole)


class _Float(metaclass=_AsType):
    original = float
    of_symbol = staticmethod(Maths.number)


_FUNCTIONS: dict[str, Callable] = {
    name: lambda x, name=name: x.function(name) for name in NAMED
} | {
    "atan2": Maths.atan2,
    "hypot": lambda x, y: Maths.sqrt(x * x + y * y),
    "fabs": abs,
    "copysign": Maths.copysign,
    "pow": lambda x, y: x**y,
    "radians": lambda x: x * (math.pi / 180.0),
    "degrees": lambda x: x * (180.0 / math.pi),
}
_REPLACED = {
    getattr(math, name): _of(getattr(math, name), function) for name, function in _FUNCTIONS.items()
}
_MATH = SimpleNamespace(
    **(vars(math) | {f.__name__: replaced for f, replaced in _REPLACED.items()})
)

_NUMPY = NumPy()


@contextmanager
def understood(package: str) -> Iterator[None]:
    """Let int, float, `math` and NumPy accept symbols in the modules of a package."""
    # A model finds these names in its module, so its code needs no change to run on symbols.
    modules = [
        vars(module)
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] == package
    ]
    # Keep the names of each module: they must be restored after the recording.
    before = [dict(module) for module in modules]
    for module in modules:
        for name, value in list(module.items()):
            if value is math:
                module[name] = _MATH
            elif value is np:
                module[name] = _NUMPY
            elif isinstance(value, functools._lru_cache_wrapper):
                # Symbols have no hash, so a cache by arguments is bypassed for them.
                module[name] = _of(value, value.__wrapped__)
            elif callable(value) and getattr(value, "__module__", "") == "math":
                module[name] = _REPLACED.get(value, value)
        # Built-in names are found after the module's names: define them there.
        module.setdefault("int", _Int)
        module.setdefault("float", _Float)
    try:
        yield
    finally:
        # Restore every module, also after an error; other FMUs share this process.
        for module, kept in zip(modules, before, strict=True):
            for name in set(module) - set(kept):
                del module[name]
            module.update(kept)
