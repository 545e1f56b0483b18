"""Unit strings as FMI wants them defined: exponents of the base units, factor and offset."""

import math
import re
from typing import NamedTuple

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9}
SYMBOLS = {
    "kg": (1.0, "kg"),
    "g": (1e-3, "kg"),
    "t": (1e3, "kg"),
    "m": (1.0, "m"),
    "nmi": (1852.0, "m"),
    "s": (1.0, "s"),
    "min": (60.0, "s"),
    "h": (3600.0, "s"),
    "A": (1.0, "A"),
    "K": (1.0, "K"),
    "mol": (1.0, "mol"),
    "cd": (1.0, "cd"),
    "rad": (1.0, "rad"),
    "deg": (math.pi / 180, "rad"),
    "rev": (2 * math.pi, "rad"),
    "rpm": (2 * math.pi / 60, "rad.s-1"),
    "kn": (1852 / 3600, "m.s-1"),
    "Hz": (1.0, "s-1"),
    "N": (1.0, "kg.m.s-2"),
    "Pa": (1.0, "kg.m-1.s-2"),
    "bar": (1e5, "kg.m-1.s-2"),
    "J": (1.0, "kg.m2.s-2"),
    "W": (1.0, "kg.m2.s-3"),
    "C": (1.0, "A.s"),
    "V": (1.0, "kg.m2.s-3.A-1"),
    "l": (1e-3, "m3"),
    "%": (1e-2, "1"),
}
WITH_PREFIX = {"g", "m", "s", "A", "K", "mol", "rad", "Hz", "N", "Pa", "J", "W", "C", "V", "l"}
FACTOR = re.compile(r"(?P<symbol>1|%|[A-Za-z]+)(?P<exponent>[+-]?\d+)?")


class BaseUnit(NamedTuple):
    """value in base units = factor * value + offset; `exponents` holds those that are not 0, in the order of `BASE`."""

    exponents: dict[str, int]
    factor: float
    offset: float


def base_unit(unit):
    """What a unit string means.

    Parameters
    ----------
    unit : str
        Products with ".", at most one "/", several units below it in brackets: ``"N.s2/m2"``, ``"1/(m.s)"``.

    Returns
    -------
    BaseUnit

    Raises
    ------
    ValueError
        The string does not follow this form, or holds a symbol that is not known.

    Examples
    --------
    >>> base_unit("N.s2/m2")
    BaseUnit(exponents={'kg': 1, 'm': -1}, factor=1.0, offset=0.0)
    >>> base_unit("deg").exponents
    {'rad': 1}
    """
    if unit == "degC":
        return BaseUnit({"K": 1}, 1.0, 273.15)
    if re.search(r"\d\.\d", unit):
        raise ValueError(f"unit {unit!r}: FMI knows whole exponents only; give the square of the value instead")
    above, _, below = unit.partition("/")
    if below.startswith("(") and below.endswith(")"):
        below = below[1:-1]
    elif "." in below:
        raise ValueError(f"unit {unit!r}: put what stands below the line in brackets: '{above}/({below})'")
    powers, factor = dict.fromkeys(BASE, 0), 1.0
    for product, sign in ((above, 1), (below or "1", -1)):
        factor *= _multiply(product, sign, powers, unit)
    return BaseUnit({name: power for name, power in powers.items() if power}, factor, 0.0)


def _multiply(product, sign, powers, unit):
    """Add the exponents of "N.s2" to `powers`; returns its factor."""
    factor = 1.0
    for part in product.split("."):
        match = FACTOR.fullmatch(part)
        if match is None:
            raise ValueError(f"unit {unit!r}: cannot read {part!r}; a unit looks like 'kg.m2' or 'N.s2/m2'")
        exponent = sign * int(match["exponent"] or 1)
        scale, definition = _symbol(match["symbol"], unit)
        factor *= scale**exponent
        for name, power in re.findall(r"([A-Za-z]+)(-?\d+)?", definition):
            powers[name] += exponent * int(power or 1)
    return factor


def _symbol(symbol, unit):
    """Factor and base units of one symbol, with or without prefix."""
    if symbol == "1":
        return 1.0, "1"
    if symbol in SYMBOLS:
        return SYMBOLS[symbol]
    prefix, rest = symbol[:1], symbol[1:]
    if prefix in PREFIXES and rest in WITH_PREFIX:
        scale, definition = SYMBOLS[rest]
        return PREFIXES[prefix] * scale, definition
    raise ValueError(
        f"unit {unit!r}: {symbol!r} is not known; known are {', '.join(sorted(SYMBOLS))}, degC and SI prefixes"
    )
