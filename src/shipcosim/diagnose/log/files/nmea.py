"""Raw sentences of NMEA 0183 as columns: each kind of sentence gives its channels, brought to common times.

Reference: NMEA 0183 as described by E. S. Raymond, "NMEA Revealed", 2.23, 2019.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import date
from functools import partial, reduce
from operator import xor
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.log.files.interpolation import at_times
from shipcosim.diagnose.log.files.times import (
    DAY,
    EPOCHS,
    epoch_unit,
    seconds_of,
    seconds_of_clock,
)
from shipcosim.errors import counted, error_at

_SENTENCE = re.compile(
    r"(?P<before>[^$!]*)[$!](?P<body>[A-Z][A-Z0-9]{3,7},[^*\r\n\"]*)(?:\*(?P<sum>[0-9A-Fa-f]{2}))?(?P<after>.*)"
)
_STAMP = re.compile(
    r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(\.\d+)?(Z|[+-]\d\d:?\d\d)?|(?<![\d.])\d{9,}(\.\d+)?(?![\d.:])"
)
"""A time with its date, or one since 1970, among other words around a sentence, such as a TAG block's."""
_SAMPLE = 200  # lines by which a file is judged; share of them that may be no sentences. Assumed.
_MOST_OTHERS = 0.3
_MOST_DAMAGED = (
    0.2  # share of sentences with a wrong checksum above which the file is not trusted. Assumed.
)
_ENOUGH = 0.9  # of the values of the fullest source that a preferred one needs. Assumed.
_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_SENTENCES = _TABLE["sentences"]
_SIDES = {"latitude": "NS", "longitude": "EW"}
_SPEEDS = {"N": 1852.0 / 3600.0, "K": 1.0 / 3.6, "M": 1.0, "S": 1609.344 / 3600.0}  # of MWV, in m/s

Values = dict[str, float]


def _values_of(kind: str, fields: list[str]) -> Values:
    """Values of a sentence by its layout; a receiver that knows no time yet knows nothing."""
    layout = _SENTENCES[kind]
    values = {}
    if "clock" in layout:
        clock = fields[layout["clock"]]
        if not clock:
            return {}
        values["clock"] = 3600.0 * int(clock[:2]) + 60.0 * int(clock[2:4]) + float(clock[4:])
    # Day, month and year, in one field or in three.
    day = [fields[place] for place in layout.get("date", ())]
    if day and all(day):
        text = "".join(day)
        year = int(text[4:]) + (2000 if len(text) == 6 else 0)
        values["date"] = float(date(year, int(text[2:4]), int(text[:2])).toordinal())
    # What says that a value is none: a field with another letter, or, where it may be missing, with this one.
    is_valid = all(fields[int(k)] in text.split() for k, text in layout.get("only", {}).items())
    invalid = layout.get("never", {}).items()
    if is_valid and not any(fields[int(k) : int(k) + 1] == [text] for k, text in invalid):
        values |= {name: _value(name, fields[k:]) for name, k in layout["values"].items()}
    return values


def _value(name: str, fields: list[str]) -> float:
    """A value from its field, with its hemisphere or unit in the next one."""
    number = float(fields[0] or "nan")
    if name == "wind_speed":
        return number * _SPEEDS[fields[1]]
    if name not in _SIDES:
        return number
    # NMEA writes degrees times 100 plus minutes, and the hemisphere apart.
    if fields[0] and fields[1] not in _SIDES[name]:
        raise ValueError(fields[1])
    whole, minutes = divmod(number, 100.0)
    return (whole + minutes / 60.0) * (-1.0 if fields[1] and fields[1] == _SIDES[name][1] else 1.0)


def _rpm(f: list[str]) -> Values:
    """Speed of a shaft or an engine. Odd numbers are to starboard, even ones to port, 0 is on the centre line."""
    if f[5] != "A":
        return {}
    sides = {"0": "centre", "1": "starboard", "2": "port"}
    what = f"{sides.get(f[2], '')} shaft" if f[1] == "S" else "engine"
    number = "" if f[1] == "S" and f[2] in sides else f" {int(f[2])}"
    return {f"{what}{number} rpm".strip(): float(f[3] or "nan")}


def _rsa(f: list[str]) -> Values:
    """Angles of the rudders, positive to starboard; the first is the starboard one, or the only one."""
    first = "starboard rudder angle" if f[3] else "rudder angle"
    angles = {first: float(f[1] or "nan")} if f[2] == "A" else {}
    return angles | ({"port rudder angle": float(f[3] or "nan")} if f[3] and f[4] == "A" else {})


_NAMED_BY_FIELDS: Mapping[str, Callable[[list[str]], Values]] = {"RPM": _rpm, "RSA": _rsa}
_KINDS = (*_SENTENCES, *_NAMED_BY_FIELDS)
"""What is read, preferred sources first."""
_UNITS = {
    **_TABLE["units"],
    **{f"{what} {n} rpm": "rpm" for what in ("shaft", "engine") for n in range(9)},
}


class _Sentence(NamedTuple):
    """A sentence that was read: its line, its kind such as GPGGA, its values, and the time that stands around it."""

    line: int
    kind: str
    values: Values
    stamp: str


@dataclass
class _Read:
    """Sentences that were read, the lines of damaged and of other ones, and how many of each kind are not read."""

    sentences: list[_Sentence] = field(default_factory=list)
    damaged: list[int] = field(default_factory=list)
    others: list[int] = field(default_factory=list)
    unread: Counter[str] = field(default_factory=Counter)


def holds_sentences(lines: list[str]) -> bool:
    """Whether the lines of a file are raw sentences.

    Examples
    --------
    >>> holds_sentences(["$GPHDT,123.4,T*32"]), holds_sentences(["time,heading", "0,123.4"])
    (True, False)
    """
    some = [line for line in lines[: 10 * _SAMPLE] if line.strip()][:_SAMPLE]
    return bool(some) and sum(map(bool, map(_SENTENCE.fullmatch, some))) > (
        1.0 - _MOST_OTHERS
    ) * len(some)


def columns_of_sentences(
    source: str, lines: list[str]
) -> tuple[dict[str, np.ndarray], dict[str, str], list[str]]:
    """Values and units by role, and remarks.

    Parameters
    ----------
    source : str
        The file, for messages.
    lines : list of str
        Sentences; before each may stand when it was received.

    Raises
    ------
    ShipcosimError
        If no sentence says the time, none gives a channel, or many are damaged.
    """
    # Read all sentences; many damaged ones mean a bad recording.
    read = _read(lines)
    count = len(read.sentences) + len(read.damaged)
    if len(read.damaged) > _MOST_DAMAGED * count:
        message = f"{len(read.damaged)} of {count} sentences of NMEA do not fit their checksum or their form."
        raise error_at(
            f"{source}, line {read.damaged[0] + 1}", message, "Record them again, or as a table."
        )
    remarks = _left_out(read)
    # Time of each sentence, and the channels that the sentences give.
    times, more = _times(source, read)
    channels, used = _channels(read, times)
    if not channels:
        message = (
            f"holds sentences of NMEA, and none gives a channel: {', '.join(read.unread) or 'ZDA'}."
        )
        raise error_at(source, message, f"Read are {', '.join(_KINDS)}.")
    # Bring all channels to the times of the heading or the position.
    base = next(name for name in ("heading", "latitude", *channels) if name in channels)
    clock = channels[base][0]
    values = {"time": clock} | {
        name: at_times(clock, *channels[name], _UNITS[name]) for name in channels
    }
    sources = "; ".join(f"{', '.join(names)} from {sentence}" for sentence, names in used.items())
    remarks += [*more, f"Sentences of NMEA, at the {len(clock)} times of {base}: {sources}."]
    return values, {name: _UNITS[name] for name in values}, remarks


def _read(lines: list[str]) -> _Read:
    read = _Read()
    # Keep sentences with a right checksum of a kind that is read; count the others for the message.
    for number, line in enumerate(lines):
        if not line.strip():
            continue
        match = _SENTENCE.fullmatch(line.strip())
        if match is None:
            read.others.append(number)
            continue
        fields = [part.strip() for part in match["body"].split(",")]
        kind = fields[0][-3:]
        if match["sum"] is not None and _checksum(match["body"]) != int(match["sum"], 16):
            read.damaged.append(number)
        elif kind not in _KINDS or fields[0].startswith("P") or len(fields[0]) != 5:
            read.unread[fields[0]] += 1
        else:
            try:
                of_kind = _NAMED_BY_FIELDS.get(kind, partial(_values_of, kind))
                stamp = _STAMP.search(f"{match['before']} {match['after']}")
                text = stamp[0] if stamp else match["before"].strip(" ,;|\t\"'")
                read.sentences.append(_Sentence(number, fields[0], of_kind(fields), text))
            except (ValueError, IndexError, KeyError):
                if any(fields[1:]):
                    read.damaged.append(number)
    return read


def _checksum(body: str) -> int:
    # The checksum is the exclusive or of all characters between $ and *.
    return reduce(xor, body.encode("latin-1", "replace"))


def _left_out(read: _Read) -> list[str]:
    """What was left out."""
    remarks = []
    lefts = (
        ("sentence", "with a wrong checksum or form", read.damaged),
        ("line", "without a sentence", read.others),
    )
    for what, why, lines in lefts:
        if lines:
            remarks.append(
                f"{counted(len(lines), what)} {why}, the first in line {lines[0] + 1}: left out."
            )
    if read.unread:
        remarks.append(
            f"Sentences not read: {', '.join(f'{kind} ({n})' for kind, n in sorted(read.unread.items()))}."
        )
    winds = sum(s.kind.endswith("MWV") and not s.values for s in read.sentences)
    if winds:
        remarks.append(f"{winds} MWV without a valid wind relative to the ship left out.")
    return remarks


def _times(source: str, read: _Read) -> tuple[np.ndarray, list[str]]:
    """Time of each sentence that was read, NaN where it is not known, and remarks. [s]"""
    # Stamps before the sentences are the time of reception, if nearly all sentences have one.
    sentences = read.sentences
    stamps = [sentence.stamp or None for sentence in sentences]
    if stamps.count(None) < (1.0 - _ENOUGH) * len(stamps):
        try:
            times = np.array([float(stamp or "nan") for stamp in stamps])
            times, remarks = times / EPOCHS[epoch_unit(times) or "s"], []
        except ValueError:
            times, remarks = seconds_of(np.array(stamps, object)) or (None, [])
        if times is not None:
            return times, ["Times are those that stand before the sentences.", *remarks]
    # Else the clock times within sentences, interpolated by line number for those without.
    timed = [sentence for sentence in sentences if "clock" in sentence.values]
    if len(timed) < 2:
        message = "holds sentences of NMEA, and none of GGA, RMC, GLL and ZDA says the time."
        remedy = "Log one of them too, or the time of reception before each sentence."
        raise error_at(source, message, remedy)
    lines = [sentence.line for sentence in timed]
    seconds, remarks = _with_dates([sentence.values for sentence in timed])
    times = np.interp([s.line for s in sentences], lines, seconds, left=np.nan, right=np.nan)
    for k, sentence in enumerate(sentences):
        before = np.searchsorted(lines, sentence.line)
        if sentence.kind.endswith("VTG") and before:
            times[k] = seconds[before - 1]  # of the fix that the same receiver has just given
    without = sorted({s.kind for s in sentences if "clock" not in s.values})
    if without:
        remarks.append(
            f"{', '.join(without)} have no time: it lies between those of the sentences around."
        )
    return times, remarks


def _with_dates(timed: list[Values]) -> tuple[np.ndarray, list[str]]:
    """Continuous times from times of day: past midnight, and over whole days if sentences have a date. [s]"""
    # Clock times go on past midnight; dates then show whole days that were not logged.
    clocks = np.array([values["clock"] for values in timed])
    seconds, remarks = seconds_of_clock(clocks)
    days = np.array([values.get("date", np.nan) for values in timed])
    dated = np.flatnonzero(np.isfinite(days))
    if not len(dated):
        return seconds, remarks
    # Whole days that are missing at each dated sentence,
    # and at the others by the nearest date in time.
    lacking = np.round((DAY * (days - days[dated[0]]) + clocks - seconds) / DAY)[dated] * DAY
    every = np.arange(len(days))
    before = np.maximum(np.searchsorted(dated, every, "right") - 1, 0)
    after = np.minimum(np.searchsorted(dated, every), len(dated) - 1)
    apart = [np.abs(seconds - seconds[dated[side]]) for side in (before, after)]
    nearest = np.where(apart[1] < apart[0], after, before)
    lacking = lacking - lacking[0]
    if lacking.any():
        remarks.append(
            f"By their dates the sentences go on after {int(lacking.max() / DAY)} whole days more."
        )
    return seconds + lacking[nearest], remarks


def _channels(
    read: _Read, times: np.ndarray
) -> tuple[dict[str, tuple[np.ndarray, np.ndarray]], dict[str, list[str]]]:
    """Times and values of each channel by one source, and which channels a source gives."""
    # Sort the values by channel and kind of sentence.
    by_channel: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for sentence, time in zip(read.sentences, times, strict=True):
        for name, value in sentence.values.items():
            if np.isfinite(value) and np.isfinite(time):
                of_kinds = by_channel.setdefault(name, {})
                of_kinds.setdefault(sentence.kind, []).append((float(time), value))
    channels = {}
    used = {}
    for name in filter(by_channel.__contains__, _UNITS):
        # Of the sources with nearly the most values take the preferred one.
        sources = by_channel[name]
        enough = _ENOUGH * max(map(len, sources.values()))
        kind = min(
            (kind for kind, pairs in sources.items() if len(pairs) >= enough),
            key=lambda kind: (_KINDS.index(kind[-3:]), -len(sources[kind])),
        )
        moments, values = np.array(sources[kind]).T
        moments, first = np.unique(moments, return_index=True)
        channels[name] = moments, values[first]
        others = sorted(sources.keys() - {kind})
        used.setdefault(kind + (f" (not {', '.join(others)})" if others else ""), []).append(name)
    return channels, used
