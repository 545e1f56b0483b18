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
