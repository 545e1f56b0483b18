"""Least squares with some coefficients that must not be negative."""

import numpy as np

_ROUNDS = 50  # a column, as a guard against rounding; a few are needed


def least_squares(
    columns: np.ndarray, series: np.ndarray, positive: np.ndarray | None = None
) -> np.ndarray:
    """Coefficients for which the columns come closest to a series, some or all of them not negative.

    Parameters
    ----------
    columns : (n, p) array
    series : (n,) array
    positive : (p,) bool array, optional
        Coefficients that must not be negative; all of them by default.

    Returns
    -------
    (p,) array

    References
    ----------
    Lawson and Hanson, Solving Least Squares Problems, SIAM, 1995, ch. 23: algorithm NNLS. Coefficients of either sign
    are free from the start and stay so.

    Examples
    --------
    >>> least_squares(np.eye(3), np.array([1.0, -2.0, -3.0]), np.array([True, True, False]))
    array([ 1.,  0., -3.])
    """
    # QR decomposition: the problem shrinks to p rows with the same solution.
    turn, triangle = np.linalg.qr(columns)
    target = turn.T @ series
    count = columns.shape[1]
    bound = np.ones(count, bool) if positive is None else np.asarray(positive, bool)
    # Gradients below rounding errors count as zero.
    least = (
        10.0
        * max(columns.shape)
        * np.finfo(float).eps
        * np.abs(triangle).sum(0).max()
        * np.linalg.norm(target)
    )
    # Start with the unbounded coefficients free and all others at 0.
    free = ~bound
    coefficients = _solution(triangle, target, free)
    for _ in range(_ROUNDS * count):
        # Negative gradient at the bounded coefficients. Where it
        # is positive, freeing the coefficient lowers the residual.
        pull = np.where(free, -np.inf, triangle.T @ (target - triangle @ coefficients))
        best = int(np.argmax(pull))
        if not pull[best] > least:
            break
        free[best] = True
        coefficients = _feasible(triangle, target, coefficients, free, bound)
    return coefficients


def _feasible(triangle, target, coefficients, free, bound):
    """Solution in the free coefficients; those that would turn negative on the way are taken from `free` again."""
    while True:
        wanted = _solution(triangle, target, free)
        below = free & bound & (wanted <= 0.0)
        if not below.any():
            return wanted
        # Go towards the unbounded solution until the first
        # coefficient reaches 0, and fix those that did.
        share = np.min(
            coefficients[below] / np.maximum(coefficients[below] - wanted[below], 1e-300)
        )
        coefficients = coefficients + share * (wanted - coefficients)
        stopped = below & (coefficients <= 1e-15 * np.abs(coefficients).max())
        stopped[np.flatnonzero(below)[np.argmin(coefficients[below])]] = True
        free &= ~stopped
        coefficients[stopped] = 0.0


def _solution(triangle, target, free):
    coefficients = np.zeros(free.size)
    coefficients[free] = np.linalg.lstsq(triangle[:, free], target, rcond=None)[0]
    return coefficients
