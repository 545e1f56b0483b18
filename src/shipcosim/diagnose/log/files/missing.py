"""Cells that hold no measurement: numbers that loggers write for missing values, and rows that a flag calls bad."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipcosim.angles import wrap_series
from shipcosim.diagnose.log.files.cells import without_fillers
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.vocabulary import vocabulary, words_of
from shipcosim.diagnose.log.roles import ROLES
from shipcosim.diagnose.numerics import runs
from shipcosim.errors import counted

FLAGS = frozenset(vocabulary()["flags"]["words"])
"""Words of a column that says which rows of another one are measurements."""
_FAR_LEAP = 5.0
"""Times all but one in a hundred changes of a channel; no ship leaps further, holds, and leaps back. Assumed."""
_LARGE_LEAP = 0.25
"""Share of a channel's range: a receiver at rest may round small speeds to 0. Assumed."""


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


def without_dropouts(signals: dict[str, tuple[np.ndarray, str]]) -> list[str]:
    """Take out, in place, the rows in which a sensor wrote one number for no value, and say so.

    Parameters
    ----------
    signals : dict of (n,) array and str
        Values and unit by role.
    """
    remarks = []
    # What drives thrusters may leap, and is none of these. Positions are looked at in m.
    for role in signals.keys() & (ROLES.keys() - {"latitude", "longitude"}):
        values, unit = signals[role]
        rows = dropouts(values, unit)
        if rows.any():
            where = f"{values[rows][0]:g} and back in {counted(rows.sum(), 'row')}"
            remarks.append(f"{role}: it leaps to {where}, as without a measurement: left empty.")
            signals[role] = np.where(rows, np.nan, values), unit
    return sorted(remarks)


def dropouts(values: np.ndarray, unit: str) -> np.ndarray:
    """True in rows with the number that a channel leaps to, and from which it leaps away again, (n,) array.

    Examples
    --------
    >>> heading = 200.0 + np.sin(np.arange(90.0) / 9.0)
    >>> heading[30:33] = 0.0
    >>> np.flatnonzero(dropouts(heading, "deg")).tolist()
    [30, 31, 32]
    """
    rows = np.zeros(len(values), bool)
    for filler in {0.0, np.nanmin(values, initial=0.0), np.nanmax(values, initial=0.0)}:
        is_filler = values == filler
        rest = np.flatnonzero(np.isfinite(values) & ~is_filler)
        if not is_filler.any() or len(rest) < _FEWEST:
            continue
        # What the channel does otherwise: its changes from row to row, and its range.
        changes = _distance(np.diff(values[rest]), unit)
        usual = np.quantile(changes, 0.99)
        large = _LARGE_LEAP * np.ptp(values[rest])
        # Leaps to the number and from it, the smaller of both; a log may begin or end with it.
        spans = runs(is_filler)
        place = np.searchsorted(rest, spans[:, 0])
        around = np.concatenate(([np.nan], values[rest], [np.nan]))
        leap = np.nanmin(_distance(around[[place, place + 1]] - filler, unit), axis=0)
        # Where the rows before and after change as fast, the channel passes through the number.
        nearby = np.pad(changes, 2)
        leap[leap < 2.0 * np.minimum(nearby[place], nearby[place + 2])] = 0.0
        # A number that stands for no value at one place does so elsewhere. A single row may be any outlier.
        if usual > 0.0 and leap.max() > large and (filler == 0.0 or is_filler.sum() > 1):
            for first, last in spans[leap > _FAR_LEAP * usual]:
                rows[first:last] = True
    return rows


def _distance(change, unit):
    """Size of changes; of angles the short way round."""
    return np.abs(wrap_series(change)) if unit == "deg" else np.abs(change)


_FEWEST = 20
"""Rows with other values, from which on a channel shows how it changes. Assumed."""
