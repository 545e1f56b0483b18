"""Cells that hold no measurement: numbers that loggers write for missing values, and rows that a flag calls bad."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.log.files.cells import without_fillers
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.vocabulary import vocabulary, words_of

FLAGS = frozenset(vocabulary()["flags"]["words"])
"""Words of a column that says which rows of another one are measurements."""


def without_missing(log: LogColumns) -> LogColumns:
    """Columns without numbers that mean 'no value', and without rows that a column such as ``heading valid`` calls bad.

    Parameters
    ----------
    log : LogColumns
        As it stands in the file, one column for each channel.
    """
    values = dict(log.values)
    remarks = list(log.remarks)
    for name, cells in log.values.items():
        if cells.dtype.kind == "f":
            values[name], more = without_fillers(name, cells)
            remarks += more
    for flag, cells in log.values.items():
        # The flag of a channel, or of a sensor with several channels, begins as their names do.
        words = words_of(flag)
        of = tuple(word for word in words if word not in FLAGS)
        bad = bad_rows(words, cells)
        if not of or not bad.any():
            continue
        for name in log.values:
            flag_words = words_of(name)
            is_flagged = flag_words[: len(of)] == of and not FLAGS & set(flag_words)
            if is_flagged and values[name].dtype.kind == "f":
                values[name] = np.where(bad, np.nan, values[name])
                remarks.append(f"'{flag}' calls {bad.sum()} rows of '{name}' bad: left empty.")
    return replace(log, values=values, remarks=tuple(remarks))


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
    none = np.zeros(len(cells), bool)
    flag_terms = vocabulary()["flags"]
    # Of a quality or status 0 may be good.
    if not FLAGS & set(words) or (1.0 in cells and not set(words) & set(flag_terms["yes"])):
        return none
    texts = np.array([str(cell).lower() for cell in cells])
    if not {*flag_terms["good"], *flag_terms["bad"]} >= set(texts):
        return none
    bad = np.isin(texts, flag_terms["bad"])
    return bad & (bad.mean() < 0.5)
