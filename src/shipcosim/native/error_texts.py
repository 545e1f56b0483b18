"""Texts of errors with values that only the running code knows."""

from __future__ import annotations

import re
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.native.symbols import SAID, Symbol

if TYPE_CHECKING:
    from shipcosim.native.recording import Recording

_VALUE = re.compile(f"{SAID}([0-9]+):([^{SAID}]*){SAID}")


def values_in_text(error: Exception, recording: Recording) -> list[Symbol]:
    """Symbols whose values stand in the text of an error."""
    return [recording.named[int(number)] for number, _ in _VALUE.findall(str(error))]


def parts(text: str) -> list[tuple[str, str]]:
    """Split a text into pairs: (words, "") and (number of a symbol, its Python format)."""
    # The pattern has two groups, so the split gives words, number, format, words, and so on.
    pieces = _VALUE.split(text)
    pairs = [(pieces[0], "")]
    for number, how, words in zip(pieces[1::3], pieces[2::3], pieces[3::3], strict=True):
        pairs += [(number, how or "r"), (words, "")]
    return [pair for pair in pairs if pair[0]]


def line_of(error: BaseException) -> str:
    """The component's line that raised an error, as text; empty if no line of it did."""
    # The innermost line of the models or of the FMU's code tells the author where to look.
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if "/models/" in frame.filename.replace("\\", "/") or "_code" in frame.filename
    ]
    return f"{Path(frames[-1].filename).name}, line {frames[-1].lineno}: " if frames else ""
