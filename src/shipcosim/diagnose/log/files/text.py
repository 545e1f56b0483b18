"""Bytes of a log as text: compressed or not, in the encodings that loggers and spreadsheets write."""

from __future__ import annotations

import re
from pathlib import Path

from shipcosim.diagnose.log.names.vocabulary import word_parts
from shipcosim.dialects import unicode_of
from shipcosim.errors import error_at
from shipcosim.series import unpacked_bytes

LONGEST_LINE = 1_000_000
"""Above which a line is of no table: 50,000 columns with names of 20 characters. Assumed. [bytes]"""
_TOO_LONG = re.compile(rb"(?<![^\r\n])[^\r\n]{%d}" % LONGEST_LINE)


def head_of(path: Path, size: int) -> bytes:
    """First bytes of a file, as many as `size`; none of a folder."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        return file.read(size)


def text_of(path: Path, encoding: str | None = None) -> tuple[str, list[str]]:
    """Text of a file and remarks on its encoding.

    Parameters
    ----------
    path : Path
        Text, or such compressed by gzip, whatever its name ends in.
    encoding : str, optional
        Of the text; else by its byte order mark, UTF-8, UTF-16 where every other byte is zero, Shift-JIS, EUC-JP,
        GB 18030, CP 949, Windows-1251 or 1250 by the words of logs that they give, Windows-1252.

    Raises
    ------
    ShipcosimError
        If it is no text, not in this encoding, or has a line longer than LONGEST_LINE.
    """
    content = unpacked_bytes(path)
    if not content.strip(b"\x00 \r\n\t"):
        raise error_at(str(path), "is empty.", "Each row is a time and its values.")
    # Each step below goes through all cells of a line, which would take minutes.
    if too_long := _TOO_LONG.search(content):
        line = len(content[: too_long.start()].splitlines()) + 1
        raise error_at(
            f"{path}, line {line}",
            f"is longer than {LONGEST_LINE / 1e6:g} MB, so this is no table.",
            "Each row is a time and its values, on a line of its own.",
        )
    # A logger that loses power leaves blocks of zero bytes; no encoding has four of them within a text.
    content = content.replace(b"UdPbC\x00", b"")  # head of a message of IEC 61162-450
    size = len(content)
    content = re.sub(rb"\x00{4,}", b"", content)
    remarks = [f"{size - len(content)} zero bytes left out."] if len(content) < size else []
    # Decode, and refuse what is no text.
    used = encoding or _encoding_of(content)
    try:
        text = content.decode(used)
    except (UnicodeDecodeError, LookupError) as error:
        remedy = 'Say its encoding in a channel file: file = {encoding = "latin-1"}.'
        raise error_at(str(path), f"is no text in {used}: {error}.", remedy) from error
    if "\x00" in text[:4096]:
        raise error_at(
            str(path), "is no text: it holds zero bytes.", "Tables are text, .xlsx or .nc."
        )
    if encoding is None and used not in ("utf-8", "utf-8-sig"):
        remarks.append(f"Read as {used}, as it is not UTF-8.")
    return text.removeprefix("\ufeff"), remarks


def _encoding_of(content: bytes) -> str:
    if encoding := unicode_of(content):
        return encoding
    # An encoding of East Asia or Russia is only believed by words of logs, as others decode too.
    counts = {}
    for name in ("cp932", "euc_jp", "gb18030", "cp949", "cp1251", "cp1250", "cp1252", "latin-1"):
        try:
            counts[name] = len("".join(word_parts().findall(content.decode(name))))
        except UnicodeDecodeError:
            continue
    best = max(counts.values())
    western = "cp1252" if "cp1252" in counts else "latin-1"
    return next(name for name in counts if counts[name] == best) if best else western
