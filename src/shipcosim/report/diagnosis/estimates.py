"""Estimates as texts, with standard deviation and as many digits as that justifies."""

import math

from shipcosim.diagnose.finding import ParameterEstimate

SHOWN = {"1": "", "deg": "°"}
LARGE = {"N": ("kN", 1e-3), "N.m": ("kN·m", 1e-3), "kg.m2": ("t·m²", 1e-3)}


def plus_minus(estimate: ParameterEstimate, absolute: bool = False) -> str:
    """An estimate with its standard deviation and unit.

    Parameters
    ----------
    estimate : ParameterEstimate
    absolute : bool
        Without the sign, where a word says it.

    Returns
    -------
    str
    """
    value, std, unit = amount(estimate, absolute)
    return f"{value} ± {std} {unit}".rstrip().replace(" °", "°")


def amount(
    estimate: ParameterEstimate, absolute: bool = False, largest: float = 0.0
) -> tuple[str, str, str]:
    """Value, standard deviation and unit as texts; `largest`, if larger, decides on the unit.

    Returns
    -------
    tuple of three str
    """
    # Unit first: digits depend on it.
    unit, factor = shown_unit(estimate.unit, max(abs(estimate.estimate), largest))
    value = factor * estimate.estimate
    std = factor * estimate.std
    # Without a standard deviation one percent of the value decides.
    size = std if std > 0.0 and math.isfinite(std) else max(abs(value), 1e-9) / 100.0
    # One digit of the uncertainty, two if it begins with 1.
    exponent = math.floor(math.log10(size))
    digits = -exponent + (size / 10.0**exponent < 2.0)
    digits = min(digits, 6)
    value = abs(value) if absolute else value
    texts = (f"{round(number, digits):.{max(digits, 0)}f}" for number in (value, std))
    return next(texts).replace("-", "−"), next(texts), unit


def shown_unit(unit: str, size: float) -> tuple[str, float]:
    """The unit in which a number of this size is shown, and the factor to it."""
    if unit in LARGE and size >= 1000.0:
        return LARGE[unit]
    return SHOWN.get(unit, unit), 1.0


def vector(north: ParameterEstimate, east: ParameterEstimate) -> str:
    """Size and direction of a vector of two estimates, as in "0.17 m/s towards 057°".

    Parameters
    ----------
    north, east : ParameterEstimate

    Returns
    -------
    str
    """
    # Standard deviation along the vector: the mean of both squares.
    size = math.hypot(north.estimate, east.estimate)
    along = ParameterEstimate(size, math.hypot(north.std, east.std) / math.sqrt(2.0), north.unit)
    towards = math.degrees(math.atan2(east.estimate, north.estimate)) % 360.0
    return f"{plus_minus(along)} towards {round(towards) % 360:03d}°"
