"""The names and units of names.toml, as look-ups."""

import re
import tomllib
import unicodedata
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

_FILE = Path(__file__).parent / "names.toml"
_WORDS = re.compile(r"[^\W\d_]+|\d+")
_HUMP = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z]{2,})")
_PERCENT = re.compile(r"%(?!\w)|(?<=.)%")  # ROS writes %time
_LONGEST = 60  # letters of words written together. Assumed.
_SHORTEST = 3  # letters of a name that is sought within another
_MARK = re.compile(r"[\u0300-\u036f]")


@dataclass(frozen=True)
class Meaning:
    """What a name says.

    Attributes
    ----------
    role : str or None
        Its role; None where it has none.
    doubt : str
        Why that is not sure; empty where it is.
    reason : str
        Why there is no role; empty where nothing is known of the name.
    """

    role: str | None
    doubt: str = ""
    reason: str = ""


@cache
def vocabulary() -> dict[str, Any]:
    """Content of names.toml."""
    return tomllib.loads(_FILE.read_text(encoding="utf-8"))


@cache
def words_of(name: str) -> tuple[str, ...]:
    """Words of a name in lower case, short forms written out.

    Examples
    --------
    >>> words_of("HDG_True"), words_of("windSpeed"), words_of("/nav/SOG")
    (('heading', 'true'), ('wind', 'speed'), ('nav', 'sog'))
    >>> words_of("thr1_stbd")
    ('thruster', '1', 'starboard')
    """
    # Scripts without blanks first, then words by their separators and capitals.
    same = _short_forms()
    name = name.replace("StB", "Stb")  # German for starboard; the capital begins no word
    if not name.isascii():
        parts = vocabulary()["words"]["parts"]
        name = word_parts().sub(lambda match: f" {parts[match[0].lower()]} ", name)
        name = _plain(name)
    name = _PERCENT.sub(" percent ", name)
    words = [word.lower() for part in _HUMP.split(name) for word in _WORDS.findall(part)]
    return tuple(part for word in words for part in _written_out(word, same).split())


def _plain(text):
    """A text without accents and with letters of full width as usual ones, as many logs write names."""
    letters = str.maketrans(vocabulary()["words"]["letters"])
    bare = _MARK.sub("", unicodedata.normalize("NFKD", text.translate(letters)))
    return unicodedata.normalize("NFC", bare)


@cache
def _short_forms() -> dict[str, str]:
    """What words are written out to, by the word without accents."""
    return {_plain(word): full for word, full in vocabulary()["words"]["same"].items()}


def _written_out(word: str, same: dict[str, str]) -> str:
    """A word in English, also one of several words without blanks between, as northern languages and loggers write."""
    # Each cut may be tried beside any other: no name of a channel is that long.
    if word in same or word in simple_words() or len(word) > _LONGEST:
        return same.get(word, word)
    for cut in range(_SHORTEST, len(word) - 1):
        first, rest = word[:cut], word[cut:]
        if first in simple_words():
            more = _written_out(rest, same)
            is_word = rest in simple_words() and len(rest) >= _SHORTEST
            if is_word or rest in _units() or " " in more:
                return f"{same.get(first, first)} {more}"
    return word


@cache
def simple_words() -> frozenset[str]:
    """Words that the names of names.toml are made of; some are written together from others."""
    terms = vocabulary()
    texts = [*_short_forms(), *terms["none"]]
    thruster = terms["thruster"]
    parts = terms, terms["words"], thruster, thruster["places"], thruster["generic"]
    for entry in (entry for part in parts for entry in part.values()):
        texts += entry if isinstance(entry, list) else entry.get("names", ())
    texts += terms["words"]["other"]
    return frozenset(word for text in texts for word in _WORDS.findall(_plain(text).lower()))


@cache
def _units() -> frozenset[str]:
    """Spellings of units of two letters or more that names may end in without a blank."""
    spellings = (text for unit in vocabulary()["units"].values() for text in unit)
    return frozenset(text for text in spellings if text.isalpha() and len(text) > 1)


@cache
def word_parts() -> re.Pattern[str]:
    """Parts of words in scripts without blanks, the longest first."""
    parts = sorted(vocabulary()["words"]["parts"], key=len, reverse=True)
    return re.compile("|".join(parts), re.IGNORECASE)


def meaning_of(words: tuple[str, ...]) -> Meaning:
    """Meaning of the words of a name, thruster words separately.

    Examples
    --------
    >>> meaning_of(words_of("GPS Latitude")).role
    'latitude'
    >>> meaning_of(words_of("Speed, apparent wind")) == meaning_of(words_of("apparent wind speed"))
    True
    >>> meaning_of(words_of("yaw")).doubt
    'yaw may be counted the other way or from east'
    >>> meaning_of(words_of("surge_dot")).reason
    'a rate of change'
    """
    terms = vocabulary()["words"]
    fillers = set(terms["filler"])
    # The whole name first, with or without filler words; a speed of GPS is over ground.
    for left_out in (set(), fillers - {"gps", "gnss"}, fillers):
        if meaning := _phrases().get(frozenset(words) - left_out):
            return meaning
    for word in words:
        if word in terms["other"]:
            return Meaning(None, reason=terms["other"][word])
    # Set points are no measurements, even where the rest of the name is a role.
    if any(word in terms["command"] for word in words):
        rest = tuple(w for w in words if w not in terms["command"])
        if rest and meaning_of(rest).role:
            return Meaning(None, reason="a set point, not a measurement")
        return Meaning(None)
    plain = tuple(w for w in words if w not in fillers and w not in terms["feedback"])
    if meaning := _phrases().get(frozenset(plain)):
        return meaning
    return _within(plain)


def _within(words):
    """The longest name that stands within the words, as a guess."""
    # Longest phrase first; short and ambiguous ones are left out.
    for length in range(len(words) - 1, 0, -1):
        for start in range(len(words) - length + 1):
            part = words[start : start + length]
            phrase = " ".join(part)
            meaning = _phrases().get(frozenset(part))
            if meaning and len(phrase) >= _SHORTEST and (meaning.role or meaning.reason):
                if meaning.role is None:
                    return Meaning(None, reason=meaning.reason)
                if meaning.role == "time" or phrase in ("bow", "course", "position", "speed"):
                    continue
                is_true_wind = meaning.role.startswith("wind") and "true" in words
                role = f"true_{meaning.role}" if is_true_wind else meaning.role
                return Meaning(role, doubt=f"it says more than '{phrase}'")
    return Meaning(None)


@cache
def _phrases() -> dict[frozenset[str], Meaning]:
    """Every name of names.toml, by the words that `words_of` gives, in any order."""
    meanings = {}
    for role, entry in vocabulary().items():
        if isinstance(entry, dict) and "names" in entry:
            meanings |= {frozenset(words_of(name)): Meaning(role) for name in entry["names"]}
    for role, entry in vocabulary().items():
        if isinstance(entry, dict) and "names" in entry:
            for name, doubt in entry.get("maybe", {}).items():
                meanings.setdefault(frozenset(words_of(name)), Meaning(role, doubt))
    for name, reason in vocabulary()["none"].items():
        meanings.setdefault(frozenset(words_of(name)), Meaning(None, reason=reason))
    return meanings
