"""Refused files of other programs: their formats, and how to make a table of them."""

from __future__ import annotations

import tomllib
from pathlib import Path

from shipcosim.diagnose.log.files.excel import is_workbook
from shipcosim.diagnose.log.files.text import head_of
from shipcosim.dialects import LFS_POINTER, is_text
from shipcosim.errors import error_at

_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_BY_NAME = {
    name: (what, f["remedy"]) for f in _TABLE["formats"] for name, what in f["names"].items()
}
_BY_CONTENT = _TABLE["marks"] | {LFS_POINTER.decode(): ".lfs"}
_SPREADSHEET = b"application/vnd.oasis.opendocument"


def refuse_foreign(path: Path) -> None:
    """Raise ShipcosimError for a file of a program whose files are not read, by its content or its name.

    Examples
    --------
    >>> refuse_foreign(Path("log.csv"))
    """
    # The first bytes tell the format, whatever the name; the name decides only without them.
    head = head_of(path, 512)
    text = head.decode("latin-1")
    kind = next((kind for mark, kind in _BY_CONTENT.items() if text.startswith(mark)), None)
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
