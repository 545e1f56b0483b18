"""NumPy for arrays that may hold symbols; linear algebra and random numbers become C primitives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shipcosim.native.symbols import (
    Maths,
    SymbolArray,
    Untraceable,
    as_symbols,
    first_symbol,
    primitive,
)


class _OrNumPy:
    """Wrapper of a NumPy module: results that hold symbols become symbol arrays."""

    def __init__(self, module: Any):
        self._module = module

    def __getattr__(self, name: str) -> Any:
        attribute = getattr(self._module, name)
        if isinstance(attribute, type) or not callable(attribute):
            return attribute
        return lambda *values, **named: as_symbols(attribute(*values, **named))


def _each(function: Callable, *matrices: np.ndarray) -> np.ndarray:
    """Apply a function of matrices to the last two axes of stacked matrices."""
    # The leading axes are broadcast as NumPy does; the C primitive takes one matrix at a time.
    stack = np.broadcast_shapes(*(matrix.shape[:-2] for matrix in matrices))
    if not stack:
        return function(*matrices)
    full = [np.broadcast_to(matrix, (*stack, *matrix.shape[-2:])) for matrix in matrices]
    rows = [_each(function, *(matrix[k] for matrix in full)) for k in range(stack[0])]
    return as_symbols(np.stack(rows))


class _LinearAlgebra(_OrNumPy):
    def inv(self, a: Any) -> np.ndarray:
        a = np.asarray(a)
        # A⁻¹ is the solution of A X = I: one C primitive serves both.
        return self.solve(a, np.broadcast_to(np.eye(a.shape[-1]), a.shape))

    def solve(self, a: Any, b: Any) -> np.ndarray:
        a = np.asarray(a)
        b = np.asarray(b)
        symbol = first_symbol(a, b)
        if symbol is None:
            return np.linalg.solve(a, b)
        # A vector is a matrix with one column.
        if b.ndim == 1:
            return self.solve(a, b[:, None])[:, 0]

        def of_one(a, b):
            n, m = b.shape
            # The C primitive takes the sizes first, then both matrices row by row.
            return primitive(
                symbol, "solved", (n, m), [n, m, *a.ravel().tolist(), *b.ravel().tolist()]
            )

        return _each(of_one, a, b)

    def pinv(self, a: Any, rcond: float = 1e-15) -> np.ndarray:
        a = np.asarray(a)
        symbol = first_symbol(a)
        if symbol is None:
            return np.linalg.pinv(a, rcond=rcond)

        def of_one(a):
            m, n = a.shape
            return primitive(symbol, "pseudo_inverse", (n, m), [m, n, rcond, *a.ravel().tolist()])

        return _each(of_one, a)


class _Generator:
    """A random generator with symbolic seeds."""

    def __init__(self, seeds: Sequence[Any]):
        self._seeds = list(seeds)
        self._drawn = []

    def random(self, size: Any = None) -> Any:
        return self._draw(0, size)

    def standard_normal(self, size: Any = None) -> Any:
        return self._draw(1, size)

    def uniform(self, low: float = 0.0, high: float = 1.0, size: Any = None) -> Any:
        return low + (high - low) * self._draw(0, size)

    def normal(self, loc: float = 0.0, scale: float = 1.0, size: Any = None) -> Any:
        return loc + scale * self._draw(1, size)

    def __getattr__(self, name: str) -> Any:
        raise Untraceable(
            f"it draws random numbers by {name}: random, uniform and normal ones can be compiled"
        )

    def _draw(self, kind, size):
        shape: Any = (
            () if size is None else (size,) if isinstance(size, (int, np.integer)) else tuple(size)
        )
        # The C runtime has no generator object. Each call gives the whole history of draws, so it
        # can repeat them and return the last.
        self._drawn += [kind, int(np.prod(shape, dtype=int))]
        symbol = first_symbol(self._seeds)
        assert symbol is not None
        numbers = primitive(
            symbol, "random_numbers", shape, [len(self._seeds), *self._seeds, *self._drawn]
        )
        return numbers if shape else numbers.item()


class _Random(_OrNumPy):
    def default_rng(self, seed: Any = None) -> Any:
        seeds = list(seed) if isinstance(seed, (tuple, list)) else [seed]
        return np.random.default_rng(seed) if first_symbol(seeds) is None else _Generator(seeds)


def _with_symbols(original: Callable, of_symbols: Callable) -> Callable:
    def call(*values, **named):
        return original(*values, **named) if first_symbol(*values) is None else of_symbols(*values)

    return call


def _clipped(x, low, high):
    return _smaller(_larger(x, low), high)


def _interpolated(x, xs, ys):
    symbol = first_symbol(x, xs, ys)
    # A scalar in a constant table has its own operation; other cases go to a C primitive.
    x = np.asarray(x)
    if first_symbol(xs, ys) is None and x.ndim == 0:
        return Maths.interp(x.item(), xs, ys)
    assert symbol is not None
    xs = np.asarray(xs)
    ys = np.asarray(ys)
    # The primitive's arguments: both sizes, the points x, then the table of xs and ys.
    given = [x.size, xs.size, *x.ravel().tolist(), *xs.tolist(), *ys.tolist()]
    numbers = primitive(symbol, "interpolated_in", x.shape, given)
    return numbers if x.ndim else numbers.item()


def _as_array(value, dtype=None, **_):
    return np.array(value, dtype=object).view(SymbolArray)


def _elementwise(function):
    many = np.frompyfunc(function, 2, 1)
    return lambda a, b: (
        many(a, b) if isinstance(a, np.ndarray) or isinstance(b, np.ndarray) else function(a, b)
    )


_smaller = _elementwise(Maths.minimum)
_larger = _elementwise(Maths.maximum)


class NumPy(_OrNumPy):
    """`numpy` for modules that run on symbols."""

    def __init__(self):
        super().__init__(np)
        self.linalg = _LinearAlgebra(np.linalg)
        self.random = _Random(np.random)
        self.where = _with_symbols(np.where, np.frompyfunc(Maths.where, 3, 1))
        self.minimum = _with_symbols(np.minimum, _smaller)
        self.maximum = _with_symbols(np.maximum, _larger)
        self.clip = _with_symbols(np.clip, _clipped)
        self.interp = _with_symbols(np.interp, _interpolated)
        self.zeros = self.empty = lambda shape, *_, **__: (
            np.zeros(shape).astype(object).view(SymbolArray)
        )
        self.array = _with_symbols(np.array, _as_array)
        self.asarray = _with_symbols(np.asarray, _as_array)
