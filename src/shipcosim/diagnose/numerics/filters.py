"""Averages of series: by a Gaussian, with derivatives, and over a moving window."""

from typing import Literal

import numpy as np

Ends = Literal["reflected", "held"]
_WIDTHS = 4.0  # standard deviations at which the Gaussian is cut off
_PADDED: dict[Ends, Literal["symmetric", "edge"]] = {"reflected": "symmetric", "held": "edge"}


def gaussian_filter(
    series: np.ndarray, width: float, *, order: int = 0, ends: Ends = "reflected", axis: int = -1
) -> np.ndarray:
    """A series averaged by a Gaussian, or a derivative of that average.

    Parameters
    ----------
    series : (..., n, ...) array
    width : float
        Standard deviation of the Gaussian, cut off at four of them. [rows]
    order : int, optional
        Of the derivative.
    ends : {"reflected", "held"}, optional
        How the series goes on beyond its ends: mirrored there, or with its first and last value.
    axis : int, optional

    Returns
    -------
    array like series
        [unit of the series per row**order]

    Examples
    --------
    The slope of a straight line, except for what is cut off:

    >>> round(float(gaussian_filter(2.0 * np.arange(21.0), 2.0, order=1)[10]), 3)
    1.999
    """
    # Weights of the Gaussian, to where it is cut off.
    reach = int(_WIDTHS * width + 0.5)
    x = np.arange(-reach, reach + 1)
    bell = np.exp(-0.5 * (x / width) ** 2)
    # A derivative of the Gaussian is a polynomial times it.
    factor = np.polynomial.Polynomial([1.0])
    for _ in range(order):  # (p g)' = (p' - x p / width**2) g
        factor = factor.deriv() - factor * np.polynomial.Polynomial([0.0, width**-2])
    return _convolved(series, factor(x) * (bell / bell.sum()), (reach, reach), ends, axis)


def moving_average(series: np.ndarray, rows: int) -> np.ndarray:
    """Mean over a window about each row, which holds one row more before it where `rows` is even.

    Parameters
    ----------
    series : (..., n) array
        Mirrored at its ends.
    rows : int
        Of the window.

    Returns
    -------
    array like series

    Examples
    --------
    >>> moving_average(np.array([0.0, 3.0, 6.0, 9.0]), 3)
    array([1., 3., 6., 8.])
    """
    before = rows // 2
    return _convolved(
        series, np.full(rows, 1.0 / rows), (before, rows - 1 - before), "reflected", -1
    )


def _convolved(series, weights, beyond, ends, axis):
    # Pad the ends, so that the result is as long as the
    # series, and convolve each series along the last axis.
    last = np.moveaxis(np.asarray(series, float), axis, -1)
    padded = np.pad(last, [(0, 0)] * (last.ndim - 1) + [beyond], mode=_PADDED[ends])
    flat = padded.reshape(-1, padded.shape[-1])
    smooth = np.array([np.convolve(row, weights, "valid") for row in flat])
    return np.moveaxis(smooth.reshape(last.shape), -1, axis)
