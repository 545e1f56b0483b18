"""Cells of a log: what is a number, a time, a word for nothing; columns of texts as numbers where they are such."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from shipcosim.errors import Problem, ShipcosimError

__all__ = ["NOTHING", "is_figure", "is_nothing", "numbers_of"]

NOTHING = frozenset(
    ("", "n/a", "na", "#n/a", "#na", "nan", "nat", "null", "none", "nil", "-", "--", "---", "?", "*", "**", "***")
    + ("missing", "invalid", "void", "undefined", "empty", "no data", "nodata", "no value", "n.a.", "1.#qnan", "-nan")
    + ("#value!", "#ref!", "#div/0!", "-1.#ind", "1.#ind", "....", "off", "fault", "error", "bad", "<null>", "(null)")
)
"""Words that loggers write where they have no value, in lower case."""

_NUMBER = r"[+-]?(?:\d[\d.,' ]*|[.,]\d+)(?:[eEdD][+-]?\d+)?"
_FIGURE = re.compile(
    rf"\s*(?:{_NUMBER}|[+-]?\d[\d:./\-+TZ ,]*(?:[AaPp]\.?[Mm]\.?)?|[+-]?(?:inf|nan))\s*", re.IGNORECASE
)
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:[,.]\d{3})+")
_MOST_DAMAGED = 0.01  # share of a column's cells that may be no numbers; more make it a column of texts. Assumed.


def is_nothing(cell: str) -> bool:
    """Whether a cell stands for no value."""
    return cell.strip().lower() in NOTHING


def is_figure(cell: str) -> bool:
    """Whether a cell is a number, a date or a time.

    Examples
    --------
    >>> [is_figure(cell) for cell in ("1,5", "-.3", "27.10.2022 08:00", "1e-3", "heading", "12 kn")]
    [True, True, True, True, False, False]
    """
    return _FIGURE.fullmatch(cell) is not None


def numbers_of(name: str, cells: Any, decimal: str) -> tuple[np.ndarray, list[str]]:
    """A column of texts as numbers where nearly all of them are such, with what is to be said.

    Parameters
    ----------
    name : str
        Of the column, for remarks.
    cells : pandas.Series of str or missing
        Its cells.
    decimal : str
        ``"."`` or ``","``; the other one groups thousands.

    Returns
    -------
    tuple of (n,) array and list of str
        float64, NaN for words that say nothing; or the texts as objects, None for these.
    """
    import pandas

    text = cells.astype("str").str.strip()
    missing = cells.isna() | text.str.lower().isin(NOTHING)
    grouping = "," if decimal == "." else "."
    plain = text.str.replace("\u2212", "-", regex=False)
    if decimal == "," or plain.str.contains(",", regex=False).any():
        is_grouped = plain.str.fullmatch(rf"[+-]?\d{{1,3}}(?:[{grouping}]\d{{3}})+(?:[{decimal}]\d*)?")
        plain = plain.where(~is_grouped, plain.str.replace(grouping, "", regex=False))
        plain = plain.str.replace(decimal, ".", regex=False) if decimal == "," else plain
    numbers: Any = pandas.to_numeric(plain.where(~missing), errors="coerce")
    damaged: Any = numbers.isna() & ~missing
    count, there = int(damaged.sum()), int((~missing).sum())
    if count > _MOST_DAMAGED * there and count > 0:
        return text.astype(object).where(~missing, None).to_numpy(object), []
    said = []
    if count:
        row = int(np.flatnonzero(damaged)[0])
        shown = text.iloc[row][:30]
        said = [f"Column '{name}': {count} cells that are no number, the first '{shown}' in row {row + 2}: left empty."]
    return numbers.to_numpy(float), said


def decimal_of(source: str, cells: list[str]) -> str | None:
    """Decimal sign of a file whose cells are not separated by commas; None where no cell has a comma.

    Parameters
    ----------
    source : str
        The file, for messages.
    cells : list of str
        Those that are figures with a comma, each once.

    Raises
    ------
    ShipcosimError
        If the commas can be decimal signs or group thousands.
    """
    if not cells:
        return None
    decimal = next((cell for cell in cells if _is_decimal(cell, ",", ".")), None)
    grouping = next((cell for cell in cells if _is_decimal(cell, ".", ",") or cell.count(",") > 1), None)
    if decimal and grouping:
        found = f"a comma is a decimal sign in '{decimal}' and groups thousands in '{grouping}'."
        raise ShipcosimError(Problem(source, found, "Write all numbers alike."))
    if decimal or grouping:
        return "," if decimal else "."
    cell = cells[0]
    found = f"'{cell}' can be {cell.replace(',', '.')} (decimal comma) or {cell.replace(',', '')} (thousands)."
    remedy = 'Say which in a channel file: file = {decimal = ","} or file = {decimal = "."}.'
    raise ShipcosimError(Problem(source, found, remedy))


def _is_decimal(cell, sign, other):
    """Whether this sign can only be the decimal sign of the number in a cell."""
    if sign not in cell or cell.count(sign) > 1:
        return False
    before, after = cell.lstrip("+-").split(sign)
    if other in before:
        return all(len(part) == 3 for part in before.split(other)[1:])
    return other not in cell and (not _GROUPED.fullmatch(cell) or before.startswith("0"))
