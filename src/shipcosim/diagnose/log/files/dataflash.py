"""Text logs of ArduPilot: a message a line, its names in a message FMT.

Reference: ArduPilot, ardupilot.org/rover/docs/logmessages.html.
"""

from __future__ import annotations

from pathlib import Path

from shipcosim.diagnose.log.files.bags import table_of
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.files.text import head_of, text_of
from shipcosim.errors import error_at

_READ = {
    "GPS": "latitude Lat longitude Lng speed_over_ground Spd course_over_ground GCrs",
    "ATT": "heading Yaw",
}
"""Roles by message, each before the column that is in its unit."""


def is_dataflash(path: Path) -> bool:
    """Whether a file is a text log of ArduPilot by its first bytes."""
    return head_of(path, 4) == b"FMT,"


def tables_of_dataflash(path: Path) -> dict[str, LogColumns]:
    """A table for each kind of message that is read, by the time since the start of the autopilot.

    Raises
    ------
    ShipcosimError
        If none is read.
    """
    names: dict[str, list[str]] = {}
    rows: dict[str, list[dict[str, float]]] = {}
    for line in text_of(path)[0].splitlines():
        kind, *cells = (cell.strip() for cell in line.split(","))
        if kind == "FMT" and len(cells) > 4:
            names[cells[2]] = cells[4:]
        row = dict(zip(names.get(kind, ()), cells, strict=False))
        # Of several receivers the first is read.
        if kind in _READ and row.get("I", "0") == "0" and len(row) == len(cells):
            roles = _READ[kind].split()
            values = {r: float(row[c]) for r, c in zip(roles[::2], roles[1::2], strict=True)}
            rows.setdefault(kind, []).append({"time": 1e-6 * float(row["TimeUS"])} | values)
    if not rows:
        message = "holds no message of ArduPilot that is read."
        raise error_at(str(path), message, f"Read are {', '.join(_READ)}.")
    return {kind: table_of(path, messages) for kind, messages in rows.items()}
