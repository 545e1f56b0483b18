"""Refused files of other programs: their formats, and how to make a table of them."""

from __future__ import annotations

from pathlib import Path

from shipcosim.diagnose.log.files.excel import is_workbook
from shipcosim.dialects import LFS_POINTER, is_text
from shipcosim.errors import error_at

_SHEET = "Save it as .xlsx or .csv, or convert it: `libreoffice --headless --convert-to xlsx FILE`."
_MATLAB = (
    "Write a table with a column for each channel: in MATLAB `writetable(struct2table(S), 'log.csv')`, in Python "
    "`scipy.io.loadmat` and pandas."
)
_HDF5 = "Write it as .nc with a dimension `time`, or as .csv: `pandas.read_hdf(FILE).to_csv('log.csv')`."
_BY_NAME = {
    ".xls": ("a workbook of Excel before 2007", _SHEET),
    ".xlsb": ("a binary workbook of Excel", _SHEET),
    ".ods": ("a spreadsheet of LibreOffice", _SHEET),
    ".numbers": ("a spreadsheet of Numbers", _SHEET),
    ".mat": ("a file of MATLAB", _MATLAB),
    ".sqlite": ("a database of SQLite", "Write its table as .csv."),
    ".ulg": ("a log of PX4", "Convert it: `ulog2csv FILE`."),
    ".bin": (
        "a binary log, as of ArduPilot",
        "Convert it: `mavlogdump.py --format csv FILE > log.csv`.",
    ),
    ".tdms": (
        "a file of LabVIEW",
        "Convert it: `tdmsinfo`, or `nptdms` in Python and `as_dataframe().to_csv(...)`.",
    ),
    ".mf4": ("a measurement in MDF", "Convert it: `asammdf export --format csv FILE`."),
    ".feather": (
        "a table of Arrow",
        "Write it as .parquet or .csv: `pandas.read_feather(FILE).to_csv('log.csv')`.",
    ),
    ".h5": ("a file of HDF5", _HDF5),
    ".hdf5": ("a file of HDF5", _HDF5),
    ".pkl": ("a pickle of Python, which could run code", "Write the table as .csv or .nc."),
    ".html": ("a page in HTML", "Save the table that it shows as .csv."),
    ".pdf": ("a document in PDF", "Save the table in it as .csv."),
    ".zip": ("an archive", "Unpack it, and name the log in it."),
    ".lfs": ("a pointer of Git LFS", "Get the file: `git lfs pull` in its repository."),
}
_BY_CONTENT = (
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", ".xls"),
    (b"MATLAB 5.0 MAT-file", ".mat"),
    (b"MATLAB 7.3 MAT-file", ".mat"),
    (b"\x89HDF\r\n\x1a\n", ".h5"),
    (b"ULog\x01", ".ulg"),
    (b"TDSm", ".tdms"),
    (b"SQLite format 3\x00", ".sqlite"),
    (b"ARROW1", ".feather"),
    (b"<!DOCTYPE html", ".html"),
    (b"<!doctype html", ".html"),
    (b"<html", ".html"),
    (b"%PDF-", ".pdf"),
    (LFS_POINTER, ".lfs"),
)
_SPREADSHEET = b"application/vnd.oasis.opendocument"


def refuse_foreign(path: Path) -> None:
    """Raise ShipcosimError for a file of a program whose files are not read, by its content or its name.

    Examples
    --------
    >>> refuse_foreign(Path("log.csv"))
    """
    # The first bytes tell the format, whatever the name; the name decides only without them.
    head = b""
    if path.is_file():
        with path.open("rb") as file:
            head = file.read(512)
    kind = next((kind for mark, kind in _BY_CONTENT if head.startswith(mark)), None)
    suffix = path.suffix.lower()
    if head.startswith(b"PK\x03\x04") and not is_workbook(path):
        kind = ".ods" if _SPREADSHEET in head else ".zip"
    # A text is read, whatever it is called.
    if kind is None and not head.startswith(b"\x1f\x8b") and not is_text(head):
        kind = suffix if suffix in _BY_NAME else None
    if kind is not None:
        what, remedy = _BY_NAME[kind]
        raise error_at(
            str(path), f"is {what}, which is not read.", remedy.replace("FILE", path.name)
        )
