"""Units as headers of logs write them."""

import re
from functools import cache

from shipcosim.diagnose.log.names.vocabulary import vocabulary
from shipcosim.dialects import name_in
from shipcosim.units import Unit, relation, spelled_unit

_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[［](?P<unit>[^\[\]［］]*)[\]］]\s*$")
_OTHERS = re.compile(
    r"^(?P<name>.*?)\s*(?:[(（](?P<a>[^()（）]*)[)）]|\{(?P<b>[^{}]*)\}|<(?P<c>[^<>]*)>|[,/:;]\s+(?P<d>[^,/\s]\S*)|(?P<e>%|°T?))\s*$"
)
_COUNTED = r"\((?:\+[NE]|clockwise (?:from (?:bow|true north)|towards true north))\)"
_MULTIPLE = re.compile(r"[*/.x]10+$")  # deg*10: whether it multiplies or divides is not said
_LONGEST_SUFFIX = 3  # words
_NO_SUFFIX = set("n rpm 1 none raw date utc local iso text h d int grad flag".split())
"""Spellings of units that at the end of a name, after an underscore, mean something else."""


def name_and_unit(header: str) -> tuple[str, str]:
    """Parts of a header: ``name [unit]``, and where it is one ``name (unit)``, ``name {unit}``, ``name, unit``.

    Examples
    --------
    >>> name_and_unit("surge (m/s)"), name_and_unit("time [s]"), name_and_unit("heading (true)")
    (('surge', 'm/s'), ('time', 's'), ('heading (true)', ''))
    """
    # A name that we have written in quotes is taken as it is.
    if (match := _BRACKETS.match(header.strip())) and (name := name_in(match["name"])) != match[
        "name"
    ]:
        return name, match["unit"].strip()
    # Brackets are the standard form. In other forms the last part must be the spelling of a unit.
    header = header.strip().strip("'\"").strip()
    if match := _BRACKETS.match(header):
        return match["name"].strip(), match["unit"].strip()
    if match := _OTHERS.match(header):
        unit = next(
            text for text in match.group("a", "b", "c", "d", "e") if text is not None
        ).strip()
        if is_unit(unit) and match["name"].strip():
            return match["name"].strip(), unit
    return header, ""


def is_unit(text: str) -> bool:
    """Whether a text is the spelling of a unit, as headers have them."""
    return bool(text.strip()) and (
        _plain(text) in _spellings() or spelled_unit(text.strip()) is not None
    )


def unit_for(spelling: str, target: str) -> str:
    """A unit in shipcosim's spelling; an ambiguous spelling means the unit of the same kind as `target`.

    Examples
    --------
    >>> unit_for("knots", "m/s"), unit_for("ms", "m/s"), unit_for("ms", "s"), unit_for("°/s", "deg/s")
    ('kn', 'm/s', 'ms', 'deg/s')
    >>> unit_for("kN", "N"), unit_for("parsec", "m")
    ('kN', 'parsec')
    """
    spelling = spelling.strip()
    if _MULTIPLE.search(spelling):
        return f"multiple: {spelling}"
    # Per second an angle is rad/s: only what turns on a shaft is counted in revolutions.
    if target == "deg/s" and _plain(spelling) in ("1/s", "s-1", "s^-1", "s⁻¹"):
        return "rad/s"
    # A spelling such as ms can stand for several units: take the first that measures the same quantity. What it means
    # on ships goes first: nm is a nautical mile, not a nanometre.
    wanted = spelled_unit(target)
    options = [
        unit
        for unit in (*_spellings().get(_plain(spelling), ()), spelling)
        if spelled_unit(unit) is not None
    ]
    for unit in options:
        if wanted is None or _are_equal(spelled_unit(unit), wanted):
            return unit
    return options[-1] if options else _spellings().get(_plain(spelling), (spelling,))[0]


def converts(unit: str, target: str) -> bool:
    """Whether a unit, as a header spells it, converts to the target.

    Examples
    --------
    >>> converts("rps", "rpm"), converts("knots", "deg")
    (True, False)
    """
    return _are_equal(spelled_unit(unit_for(unit, target)), spelled_unit(target))


def _are_equal(unit: Unit | None, other: Unit | None) -> bool:
    """True if two units that are defined convert into each other."""
    if unit is None or other is None:
        return False
    return relation(unit, other) in ("same", "convertible")


def unit_after(words: tuple[str, ...], target: str) -> tuple[tuple[str, ...], str]:
    """A name's words without the unit at their end, and this unit; empty where there is none.

    Parameters
    ----------
    words : tuple of str
        As from `words_of`.
    target : str
        Unit of what the name may mean.

    Examples
    --------
    >>> unit_after(("surge", "m", "s"), "m/s"), unit_after(("yaw", "rate", "deg", "s"), "deg/s")
    ((('surge',), 'm/s'), (('yaw', 'rate'), 'deg/s'))
    """
    wanted = spelled_unit(target)
    # Longest suffix first, with any separator between its words.
    for count in range(min(_LONGEST_SUFFIX, len(words) - 1), 0, -1):
        last = words[-count:]
        for text in dict.fromkeys(("_".join(last), "/".join(last), "".join(last))):
            if text in _NO_SUFFIX:
                continue
            for unit in _spellings().get(text, ()):
                if _are_equal(spelled_unit(unit), wanted):
                    return words[:-count], unit
    return words, ""


def _plain(text: str) -> str:
    # Times by CF say since when after their unit. "Grad" is German for a degree; "grad" can be a gon as well.
    text = re.sub(r"\bGrad\b", "deg", text)
    # What stands in brackets behind it agrees with our roles: SAMOS writes how angles are counted.
    return re.sub(_COUNTED + r"|\s+since\s.*|\s+", "", text).lower()


@cache
def _spellings() -> dict[str, tuple[str, ...]]:
    """Units by every spelling of names.toml; some stand for several."""
    units: dict[str, tuple[str, ...]] = {}
    for unit, spellings in vocabulary()["units"].items():
        for spelling in (unit.lower(), *spellings):
            if unit not in units.get(spelling, ()):
                units[spelling] = (*units.get(spelling, ()), unit)
    return units
