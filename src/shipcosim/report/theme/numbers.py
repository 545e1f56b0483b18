"""Numbers as texts."""

import math

import numpy as np
from numpy.typing import NDArray


def finite(values: NDArray) -> NDArray:
    """Those of some values that are finite."""
    return values[np.isfinite(values)]


def extent(values: NDArray) -> float:
    """From the least to the largest finite value; 0 without any."""
    numbers = finite(values)
    return float(np.ptp(numbers)) if numbers.size else 0.0


def span(start: float, end: float) -> str:
    """A stretch of a log.

    Examples
    --------
    >>> span(463.0, 499.0)
    '463–499 s'
    """
    return f"{start:.0f}–{end:.0f} s"


def plain(value: float | None, digits: int = 3) -> str:
    """A number with so many significant digits, never as a power of ten unless it is tiny or huge.

    Examples
    --------
    >>> plain(0.33714), plain(7520.0), plain(None)
    ('0.337', '7520', '–')
    """
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0.0 or not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{digits}g}".replace("-", "−")
    # So many decimals that the significant digits are there, without an exponent.
    decimals = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:.{decimals}f}".replace("-", "−")


def signed(value: float) -> str:
    """A difference with its sign and one decimal.

    Examples
    --------
    >>> signed(-0.33), signed(2.0)
    ('−0.3', '+2.0')
    """
    return f"{value:+.1f}".replace("-", "−")


def metres(value: float | None) -> str:
    """A distance with two significant digits.

    Examples
    --------
    >>> metres(0.618)
    '0.62 m'
    """
    return f"{plain(value, 2)} m"


def percent(share: float, digits: int = 0) -> str:
    """A share as percentage.

    Examples
    --------
    >>> percent(0.937), percent(0.02, 1)
    ('94 %', '2.0 %')
    """
    return f"{100 * share:.{digits}f} %"
