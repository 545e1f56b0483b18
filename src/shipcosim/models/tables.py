"""Tables inside parameter sets: text, rows by semicolons, columns by blanks."""

from functools import lru_cache


@lru_cache(maxsize=64)
def columns(text, width):
    """Columns of a table, parsed once per text.

    Parameters
    ----------
    text : str
        Rows by ";", columns by blanks.
    width : int
        Number of columns that every row must have.

    Returns
    -------
    tuple of tuples of float
        One tuple per column.

    Raises
    ------
    ValueError
        A row has another number of columns, or what is not a number; the row is named.

    Examples
    --------
    >>> columns("0 -0.53; 10 -0.59", 2)
    ((0.0, 10.0), (-0.53, -0.59))
    """
    rows = [_row(number, row, width) for number, row in enumerate(text.strip(" ;\n").split(";"), 1)]
    return tuple(zip(*rows, strict=True))


def text(rows):
    """The table as text, the inverse of `columns` for rows of numbers.

    Parameters
    ----------
    rows : iterable of iterables of float

    Returns
    -------
    str

    Examples
    --------
    >>> text([(0.0, -0.53), (10.0, -0.59)])
    '0 -0.53; 10 -0.59'
    """
    return "; ".join(" ".join(f"{value:.5g}" for value in row) for row in rows)


def _row(number, row, width):
    try:
        values = tuple(float(value) for value in row.split())
    except ValueError as error:
        raise ValueError(f"table, row {number}: '{row.strip()}' is not numbers separated by blanks.") from error
    if len(values) != width:
        raise ValueError(f"table, row {number}: {len(values)} columns in '{row.strip()}'. There must be {width}.")
    return values
