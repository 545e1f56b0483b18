"""One column by itself: the roles that its name and its unit allow, and how sure that is."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.thrusters import OF_A_MAP, Drive, drive_of, thrusters_named
from shipcosim.diagnose.log.names.units import converts, unit_after, unit_for
from shipcosim.diagnose.log.names.vocabulary import meaning_of, vocabulary, words_of
from shipcosim.diagnose.log.roles import ROLES, role_of

Thrusters = Mapping[str, tuple[str, ...]]
"""Thrusters of a system by name, with what drives each: ``"rpm"``, ``"azimuth"``, ``"thrust"``."""
EXACT = 0
SURE = 1
GUESS = 2
UNUSED = Channel(column="-")
_THRUSTER_UNITS = {"rpm": "rpm", "azimuth": "deg", "thrust": "N"}
_OPPOSITE = {"sway": "port", "yaw_rate": "port", "surge": "astern"}  # words for the other sign
_OF_WIND = {"speed", "velocity", "direction", "angle", "from"}
_FACTOR = re.compile(r"[*/×xX]\s*10+\b")
_SUFFIXES = ("m/s", "deg/s", "deg", "s", "m", "rpm", "N", "%")  # units that names end in


@dataclass(frozen=True)
class Guess:
    """What a column may be.

    Attributes
    ----------
    column : str
        Its name.
    role : str
        Its role; empty where it is not used.
    channel : Channel
        How it gives the role; `UNUSED` of a column that is not used.
    rank : int
        `EXACT` where it has the role's name, `SURE` where its name has one meaning, else `GUESS`.
    why : str
        Of a guess what is not sure; of a column that is not used why.
    kind : str
        ``"command"``, ``"feedback"`` or empty.
    unit : str
        As the header or the name states it; empty where they do not.
    notes : tuple of str
        Remarks to make if it is used.
    """

    column: str
    role: str = ""
    channel: Channel = UNUSED
    rank: int = GUESS
    why: str = ""
    kind: str = ""
    unit: str = ""
    notes: tuple[str, ...] = field(default=())

    def read_as(self, settings: Mapping[str, Any], **more: Any) -> Guess:
        """Guess for this column with other settings of its channel and other changes."""
        return replace(self, channel=self.channel.model_copy(update=settings), **more)

    def refused(self, why: str) -> Guess:
        """Guess that this column is not used."""
        return replace(self, role="", why=why)

    @property
    def is_guess(self) -> bool:
        """Whether a channel file has to confirm it."""
        return self.rank == GUESS

    @property
    def in_unit(self) -> str:
        """``"in kn: "`` where its unit is known; else empty."""
        unit = self.channel.unit or self.unit
        return f"in {unit}: " if unit else ""


def guesses_of(
    column: str, log: LogColumns, thrusters: Thrusters | None, site: frozenset[str] = frozenset()
) -> list[Guess]:
    """Guesses for a column by itself; one guess without a role if nothing fits.

    Parameters
    ----------
    column : str
    log : LogColumns
        The file.
    thrusters : mapping, optional
        Of the system; without, any name of a thruster is one.
    site : frozenset of str
        Words that all names share and that say nothing of a channel.
    """
    values = log.values[column]
    stated = log.units[column]
    role = role_of(column)
    # The name is a role, or a thruster of this system with what drives it.
    if role and (column in ROLES or thrusters is None or column.rpartition("_")[0] in thrusters):
        if refused := _of_a_map(column, stated, thrusters):
            return [refused]
        return [Guess(column, column, Channel(column=column), EXACT, unit=stated)]
    if _is_empty(values):
        return [Guess(column, why="it has no value")]
    words = tuple(word for word in words_of(column) if word not in site)
    if not words or (words == ("column", words[-1]) and column.startswith("column ")):
        return [Guess(column, why="it has no name")]
    # Names of thrusters come before other meanings, unless they lead to no thruster.
    if drive := drive_of(words, stated, values):
        guesses = _of_thruster(column, drive, stated, thrusters)
        if guesses[0].role or meaning_of(words).role is None:
            return guesses
    # A name of a thruster may end in a unit, with the thruster's number behind it.
    number = words[-1:] if words[-1].isdigit() else ()
    kinds = [w for w in words if w in vocabulary()["words"]["feedback"]]
    ending = tuple(w for w in words[: len(words) - len(number)] if w not in kinds)
    for target in () if stated else _THRUSTER_UNITS.values():
        rest, suffix = unit_after((*kinds, *number, *ending), target)
        if suffix and (drive := drive_of(rest, suffix, values)):
            guesses = _of_thruster(column, drive, suffix, thrusters)
            if guesses[0].role:
                of_name = {"unit": suffix}
                return [replace(g, channel=g.channel.model_copy(update=of_name)) for g in guesses]
    # What a file of NetCDF says of a column goes before a name that has no sure meaning.
    title = words_of(log.titles.get(column, ""))
    if meaning_of(words).role is None or meaning_of(words).doubt:
        words = title if meaning_of(title).role else words
    # A number in a name counts sensors of a kind; with several of them each is a guess.
    guesses = _by_meaning(column, words, stated, values)
    bare = tuple(word for word in words if not word.isdigit())
    if guesses.is_guess and bare != words and not _FACTOR.search(column):
        again = _by_meaning(column, bare, stated, values)
        if again.role not in ("", "time") and not again.is_guess:
            return [again]
    return [guesses]


def _is_empty(values):
    if values.dtype.kind == "f":
        return not np.isfinite(values).any()
    return values.dtype.kind == "O" and all(value is None for value in values)


def _by_meaning(column, words, stated, values):
    """By the words of the name, with a unit at its end or without."""
    # A wind without a quantity is a speed or a direction by its unit.
    if "wind" in words and not _OF_WIND & set(words):
        of_turns = converts(stated, "deg") if stated else unit_after(words, "deg")[1]
        if stated or of_turns or unit_after(words, "m/s")[1]:
            words = ("direction" if of_turns else "speed", *words)
    meaning = meaning_of(words)
    unit = stated
    # A name without a meaning may end in a unit, also before .PV; read it without this.
    terms = vocabulary()["words"]
    plain = {*terms["feedback"], *terms["filler"]} - {"gps", "gnss"}
    words = tuple(word for word in words if word not in plain)
    if (meaning.role is None or meaning.doubt) and not stated:
        for target in _SUFFIXES:
            rest, suffix = unit_after(words, target)
            again = meaning_of(rest) if suffix else meaning
            if again.role and _measures(unit_for(suffix, ROLES[again.role].unit), again.role):
                meaning = again
                unit = unit_for(suffix, ROLES[again.role].unit)
                break
            if suffix and again.reason and not meaning.reason:
                meaning = again
    if meaning.role is None:
        return Guess(column, why=meaning.reason or "its name is not known")
    role = meaning.role
    # Exclude units of another quantity, and texts where numbers are needed.
    if unit and role not in ("time", "latitude", "longitude") and not _measures(unit, role):
        return Guess(
            column, why=f"its unit '{unit}' is none of {role}, which is in {ROLES[role].unit}"
        )
    if values.dtype.kind == "O" and role not in ("time", "latitude", "longitude"):
        shown = next(str(value) for value in values if value is not None)[:20]
        return Guess(column, why=f"it holds texts such as '{shown}'")
    given = unit if unit and not stated else None
    doubt = meaning.doubt
    sign = 1
    offset = 0.0
    # Positive to port means the opposite sign of the role, and where the wind goes to is half a turn off.
    if doubt and _OPPOSITE.get(role) in words:
        doubt = f"by its name positive to {_OPPOSITE[role]}"
        sign = -1
    if doubt and role.endswith("wind_from") and words[-1] in ("to", "towards"):
        doubt = "by its name where the wind goes to"
        offset = 180.0
    channel = Channel(
        column=column,
        unit=unit_for(given, ROLES[role].unit) if given else None,
        sign=sign,
        offset=offset,
    )
    return Guess(column, role, channel, GUESS if doubt else SURE, doubt, unit=unit)


def _measures(unit, role):
    return converts(unit, ROLES[role].unit) or unit_for(unit, ROLES[role].unit) in ("ft", "ft/s")


def _of_thruster(
    column: str, drive: Drive, stated: str, thrusters: Thrusters | None
) -> list[Guess]:
    """What a thruster's column may be."""
    # Thrusters that the name can mean; without a system the name itself is the thruster.
    if thrusters is None:
        name = "_".join(sorted(drive.place)) or "propeller"
        names = [name]
        doubt = ""
    else:
        # A number of an azimuth thruster counts these alone.
        turning = {name: by for name, by in thrusters.items() if "azimuth" in by}
        is_turning = turning and "azimuth" in words_of(column)
        names, doubt = thrusters_named(drive.place, turning if is_turning else thrusters)
    there = ", ".join(thrusters) if thrusters else ""
    if not names and not there:
        why = "the system has no thruster that it can be; a channel file can name an input of the system"
        return [Guess(column, why=why)]
    if not names:
        return [Guess(column, why=f"no thruster of the system is meant by it: there is {there}")]
    # Pulses and per cent become a speed only by a map.
    if drive.quantity in ("pwm", "percent"):
        return [Guess(column, why=_needs_a_map(column, drive.quantity, names[0], thrusters))]
    if not drive.quantity:
        return [Guess(column, why=f"it says no quantity of {names[0]}: rpm, azimuth or thrust")]
    guesses = []
    # Each possible thruster must be driven by this quantity, in a unit that converts.
    for name in names:
        role = f"{name}_{drive.quantity}"
        unit = _THRUSTER_UNITS[drive.quantity]
        wanted = (thrusters or {}).get(name, (drive.quantity,))
        if drive.quantity not in wanted:
            guesses.append(
                Guess(
                    column,
                    why=f"the system drives {name} by {' and '.join(wanted) or 'nothing logged'}",
                )
            )
            continue
        if stated and not converts(stated, unit):
            guesses.append(
                Guess(column, why=f"its unit '{stated}' is none of {role}, which is in {unit}")
            )
            continue
        why = doubt or drive.doubt
        if not why and "rpm" in wanted and "rudder" in words_of(column):
            why = "a rudder's angle turns the ship the other way than an azimuth thruster's"
        channel = Channel(column=column)
        notes = ("a command; there is no feedback",) if drive.kind == "command" else ()
        if "bow" in drive.place and "tunnel" in words_of(name):
            notes = (*notes, "the tunnel thruster is assumed to be the one at the bow")
        guesses.append(
            Guess(column, role, channel, GUESS if why else SURE, why, drive.kind, stated, notes)
        )
    used = [guess for guess in guesses if guess.role]
    return used or guesses[:1]


def _of_a_map(column, stated, thrusters):
    """A guess without a role for a thruster's channel in per cent or pulses, None for others."""
    kind = OF_A_MAP.get(stated.strip().lower())
    if kind is None or column in ROLES:
        return None
    return Guess(column, why=_needs_a_map(column, kind, column.rpartition("_")[0], thrusters))


def _needs_a_map(column, quantity, name, thrusters):
    """Why a command in pulses or per cent is not used, and what to write."""
    wanted = next(iter((thrusters or {}).get(name, ())), "rpm")
    unit = _THRUSTER_UNITS[wanted]
    pairs = (
        "[[1100, A], [1500, 0], [1900, B]]"
        if quantity == "pwm"
        else "[[-100, A], [0, 0], [100, B]]"
    )
    word = "pulses (PWM)" if quantity == "pwm" else "per cent"
    entry = f'{name}_{wanted} = {{column = "{column}", map = {pairs}}}'
    return f"{word} become {wanted} by a map only: write {entry}, A and B in {unit}"
