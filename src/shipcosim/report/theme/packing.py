"""Data small enough for a page: series in whole steps of what a figure can show, and everything compressed."""

import base64
import gzip
import json
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEVELS = 10_000
"""Steps that a series' range has at least: a panel of 200 px may be looked at fifty times closer."""

SPIKY = 50.0  # ranges over the spread of most values: from here on finer steps, and single numbers
BEYOND = 1e4
BYTES_A_NUMBER = 3.4  # of noise, compressed
SMALLEST = 1e-300  # of a run that diverged: what is larger becomes a gap
LARGEST = float(np.finfo(np.float32).max)


def packed_text(text: str) -> str:
    """A text as base64 of its gzip; `unpacked` of `templates/figures.js` reads it.

    Examples
    --------
    >>> import base64, gzip
    >>> gzip.decompress(base64.b64decode(packed_text("ship"))).decode()
    'ship'
    """
    return base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode()


def packed_data(data: Any) -> str:
    """What a page draws, as compressed JSON. Numbers that JSON does not have are an error."""
    return packed_text(json.dumps(data, separators=(",", ":"), allow_nan=False))


def packed_series(values: ArrayLike, levels: float = LEVELS) -> dict[str, Any] | list[float | None]:
    """A series as steps from one value to the next, which compress well; `series` of `templates/figures.js` reads it.

    Parameters
    ----------
    values : (n,) array
        Any numbers; what is not finite becomes a gap.
    levels : float
        The range has at least so many steps.

    Returns
    -------
    dict or list
        The size of a step, 1, 2 or 5 times a power of ten, and how many there are from one value to the next, None
        at a gap. The numbers themselves where they are the same, or where a run diverged and no step serves all.

    Examples
    --------
    >>> packed_series([0.0, 1.0, float("nan"), 0.5], 10)
    {'step': 0.1, 'steps': [0, 10, None, -5]}
    """
    found = np.asarray(values, float)
    known = np.isfinite(found) & (np.abs(found) < LARGEST)
    step = _step(found[known], levels)
    if step is None:
        return [float(f"{v:.6g}") if ok else None for v, ok in zip(found, known, strict=True)]
    steps = np.full(len(found), None, object)
    counts = np.round(found[known] / step).astype(np.int64)
    steps[known] = np.diff(counts, prepend=0)
    return {"step": step, "steps": steps.tolist()}


def most_rows(columns: Collection[ArrayLike], budget: int) -> int:
    """How many rows of a table a page may hold.

    Parameters
    ----------
    columns : collection of (n,) array
        Series that vary.
    budget : int
        Bytes of the page for them.

    Returns
    -------
    int
        All n if they fit, smooth as they are; else what fits even of noise.
    """
    rows = max((np.size(column) for column in columns), default=0)
    sure = max(int(budget / (BYTES_A_NUMBER * max(len(columns), 1))), 500)
    if (
        sure < rows <= 3 * sure
        and len(packed_data([packed_series(column) for column in columns])) <= budget
    ):
        return rows
    return sure


def _step(known: NDArray, levels: float) -> float | None:
    """The step of a series; None where there is no range, or none that serves all of it."""
    span = float(np.ptp(known)) if known.size else 0.0
    if not SMALLEST < span < LARGEST:
        return None
    spread = float(np.subtract(*np.quantile(known, [0.95, 0.05]))) or span
    if span > BEYOND * spread:
        return None
    finest = max(min(span, SPIKY * spread) / levels, 1e-15 * float(np.abs(known).max()))
    power = int(np.floor(np.log10(finest)))
    return max(
        float(f"{m}e{power}") for m in (1, 2, 5) if float(f"{m}e{power}") <= 1.000001 * finest
    )
