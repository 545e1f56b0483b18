"""A parameter as the files of a ship give it, and tables in CSV files."""

import csv
import math
from pathlib import Path
from typing import Any, NamedTuple

from shipcosim.errors import Problem


class Entry(NamedTuple):
    """A parameter as a file says it: value, unit, tolerance, origin, columns of a table, file and name, uncertainty,
    and whether it is said of another component that this one is like."""

    value: Any
    unit: str
    tolerance: float
    origin: str
    columns: tuple[str, ...]
    where: str
    uncertainty: tuple[float, ...] = ()
    inherited: bool = False


def table_entry(file: Path, where: str, problems: list[Problem]) -> Entry | None:
    """Read a table as text: comments with the source, a header with units, rows of numbers."""
    if not file.is_file():
        problems.append(Problem(where, f"there is no file {file}."))
        return None
    lines = file.read_text(encoding="utf-8").splitlines()
    # The source stands in a comment above the table.
    source = next(
        (
            line[1:].partition("source:")[2].strip()
            for line in lines
            if line.startswith("# source:")
        ),
        "",
    )
    # First row: names and units; all others: numbers.
    header, *rows = list(
        csv.reader(line for line in lines if line.strip() and not line.startswith("#"))
    ) or [[]]
    if not source:
        problems.append(
            Problem(
                str(file),
                "no line says where the table is from.",
                "Write '# source: ...' above it.",
            )
        )
    # Each row has a number for each column.
    for number, row in enumerate(rows, 1):
        if len(row) != len(header) or not all(_is_number_text(cell) for cell in row):
            problems.append(
                Problem(f"{file}, row {number}", f"{row}.", f"A row has {len(header)} numbers.")
            )
    text = "; ".join(" ".join(cell.strip() for cell in row) for row in rows)
    return Entry(text, "1", 0.0, source, tuple(cell.strip() for cell in header), str(file))


def _is_number_text(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False
