"""Bags of ROS and files of MCAP as tables, one for each topic."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.errors import error_at, reading

_TABLES = (
    "Or write its topics as tables: PlotJuggler, or `rostopic echo -b FILE -p TOPIC > log.csv`."
)
_DEEPEST = 6  # levels of a message


def is_bag(path: Path) -> bool:
    """Whether a path is a bag of ROS by its name: .bag, .mcap, .db3, or a folder with metadata.yaml."""
    return path.suffix.lower() in (".mcap", ".db3", ".bag") or (path / "metadata.yaml").is_file()


def tables_of_bag(path: Path) -> dict[str, LogColumns]:
    """Numbers of each topic's messages by the time at which they were recorded, in seconds since 1970.

    Raises
    ------
    ShipcosimError
        If rosbags is missing, or the bag cannot be read or holds no numbers.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        remedy = "Install it by `pip install 'shipcosim[ros]'`."
        raise error_at(str(path), "bags of ROS need rosbags.", f"{remedy} {_TABLES}") from error
    rows: dict[str, list[dict[str, float]]] = {}
    with reading(path, f"Is this bag of ROS 1 or ROS 2 whole? {_TABLES}"):
        store = get_typestore(Stores.ROS2_HUMBLE)
        with AnyReader([path], default_typestore=store) as reader:
            for connection, stamp, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                row = {"time": 1e-9 * stamp} | dict(_numbers(message, "", 0))
                rows.setdefault(connection.topic.strip("/").replace("/", "."), []).append(row)
    tables = {
        topic: table_of(path, messages) for topic, messages in rows.items() if len(messages[0]) > 1
    }
    if not tables:
        raise error_at(str(path), "is a bag without numbers.", "Record the topics of the ship.")
    return tables


def _numbers(message: Any, before: str, depth: int) -> Iterator[tuple[str, float]]:
    """Names and values of all numbers of a message; those of headers and lists are left out."""
    for name, value in vars(message).items():
        if name in ("header", "__msgtype__"):
            continue
        label = f"{before}.{name}" if before else name
        if isinstance(value, (bool, int, float, np.number)):
            yield label, float(value)
        elif hasattr(value, "__msgtype__") and depth < _DEEPEST:
            yield from _numbers(value, label, depth + 1)


def table_of(path: Path, rows: list[dict[str, float]]) -> LogColumns:
    """Messages with a time [s] as a table with a column for each name, NaN where a message has none."""
    names = dict.fromkeys(name for row in rows for name in row)
    values = {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
    return LogColumns(str(path), values, {name: "s" if name == "time" else "" for name in names})
