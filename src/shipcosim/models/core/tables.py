"""Tables inside parameter sets: text, rows by semicolons, columns by blanks.

References
----------
Definition of this text form.
"""

from collections.abc import Iterable
from functools import lru_cache
from math import pi
from typing import Any


@lru_cache(maxsize=64)
def parse(text: str) -> tuple[tuple[float, ...], ...]:
    """Rows of a table, parsed once per text.

    Parameters
    ----------
    text : str
        Rows by ";", columns by blanks.

    Returns
    -------
    tuple of tuples of float
        One tuple per row, all of the same length. [as the parameter set says]

    Raises
    ------
    ValueError
        A row holds what is not a number, or another number of columns than the first; the row is named.

    Examples
    --------
    >>> parse("0 -0.53; 10 -0.59")
    ((0.0, -0.53), (10.0, -0.59))
    """
    # Blank space and a final semicolon are no row.
    rows = tuple(_row(number, row) for number, row in enumerate(text.strip(" ;\n").split(";"), 1))
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise ValueError(
                f"table, row {number}: {len(row)} columns. The first row has {len(rows[0])}."
            )
    return rows


@lru_cache(maxsize=32)
def columns_by_angle(text: str, name: str, last: float) -> tuple[tuple[float, ...], ...]:
    """Angle and three columns of a table whose angles go from 0 to a last one, parsed once per text.

    Parameters
    ----------
    text : str
        Rows by ";", columns by blanks.
    name : str
        Of the table, for messages.
    last : float
        Last angle. [deg]

    Returns
    -------
    tuple of tuples of float
        The angle, then the other columns. [rad, as the parameter set says]

    Raises
    ------
    ValueError
        The table is not one of four columns with these angles.
    """
    angles, *others = columns(text, 4)
    if angles[0] != 0.0 or angles[-1] != last:
        raise ValueError(
            f"{name}: angles from {angles[0]:g} to {angles[-1]:g}. They must go from 0 to {last:g} deg."
        )
    return tuple(angle * pi / 180.0 for angle in angles), *others


@lru_cache(maxsize=64)
def columns(text: str, width: int) -> tuple[tuple[float, ...], ...]:
    """Columns of a table whose first column increases, parsed once per text.

    Parameters
    ----------
    text : str
        Rows by ";", columns by blanks.
    width : int
        Number of columns that the table must have. [1]

    Returns
    -------
    tuple of tuples of float
        One tuple per column. [as the parameter set says]

    Raises
    ------
    ValueError
        The table is not one of numbers, has another number of columns, fewer than two rows, or a first column that does
        not increase; the message says what was found.

    Examples
    --------
    >>> columns("0 -0.53; 10 -0.59", 2)
    ((0.0, 10.0), (-0.53, -0.59))
    """
    # A look-up needs increasing abscissae and at least two rows.
    rows: Any = parse(text)
    if len(rows[0]) != width or len(rows) < 2:
        raise ValueError(
            f"table of {len(rows)} rows and {len(rows[0])} columns. It needs rows of {width} numbers."
        )
    for number, (before, row) in enumerate(zip(rows, rows[1:], strict=False), 2):
        if row[0] <= before[0]:
            raise ValueError(
                f"table, row {number}: {row[0]:g} after {before[0]:g}. The first column must increase."
            )
    return tuple(zip(*rows, strict=True))


def text(rows: Iterable[Iterable[float]]) -> str:
    """The table as text, the inverse of `parse` to five digits.

    Parameters
    ----------
    rows : iterable of iterables of float
        Values, row by row. [as the parameter set says]

    Returns
    -------
    str
        Rows by ";", columns by blanks.

    Examples
    --------
    >>> text([(0.0, -0.53), (10.0, -0.59)])
    '0 -0.53; 10 -0.59'
    """
    return "; ".join(" ".join(f"{value + 0.0:.5g}" for value in row) for row in rows)


def _row(number, row):
    """Numbers of a row."""
    try:
        return tuple(float(value) for value in row.split())
    except ValueError:
        raise ValueError(
            f"table, row {number}: '{row.strip()}' is not numbers separated by blanks."
        ) from None
