"""Tridiagonal systems of linear equations."""

import numpy as np


def solve_tridiagonal(
    lower: np.ndarray, diagonal: np.ndarray, upper: np.ndarray, right: np.ndarray
) -> np.ndarray:
    """Solve lower[i] x[i - 1] + diagonal[i] x[i] + upper[i] x[i + 1] = right[i] for all rows at once.

    By cyclic reduction: every other row is put into its neighbours, which leaves a system of half the size. Without
    exchange of rows; in a row the diagonal must be no smaller than what stands beside it.

    Parameters
    ----------
    lower, diagonal, upper : (n,) arrays
        The first of `lower` and the last of `upper` do not count.
    right : (n, ...) array

    Returns
    -------
    (n, ...) array

    References
    ----------
    Golub and Van Loan, Matrix Computations, 4th ed., Johns Hopkins University Press, 2013, sec. 4.5.4.

    Examples
    --------
    >>> one, two = np.ones(3), 2.0 * np.ones(3)
    >>> solve_tridiagonal(one, two, one, np.array([4.0, 8.0, 8.0]))
    array([1., 2., 3.])
    """
    below, middle, above = (
        band.reshape(-1, *[1] * (right.ndim - 1)) for band in (lower, diagonal, upper)
    )
    return _solved(below, middle, above, right)


def _solved(lower, diagonal, upper, right):
    if len(diagonal) == 1:
        return right / diagonal
    # Solve each odd row for its unknown, in terms of its neighbours.
    before, after, alone = (
        series[1::2] / diagonal[1::2] for series in (lower, upper, right)
    )  # of every other row
    # Insert these into the even rows, which leaves a tridiagonal system of half the size.
    n = len(before)
    up = upper[::2][:n]
    down = lower[::2][1:]
    left = slice(0, len(down))
    rest = [
        np.zeros_like(lower[::2]),
        diagonal[::2].copy(),
        np.zeros_like(upper[::2]),
        np.array(right[::2]),
    ]
    rest[0][1:], rest[2][:n] = -down * before[left], -up * after
    rest[1][:n] -= up * before
    rest[1][1:] -= down * after[left]
    rest[3][:n] -= up * alone
    rest[3][1:] -= down * alone[left]
    # Solve the smaller system, and insert its solution into the odd rows.
    solution = np.empty(right.shape, np.result_type(right, diagonal))
    solution[::2] = _solved(*rest)
    solution[1::2] = alone - before * solution[::2][:n]
    solution[1::2][left] -= after[left] * solution[2::2]
    return solution
