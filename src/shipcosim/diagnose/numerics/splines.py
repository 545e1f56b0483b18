"""Cubic splines through series."""

import numpy as np

from shipcosim.diagnose.numerics.tridiagonal import solve_tridiagonal


def spline_integral(time: np.ndarray, series: np.ndarray) -> np.ndarray:
    """Integral of the cubic spline through a series, from the first row on.

    The third derivative is the same on both sides of the second row and of the last but one ("not a knot"). Through
    three rows this is a parabola, through two a line.

    Parameters
    ----------
    time : (n,) array
        Increasing; at least two rows.
    series : (n, ...) array
        Real or complex.

    Returns
    -------
    (n, ...) array
        At each row. [unit of the series times that of time]

    References
    ----------
    de Boor, A Practical Guide to Splines, rev. ed., Springer, 2001, ch. IV.

    Examples
    --------
    >>> time = np.array([0.0, 1.0, 2.0, 4.0])
    >>> spline_integral(time, 4.0 * time**3)
    array([  0.,   1.,  16., 256.])
    """
    # Slopes of the chords, and from these the derivatives of the spline at the rows.
    step = np.diff(time).reshape(-1, *[1] * (series.ndim - 1))
    slope = np.diff(series, axis=0) / step
    d = _slopes(step, slope)
    # Exact integral of the Hermite cubic: trapezium rule plus a correction by the end derivatives.
    parts = 0.5 * step * (series[1:] + series[:-1]) + step**2 / 12.0 * (d[:-1] - d[1:])
    return np.concatenate([np.zeros_like(parts[:1]), np.cumsum(parts, axis=0)])


def _slopes(step, slope):
    """Derivatives of the spline at the rows; those at the ends are taken out of the equations of the rows beside."""
    # Through two rows a line, through three a parabola.
    if len(step) == 1:
        return np.concatenate([slope, slope])
    if len(step) == 2:
        bend = (slope[1:] - slope[:1]) / step.sum(axis=0)
        return np.concatenate(
            [slope[:1] - bend * step[:1], slope[:1] + bend * step[:1], slope[1:] + bend * step[1:]]
        )
    # Continuity of the second derivative at each inner
    # row gives a tridiagonal system for the derivatives.
    before = step[:-1]
    after = step[1:]
    lower = after.copy()
    diagonal = 2.0 * (before + after)
    upper = before.copy()
    right = 3.0 * (after * slope[:-1] + before * slope[1:])
    # Eliminate the end derivatives by the not-a-knot conditions.
    first = _end(step[0], step[1], slope[0], slope[1])
    last = _end(step[-1], step[-2], slope[-1], slope[-2])
    lower[0], upper[-1] = 0.0, 0.0
    diagonal[0] -= step[0] + step[1]
    diagonal[-1] -= step[-1] + step[-2]
    right[0], right[-1] = right[0] - first, right[-1] - last
    inner = solve_tridiagonal(lower.ravel(), diagonal.ravel(), upper.ravel(), right)
    # The end derivatives follow from the same conditions.
    ends = (
        (first - (step[0] + step[1]) * inner[0]) / step[1],
        (last - (step[-1] + step[-2]) * inner[-1]) / step[-2],
    )
    return np.concatenate([ends[0][None], inner, ends[1][None]])


def _end(outer, inner, slope_outer, slope_inner):
    """Right side of an end's equation, inner d_end + (outer + inner) d_next = this."""
    both = outer + inner
    return ((outer + 2.0 * both) * inner * slope_outer + outer**2 * slope_inner) / both
