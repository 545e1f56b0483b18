"""Records of JSON as text: a list of them, one a line, or a list for each column; tabs between cells."""

from __future__ import annotations

import json
import re
from pathlib import Path

from shipcosim.diagnose.log.files.text import text_of


def is_json(path: Path) -> bool:
    """Whether a file holds records of JSON by its first characters."""
    with path.open("rb") as file:
        return re.match(rb'(?:\xef\xbb\xbf)?\s*(?:\[\s*)?\{\s*"', file.read(512)) is not None


def text_of_records(path: Path) -> tuple[str, list[str]]:
    """Records as lines of text with tabs between, and remarks; names of nested values have dots.

    Raises
    ------
    ValueError
        If it is no JSON, or holds no records.
    """
    import pandas

    text, said = text_of(path)
    try:
        content = json.loads(text)
    except ValueError:
        # One record a line.
        content = [json.loads(line) for line in text.splitlines() if line.strip()]
    # One record of lists is a table by its columns.
    is_by_column = isinstance(content, dict) and any(
        isinstance(values, (list, dict)) for values in content.values()
    )
    frame = pandas.DataFrame(content) if is_by_column else pandas.json_normalize(content)
    return frame.to_csv(sep="\t", index=False), said
