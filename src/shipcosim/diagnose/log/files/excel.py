"""Workbooks of Excel as text: the sheet with the most cells, tabs between them."""

from __future__ import annotations

import datetime
import zipfile
from pathlib import Path

from shipcosim.errors import error_at, suggestion

LARGEST_WORKBOOK = 1 << 30
"""Most bytes that a workbook may unpack to."""


def is_workbook(path: Path) -> bool:
    """Whether a file is a workbook by its name."""
    return path.suffix.lower() in (".xlsx", ".xlsm")


def text_of_sheet(path: Path, sheet: str | None = None) -> tuple[str, list[str]]:
    """Cells of a sheet as lines of text with tabs between, and what is to be said.

    Parameters
    ----------
    path : Path
        .xlsx or .xlsm. Formulae have the value that Excel stored.
    sheet : str, optional
        Name of the sheet.

    Raises
    ------
    ShipcosimError
        If openpyxl is missing, or the workbook cannot be read or has no such sheet.
    """
    try:
        import openpyxl
    except ImportError as error:
        remedy = "Install it by `pip install shipcosim[excel]`, or save the sheet as .csv."
        raise error_at(str(path), "workbooks of Excel need openpyxl.", remedy) from error
    # Check the unpacked size before reading, against
    # archives that are small but unpack to a huge file.
    try:
        with zipfile.ZipFile(path) as parts:
            size = sum(part.file_size for part in parts.infolist())
        if size > LARGEST_WORKBOOK:
            raise ValueError(f"it unpacks to {size / 2**30:.3g} GiB")
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = {
            one.title: [row for row in one.iter_rows(values_only=True)] for one in book.worksheets
        }
    except Exception as error:  # openpyxl raises what zip, XML and its own code do
        raise error_at(str(path), f"is no workbook that can be read: {error}.") from error
    if sheet is not None and sheet not in sheets:
        raise error_at(str(path), f"has no sheet '{sheet}'.", suggestion(sheet, sheets))
    if not sheets:
        raise error_at(str(path), "is no workbook that can be read: it has no sheet.")
    # Without a name the sheet with the most cells is read.
    used = sheet or max(sheets, key=lambda name: sum(len(row) for row in sheets[name]))
    rows = [[_text(cell) for cell in row] for row in sheets[used]]
    said = (
        [f"Sheet '{used}' of {len(sheets)} is read."] if sheet is None and len(sheets) > 1 else []
    )
    return "\n".join("\t".join(row) if any(row) else "" for row in rows), said


def _text(cell: object) -> str:
    """A cell as a text file would have it."""
    if cell is None:
        return ""
    if isinstance(cell, datetime.datetime):
        return cell.isoformat(" ")
    if isinstance(cell, (datetime.date, datetime.time)):
        return cell.isoformat()
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    return " ".join(str(cell).split())
