"""A long log in stretches: more rows than a diagnosis needs cost time, and tell it little that it does not know."""

import numpy as np
import xarray

_SLOW_ENOUGH = 0.16  # s over the root of the ship's length in m: rows that are closer are averaged, 0.93 s for 33.9 m
MOST_ROWS = 6_000
"""Rows, averaged as the ship's length asks, that a diagnosis takes: 100 min at 1 Hz. Set on 2 min for a hard log."""
STRETCHES = 5
"""Parts of a longer log that are taken, of equal length: 20 min each at 1 Hz. Assumed."""
_SHORT = 0.1  # of a stretch: longer holes part it, shorter stretches are left out


def rows_averaged(length: float, step: float) -> int:
    """How many rows of a log are averaged into one, which a ship's answer leaves time for.

    Parameters
    ----------
    length : float
        Of the ship. [m]
    step : float
        From row to row. [s]
    """
    return max(round(_SLOW_ENOUGH * np.sqrt(length) / step), 1)


def in_stretches(log: xarray.Dataset, length: float) -> xarray.Dataset:
    """A repaired log, if it is long only in stretches that are spread evenly over its rows, from the first to the last.

    Rows without any value do not count. Which rows are taken goes by their number alone, so that a log read in two ways
    is the same rows in both.

    Parameters
    ----------
    log : xarray.Dataset
        On even rows, as from `repaired`.
    length : float
        Of the ship. [m]

    Returns
    -------
    xarray.Dataset
        Itself where it is not long.
    """
    # Rows that average to the largest number allowed. A shorter log is used as it is.
    time = log["time"].values
    most = MOST_ROWS * rows_averaged(length, time[1] - time[0])
    if time.size <= most:
        return log
    # Evenly spread parts of equal length, among rows with any value.
    rows = np.flatnonzero(
        np.any([np.isfinite(channel.values) for channel in log.data_vars.values()], axis=0)
    )
    part = most // STRETCHES
    if rows.size > most:
        first = np.linspace(0, rows.size - part, STRETCHES).round().astype(int)
        rows = rows[(first[:, None] + np.arange(part)).ravel()]
    # Part them at long holes, and leave out what is too short.
    ends = np.flatnonzero(np.diff(rows, append=np.inf) > _SHORT * part)
    begins = np.concatenate([[0], ends[:-1] + 1])
    pairs = [(a, b) for a, b in zip(begins, ends, strict=True) if b - a >= _SHORT * part]
    wanted = [np.arange(int(rows[a]), int(rows[b]) + 1) for a, b in pairs]
    return log.isel(time=np.concatenate(wanted)) if wanted else log


def stretches_of(time: np.ndarray) -> list[slice]:
    """Rows that follow each other at even times, in order."""
    # A stretch ends where the step is longer than the usual one.
    ends = np.flatnonzero(np.diff(time, append=np.inf) > 1.5 * (time[1] - time[0])) + 1
    return [slice(int(a), int(b)) for a, b in zip([0, *ends[:-1]], ends, strict=True)]
