"""Units of measurement: what a spelling such as ``"N.s2/m2"`` means in SI base units, and conversions between units.

The one table of units, for FMUs, system structures and time series. Spellings that it does not hold, such as ``"ft"``,
are left to pint where a time series is converted. This is the only door to pint, which takes half a second to import
and is therefore imported only then.

Reference: FMI 2.0.4, section 2.2.2; the same in FMI 3.0 and SSP 1.0. BIPM, The International System of Units, 9th ed.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, TypeGuard

if TYPE_CHECKING:
    import pint

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
"""In the order of FMI. The radian is one of them there, so that an angle is not taken for a ratio."""

_ANGLE = BASE_UNITS.index("rad")


@dataclass(frozen=True)
class Unit:
    """A unit of measurement: value in SI base units = factor * value + offset.

    Parameters
    ----------
    name : str
        As the file spells it.
    exponents : tuple of 8 int or None
        Of the base units kg, m, s, A, K, mol, cd, rad; None where the unit is defined nowhere.
    factor, offset : float
        To SI base units.
    """

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0

    @property
    def powers(self) -> dict[str, int]:
        """Exponents by base unit, those that are not 0, in the order of `BASE_UNITS`; empty without a definition."""
        pairs = zip(BASE_UNITS, self.exponents, strict=True) if self.exponents else ()
        return {name: power for name, power in pairs if power}

    @property
    def definition(self) -> str:
        """The unit in base units: ``"0.0174533 rad"``, ``"100000 kg m-1 s-2"``; empty where it is defined nowhere."""
        if self.exponents is None:
            return ""
        parts = [name if power == 1 else f"{name}{power}" for name, power in self.powers.items()]
        text = " ".join([f"{self.factor:.6g}", *(parts or ["(no dimension)"])])
        return f"{text} + {self.offset:.6g}" if self.offset else text

    @property
    def base_unit_attributes(self) -> dict[str, str]:
        """Attributes of the element ``BaseUnit`` that defines the unit in a file of FMI or SSP."""
        attributes = {name: str(power) for name, power in self.powers.items()}
        attributes |= {"factor": repr(self.factor)} if self.factor != 1.0 else {}
        return attributes | ({"offset": repr(self.offset)} if self.offset else {})


class UnitError(ValueError):
    """Units that cannot be read or converted.

    Parameters
    ----------
    found : str
        What is wrong, as a sentence.
    remedy : str
        What would be right; empty where nothing can be said.
    """

    def __init__(self, message: str, remedy: str = ""):
        super().__init__(f"{message} {remedy}".rstrip())
        self.found = message
        self.remedy = remedy


_TABLE = """
1    1
-    1
%    0.01
kg   1                    kg
g    0.001                kg
t    1000                 kg
m    1                    m
nmi  1852                 m
s    1                    s
min  60                   s
h    3600                 s
d    86400                s
A    1                    A
K    1                    K
degC 1+273.15             K
mol  1                    mol
cd   1                    cd
rad  1                    rad
deg  0.017453292519943295 rad
gon  0.015707963267948967 rad
rev  6.283185307179586    rad
rpm  0.10471975511965977  s-1 rad
kn   0.5144444444444445   m s-1
Hz   1                    s-1
N    1                    kg m s-2
Pa   1                    kg m-1 s-2
bar  100000               kg m-1 s-2
J    1                    kg m2 s-2
W    1                    kg m2 s-3
V    1                    kg m2 s-3 A-1
Ohm  1                    kg m2 s-3 A-2
C    1                    s A
l    0.001                m3
"""
"""Symbol, factor and offset to SI base units, and these with their exponents."""


def _unit(name: str, factor: float = 1.0, offset: float = 0.0, **exponents: int) -> Unit:
    return Unit(name, tuple(exponents.get(base, 0) for base in BASE_UNITS), factor, offset)


def _unit_of_line(line: str) -> Unit:
    name, number, *powers = line.split()
    factor, _, offset = number.partition("+")
    parts = [re.fullmatch(r"([A-Za-z]+)(-?\d+)?", power) for power in powers]
    exponents = {part[1]: int(part[2] or 1) for part in parts if part}
    return _unit(name, float(factor), float(offset or 0.0), **exponents)


SYMBOLS = {unit.name: unit for unit in map(_unit_of_line, _TABLE.strip().splitlines())}
"""Units by their symbol, for spellings that no file defines."""
RADIAN = SYMBOLS["rad"]

AMBIGUOUS = ("C", "d", "g", "t")
"""Symbols that files also use for other units, such as C for degrees Celsius."""

PREFIXES = {
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "h": 1e2,
    "d": 1e-1,
    "c": 1e-2,
    "m": 1e-3,
    "u": 1e-6,
    "n": 1e-9,
}
WITH_PREFIX = set("g m s A K mol rad Hz N Pa bar J W C V Ohm l".split())
"""Symbols that a prefix of the SI can stand before."""

_FACTOR = re.compile(r"(?P<symbol>[A-Za-z%]+|1|-)(?:\^?(?P<exponent>[+-]?\d+))?")


def fmi_unit(spelling: str) -> Unit:
    """Unit of a spelling in FMI's form, to be written into a model description.

    Parameters
    ----------
    spelling : str
        Products with ".", at most one "/", several units below it in brackets: ``"N.s2/m2"``, ``"1/(m.s)"``.

    Returns
    -------
    Unit

    Raises
    ------
    UnitError
        If the spelling does not follow this form, or holds a symbol that is not known.

    Examples
    --------
    >>> fmi_unit("N.s2/m2").powers
    {'kg': 1, 'm': -1}
    >>> fmi_unit("rpm").powers
    {'s': -1, 'rad': 1}
    """
    if re.search(r"\d\.\d", spelling):
        raise UnitError(
            f"unit {spelling!r}: FMI knows whole exponents only; give the square of the value instead"
        )
    if re.search(r"[*^]|/.*/", spelling):
        raise UnitError(
            f"unit {spelling!r}: FMI writes 'N.m', 'm2' and at most one '/', as in 'J/(kg.K)'"
        )
    return _read(spelling)


@lru_cache(4096)
def spelled_unit(spelling: str) -> Unit | None:
    """Unit of a spelling as files have it (``kg.m2/s``, ``N/(m.s)``, ``m/s^2``, ``kn``), or None if it makes no sense.

    Examples
    --------
    >>> spelled_unit("km/h").factor == 1000 / 3600
    True
    >>> spelled_unit("parsnip")
    """
    try:
        return _read(spelling)
    except UnitError:
        return None


def _read(spelling: str) -> Unit:
    """Unit of a spelling, or UnitError."""
    numerator, *denominators = spelling.replace("*", ".").split("/")
    parts = [(part, 1) for part in numerator.split(".")]
    for denominator in denominators:
        bracketed = re.fullmatch(r"\((.*)\)", denominator)
        if "." in denominator and not bracketed:
            below = f"'{numerator}/({denominator})'"
            raise UnitError(
                f"unit {spelling!r}: put what stands below the line in brackets: {below}"
            )
        parts += [(part, -1) for part in (bracketed[1] if bracketed else denominator).split(".")]
    exponents = [0] * len(BASE_UNITS)
    factor = 1.0
    offset = 0.0
    for text, sign in parts:
        unit, power = _part(text, spelling)
        power *= sign
        if unit.offset and (len(parts), power) != (1, 1):
            raise UnitError(
                f"unit {spelling!r}: {unit.name} is a scale of temperature; write K in a product"
            )
        exponents = [
            have + power * more for have, more in zip(exponents, unit.exponents or (), strict=True)
        ]
        factor = factor * unit.factor**power
        offset = unit.offset
    return Unit(spelling, tuple(exponents), factor, offset)


def _part(text: str, spelling: str) -> tuple[Unit, int]:
    """Unit and exponent of one part of a product, such as "mm2"."""
    match = _FACTOR.fullmatch(text)
    if match is None:
        raise UnitError(
            f"unit {spelling!r}: cannot read {text!r}; a unit looks like 'kg.m2' or 'N.s2/m2'"
        )
    symbol = match["symbol"]
    power = int(match["exponent"] or 1)
    if symbol in SYMBOLS:
        return SYMBOLS[symbol], power
    prefix = symbol[:1]
    rest = symbol[1:]
    if prefix in PREFIXES and rest in WITH_PREFIX:
        return Unit(symbol, SYMBOLS[rest].exponents, PREFIXES[prefix] * SYMBOLS[rest].factor), power
    raise UnitError(
        f"unit {spelling!r}: {symbol!r} is not known; known are {', '.join(sorted(SYMBOLS))}, SI prefixes"
    )


def find_unit(name: str | None, *definitions: Mapping[str, Unit]) -> Unit | None:
    """Unit of a name: as a file defines it, else by the common spelling, else a unit without definition.

    Parameters
    ----------
    name : str or None
        None: no unit.
    *definitions : mapping of name to Unit
        Definitions of the file that the name stands in; the first that has the name counts.
    """
    if name is None:
        return None
    for units in definitions:
        if name in units:
            return units[name]
    return spelled_unit(name) or Unit(name)


def relation(source: Unit, target: Unit) -> str:
    """How two units relate.

    Parameters
    ----------
    source, target : Unit
        The units.

    Returns
    -------
    str
        ``"same"``; ``"convertible"``; ``"angle"`` where they are equal except for the radian; ``"unknown"`` where one of
        them has no definition; ``"incompatible"``.
    """
    if source.exponents is None or target.exponents is None:
        return "same" if source.name == target.name else "unknown"
    if source.exponents == target.exponents:
        return (
            "same"
            if (source.factor, source.offset) == (target.factor, target.offset)
            else "convertible"
        )
    return "angle" if source.exponents[:_ANGLE] == target.exponents[:_ANGLE] else "incompatible"


def contradicts(unit: Unit, other: Unit) -> bool:
    """Whether two definitions of one name differ by more than rounding; rad and 1 count as the same dimension."""
    related = relation(unit, other)
    if related == "incompatible":
        return True
    is_close = math.isclose(unit.factor, other.factor, rel_tol=1e-3)
    return related == "convertible" and not (is_close and abs(unit.offset - other.offset) <= 0.1)


def told_apart(unit: Unit, other: Unit) -> tuple[str, str]:
    """Names of two units; where both have one name, with their definitions.

    Examples
    --------
    >>> told_apart(SYMBOLS["m"], SYMBOLS["kg"]), told_apart(SYMBOLS["m"], Unit("m", None))
    (('m', 'kg'), ('m (1 m)', 'm (not defined)'))
    """
    names = [unit.name, other.name]
    if unit.name == other.name:
        names = [f"{each.name} ({each.definition or 'not defined'})" for each in (unit, other)]
    return names[0], names[1]


def conversion(source: Unit | None, target: Unit | None) -> tuple[float, float]:
    """Factor and offset from one unit to the other: target value = factor * source value + offset.

    Parameters
    ----------
    source, target : Unit or None
        None: no unit.

    Returns
    -------
    tuple of two float
        (1, 0), which changes nothing, where one of them is missing or they cannot be converted.

    Examples
    --------
    >>> conversion(spelled_unit("degC"), spelled_unit("K"))
    (1.0, 273.15)
    """
    if (
        source is None
        or target is None
        or relation(source, target) in ("same", "unknown", "incompatible")
    ):
        return 1.0, 0.0
    return source.factor / target.factor, (source.offset - target.offset) / target.factor


def spelled_conversion(source: str, target: str) -> tuple[float, float]:
    """Factor and offset from one unit to the other by their spellings, those included that pint alone knows.

    Parameters
    ----------
    source, target : str
        ``"kn"``, ``"N.m"``, ``"ft"``.

    Returns
    -------
    tuple of two float
        Target value = factor * source value + offset.

    Raises
    ------
    UnitError
        If a unit is unknown or the two do not measure the same thing.

    Examples
    --------
    >>> spelled_conversion("kn", "m/s")
    (0.5144444444444445, 0.0)
    """
    given = spelled_unit(source)
    wanted = spelled_unit(target)
    if given is None or wanted is None:
        return _pint_conversion(source, target)
    if relation(given, wanted) == "incompatible":
        raise UnitError(
            f"cannot convert '{source}' into '{target}': they measure different things."
        )
    return conversion(given, wanted)


_AMOUNT = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"(?P<unit>\s+\S.*|(?![eE][+-]?\d)[A-Za-z%°µΩ].*)"
)


def amount(text: str) -> tuple[float, str] | None:
    """Number and unit of an amount as people write it, or None for any other text.

    Examples
    --------
    >>> amount("45 deg"), amount("-1.5e3kN"), amount("kaimal"), amount("45")
    ((45.0, 'deg'), (-1500.0, 'kN'), None, None)
    """
    match = _AMOUNT.fullmatch(text)
    return (float(match["number"]), match["unit"].strip()) if match else None


def is_amount(value: Any) -> TypeGuard[str]:
    """True for a text that is a number with a unit.

    Examples
    --------
    >>> is_amount("45 deg"), is_amount("kaimal"), is_amount(45.0)
    (True, False, False)
    """
    return isinstance(value, str) and amount(value) is not None


def number_in(text: str, target: Unit | None, *, difference: bool = False) -> float:
    """Number of an amount with a unit, in another unit.

    Parameters
    ----------
    text : str
        Such as ``"45 deg"``, also in a unit that pint alone knows.
    target : Unit or None
        In which the number is wanted; None where what it is for has no unit.
    difference : bool
        Whether it is a difference of two values: 1 degC is 1 K then, not 274.15 K.

    Returns
    -------
    float

    Raises
    ------
    UnitError
        If the text is no amount, or measures another thing.

    Examples
    --------
    >>> number_in("2 kn", spelled_unit("km/h"))
    3.704
    """
    parsed = amount(text)
    name = target.name if target else "1"
    if parsed is None:
        raise UnitError(
            f"{text!r} is no number with a unit.",
            f"Write a number in {name}, or such as '2.5 {name}'.",
        )
    number, spelling = parsed
    source = spelled_unit(spelling) or _pint_unit(spelling)
    if source is None:
        raise UnitError(
            f"{text!r}: the unit {spelling!r} is not known.",
            "Units are written like deg, kn or N.m.",
        )
    if target is None or not _same_kind(source, target):
        wanted = f"{name} is wanted" if target else "no unit is wanted"
        raise UnitError(
            f"{text!r} is in {spelling}, where {wanted}: they measure different things.",
            (
                f"Write a number in {target.name}, or one with a unit that converts to it."
                if target
                else "Write a number."
            ),
        )
    factor = source.factor / target.factor
    offset = (source.offset - target.offset) / target.factor
    return number * factor + (0.0 if difference else offset)


def value_of(text: str) -> Any:
    """Value of a typed text, read as TOML; other text stays text.

    Examples
    --------
    >>> [value_of(text) for text in ("5e5", " true", "10 kn", "'5'")]
    [500000.0, True, '10 kn', '5']
    """
    try:
        return tomllib.loads(f"value = {text.strip()}")["value"]
    except (ValueError, RecursionError):
        return text.strip()


def seconds(given: str | float) -> float:
    """A time as people give it, in seconds.

    Parameters
    ----------
    given : str or float
        Such as ``"10 min"``; a number is in seconds.

    Returns
    -------
    float
        [s]

    Raises
    ------
    UnitError
        If it is no finite number, or measures another thing.

    Examples
    --------
    >>> seconds("1.5 min"), seconds("90"), seconds(90.0)
    (90.0, 90.0, 90.0)
    """
    remedy = "Give seconds, or a text with a unit, such as '10 min'."
    try:
        number = float(given)
    except ValueError:
        if amount(str(given)) is None:
            raise UnitError(f"{given!r} is no time.", remedy) from None
        number = number_in(str(given), _unit("s", s=1))
    except TypeError:
        raise UnitError(f"{given!r:.60} is no time.", remedy) from None
    if not math.isfinite(number):
        raise UnitError(f"{given!r} is no time.", remedy)
    return number


def whole_steps(duration: float, step_size: float) -> int | None:
    """Number of steps in a duration; None if it is not whole, to a millionth of a step.

    Examples
    --------
    >>> whole_steps(1100.0, 0.05)
    22000
    >>> whole_steps(0.12, 0.05) is None
    True
    """
    # Rounding errors of decimal step sizes are allowed, half steps are not.
    steps = steps_in(duration, step_size)
    count = round(steps)
    return count if abs(steps - count) <= 1e-6 else None


def as_python(value: Any) -> Any:
    """A number of NumPy or xarray as one of Python; anything else as it is.

    Examples
    --------
    >>> import numpy as np
    >>> as_python(np.float32(0.5)), as_python("2.5 deg")
    (0.5, '2.5 deg')
    """
    return value.item() if getattr(value, "size", None) == 1 else value


def is_finite(value: Any) -> bool:
    """Whether a number is finite as a float: whole numbers can be larger than any.

    Examples
    --------
    >>> [is_finite(value) for value in (2, 1e308, 10**400, float("nan"))]
    [True, True, False, False]
    """
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def steps_in(duration: float, step_size: float) -> float:
    """Number of steps in a duration, whole or not, but at most `MOST_STEPS`: numbers of any size stand in files.

    Examples
    --------
    >>> steps_in(0.3, 0.2), steps_in(-1e308, 1e-308)
    (1.4999999999999998, -9007199254740992.0)
    """
    return max(-MOST_STEPS, min(duration / step_size, MOST_STEPS))


MOST_STEPS = 2.0**53
"""Beyond this number not every whole number is a float."""


def _same_kind(source: Unit, target: Unit) -> bool:
    """Whether an amount in one unit can stand for an amount in the other.

    An angle is no ratio, but files that define rad or deg without the radian mean the angle.
    """
    if (related := relation(source, target)) != "angle":
        return related in ("same", "convertible")
    named = spelled_unit(target.name)
    return named is not None and named.exponents == source.exponents


_NAMES = ("kilogram", "meter", "second", "ampere", "kelvin", "mole", "candela", "radian")
_IN_PINT: dict[str, str] = dict(zip(_NAMES, BASE_UNITS, strict=True))


def _pint_unit(spelling: str) -> Unit | None:
    """Unit of a spelling that only pint knows, such as "ft" or "°"; None for unknown ones."""

    try:
        registry = _registry()
        unit = registry(_pint_spelling(spelling)).units
        offset, scaled = (
            float(registry.Quantity(value, unit).to_base_units().magnitude) for value in (0.0, 1.0)
        )
        in_base = registry.Quantity(1.0, unit).to_base_units()
        powers = {str(name): float(str(power)) for name, power in in_base.unit_items()}
    except Exception:  # pint raises anything at a text that is no unit, AssertionError too
        return None
    if any(name not in _IN_PINT or not power.is_integer() for name, power in powers.items()):
        return None
    return _unit(
        spelling,
        scaled - offset,
        offset,
        **{_IN_PINT[name]: int(power) for name, power in powers.items()},
    )


def _pint_conversion(source: str, target: str) -> tuple[float, float]:
    import pint

    try:
        registry = _registry()
        units = [registry(_pint_spelling(spelling)).units for spelling in (source, target)]
        offset, scaled = (
            float(registry.Quantity(value, units[0]).to(units[1]).magnitude) for value in (0.0, 1.0)
        )
    except pint.UndefinedUnitError as error:
        why = str(error).replace("is not defined in the unit registry", "is not known")
        raise UnitError(
            f"cannot convert '{source}' into '{target}': {why}.",
            "Units are written like N.m, kn or deg.",
        ) from error
    except pint.DimensionalityError as error:
        raise UnitError(
            f"cannot convert '{source}' into '{target}': they measure different things."
        ) from error
    except UnitError:
        raise
    except Exception as error:  # pint raises anything, AssertionError too
        # Such as degC/min: a scale with a zero of its own has no place in a product.
        raise UnitError(f"cannot convert '{source}' into '{target}'.") from error
    return scaled - offset, offset


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    return pint.UnitRegistry()


_TOKEN = re.compile(
    r"(?P<name>[A-Za-z_%°µΩ]+)(?:\^|\*\*)?(?P<power>-?\d)?|(?P<sign>[.*/()]|1(?!\d))|\s+"
)


def _pint_spelling(unit: str) -> str:
    """FMI's "kg.m2/s" as pint wants it. Only names, powers and signs get through: pint evaluates what it reads."""
    spelling = ""
    position = 0
    while position < len(unit):
        token = _TOKEN.match(unit, position)
        if token is None:
            raise UnitError(f"'{unit}' is no unit.", "Units are written like N.m, kg.m2/s or deg.")
        power = f"**{token['power']}" if token["power"] else ""
        spelling += (token["name"] or (token["sign"] or "").replace(".", "*")) + power
        position = token.end()
    return spelling
