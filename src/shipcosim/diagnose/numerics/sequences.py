"""Sums along a sequence, and runs of flags in it."""

import numpy as np


def running_sums(values: np.ndarray) -> np.ndarray:
    """Sums of the values before each one, and of all of them: (n + 1,) array from 0 on.

    Examples
    --------
    >>> running_sums(np.array([1, 2, 3])).tolist()
    [0, 1, 3, 6]
    """
    return np.concatenate([[0], np.cumsum(values)])


def trapezium(rates: np.ndarray, steps: np.ndarray | float) -> np.ndarray:
    """Integral of rates (n, k) from the first row until each one, by the trapezium rule: (n, k) array.

    `steps` from row to row: one, or an (n - 1, 1) array.

    Examples
    --------
    >>> trapezium(np.array([[0.0], [2.0], [2.0]]), 0.5).ravel().tolist()
    [0.0, 0.5, 1.5]
    """
    added = 0.5 * steps * (rates[1:] + rates[:-1])
    return np.concatenate([np.zeros_like(rates[:1]), np.cumsum(added, axis=0)])


def runs(flags: np.ndarray) -> np.ndarray:
    """First and one past the last index of each run of true values: (k, 2).

    Examples
    --------
    >>> runs(np.array([False, True, True, False, True])).tolist()
    [[1, 3], [4, 5]]
    """
    # Edges of runs are where the flags change, with 0 before and after.
    edges = np.flatnonzero(np.diff(np.r_[0, np.asarray(flags, np.int8), 0]))
    return edges.reshape(-1, 2)


def places(at: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Fractional rows of a series, limited to its first and last: the row before, and the share of the step after it.

    Examples
    --------
    >>> low, share = places(np.array([-1.0, 0.25, 2.0, 9.0]), 3)
    >>> low.tolist(), share.tolist()
    ([0, 0, 1, 1], [0.0, 0.25, 1.0, 1.0])
    """
    at = np.clip(at, 0.0, rows - 1.0)
    low = np.minimum(at.astype(int), rows - 2)
    return low, at - low


def between(series: np.ndarray, low: np.ndarray, share: np.ndarray) -> np.ndarray:
    """A series at `places` along its last axis, linear between rows.

    Examples
    --------
    >>> between(np.array([2.0, 4.0, 10.0]), *places(np.array([0.5, 2.0]), 3)).tolist()
    [3.0, 10.0]
    """
    return series[..., low] * (1.0 - share) + series[..., low + 1] * share
