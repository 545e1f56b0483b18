"""Data small enough for a page: series in whole steps of visible size, all compressed."""

import base64
import gzip
import json
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shipcosim.report.theme.numbers import extent

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
    # Level 6 takes twice as long as 5 and saves three percent.
    return base64.b64encode(gzip.compress(text.encode(), 5, mtime=0)).decode()


def packed_bytes(content: bytes) -> str:
    """Bytes of a page, compressed and in letters, as short as can be."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()


def packed_data(data: Any) -> str:
    """Data of a page as compressed JSON, records by their fields; NaN and infinity are an error."""
    return packed_text(json.dumps(data, separators=(",", ":"), allow_nan=False, default=vars))


def packed_series(values: ArrayLike, levels: float = LEVELS) -> dict[str, Any] | list[float | None]:
    """A series as differences in whole steps, which compress well; `templates/figures.js` reads it.

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
    # Gaps where values are not finite, or too large for the browser.
    numbers = np.asarray(values, float)
    drawable = np.isfinite(numbers) & (np.abs(numbers) < LARGEST)
    # Where no step serves the whole range, the numbers themselves.
    step = _step(numbers[drawable], levels)
    if step is None:
        return [float(f"{v:.6g}") if ok else None for v, ok in zip(numbers, drawable, strict=True)]
    # Whole steps from one value to the next: small integers compress well.
    steps = np.full(len(numbers), None, object)
    counts = np.round(numbers[drawable] / step).astype(np.int64)
    steps[drawable] = np.diff(counts, prepend=0)
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
    # Rows that fit even if the series are noise.
    rows = max((np.size(column) for column in columns), default=0)
    sure = max(int(budget / (BYTES_A_NUMBER * max(len(columns), 1))), 500)
    # Somewhat more rows fit if they compress well: measure it.
    if (
        sure < rows <= 3 * sure
        and len(packed_data([packed_series(column) for column in columns])) <= budget
    ):
        return rows
    return sure


def _step(numbers: NDArray, levels: float) -> float | None:
    """Step of a series; None without a range, or where no step serves all of it."""
    # A range that is zero or beyond float32 cannot be divided into steps.
    span = extent(numbers)
    if not SMALLEST < span < LARGEST:
        return None
    # Spread of most values: single peaks must not make the steps coarse.
    spread = float(np.subtract(*np.quantile(numbers, [0.95, 0.05]))) or span
    if span > BEYOND * spread:
        return None
    # Finest step that is needed, but not below the precision of the numbers.
    finest = max(min(span, SPIKY * spread) / levels, 1e-15 * float(np.abs(numbers).max()))
    # The next smaller 1, 2 or 5 times a power of ten.
    power = int(np.floor(np.log10(finest)))
    return max(
        float(f"{m}e{power}") for m in (1, 2, 5) if float(f"{m}e{power}") <= 1.000001 * finest
    )
