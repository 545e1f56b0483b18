"""Records of JSON, of XML such as GPX, or of lines with ``key=value``, as text with tabs between cells."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

from shipcosim.diagnose.log.files.text import head_of, text_of

_GPSD = {"track": "course over ground [deg]", "speed": "speed over ground [m/s]"}
"""Reference: gpsd_json(5), gpsd 3.25: classes TPV and ATT."""


_UNITS = {
    "rateofturn": "rad/s",
    "heading": "rad",
    "course": "rad",
    "angle": "rad",
    "direction": "rad",
    "speed": "m/s",
    "revolutions": "Hz",
}
"""Units of Signal K by a part of the last word of a path."""
_GROUPS = "navigation.", "environment.", "propulsion.", "steering."  # with which its paths begin


_PAIR = re.compile(r'([^\s=]+)=("[^"]*"|\S*)')
# Two lines of pairs: one alone may stand above a table, as its title.
_MARKS = re.compile(
    rb'(?:\xef\xbb\xbf)?\s*(?:(?:\[\s*)?\{\s*"|<\?xml|<gpx|(?:[\w.]+=\S+[ \t]+){2}[^\n]*\n\s*[\w.]+=)'
)


def holds_records(path: Path) -> bool:
    """Whether a file holds records by its first characters."""
    return _MARKS.match(head_of(path, 4096)) is not None


def text_of_records(path: Path) -> tuple[str, list[str]]:
    """Records as lines of text with tabs between, and remarks; names of nested values have dots.

    Raises
    ------
    ValueError
        If it is neither JSON nor XML, or holds no records.
    """
    import pandas

    text, remarks = text_of(path)
    lines = [line for line in text.splitlines() if line.strip()]
    try:
        content = json.loads(text)
    except ValueError:
        # Not one document of JSON: elements of XML, or one record a line.
        if lines[0].lstrip().startswith("<"):
            content = list(_elements(text))
        elif lines[0].lstrip().startswith("{"):
            content = list(map(json.loads, lines))
        else:
            content = [{k: v.strip('"') for k, v in _PAIR.findall(line)} for line in lines]
    # Deltas of Signal K: each has values by their paths.
    if isinstance(content, list) and any("updates" in record for record in content):
        content = [row for record in content for row in _rows_of_delta(record)]
    # Reports of gpsd: their names have units and one meaning, and other classes of them have none of ours.
    if isinstance(content, list) and any(record.get("class") == "TPV" for record in content):
        content = [
            {_GPSD.get(name, name): value for name, value in record.items()}
            for record in content
            if record.get("class") in ("TPV", "ATT")
        ]
    # One record of lists is a table by its columns.
    is_by_column = isinstance(content, dict) and any(
        isinstance(values, (list, dict)) for values in content.values()
    )
    frame = pandas.DataFrame(content) if is_by_column else pandas.json_normalize(content)
    return frame.to_csv(sep="\t", index=False), remarks


def _elements(text):
    """Attributes and texts of the elements with several of them that occur most often, such as points of a track."""
    every = [e for e in ElementTree.fromstring(text).iter() if len(e) + len(e.attrib) > 1]
    most = Counter(element.tag for element in every).most_common(1)
    for element in every:
        if element.tag == most[0][0]:
            texts = {
                part.tag.rpartition("}")[2]: (part.text or "").strip() for part in element.iter()
            }
            yield element.attrib | {name: content for name, content in texts.items() if content}


def _rows_of_delta(record):
    """Rows of time, path and value of a delta; values with parts, such as a position, have a path for each.

    Reference: Signal K specification 1.7, delta format.
    """
    for update in record.get("updates", ()):
        for entry in update.get("values", ()):
            value = entry["value"]
            parts = value if isinstance(value, dict) else {"": value}
            for name, number in parts.items():
                path = f"{entry['path']}.{name}".strip(".")
                unit = unit_of_path(path)
                yield {"time": update.get("timestamp"), "path": path, "value": number, "unit": unit}


def unit_of_path(name: str) -> str:
    """Unit of a value of Signal K by its path, such as ``navigation.headingTrue``; empty for other names."""
    last = name.rpartition(".")[2].lower()
    known = (unit for part, unit in _UNITS.items() if part in last)
    return next(known, "") if name.startswith(_GROUPS) else ""
