"""Workbooks of Excel as text: the sheet with the most cells, tabs between them."""

from __future__ import annotations

import datetime
import io
import zipfile
from pathlib import Path
from typing import Any

from shipcosim.diagnose.log.files.text import head_of
from shipcosim.dialects import is_text
from shipcosim.errors import ShipcosimError, error_at, suggestion

LARGEST_WORKBOOK = 1 << 30
"""Most bytes that a workbook may unpack to."""


def is_workbook(path: Path) -> bool:
    """Whether a file is a workbook: an archive with one, or a binary file with such a name."""
    head = head_of(path, 8)
    if path.suffix.lower() in (".xlsx", ".xlsm"):
        return head.startswith(b"PK") or not is_text(head)
    if not head.startswith(b"PK\x03\x04"):
        return False
    with zipfile.ZipFile(path) as parts:
        return "xl/workbook.xml" in parts.namelist()


def text_of_sheet(path: Path, sheet: str | None = None) -> tuple[str, list[str]]:
    """Cells of a sheet as lines of text with tabs between, and remarks.

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
    content = io.BytesIO(path.read_bytes())
    try:
        with zipfile.ZipFile(content) as parts:
            size = sum(part.file_size for part in parts.infolist())
        if size > LARGEST_WORKBOOK:
            raise error_at(str(path), f"cannot be read: it unpacks to {size / 2**30:.3g} GiB.")
        book = openpyxl.load_workbook(content, read_only=True, data_only=True)
        sheets = {worksheet.title: _rows(worksheet) for worksheet in book.worksheets}
    except (ShipcosimError, MemoryError):
        raise
    except Exception as error:  # openpyxl raises anything where a part is damaged
        message = "cannot be read: it is no workbook of Excel, or a damaged one."
        raise error_at(str(path), message, "Save it again, as .xlsx or .csv.") from error
    if sheet is not None and sheet not in sheets:
        raise error_at(str(path), f"has no sheet '{sheet}'.", suggestion(sheet, sheets))
    if not sheets:
        raise error_at(str(path), "is a workbook without a sheet.")
    # Without a name the sheet with the most cells is read.
    used = sheet or max(sheets, key=lambda name: sum(len(row) for row in sheets[name]))
    rows = [[_text(cell) for cell in row] for row in sheets[used]]
    remarks = (
        [f"Sheet '{used}' of {len(sheets)} is read."] if sheet is None and len(sheets) > 1 else []
    )
    return "\n".join("\t".join(row) if any(row) else "" for row in rows), remarks


def _rows(sheet: Any) -> list[tuple[Any, ...]]:
    """Rows of a sheet, each up to its last cell: one far cell would make every row as long as a sheet can be."""
    sheet.reset_dimensions()
    rows = list(sheet.iter_rows(values_only=True))
    width = max((len(row) for row in rows), default=0)
    return [row + (None,) * (width - len(row)) if row else row for row in rows]


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
