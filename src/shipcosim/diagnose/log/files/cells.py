"""Cells of a log: what is a number, a time, a word for nothing; columns of texts as numbers where they are such."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from shipcosim.diagnose.numerics import finite
from shipcosim.dialects import NOTHING, WITH_UNIT
from shipcosim.errors import counted

_SIDES = ("N", "S", "E", "W")  # after a number of a position, no unit
_FILLERS = re.compile(r"9{2,}(\.(9+|25))?|8{4,}|3276[78]|65535|214748364[78]|4294967295")
"""Numbers that loggers write for missing values, without their sign: nines or eights alone, ends of integers, 999.25."""
_LEAST_ALONE = 999.0
"""Smallest number that means 'no value' where all other values are the same: a command may go from 0 to 99. Assumed."""
_NO_NUMBER = 1e15
"""Times the median of a column; a larger number, such as 1e30, stands for no value. Assumed."""
_GROUPS = r"(?<=\d)['\u2019\u00a0\u202f](?=\d{3}(?!\d))"  # between thousands in Swiss, French and Nordic numbers
_MOST_DAMAGED = 0.01  # share of a column's cells that may be no numbers; more make it a column of texts. Assumed.


def numbers_of(name: str, cells: Any, decimal: str) -> tuple[np.ndarray, list[str]]:
    """A column of texts as numbers where nearly all of them are such, with remarks.

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

    # Bring minus signs and exponents of Fortran to the usual form.
    text = cells.astype("str").str.strip()
    missing = cells.isna() | text.str.lower().isin(NOTHING)
    grouping = "," if decimal == "." else "."
    plain = text.str.replace("\u2212", "-", regex=False)
    plain = plain.str.replace(_GROUPS, "", regex=True)
    plain = plain.str.replace(r"(?<=[\d.])[dD](?=[+-]?\d+$)", "e", regex=True)
    # Remove the grouping of thousands only where the whole cell
    # has this form, then put a point for the decimal sign.
    if decimal == "," or plain.str.contains(",", regex=False).any():
        is_grouped = plain.str.fullmatch(
            rf"[+-]?\d{{1,3}}(?:[{grouping}]\d{{3}})+(?:[{decimal}]\d*)?"
        )
        plain = plain.where(~is_grouped, plain.str.replace(grouping, "", regex=False))
        plain = plain.str.replace(decimal, ".", regex=False) if decimal == "," else plain
    # A few damaged cells are left empty; with more of them the column holds texts.
    numbers: Any = pandas.to_numeric(plain.where(~missing), errors="coerce")
    damaged: Any = numbers.isna() & ~missing
    count = int(damaged.sum())
    there = int((~missing).sum())
    if count > _MOST_DAMAGED * there and count > 0:
        return text.astype(object).where(~missing, None).to_numpy(object), []
    remarks = []
    if count:
        row = int(np.flatnonzero(damaged)[0])
        shown = text.iloc[row][:30]
        remarks = [
            f"Column '{name}': {count} cells that are no number, the first '{shown}' in row {row + 2}: left empty."
        ]
    return numbers.to_numpy(float), remarks


def without_fillers(name: str, values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """A column without the number that means 'no value' in it, and remarks.

    It is one of those that loggers take for it, does not just begin or end the column, and is further from all other
    values than these are from each other; or it is so large that nothing measured is, such as 1e30.

    Examples
    --------
    >>> without_fillers("surge", np.array([1.0, -9999.0, 1.5, -9999.0, 1e30]))[0].tolist()
    [1.0, nan, 1.5, nan, nan]
    """
    numbers = finite(values)
    if len(numbers) < 3:
        return values, []
    rows = np.abs(values) > _NO_NUMBER * max(np.median(np.abs(numbers)), 1.0)
    for filler in (numbers.min(), numbers.max()):
        rest = numbers[numbers != filler]
        if not len(rest) or not _FILLERS.fullmatch(f"{abs(filler):.12g}"):
            continue
        # A single number at an end may be measured, as a time after a gap.
        is_inside = len(rest) < len(numbers) - 1 or filler not in (numbers[0], numbers[-1])
        is_far = np.abs(rest - filler).min() > max(np.ptp(rest), 10.0)
        if is_inside and is_far and (np.ptp(rest) > 0.0 or abs(filler) >= _LEAST_ALONE):
            rows |= values == filler
    if not rows.any():
        return values, []
    where = counted(rows.sum(), "row")
    message = f"Column '{name}': {values[rows][0]:g} means 'no value' in {where}."
    # Another number may mean the same.
    left, more = without_fillers(name, np.where(rows, np.nan, values))
    return left, [message, *more]


def with_unit(cells: np.ndarray, decimal: str) -> tuple[np.ndarray, str] | None:
    """Numbers and unit of cells that all end with the same unit; None for others.

    Examples
    --------
    >>> with_unit(np.array(["5.5 kn", None, "6 kn"], object), ".")
    (array([5.5, nan, 6. ]), 'kn')
    """
    # All cells must have one and the same unit.
    matches = [None if cell is None else re.fullmatch(WITH_UNIT, cell) for cell in cells]
    stated = {match["unit"] for match in matches if match}
    if len(stated) != 1 or any(
        m is None and cell is not None for m, cell in zip(matches, cells, strict=True)
    ):
        return None
    unit = stated.pop()
    if unit in _SIDES:
        return None
    numbers = [np.nan if m is None else float(m["number"].replace(decimal, ".")) for m in matches]
    return np.array(numbers), unit
