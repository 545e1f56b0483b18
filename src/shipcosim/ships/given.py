"""A number in a ship file: plain, a text with a unit, or a table with tolerance and origin."""

import math
import re
from dataclasses import dataclass
from typing import Any

from pydantic import BeforeValidator

from shipcosim import units

_PLAIN = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*")
_KEYS = ("value", "unit", "tolerance", "uncertainty", "origin")
PLAIN = "given in the ship file"


@dataclass(frozen=True)
class Given:
    """A number that the ship file gives, in the unit of its key.

    Attributes
    ----------
    value : float
    tolerance : float or None
        Standard deviation; None where nothing is said of it.
    origin : str
        Where it comes from; empty where the file's own source holds.
    uncertainty : tuple of two floats, or empty
        Least and largest value of different sources.
    """

    value: float
    tolerance: float | None = None
    origin: str = ""
    uncertainty: tuple[float, ...] = ()


def reader(unit: str, *, least: float | None = None, most: float | None = None) -> BeforeValidator:
    """Reads a number with a unit and bounds, for a pydantic record.

    Parameters
    ----------
    unit : str
        In which it is kept, and in which a plain number is.
    least, most : float, optional
        Bounds of what can be; the least itself is none where it is 0.

    Returns
    -------
    BeforeValidator
        It raises a ValueError with what would be right.
    """

    def read(given_value: Any) -> Given | None:
        if given_value is None or isinstance(given_value, Given):
            return given_value
        given = given_in_unit(given_value, unit)
        # Zero as a bound means positive: a length of 0 m is missing, not short.
        if least is not None and not (
            given.value > least if least == 0.0 else given.value >= least
        ):
            more = "greater than 0" if least == 0.0 else f"at least {least:g}"
            raise ValueError(
                f"found {_text(given_value)}. It must be {more} {_shown(unit)}".rstrip() + "."
            )
        if most is not None and given.value > most:
            raise ValueError(
                f"found {_text(given_value)}. It must be at most {most:g} {_shown(unit)}".rstrip()
                + "."
            )
        return given

    return BeforeValidator(read)


def number_in(given: Any, unit: str) -> float:
    """A number, or a text with a unit, in another unit.

    Parameters
    ----------
    given : Any
        As it stands in the file.
    unit : str
        That is wanted.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        With what would be right.

    Examples
    --------
    >>> number_in("12 kn", "m/s")
    6.173333333333334
    >>> number_in(2650, "kg")
    2650.0
    """
    # A text with a unit is converted; a plain number has the unit of the key.
    if isinstance(given, str) and not _PLAIN.fullmatch(given):
        value = units.number_in(given, units.spelled_unit(unit))
    elif isinstance(given, (int, float, str)) and not isinstance(given, bool):
        value = math.inf if isinstance(given, int) and abs(given) > 1e300 else float(given)
    else:
        raise ValueError(
            f"found {_text(given)}. Write a number in {unit}, or a text such as '12.5 {unit}'."
        )
    # Values of this size are typing errors.
    if not math.isfinite(value) or abs(value) > 1e20:
        raise ValueError(f"found {_text(given)}. Give a finite number.")
    return value


def given_in_unit(given: Any, unit: str) -> Given:
    """Read a number, a text with a unit or a table of a file, in a given unit.

    Raises
    ------
    ValueError
        With what would be right.
    """
    # Plain numbers and texts.
    if not isinstance(given, dict):
        return Given(number_in(given, unit))
    if wrong := [key for key in given if key not in _KEYS]:
        raise ValueError(f"'{wrong[0]}' is no key of a number. It has: {', '.join(_KEYS)}.")
    if "value" not in given:
        raise ValueError(
            "'value' is missing. Write { value = 1.0, tolerance = 0.1, origin = \"drawing\" }."
        )
    # The table may have a unit of its own, for value, tolerance and uncertainty.
    own_unit = given.get("unit", unit)
    origin = given.get("origin", "")
    if not isinstance(own_unit, str) or not isinstance(origin, str):
        raise ValueError("unit and origin are texts in quotes.")

    def number(entry: Any) -> float:
        return number_in(
            entry if isinstance(entry, str) else f"{number_in(entry, own_unit)!r} {own_unit}",
            unit,
        )

    # Convert the standard deviation by the same unit.
    tolerance = None if "tolerance" not in given else number(given["tolerance"])
    if tolerance is not None and tolerance < 0.0:
        raise ValueError(f"the tolerance is {tolerance:g}. It is a standard deviation, at least 0.")
    value = number(given["value"])
    # Least and largest value of several sources.
    both = given.get("uncertainty", [])
    if not isinstance(both, list) or len(both) not in (0, 2):
        raise ValueError("uncertainty is the least and the largest value, [0.6, 1.5].")
    return Given(value, tolerance, origin, tuple(map(number, both)))


def _text(given: Any) -> str:
    text = f'"{given}"' if isinstance(given, str) else str(given)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _shown(unit: str) -> str:
    return "" if unit == "1" else unit
