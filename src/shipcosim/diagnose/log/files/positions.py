"""Positions as instruments write them: ddmm.mmmm of NMEA, hemispheres, texts with degrees, minutes and seconds."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from shipcosim.diagnose.log.names.vocabulary import vocabulary, words_of
from shipcosim.diagnose.numerics import finite

MINUTES = "ddmm.mmmm"
"""Spelling of the unit of latitudes and longitudes in NMEA 0183: degrees times 100 plus minutes."""
_TEXT = re.compile(
    r"\s*(?P<before>[NSEØÖWVnseøöwv])?\s*(?P<degrees>[+-]?\d+(?:\.\d+)?)\s*[°ºd*-]?\s*"
    r"(?:(?P<minutes>\d+(?:\.\d+)?)\s*['′’´m]?\s*(?:(?P<seconds>\d+(?:\.\d+)?)\s*(?:\"|″|''|s)?\s*)?)?"
    r"(?P<after>[NSEØÖWVnseøöwv])?\s*"
)


def is_minutes(values: np.ndarray, largest: float) -> bool:
    """Whether numbers cannot be degrees, but can be degrees times 100 plus minutes.

    Parameters
    ----------
    values : (n,) array
    largest : float
        Of the degrees: 90 or 180.

    Examples
    --------
    >>> [is_minutes(np.array([value]), 90.0) for value in (6324.0949, 63.4, 6390.0)]
    [True, False, False]
    """
    # Most numbers must be too large for degrees, and nearly all must have minutes below 60.
    sizes = np.abs(finite(values))
    if not len(sizes) or (sizes > largest).mean() < 0.5:
        return False
    return bool(
        (np.mod(sizes, 100.0) < 60.0).mean() > 0.99
        and (sizes < 100.0 * largest + 60.0).mean() > 0.99
    )


def degrees_of_minutes(values: np.ndarray) -> np.ndarray:
    """Degrees of ddmm.mmmm.

    Examples
    --------
    >>> degrees_of_minutes(np.array([6330.0, -1030.0])).tolist()
    [63.5, -10.5]
    """
    size = np.abs(values)
    return np.copysign(np.floor(size / 100.0) + np.mod(size, 100.0) / 60.0, values)


def hemisphere_signs(cells: np.ndarray, role: str) -> np.ndarray | None:
    """Signs of a column of N and S, E and W, or port and starboard; None where it holds something else.

    Parameters
    ----------
    cells : (n,) array of str or None
        The column.
    role : str
        Of the numbers that the column belongs to.
    """
    signs = sides_of(role)
    texts = _texts(cells)
    if not texts or not signs.keys() >= texts:
        return None
    return np.array([signs.get(str(cell).strip().upper(), np.nan) for cell in cells])


def are_codes(cells: np.ndarray) -> bool:
    """Whether a column holds two codes that may be directions: 1 and 0, 1 and -1, or CW and CCW."""
    return len(_texts(cells)) == 2 and _texts(cells) <= {"1.0", "0.0", "-1.0", "CW", "CCW"}


def _texts(cells):
    return {str(cell).strip().upper() for cell in cells if cell is not None and cell == cell}


def sides_of(role: str) -> dict[str, float]:
    """Signs by the words for sides that may stand behind the numbers of a role; empty where none do."""
    sides = vocabulary()["sides"]
    return sides["along" if role.endswith(("_rpm", "_thrust")) else sides["of"].get(role, "none")]


def degrees_of_texts(cells: np.ndarray, largest: float) -> np.ndarray | None:
    """Degrees of texts such as ``63° 24.09' N``, ``63 24 5.7 N`` or ``6324.0949,N``; None for other texts.

    Parameters
    ----------
    cells : (n,) array of str or None
    largest : float
        Of the degrees: 90 or 180.
    """
    decimal_degrees = np.full(len(cells), np.nan)
    # Parse degrees, minutes and seconds of each text, with the hemisphere before or behind.
    for row, cell in enumerate(cells):
        if cell is None:
            continue
        # A comma is the decimal sign where no point is, and stands between cells of NMEA elsewhere.
        text = str(cell)
        is_decimal = "." not in text and re.search(r"[°º ].*\d,\d|\d,\d{3}", text)
        if not is_decimal and re.fullmatch(r"\D*\d{1,3},\d{1,2}\D*", text):
            return None  # 62,33 N can be 62.33 or 62 degrees and 33 minutes
        match = _TEXT.fullmatch(text.replace(",", "." if is_decimal else " "))
        if match is None or any(
            float(match[part] or 0.0) >= 60.0 for part in ("minutes", "seconds")
        ):
            return None
        degrees = float(match["degrees"])
        # A number beyond all degrees is in degrees and minutes without a separator.
        if match["minutes"] is None and abs(degrees) > largest:
            degrees = float(degrees_of_minutes(np.array([degrees]))[0])
        parts = float(match["minutes"] or 0.0) / 60.0 + float(match["seconds"] or 0.0) / 3600.0
        hemisphere = (match["before"] or match["after"] or "N").upper()
        decimal_degrees[row] = np.copysign(abs(degrees) + parts, degrees) * (
            -1.0 if hemisphere in "SWV" else 1.0
        )
    return decimal_degrees


def with_minutes(values: dict[str, np.ndarray], units: dict[str, str]) -> list[str]:
    """Add minutes to the whole degrees in the column before them, in place; remarks."""
    remarks = []
    for name, after in pairwise(list(values)):
        words = {*words_of(after), units[after]}
        is_pair = words & {"min", "minutes"} and words & {"latitude", "longitude"} & {
            *words_of(name)
        }
        if not is_pair or "O" in (values[name].dtype, values[after].dtype):
            continue
        # Whole minutes may have seconds in a third column, and a zero has no sign.
        degrees = values[name]
        if (degrees == np.trunc(degrees)).all() and degrees.all() and (values[after] % 1.0).any():
            values[name] = degrees + np.copysign(values.pop(after) / 60.0, degrees)
            remarks.append(f"Minutes in '{after}' are added to the degrees in '{name}'.")
    return remarks
