"""Dialects of text tables: what separates cells, which sign is the decimal one, what is a number or nothing."""

from __future__ import annotations

import codecs
import csv
import json
import re
from collections import Counter
from typing import TYPE_CHECKING, Any

from shipcosim.errors import error_at

if TYPE_CHECKING:
    import numpy as np

_WORDS = (
    "n/a na #n/a #na nan nat null none nil - -- --- ? * ** *** missing invalid void "
    "undefined empty nodata n.a. 1.#qnan -nan #value! #ref! #div/0! -1.#ind 1.#ind .... off "
    "fault error bad <null> (null) #### ##### ###### #name? #num! err ovf n.v. k.a. s/d n/d --.- ---.- \\n shutdown "
)
_PHRASES = (
    "no data,no value,bad input,i/o timeout,pt created,scan off,comm fail,calc failed,sin dato"
)
NOTHING = frozenset(("", *_PHRASES.split(","), *_WORDS.split()))
"""Words that loggers write where they have no value, in lower case."""
LFS_POINTER = b"version https://git-lfs.github.com/spec/"
"""Start of the file that a clone without Git LFS has instead of a large one."""
_NUMBER = r"[+-]?(?:\d[\d.,'\u2019\u00a0\u202f ]*|[.,]\d+)(?:[eEdD][+-]?\d+)?"
_STAMP = r"[+-]?\d[\d:./\-+TZ ,]*(?:[AaPp]\.?[Mm]\.?)?"
_STAMP += r"|\d{1,2}[-/. ]{1,2}[A-Za-z]{3,9}[-/. ]\d\d[\d:., ]*"
WITH_UNIT = r"(?P<number>[+-]?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*(?P<unit>[A-Za-zµ°º%][A-Za-z0-9µ°º%/^.·-]{0,7})"
_CLOCK = r"[+-]?\d+:\d\d:\d\d(?:\.\d+)?"
_SPAN = rf"{_CLOCK}|[+-]?\d+ days?(?:,? {_CLOCK})?|[+-]?P[\dDTHMS.-]*\d[DHMS]"
_FIGURE = re.compile(
    rf"\s*(?:{_NUMBER}|{_STAMP}|{_SPAN}|{WITH_UNIT}|[+-]?(?:inf|nan))\s*", re.IGNORECASE
)
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:[,.]\d{3})+")
_SEPARATORS = ("\t", ";", "|", ",", " ")
_SAMPLE = 60  # lines by which a layout is judged
_MARKS = ("#", "%", "//", "!")
_WORD = re.compile(r"[A-Za-z_][\w./-]*")


def unicode_of(content: bytes) -> str:
    """Which encoding of Unicode a text is in, by its byte order mark, zero bytes or UTF-8's rules; empty for others.

    Examples
    --------
    >>> [unicode_of("time".encode(name)) for name in ("utf-8", "utf-16", "utf-16-le", "utf-32-be")]
    ['utf-8', 'utf-16', 'utf-16-le', 'utf-32-be']
    """
    for mark, name in _BYTE_ORDERS:
        if content.startswith(mark):
            return name
    first = content[:400]
    # Of four bytes of UTF-32 three are zero, of two of UTF-16 one.
    if first.count(0) > 0.6 * len(first):
        return "utf-32-le" if first[0] else "utf-32-be"
    if len(first) > 3 and first[1::2].count(0) > 0.6 * len(first[1::2]):
        return "utf-16-le"
    if len(first) > 3 and first[0::2].count(0) > 0.6 * len(first[0::2]):
        return "utf-16-be"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return ""
    return "utf-8"


_BYTE_ORDERS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


def is_text(head: bytes) -> bool:
    """Whether a file can only be a text by its first bytes: ASCII without control characters."""
    return head.isascii() and min(head, default=0) > 8


def is_comment(line: str) -> bool:
    """Whether a line is no part of the table."""
    return line.lstrip().startswith(_MARKS)


def cells_in(line: str, separator: str) -> list[str]:
    """Cells of a line, without the blanks around them.

    Examples
    --------
    >>> cells_in('1;"a;b"; 2', ";")
    ['1', 'a;b', '2']
    >>> cells_in("  1   2 ", " ")
    ['1', '2']
    """
    if separator == " ":
        return line.split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    return [
        cell.strip()
        for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    ]


def header_of(name: str, unit: str) -> str:
    """Header ``name [unit]`` of a column that we write; a name that readers would change stands in quotes, as JSON.

    Examples
    --------
    >>> header_of("x", "m"), header_of("x ", "m"), name_in(header_of("x ", "m").partition(" [")[0])
    ('x [m]', '"x " [m]', 'x ')
    """
    is_plain = name == name.strip(" '\"") and name.isprintable() and name
    return f"{name if is_plain else json.dumps(name)} [{unit}]"


def name_in(text: str) -> str:
    """Name of a column from the text of `header_of`; other texts stay unchanged."""
    if len(text) < 2 or not text.startswith('"') or not text.endswith('"'):
        return text
    try:
        return str(json.loads(text))
    except ValueError:
        return text


def separator_of(lines: list[str]) -> str:
    """The separator that gives rows of equal length, of figures."""
    stated = next((line for line in lines[:1] if line.lower().startswith("sep=")), None)
    if stated and len(stated.strip()) == 5:
        return stated.strip()[4]
    rows = [line for line in lines if line.strip() and not is_comment(line)]
    sample = (
        [rows[round(i * (len(rows) - 1) / _SAMPLE)] for i in range(_SAMPLE + 1)][_SAMPLE // 4 :]
        if rows
        else []
    )
    scores = {}
    for separator in _SEPARATORS:
        cells = [cells_in(line, separator) for line in sample]
        width, count = Counter(map(len, cells)).most_common(1)[0] if cells else (0, 0)
        flat = [cell for row in cells for cell in row if cell]
        good = sum(
            1.0 if is_figure(c) or is_nothing(c) else 0.6 if _WORD.fullmatch(c) else 0.0
            for c in flat
        )
        scores[separator] = (count / len(cells)) * good / max(len(flat), 1) if width > 1 else 0.0
    best = max(scores.values())
    return (
        next(separator for separator in _SEPARATORS if scores[separator] > 0.9 * best)
        if best > 0.0
        else ","
    )


def is_nothing(cell: str) -> bool:
    """Whether a cell stands for no value."""
    return cell.strip().lower() in NOTHING


def is_figure(cell: str) -> bool:
    """Whether a cell is a number, a date, a time or a span of time.

    Examples
    --------
    >>> [is_figure(cell) for cell in ("1,5", "-.3", "27.10.2022 08:00", "1e-3", "heading", "12 kn")]
    [True, True, True, True, False, True]
    """
    return _FIGURE.fullmatch(cell) is not None


def seconds_of_spans(cells: Any) -> np.ndarray | None:
    """Time spans of pandas, Python and ISO 8601 in seconds; None if a cell is no time span.

    Parameters
    ----------
    cells : pandas.Series of str or missing

    Examples
    --------
    >>> import pandas
    >>> seconds_of_spans(pandas.Series(["0:00:01.5", "1 day, 0:00:02", "P1DT3S", None])).tolist()
    [1.5, 86402.0, 86403.0, nan]
    """
    import pandas

    if not cells.dropna().str.fullmatch(_SPAN).all():
        return None
    spans = pandas.to_timedelta(cells, errors="coerce")
    is_read = spans.notna().eq(cells.notna()).all()
    return spans.dt.total_seconds().to_numpy(float) if is_read else None


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
    grouping = next(
        (cell for cell in cells if _is_decimal(cell, ".", ",") or cell.count(",") > 1), None
    )
    if decimal and grouping:
        message = f"a comma is a decimal sign in '{decimal}' and groups thousands in '{grouping}'."
        raise error_at(source, message, "Write all numbers alike.")
    if decimal or grouping:
        return "," if decimal else "."
    cell = cells[0]
    message = f"'{cell}' can be {cell.replace(',', '.')} (decimal comma) or {cell.replace(',', '')} (thousands)."
    raise error_at(
        source,
        message,
        'Say which in a channel file: file = {decimal = ","} or file = {decimal = "."}.',
    )


def _is_decimal(cell, sign, other):
    """Whether this sign can only be the decimal sign of the number in a cell."""
    if sign not in cell or cell.count(sign) > 1:
        return False
    before, after = cell.lstrip("+-").split(sign)
    if other in before:
        return all(len(part) == 3 for part in before.split(other)[1:])
    return other not in cell and (not _GROUPED.fullmatch(cell) or before.startswith("0"))
