"""Cells that hold no measurement: numbers that loggers write for missing values, and rows that a flag calls bad."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.log.files.cells import without_fillers
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.vocabulary import words_of
from shipcosim.diagnose.numerics import finite

FLAGS = frozenset("quality valid validity ok good flag status".split())
"""Words of a column that says which rows of another one are measurements."""
_YES = FLAGS - {"quality", "flag", "status"}  # words by which 1 is good and 0 is bad
_GOOD = frozenset("good ok valid true yes".split())
_BAD = frozenset("bad invalid false no fault failed".split())
_OPC = (64, 192, 255)  # quality of OPC: bad below the first number, good from the second on


def without_missing(log: LogColumns) -> LogColumns:
    """Columns without numbers that mean 'no value', and without rows that a column such as ``heading valid`` calls bad.

    Parameters
    ----------
    log : LogColumns
        As it stands in the file, one column for each channel.
    """
    values = dict(log.values)
    said = list(log.remarks)
    for name, cells in log.values.items():
        if cells.dtype.kind == "f":
            values[name], more = without_fillers(name, cells)
            said += more
    for flag, cells in log.values.items():
        # The flag of a channel, or of a sensor with several channels, begins as their names do.
        words = words_of(flag)
        of = tuple(word for word in words if word not in FLAGS)
        if not of or len(of) == len(words) or not (bad := bad_rows(words, cells)).any():
            continue
        names = [n for n in values if words_of(n)[: len(of)] == of and values[n].dtype.kind == "f"]
        names = [name for name in names if not FLAGS & set(words_of(name))]
        values |= {name: np.where(bad, np.nan, values[name]) for name in names}
        if names:
            said.append(f"'{flag}' calls {bad.sum()} rows of {', '.join(names)} bad: left empty.")
    return replace(log, values=values, remarks=tuple(said))


def bad_rows(words: tuple[str, ...], cells: np.ndarray) -> np.ndarray:
    """True in rows that a flag calls bad, (n,) array; nowhere if its code is not known, or most rows would be bad.

    Parameters
    ----------
    words : tuple of str
        Of the name of the flag.
    cells : (n,) array
        Texts, None for words that say 'no value', such as bad; 0 and 1; or the quality of OPC.

    Examples
    --------
    >>> bad_rows(("valid",), np.array([1.0, 1.0, 0.0])).tolist()
    [False, False, True]
    >>> bad_rows(("quality",), np.array(["Good", "Good", None], object)).tolist()
    [False, False, True]
    """
    bad = np.zeros(len(cells), bool)
    if cells.dtype.kind == "O":
        texts = ["bad" if cell is None else str(cell).strip().lower() for cell in cells]
        if set(texts) <= _GOOD | _BAD:
            bad = np.isin(texts, list(_BAD))
    elif len(known := finite(cells)) and set(known) <= {0.0, 1.0} and _YES & set(words):
        bad = cells == 0.0
    elif len(known) and _OPC[1] <= known.max() <= _OPC[2]:
        bad = cells < _OPC[0]
    return bad & (bad.mean() < 0.5)
