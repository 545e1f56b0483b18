"""Workbooks of Excel as text: the sheet with the most cells, tabs between them."""

from __future__ import annotations

import datetime
import io
import zipfile
from pathlib import Path

from shipcosim.dialects import is_text
from shipcosim.errors import error_at, suggestion

LARGEST_WORKBOOK = 1 << 30
"""Most bytes that a workbook may unpack to."""


def is_workbook(path: Path) -> bool:
    """Whether a file is a workbook: an archive that holds one, or a file of its name that is no text."""
    with path.open("rb") as file:
        head = file.read(8)
    if path.suffix.lower() in (".xlsx", ".xlsm"):
        return head.startswith(b"PK") or not is_text(head)
    if not head.startswith(b"PK\x03\x04"):
        return False
    with zipfile.ZipFile(path) as parts:
        return "xl/workbook.xml" in parts.namelist()


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
        If openpyxl is missing, or the workbook has no such sheet.
    """
    try:
        import openpyxl
    except ImportError as error:
        remedy = "Install it by `pip install shipcosim[excel]`, or save the sheet as .csv."
        raise error_at(str(path), "workbooks of Excel need openpyxl.", remedy) from error
    # Check the unpacked size before reading, against
    # archives that are small but unpack to a huge file.
    with zipfile.ZipFile(path) as parts:
        size = sum(part.file_size for part in parts.infolist())
    if size > LARGEST_WORKBOOK:
        raise ValueError(f"it unpacks to {size / 2**30:.3g} GiB")
    content = io.BytesIO(path.read_bytes())
    book = openpyxl.load_workbook(content, read_only=True, data_only=True)
    sheets = {
        one.title: [row for row in one.iter_rows(values_only=True)] for one in book.worksheets
    }
    if sheet is not None and sheet not in sheets:
        raise error_at(str(path), f"has no sheet '{sheet}'.", suggestion(sheet, sheets))
    if not sheets:
        raise error_at(str(path), "is a workbook without a sheet.")
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
