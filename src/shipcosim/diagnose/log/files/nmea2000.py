"""Messages of NMEA 2000 as CANboat writes them, one a line, as tables: raw (CSV of bytes), or read
(JSON, or the text of its analyzer).

Reference: CANboat, github.com/canboat/canboat: its list of messages (PGN) and the forms of its logs.
"""

from __future__ import annotations

import json
import re
import struct
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from shipcosim.diagnose.log.files.bags import table_of
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.files.text import head_of, text_of
from shipcosim.errors import error_at

_STAMP = r"(?P<day>\d{4}-\d\d-\d\d)[-TZ ](?P<clock>\d\d:\d\d:\d\d(?:[.,]\d+)?)Z?"
_RAW = re.compile(
    _STAMP
    + r",\d+,(?P<pgn>\d+),(?P<source>\d+),\d+,\d+,(?P<fields>[0-9a-fA-F]{2}(?:,[0-9a-fA-F]{2})*)\s*"
)
_TOLD = re.compile(
    _STAMP + r"\s+\d+\s+(?P<source>\d+)\s+\d+\s+(?P<pgn>\d+)\s+[^:]+:\s*(?P<fields>.*)"
)
_REFERENCES = {0: "True", 1: "Magnetic"}
_WINDS = {0: "True (ground referenced to North)", 1: "Magnetic", 2: "Apparent"}
_RAW_FIELDS = {
    127250: ("<xHhhB", {"Heading": (0, 1e-4), "Reference": (3, _REFERENCES)}),
    127251: ("<xi", {"Rate": (0, 1e-6 / 32.0)}),
    129025: ("<ii", {"Latitude": (0, 1e-7), "Longitude": (1, 1e-7)}),
    129026: ("<xBHH", {"COG Reference": (0, _REFERENCES), "COG": (1, 1e-4), "SOG": (2, 1e-2)}),
    130306: ("<xHHB", {"Wind Speed": (0, 1e-2), "Wind Angle": (1, 1e-4), "Reference": (2, _WINDS)}),
}
"""Layout of the bytes, and of each field its place and its resolution in SI units (positions in degrees)."""
_NOTHING = {"H": 0xFFFF, "i": 0x7FFFFFFF}


def is_messages(path: Path) -> bool:
    """Whether a file holds messages of NMEA 2000 by its first lines."""
    head = head_of(path, 4096).decode("latin-1").splitlines()
    lines = [line for line in head[:20] if line.strip() and not line.startswith("#")]
    return any(
        _RAW.fullmatch(line) or _TOLD.fullmatch(line) or line[:1] == "{" and '"pgn":' in line
        for line in lines[:2]
    )


def tables_of_messages(path: Path) -> dict[str, LogColumns]:
    """A table for each kind of message that is read, by the time of its lines in seconds since 1970.

    Raises
    ------
    ShipcosimError
        If no message is read.
    """
    by_pgn: dict[int, list[tuple[float, int, dict]]] = {}
    unread: Counter[int] = Counter()
    damaged = 0
    in_si = None
    for line in text_of(path)[0].splitlines():
        try:
            if line.startswith("{") and '"pgn"' not in line:
                # The first line of JSON says the units: std has degrees, si radians.
                in_si = {"si": True, "std": False}.get(json.loads(line).get("units"))
                continue
            pgn, time, source, fields, is_si = _message(line, in_si)
            if fields is None:
                unread[pgn] += 1
            else:
                row = time, source, _columns(fields, is_si)
                by_pgn.setdefault(pgn, []).append(row)
        except Exception:  # a field of any type and size can stand in a damaged message
            damaged += bool(line.strip()) and not line.startswith("#")
    if not by_pgn:
        remedy = f"Read are {', '.join(map(str, _RAW_FIELDS))}."
        raise error_at(str(path), "holds messages of NMEA 2000, and none gives a channel.", remedy)
    remarks = [f"{damaged} lines that are no message left out."] if damaged else []
    remarks += [
        f"Messages not read: {', '.join(f'{k} ({n})' for k, n in sorted(unread.items()))}."
    ] * bool(unread)
    return {
        f"PGN {pgn}": _table(path, rows, remarks if k == 0 else [])
        for k, (pgn, rows) in enumerate(by_pgn.items())
    }


def _message(line, in_si):
    """PGN, time, source and fields of a line, None for fields that are not read; and whether these are in SI units."""
    is_raw = False
    if line.startswith("{"):
        message = json.loads(line)
        when = re.fullmatch(_STAMP, message["timestamp"])
        source = message.get("src", 0)
        content = message.get("fields")
    else:
        message = when = _RAW.fullmatch(line) or _TOLD.fullmatch(line)
        if message is None:
            raise ValueError(line)
        is_raw = message.re is _RAW
        source = message["source"]
        content = message["fields"]
        in_si = is_raw or " rad" in line
    if when is None:
        raise ValueError(line)
    moment = np.datetime64(f"{when['day']}T{when['clock'].replace(',', '.')}", "ns")
    pgn = int(message["pgn"])
    if pgn not in _RAW_FIELDS:
        content = None
    elif isinstance(content, str):
        content = _of_bytes(pgn, content) if is_raw else _of_text(content)
    return pgn, float(moment.astype("int64")) * 1e-9, int(source), content, in_si


def _of_bytes(pgn, text):
    """Fields of a message of bytes such as ``ff,6c,42``."""
    form, places = _RAW_FIELDS[pgn]
    content = bytes.fromhex(text.replace(",", ""))
    values = struct.unpack(form, content[: struct.calcsize(form)])
    codes = form.replace("x", "")[1:]
    fields = {}
    for name, (place, size) in places.items():
        if isinstance(size, dict):
            # References are the lowest two bits, of winds the lowest three.
            fields[name] = size.get(values[place] & (7 if size is _WINDS else 3), "unknown")
        elif values[place] != _NOTHING[codes[place]]:
            fields[name] = size * values[place]
    return fields


def _of_text(text):
    """Fields of a line of text: ``Heading = 45.0 deg; Reference = True``."""
    fields = {}
    for name, value in (part.split("=") for part in text.split(";") if part.count("=") == 1):
        number = re.fullmatch(r"\s*([+-]?\d+(?:\.\d+)?)(?:\s+(?:deg|rad)?(?:m?/s)?)?\s*", value)
        fields[name.strip()] = float(number[1]) if number else value.strip()
    return fields


def _columns(fields, in_si):
    """Values by name and unit; the name says what an angle or a wind is counted from."""
    reference = fields.get("COG Reference", fields.get("Reference", "unknown"))
    reference = reference.get("name", "unknown") if isinstance(reference, dict) else reference
    angle = {True: "rad", False: "deg", None: ""}[in_si]
    # Winds over ground count from north; any other reference stays in the name.
    wind = {_WINDS[0]: "true", "Apparent": "apparent"}.get(
        reference, f"other {str(reference).lower()}"
    )
    kind = "direction" if wind == "true" else "angle"
    labels = {
        "Heading": (f"Heading {reference}", angle),
        "COG": (f"COG {reference}", angle),
        "SOG": ("SOG", "m/s"),
        "Rate": ("rate of turn", angle and f"{angle}/s"),
        "Latitude": ("Latitude", "deg"),
        "Longitude": ("Longitude", "deg"),
        "Wind Speed": (f"{wind} wind speed", "m/s"),
        "Wind Angle": (f"{wind} wind {kind}", angle),
    }
    return {
        labels[name]: float(value)
        for name, value in fields.items()
        if name in labels and isinstance(value, (int, float))
    }


def _table(path, rows, remarks):
    """One kind of message from the device that sends the most of them."""
    counts = Counter(source for _, source, _ in rows)
    used = counts.most_common(1)[0][0]
    others = [str(source) for source in counts if source != used]
    if others:
        remarks = [*remarks, f"from device {used} (not {', '.join(others)})."]
    rows = [(time, values) for time, source, values in rows if source == used]
    names = dict(key for _, values in rows for key in values)
    messages = [{"time": time} | {n: v for (n, _), v in values.items()} for time, values in rows]
    return replace(table_of(path, messages), units={"time": "s"} | names, remarks=tuple(remarks))
