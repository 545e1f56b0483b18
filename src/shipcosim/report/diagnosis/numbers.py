"""Numbers of a diagnosis as texts: as many digits as their uncertainty is worth."""

import math

SHOWN = {"1": "", "": ""}
LARGE = {"N": ("kN", 1e-3), "N.m": ("kN·m", 1e-3)}


def plus_minus(estimate, absolute=False):
    """An estimate with its standard deviation and unit.

    Parameters
    ----------
    estimate : Estimate
    absolute : bool
        Without the sign, where a word says it.

    Returns
    -------
    str
    """
    value, std, unit = amount(estimate, absolute)
    return f"{value} ± {std} {unit}".rstrip().replace(" °", "°")


def amount(estimate, absolute=False, largest=0.0):
    """Value, standard deviation and unit of an estimate, as texts; `largest` decides on the unit if it is larger.

    Returns
    -------
    tuple of three str
    """
    unit, factor = _scaled(estimate, max(abs(estimate.estimate), largest))
    value, std = factor * estimate.estimate, factor * estimate.std
    digits = _digits(std, value)
    value = abs(value) if absolute else value
    return f"{value:.{digits}f}".replace("-", "−"), f"{std:.{digits}f}", unit


def _scaled(estimate, size):
    if estimate.unit in LARGE and size >= 1000.0:
        return LARGE[estimate.unit]
    return {"deg": "°"}.get(estimate.unit, SHOWN.get(estimate.unit, estimate.unit)), 1.0


def _digits(std, value):
    """Decimals that show the uncertainty with one digit, or two where it begins with 1.

    Examples
    --------
    >>> _digits(0.0121, 0.337), _digits(0.4, 5.0), _digits(80.0, 4100.0)
    (3, 1, 0)
    """
    size = std if std > 0.0 and math.isfinite(std) else max(abs(value), 1e-9) / 100.0
    exponent = math.floor(math.log10(size))
    digits = -exponent + (size / 10.0**exponent < 2.0)
    return min(max(digits, 0), 6)


def vector(north, east):
    """Size and direction of a vector of two estimates, as in "0.17 m/s towards 057°".

    Parameters
    ----------
    north, east : Estimate

    Returns
    -------
    str
    """
    size = math.hypot(north.estimate, east.estimate)
    along = type(north)(size, math.hypot(north.std, east.std) / math.sqrt(2.0), north.unit)
    towards = math.degrees(math.atan2(east.estimate, north.estimate)) % 360.0
    return f"{plus_minus(along)} towards {round(towards) % 360:03d}°"


def span(start, end):
    """A stretch of a log.

    Examples
    --------
    >>> span(463.0, 499.0)
    '463–499 s'
    """
    return f"{start:.0f}–{end:.0f} s"


def plain(value, digits=3):
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
    decimals = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:.{decimals}f}".replace("-", "−")
