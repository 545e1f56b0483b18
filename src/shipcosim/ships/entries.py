"""A parameter as the files of a ship give it, and tables in CSV files."""

import csv
import math
from pathlib import Path
from typing import Any, NamedTuple

from shipcosim.errors import Problem, reading


class Quantity(NamedTuple):
    """A parameter of a ship, as a file says it, a formula estimates it, or the model's default has it.

    Attributes
    ----------
    value : float, int, bool or str
        Value; a table is a str, rows by ";", columns by blanks.
    unit, origin : str
        FMI's spelling of the unit, where the number comes from.
    tolerance : float
        Standard deviation within which it counts as known, in its unit; 0 where nobody says.
    columns : tuple of str
        Name and unit of each, of a table.
    where : str
        File and name, for messages.
    uncertainty : tuple of two floats, or empty
        Least and largest value that one source or another has, in its unit. The diagnosis takes no notice of it.
    inherited : bool
        It is said of another component that this one is like.
    description : str
        What it is, one line, as the model declares it.
    """

    value: Any
    unit: str
    tolerance: float
    origin: str
    columns: tuple[str, ...] = ()
    where: str = ""
    uncertainty: tuple[float, ...] = ()
    inherited: bool = False
    description: str = ""


def table_entry(file: Path, where: str, problems: list[Problem]) -> Quantity | None:
    """Read a table as text: comments with the source, a header with units, rows of numbers."""
    if not file.is_file():
        problems.append(Problem(where, f"there is no file {file}."))
        return None
    with reading(file):
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
    if not rows:
        problems.append(Problem(str(file), "it has no rows.", "Write a header, then numbers."))
        return None
    # Each row has a number for each column.
    for number, row in enumerate(rows, 1):
        if len(row) != len(header) or not all(_is_number_text(cell) for cell in row):
            problems.append(
                Problem(f"{file}, row {number}", f"{row}.", f"A row has {len(header)} numbers.")
            )
    text = "; ".join(" ".join(cell.strip() for cell in row) for row in rows)
    return Quantity(text, "1", 0.0, source, tuple(cell.strip() for cell in header), str(file))


def _is_number_text(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False
