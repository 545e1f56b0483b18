"""Piecewise linear interpolation in tables, for floats, arrays and tensors.

References
----------
Definition of linear interpolation, constant beyond the ends of a table.
"""

from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.maths import Arithmetic, floor, library_of


def interp(x: Arithmetic, xs: Sequence[float], ys: Sequence[float]) -> Arithmetic:
    """One column of a table by piecewise linear interpolation, constant beyond the ends.

    Parameters
    ----------
    x : float or (...) array or tensor
        Abscissa. [any unit]
    xs : (n,) sequence of float, increasing
        Abscissae of the table. [the unit of x]
    ys : (n,) sequence of float
        Ordinates of the table. [any unit]

    Returns
    -------
    like x
        Ordinate. [the unit of ys]
    """
    if isinstance(x, float):
        if x <= xs[0]:
            return ys[0]
        if x >= xs[-1]:
            return ys[-1]
        # No number is beyond all abscissae: the result is none either.
        i = min(bisect_right(xs, x), len(xs) - 1) - 1
        return ys[i] + (ys[i + 1] - ys[i]) * (x - xs[i]) / (xs[i + 1] - xs[i])
    # Recorded numbers bring their own interpolation, arrays use NumPy's, tensors the one below.
    library = library_of(x)
    if hasattr(library, "interp"):
        return library.interp(x, xs, ys)
    return _interp_tensor(library, x, xs, ys)


def interp_columns(x: Arithmetic, xs: Sequence[float], *columns: Sequence[float]) -> list:
    """Several columns of one table by piecewise linear interpolation, constant beyond the ends.

    Parameters
    ----------
    x : float or (...) array or tensor
        Abscissa. [any unit]
    xs : (n,) sequence of float, increasing
        Abscissae of the table. [the unit of x]
    columns : (n,) sequences of float
        Ordinates of the table. [any units]

    Returns
    -------
    list, one value like x per column
        Ordinates. [the units of columns]
    """
    if not isinstance(x, float):
        return [interp(x, xs, ys) for ys in columns]
    if x <= xs[0]:
        return [ys[0] for ys in columns]
    if x >= xs[-1]:
        return [ys[-1] for ys in columns]
    # One search serves all columns.
    i = min(bisect_right(xs, x), len(xs) - 1)
    share = (x - xs[i - 1]) / (xs[i] - xs[i - 1])
    return [ys[i - 1] + (ys[i] - ys[i - 1]) * share for ys in columns]


class EvenTable(NamedTuple):
    """Columns of a table with evenly spaced abscissae, made by `even_table`.

    Parameters
    ----------
    first : float
        First abscissa. [any unit]
    per_unit : float
        Number of abscissae per unit. [1/unit of first]
    rows : (n, columns, 2) nested tuples of float
        Per abscissa and column the value and its change up to the next abscissa. [any units]
    array : (n, 2 columns) array
        The same as array: all values, then all changes. [any units]
    """

    first: float
    per_unit: float
    rows: tuple
    array: np.ndarray


def even_table(xs: np.ndarray, *columns: np.ndarray) -> EvenTable:
    """The table that `interp_even` reads.

    Parameters
    ----------
    xs : (n,) array, evenly spaced
        Abscissae. [any unit]
    columns : (n,) arrays
        Ordinates of the table. [any units]

    Returns
    -------
    EvenTable
        The columns with their changes per abscissa. [the units of xs and columns]
    """
    # Store differences with the values: the interpolation then needs one product per column.
    values = np.stack(columns, axis=-1)
    changes = np.diff(values, axis=0, append=values[-1:])
    rows = (
        tuple(zip(*row, strict=True)) for row in zip(values.tolist(), changes.tolist(), strict=True)
    )
    per_unit = float((len(xs) - 1) / (xs[-1] - xs[0]))
    return EvenTable(
        float(xs[0]), per_unit, tuple(rows), np.concatenate([values, changes], axis=-1)
    )


def interp_even(x: Arithmetic, table: EvenTable) -> list:
    """All columns of a table with even abscissae by piecewise linear interpolation, without a search.

    Parameters
    ----------
    x : float or (...) array or tensor
        Abscissa within the table. [the unit of the table's abscissae]
    table : EvenTable
        The table.

    Returns
    -------
    list, one value like x per column
        Ordinates. [the units of the table's columns]
    """
    # Even spacing: the index follows from a division, without a search.
    position = (x - table.first) * table.per_unit
    if isinstance(x, float):
        below = int(position)
        share = position - below
        return [value + share * change for value, change in table.rows[below]]
    below = floor(position)
    library = library_of(x)
    # Look the rows up in the arithmetic of x; recorded numbers have their own look-up.
    share = position - below
    if hasattr(library, "row_of"):
        rows = library.row_of(table.array, below)
    elif library is np:
        rows = np.take(table.array, below.astype(int), axis=0)
    else:
        rows = library.as_tensor(table.array, dtype=x.dtype, device=x.device)[below.detach().long()]
    width = rows.shape[-1] // 2
    return [rows[..., k] + share * rows[..., width + k] for k in range(width)]


def _interp_tensor(torch, x, xs, ys):
    """`interp` of a tensor, with gradients."""
    xs, ys = (torch.as_tensor(s, dtype=x.dtype, device=x.device) for s in (xs, ys))
    # The index has no gradient; the value has one by x and by the table.
    x = x.clamp(xs[0], xs[-1])
    i = (torch.searchsorted(xs, x.detach().contiguous(), right=True) - 1).clamp(0, len(xs) - 2)
    return ys[i] + (ys[i + 1] - ys[i]) * (x - xs[i]) / (xs[i + 1] - xs[i])
