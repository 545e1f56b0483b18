"""Units by their SI base units, as the unit definitions of SSP and FMI give them.

Reference: FMI 2.0.4, section 2.2.2; the same in FMI 3.0 and SSP 1.0.
"""

import math
import re
from dataclasses import dataclass

from shipcosim.ssp.xml.document import local

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
ANGLE = BASE.index("rad")


@dataclass(frozen=True)
class Unit:
    """A unit of measurement: value in SI base units = factor * value + offset.

    Parameters
    ----------
    name : str
        As the file spells it.
    exponents : tuple of 8 int or None
        Of kg, m, s, A, K, mol, cd, rad; None where the unit is defined nowhere.
    factor, offset : float
        To SI base units.
    """

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0


def read_units(elements):
    """Units by name from Unit elements of an SSP file or model description; those without a base unit are left out."""
    units = {}
    for element in elements:
        base = next((part for part in element if local(part) == "BaseUnit"), None)
        if base is not None and element.get("name") is not None:
            exponents = tuple(int(base.get(name, 0)) for name in BASE)
            scale = float(base.get("factor", 1.0)), float(base.get("offset", 0.0))
            units[element.get("name")] = Unit(element.get("name"), exponents, *scale)
    return units


def find_unit(name, *tables):
    """Unit of a name: from the first table that has it, else by the common spelling, else a unit without definition.

    Parameters
    ----------
    name : str or None
        None: no unit.
    *tables : mapping of name to Unit
        Definitions of the file that the name stands in.
    """
    if name is None:
        return None
    for table in tables:
        if name in table:
            return table[name]
    return spelled(name) or Unit(name)


def relation(source, target):
    """How two units relate: ``same``, ``convertible``, ``angle`` (all but rad equal), ``unknown``, ``incompatible``."""
    if source.exponents is None or target.exponents is None:
        return "same" if source.name == target.name else "unknown"
    if source.exponents == target.exponents:
        return "same" if (source.factor, source.offset) == (target.factor, target.offset) else "convertible"
    without_angle = [unit.exponents[:ANGLE] for unit in (source, target)]
    return "angle" if without_angle[0] == without_angle[1] else "incompatible"


def conversion(source, target):
    """Factor and offset from one unit to the other: target value = factor * source value + offset.

    Examples
    --------
    >>> conversion(spelled("degC"), spelled("K"))
    (1.0, 273.15)
    """
    if source is None or target is None or relation(source, target) in ("same", "unknown", "incompatible"):
        return 1.0, 0.0
    return source.factor / target.factor, (source.offset - target.offset) / target.factor


def _unit(factor=1.0, offset=0.0, **exponents):
    return tuple(exponents.get(name, 0) for name in BASE), factor, offset


SYMBOLS = {
    "1": _unit(),
    "-": _unit(),
    "%": _unit(0.01),
    "kg": _unit(kg=1),
    "g": _unit(1e-3, kg=1),
    "t": _unit(1e3, kg=1),
    "m": _unit(m=1),
    "nmi": _unit(1852.0, m=1),
    "s": _unit(s=1),
    "min": _unit(60.0, s=1),
    "h": _unit(3600.0, s=1),
    "d": _unit(86400.0, s=1),
    "A": _unit(A=1),
    "K": _unit(K=1),
    "degC": _unit(1.0, 273.15, K=1),
    "mol": _unit(mol=1),
    "cd": _unit(cd=1),
    "rad": _unit(rad=1),
    "deg": _unit(math.pi / 180, rad=1),
    "rev": _unit(2 * math.pi, rad=1),
    "rpm": _unit(2 * math.pi / 60, rad=1, s=-1),
    "kn": _unit(1852.0 / 3600.0, m=1, s=-1),
    "Hz": _unit(s=-1),
    "N": _unit(kg=1, m=1, s=-2),
    "Pa": _unit(kg=1, m=-1, s=-2),
    "bar": _unit(1e5, kg=1, m=-1, s=-2),
    "J": _unit(kg=1, m=2, s=-2),
    "W": _unit(kg=1, m=2, s=-3),
    "V": _unit(kg=1, m=2, s=-3, A=-1),
    "Ohm": _unit(kg=1, m=2, s=-3, A=-2),
    "C": _unit(A=1, s=1),
    "l": _unit(1e-3, m=3),
}
"""Exponents, factor and offset of the spellings in use; for names that no file defines."""

PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXABLE = {"g", "m", "s", "A", "K", "rad", "Hz", "N", "Pa", "bar", "J", "W", "V", "Ohm", "l"}
FACTOR = re.compile(r"([A-Za-z%]+|1|-)(?:\^?(-?\d+))?")


def spelled(name):
    """Unit by its spelling in FMI's manner (``kg.m2/s``, ``N/(m.s)``, ``kn``), or None where it makes no sense.

    Examples
    --------
    >>> spelled("km/h").factor == 1000 / 3600
    True
    >>> spelled("parsnip")
    """
    numerator, *denominators = name.replace("*", ".").split("/")
    parts = [(factor, 1) for factor in numerator.split(".")]
    for denominator in denominators:
        whole = re.fullmatch(r"\((.*)\)", denominator)
        if "." in denominator and not whole:
            return None  # "a/b.c" is read in two ways
        parts += [(factor, -1) for factor in (whole[1] if whole else denominator).split(".")]
    exponents, scale, offset = [0] * len(BASE), 1.0, 0.0
    for text, sign in parts:
        symbol = _symbol(text)
        if symbol is None:
            return None
        (powers, factor, offset), power = symbol[:-1], sign * symbol[-1]
        if offset and (len(parts), power) != (1, 1):
            return None  # a temperature scale in a product
        exponents = [have + power * more for have, more in zip(exponents, powers, strict=True)]
        scale *= factor**power
    return Unit(name, tuple(exponents), scale, offset)


def _symbol(text):
    match = FACTOR.fullmatch(text)
    if match is None:
        return None
    symbol, power = match[1], int(match[2] or 1)
    if symbol in SYMBOLS:
        return *SYMBOLS[symbol], power
    if symbol[0] in PREFIXES and symbol[1:] in PREFIXABLE:
        exponents, factor, offset = SYMBOLS[symbol[1:]]
        return exponents, PREFIXES[symbol[0]] * factor, offset, power
    return None
