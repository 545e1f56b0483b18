"""Columns of thrusters: which thruster of the system, which quantity of it, command or feedback."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from shipcosim.diagnose.log.names.units import converts, unit_for
from shipcosim.diagnose.log.names.vocabulary import vocabulary, words_of
from shipcosim.diagnose.numerics import finite

_PWM = (850.0, 2150.0)  # us, pulse widths of servos and speed controllers
OF_A_MAP = {"%": "percent", "pct": "percent", "percent": "percent"}
OF_A_MAP |= {"us": "pwm", "µs": "pwm", "pwm": "pwm"}
"""Units that become a speed by a map only, and what they are of."""
_SURE = {"rpm", "azimuth", "thrust", "rudder", "force"}  # words that hardly say anything else
_FASTEST = 100.0  # 1/s, no shaft turns faster: larger numbers of revolutions are those of a minute
_ENGINES = {"engine", "me"}
_ELSEWHERE = {"bow", "port", "starboard", "stern", "centre"}


@dataclass(frozen=True)
class Drive:
    """What the name of a thruster's column says.

    Attributes
    ----------
    quantity : str
        ``"rpm"``, ``"azimuth"``, ``"thrust"``, ``"pwm"``, ``"percent"``; empty where it says none.
    place : frozenset of str
        Words for the thruster: port, bow, 1; empty where there are none but "thruster" and the like.
    kind : str
        ``"command"``, ``"feedback"`` or empty.
    doubt : str
        Why the quantity is not sure; empty where it is.
    """

    quantity: str
    place: frozenset[str]
    kind: str = ""
    doubt: str = ""


def drive_of(words: tuple[str, ...], unit: str, values: np.ndarray) -> Drive | None:
    """The quantity of a thruster that a column names; None if it names none.

    Parameters
    ----------
    words : tuple of str
        Of its name, see `words_of`.
    unit : str
        As stated, or empty.
    values : (n,) array
        Its numbers.

    Examples
    --------
    >>> drive_of(words_of("stbd_rpm_fb"), "", np.zeros(2))
    Drive(quantity='rpm', place=frozenset({'starboard'}), kind='feedback', doubt='')
    >>> drive_of(words_of("wind speed"), "", np.zeros(2)) is None
    True
    """
    # Command or feedback, and the words without those.
    terms = vocabulary()["words"]
    kind = next((k for k in ("feedback", "command") if any(w in terms[k] for w in words)), "")
    rest = [
        w
        for w in words
        if w not in terms["command"] and w not in terms["feedback"] and w not in terms["filler"]
    ]
    if any(word in terms["other"] for word in rest):
        return None
    generic = set(vocabulary()["thruster"]["generic"]["words"])
    # Quantity and place; the name must clearly be one of a thruster.
    whole = rest
    quantity, word, rest = _quantity(rest)
    word = quantity if quantity in whole else word
    place = frozenset(_places().get(w, w) for w in rest if w not in generic)
    is_named = len(rest) > len(place) or word in _SURE or bool(set(rest) & set(_places()))
    is_named = is_named or bool(quantity and rest and all(w.isdigit() for w in rest))
    places = set(_places().values())
    if not is_named or any(w not in places and not w.isdigit() and len(w) > 1 for w in place):
        return None
    is_letter = bool({"p", "s"} & set(rest))
    if is_letter and len(word) < 2:
        return None
    if not quantity and not (place or generic & set(rest)):
        return None
    # Unit and values decide between pulses, per cent and others.
    quantity, doubt = _by_values(quantity, word, unit.strip().lower(), values)
    if quantity == "rpm" and _ENGINES & set(whole):
        doubt = "an engine turns as fast as its propeller only where there is no gear"
    if is_letter:
        doubt = doubt or "a single letter may stand for something else than the side"
    return Drive(quantity, place, kind, doubt)


def thrusters_named(
    place: frozenset[str], thrusters: Mapping[str, tuple[str, ...]]
) -> tuple[list[str], str]:
    """Thrusters of a system that some words can mean, and why that is a guess; empty where it is none.

    Parameters
    ----------
    place : frozenset of str
        See `Drive`.
    thrusters : mapping of str to tuple of str
        Names of the system's, and what drives each.

    Examples
    --------
    >>> ship = {"port": ("rpm", "azimuth"), "starboard": ("rpm", "azimuth"), "tunnel": ("rpm",)}
    >>> thrusters_named(frozenset({"starboard"}), ship)
    (['starboard'], '')
    >>> thrusters_named(frozenset({"bow"}), ship)[0], thrusters_named(frozenset({"stern"}), ship)[0]
    (['tunnel'], [])
    """
    # The same place, then one whose words contain the
    # others, then by number, then by what is usual.
    placed = {name: _place_of(name) for name in thrusters}
    if same := [name for name, words in placed.items() if words == place]:
        return same, "" if len(same) == 1 else "it names several"
    if not place:
        main = [
            name for name, drives in thrusters.items() if len(thrusters) == 1 or "azimuth" in drives
        ]
        return main or list(thrusters), "" if len(
            thrusters
        ) == 1 else "one value for all of these is assumed"
    # A number alone is counted by each maker in an order of its own.
    near = [name for name, words in placed.items() if words and (words < place or place < words)]
    is_number = all(word.isdigit() for word in place)
    if len(near) == 1 and not is_number:
        more = (place - placed[near[0]]) & _ELSEWHERE
        more -= {"bow"} if "tunnel" in placed[near[0]] else set()
        return near, f"it says more than '{near[0]}': {', '.join(sorted(more))}" if more else ""
    if is_number and len(place) == 1 and 0 < (number := int(next(iter(place)))) <= len(thrusters):
        return (
            [list(thrusters)[number - 1]],
            f"a number alone may count otherwise; they are counted in the order of the system: {', '.join(thrusters)}",
        )
    if place & {"bow"}:
        across = [name for name, words in placed.items() if "tunnel" in words]
        if len(across) == 1:
            return across, ""
    return near, "it can be any of these" if near else ""


def _place_of(name):
    generic = set(vocabulary()["thruster"]["generic"]["words"]) | set(
        vocabulary()["words"]["filler"]
    )
    return frozenset(_places().get(word, word) for word in words_of(name) if word not in generic)


@cache
def _places() -> dict[str, str]:
    return {
        word: place for place, words in vocabulary()["thruster"]["places"].items() for word in words
    }


@cache
def _phrases() -> list[tuple[tuple[str, ...], str]]:
    """Words that name a quantity of a thruster, those of many words first."""
    terms = vocabulary()["thruster"]
    quantities = ("rpm", "azimuth", "thrust", "pwm", "percent")
    phrases = sorted(
        (words_of(phrase), quantity) for quantity in quantities for phrase in terms[quantity]
    )
    # The word azimuth also names the thruster: beside another quantity it is none.
    return sorted(phrases, key=lambda pair: (-len(pair[0]), pair == (("azimuth",), "azimuth")))


def _quantity(words):
    """The quantity that some words name, the words for it, and those that are left."""
    for phrase, quantity in _phrases():
        for start in range(len(words) - len(phrase), -1, -1):
            if tuple(words[start : start + len(phrase)]) == phrase:
                rest = words[:start] + words[start + len(phrase) :]
                return quantity, phrase[-1], rest
    return "", "", list(words)


def _by_values(quantity, word, unit, values):
    """The quantity by its unit and its numbers besides."""
    # A stated unit decides; without a quantity the range of the values does.
    numbers = finite(values) if values.dtype.kind == "f" else np.empty(0)
    if unit in OF_A_MAP:
        return OF_A_MAP[unit], ""
    # In rpm the word azimuth is the kind of thruster.
    is_kind = word == "azimuth" and unit_for(unit, "rpm") == "rpm"
    if is_kind or (quantity == "" and unit and converts(unit, "rpm")):
        return "rpm", ""
    inside = len(numbers) and numbers.min() >= _PWM[0] and numbers.max() <= _PWM[1]
    if quantity == "" and inside:
        return "pwm", ""
    if quantity == "" and len(numbers) and np.abs(numbers).max() <= 100.0:
        return "percent", ""
    if word == "revolutions" and not unit:
        is_fast = len(numbers) and np.abs(numbers).max() > _FASTEST
        return (
            quantity,
            "" if is_fast else "revolutions a second, as Signal K has them, or a minute",
        )
    is_sure = word in _SURE or unit or quantity in ("", "pwm", "percent")
    return quantity, "" if is_sure else f"'{word}' may be something else"
