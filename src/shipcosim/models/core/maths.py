"""The functions that models are written in: each works on floats, NumPy arrays and torch tensors.

Python floats take the first branch, so that a model in an FMU costs what `math` costs. torch is never imported here;
it can only be needed where somebody already passed a tensor.
"""

import math
import sys
from bisect import bisect_right
from typing import NamedTuple

import numpy as np

pi = math.pi
_TINY = 1e-30
_FEW = 256  # elements, below which a call of NumPy costs more than what it computes


def _library(*values):
    """NumPy, or torch when one of the values is a tensor."""
    torch = sys.modules.get("torch")
    if torch is not None and any(isinstance(value, torch.Tensor) for value in values):
        return torch
    return np


def sin(x):
    """Sine of an angle in rad."""
    if isinstance(x, float):
        return math.sin(x)
    return sincos(x)[0] if _many(x) else _library(x).sin(x)


def cos(x):
    """Cosine of an angle in rad."""
    if isinstance(x, float):
        return math.cos(x)
    return sincos(x)[1] if _many(x) else _library(x).cos(x)


def sincos(x):
    """Sine and cosine of an angle in rad; together cheaper than each alone.

    Of many angles at once they are t u and u - 1 with t = tan(x/2) and u = 2/(1 + t²): NumPy's tangent is vectorised,
    its sine and cosine of doubles are not. They differ from those by some 1e-16.

    Parameters
    ----------
    x : float or (...) array or tensor
        Angle. [rad]

    Returns
    -------
    tuple of two, like x
    """
    if isinstance(x, float):
        return math.sin(x), math.cos(x)
    if not isinstance(x, np.ndarray):
        library = _library(x)
        return library.sin(x), library.cos(x)
    if x.size < _FEW:
        return np.sin(x), np.cos(x)
    t = np.tan(0.5 * x)
    u = t * t
    u += 1.0
    np.divide(2.0, u, out=u)
    t *= u
    u -= 1.0
    return t, u


def exp(x):
    """e to the x."""
    return math.exp(x) if isinstance(x, float) else _library(x).exp(x)


def sqrt(x):
    """Square root; the derivative at 0 is infinite, so give a tensor a floor first."""
    return math.sqrt(x) if isinstance(x, float) else _library(x).sqrt(x)


def tanh(x):
    """Hyperbolic tangent."""
    return math.tanh(x) if isinstance(x, float) else _library(x).tanh(x)


def floor(x):
    """Largest whole number not above x, as float."""
    return float(math.floor(x)) if isinstance(x, float) else _library(x).floor(x)


def atan2(y, x):
    """Angle of the vector (x, y) in (-π, π]."""
    if isinstance(y, float) and isinstance(x, float):
        return math.atan2(y, x)
    library = _library(y, x)
    if library is np:
        return np.arctan2(y, x)
    return library.atan2(*_tensors(library, y, x))


def hypot(x, y):
    """Length of the vector (x, y); of tensors with a finite derivative at 0 too."""
    if isinstance(y, float) and isinstance(x, float):
        return math.sqrt(x * x + y * y)
    square = x * x + y * y
    return np.sqrt(square) if _library(x, y) is np else (square + _TINY).sqrt()


def where(condition, a, b):
    """`a` where the condition holds, `b` elsewhere. Both are evaluated."""
    if condition is True:
        return a
    if condition is False:
        return b
    library = _library(condition, a, b)
    if library is np:
        return np.where(condition, a, b)
    return library.where(library.as_tensor(condition), *_tensors(library, a, b))


def minimum(a, b):
    """The smaller of the two, element by element."""
    if isinstance(a, float) and isinstance(b, float):
        return a if a < b else b
    return np.minimum(a, b) if _library(a, b) is np else where(a < b, a, b)


def maximum(a, b):
    """The larger of the two, element by element."""
    if isinstance(a, float) and isinstance(b, float):
        return a if a > b else b
    return np.maximum(a, b) if _library(a, b) is np else where(a > b, a, b)


def clip(x, low, high):
    """`x` within [low, high]."""
    if isinstance(x, float) and isinstance(low, float) and isinstance(high, float):
        x = x if x > low else low
        return x if x < high else high
    return minimum(maximum(x, low), high)


def sign(x):
    """-1.0, 0.0 or 1.0."""
    return where(x > 0, 1.0, where(x < 0, -1.0, 0.0))


def wrap(angle):
    """The same angle in [-π, π)."""
    if isinstance(angle, float) and -pi <= angle < pi:
        return angle
    return angle - 2.0 * pi * floor((angle + pi) / (2.0 * pi))


def interp(x, xs, ys):
    """Piecewise linear interpolation, constant beyond the ends.

    Parameters
    ----------
    x : float or (...) array or tensor
        Where.
    xs : tuple of float, increasing
        Abscissae of the table.
    ys : tuple of float
        Ordinates of the table.

    Returns
    -------
    like x
    """
    if isinstance(x, float):
        if x <= xs[0]:
            return ys[0]
        if x >= xs[-1]:
            return ys[-1]
        i = bisect_right(xs, x) - 1
        return ys[i] + (ys[i + 1] - ys[i]) * (x - xs[i]) / (xs[i + 1] - xs[i])
    library = _library(x)
    if library is np:
        return np.interp(x, xs, ys)
    return _interp_tensor(library, x, xs, ys)


def interp_columns(x, xs, *columns):
    """Several columns of one table by piecewise linear interpolation, constant beyond the ends.

    Parameters
    ----------
    x : float or (...) array or tensor
        Where.
    xs : tuple of float, increasing
        Abscissae of the table.
    columns : tuples of float
        Ordinates of the table.

    Returns
    -------
    list, one value like x per column
    """
    if not isinstance(x, float):
        return [interp(x, xs, ys) for ys in columns]
    if x <= xs[0]:
        return [ys[0] for ys in columns]
    if x >= xs[-1]:
        return [ys[-1] for ys in columns]
    i = bisect_right(xs, x)
    share = (x - xs[i - 1]) / (xs[i] - xs[i - 1])
    return [ys[i - 1] + (ys[i] - ys[i - 1]) * share for ys in columns]


class EvenTable(NamedTuple):
    """Columns over evenly spaced abscissae, made by `even_table`.

    Parameters
    ----------
    first, per_unit : float
        First abscissa, and how many there are per unit.
    rows : tuple of tuples of pairs
        Per abscissa and column the value, and its change up to the next one.
    array : (n, 2 columns) array
        The same: values, then changes.
    """

    first: float
    per_unit: float
    rows: tuple
    array: np.ndarray


def even_table(xs, *columns):
    """A table for `interp_even`.

    Parameters
    ----------
    xs : (n,) array, evenly spaced
        Abscissae.
    columns : (n,) arrays
        Ordinates of the table.

    Returns
    -------
    EvenTable
    """
    values = np.stack(columns, axis=-1)
    changes = np.diff(values, axis=0, append=values[-1:])
    rows = (tuple(zip(*row, strict=True)) for row in zip(values.tolist(), changes.tolist(), strict=True))
    per_unit = float((len(xs) - 1) / (xs[-1] - xs[0]))
    return EvenTable(float(xs[0]), per_unit, tuple(rows), np.concatenate([values, changes], axis=-1))


def interp_even(x, table):
    """All columns of a table with even abscissae by piecewise linear interpolation, without a search.

    Parameters
    ----------
    x : float or (...) array or tensor
        Where, within the table.
    table : EvenTable

    Returns
    -------
    list, one value like x per column
    """
    position = (x - table.first) * table.per_unit
    if isinstance(x, float):
        below = int(position)
        share = position - below
        return [value + share * change for value, change in table.rows[below]]
    below = floor(position)
    library, share = _library(x), position - below
    if library is np:
        rows = np.take(table.array, below.astype(int), axis=0)
    else:
        rows = library.as_tensor(table.array, dtype=x.dtype, device=x.device)[below.detach().long()]
    width = rows.shape[-1] // 2
    return [rows[..., k] + share * rows[..., width + k] for k in range(width)]


def rk4(rates, state, h):
    """One Runge-Kutta step of fourth order.

    Parameters
    ----------
    rates : callable
        ``rates(*state)`` gives the tuple of time derivatives.
    state : tuple of scalars
        Values at the start.
    h : float
        Step. [s]

    Returns
    -------
    tuple like state
        Values at the end.

    Examples
    --------
    Decay over one time constant, a tenth at a time, against 1/e = 0.367879:

    >>> y = (1.0,)
    >>> for _ in range(10):
    ...     y = rk4(lambda y: (-y,), y, 0.1)
    >>> round(y[0], 6)
    0.36788
    """
    half, sixth = 0.5 * h, h / 6.0
    k1 = rates(*state)
    k2 = rates(*[y + half * k for y, k in zip(state, k1, strict=True)])
    k3 = rates(*[y + half * k for y, k in zip(state, k2, strict=True)])
    k4 = rates(*[y + h * k for y, k in zip(state, k3, strict=True)])
    slopes = zip(state, k1, k2, k3, k4, strict=True)
    return tuple([y + sixth * (a + 2.0 * (b + c) + d) for y, a, b, c, d in slopes])


def rk4_pair(rates, x, y, h, start, middle, end):
    """One Runge-Kutta step of fourth order of two variables, without the loops of `rk4`.

    Parameters
    ----------
    rates : callable
        ``rates(x, y, *driven)`` gives the two time derivatives.
    x, y : scalars
        Values at the start.
    h : float
        Step. [s]
    start, middle, end : tuples
        What the rates depend on besides, known in advance, at these times of the step.

    Returns
    -------
    tuple of two
        Values at the end.
    """
    half, sixth = 0.5 * h, h / 6.0
    a, p = rates(x, y, *start)
    b, q = rates(x + half * a, y + half * p, *middle)
    c, r = rates(x + half * b, y + half * q, *middle)
    d, s = rates(x + h * c, y + h * r, *end)
    return x + sixth * (a + 2.0 * (b + c) + d), y + sixth * (p + 2.0 * (q + r) + s)


def substeps(h, longest):
    """Number of equal sub-steps of at most `longest` that make up the step h.

    Examples
    --------
    >>> substeps(0.05, 0.05), substeps(0.1, 0.03)
    (1, 4)
    """
    return max(1, math.ceil(h / longest - 1e-9))


def _many(x):
    """Whether x is an array of so many elements that computing them costs more than a few calls of NumPy."""
    return isinstance(x, np.ndarray) and x.size >= _FEW


def _interp_tensor(torch, x, xs, ys):
    """`interp` with gradients."""
    xs, ys = (torch.as_tensor(s, dtype=x.dtype, device=x.device) for s in (xs, ys))
    x = x.clamp(xs[0], xs[-1])
    i = (torch.searchsorted(xs, x.detach().contiguous(), right=True) - 1).clamp(0, len(xs) - 2)
    return ys[i] + (ys[i + 1] - ys[i]) * (x - xs[i]) / (xs[i + 1] - xs[i])


def _tensors(torch, *values):
    """All values as tensors of the kind of the first tensor among them, of double precision where there is none."""
    like = next((value for value in values if isinstance(value, torch.Tensor)), torch.zeros((), dtype=torch.float64))
    return [torch.as_tensor(value, dtype=like.dtype, device=like.device) for value in values]
