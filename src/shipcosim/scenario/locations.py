"""Line of a key in a TOML file, for messages."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from shipcosim.errors import Problem
from shipcosim.scenario.model import Scenario

AnyKeys = Sequence[str | int]


Keys = tuple[str | int, ...]
"""Keys and positions in lists, from the outside in."""


_HEADER = re.compile(r"""\s*(\[\[?)\s*((?:[\w.\s-]|"[^"]*"|'[^']*')+?)\s*\]\]?\s*(?:#.*)?$""")
_KEY = re.compile(r"""\s*((?:[\w.-]|"[^"]*"|'[^']*')+)\s*=""")
_NAME = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")


def problem_at(
    scenario: Scenario,
    keys: AnyKeys,
    message: str,
    remedy: str = "",
    severity: str = "error",
) -> Problem:
    """Problem at a key of a scenario, with its line if it was read from a file.

    Parameters
    ----------
    scenario : Scenario
        With the key.
    keys : sequence of str and int
        Keys and positions in lists from the outside in, as ``("events", 0, "time")``.
    message, remedy, severity : str
        As of the problem.
    """
    path = scenario.path
    text = _text_of(path, path.stat().st_mtime_ns) if path and path.is_file() else ""
    return Problem(location_of(path or "scenario", text, keys), message, remedy, severity)


def location_of(path: str | Path, text: str, keys: AnyKeys) -> str:
    """File and line of a key for messages; the file alone if the key is not in its text."""
    line = line_of(text, keys)
    return f"{path}, line {line}" if line else str(path)


def line_of(text: str, keys: AnyKeys) -> int:
    """Line of a key, or of the innermost table around it, in a TOML text; 0 if there is none.

    Examples
    --------
    >>> line_of("step_size = 0.1\\n[[events]]\\ntime = 2.0", ("events", 0, "time"))
    3
    """
    lines = _lines_of_keys(text)
    # The deepest table or key on the way to the wanted one.
    keys = tuple(keys)
    return next((lines[keys[:n]] for n in range(len(keys), 0, -1) if keys[:n] in lines), 0)


@lru_cache(maxsize=4)
def _lines_of_keys(text: str) -> dict[Keys, int]:
    """First line of each table and key of a TOML text, found once for all problems of a file."""
    section: Keys = ()
    counts: dict[tuple, int] = {}
    lines: dict[Keys, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        # A header opens a table; a key belongs to the table that is open.
        if header := _HEADER.match(line):
            section = _section(_names(header[2]), header[1] == "[[", counts)
            lines.setdefault(section, number)
        elif key := _KEY.match(line):
            lines.setdefault((*section, *_names(key[1])), number)
    return lines


@lru_cache(maxsize=4)
def _text_of(path: Path, changed: int) -> str:
    """Text of a file that was changed last at a time in ns."""
    return path.read_text(encoding="utf-8-sig")


def _names(dotted: str) -> list[str]:
    return [name.strip("\"'") for name in _NAME.findall(dotted)]


def _section(names: Sequence[str], repeated: bool, counts: dict[tuple, int]) -> Keys:
    """Keys of a table by its header; `counts` numbers the tables in lists."""
    path: Keys = ()
    for number, name in enumerate(names, 1):
        path = (*path, name)
        # A header in double brackets begins the next table of its list.
        if repeated and number == len(names):
            counts[path] = counts.get(path, -1) + 1
        # Inner tables belong to the list entry that is open.
        if path in counts:
            path = (*path, counts[path])
    return path
