"""White noise of a series by its differences, and the size of normal values that outliers do not move."""

import math

import numpy as np


def noise_by_differences(values: np.ndarray, order: int, axis: int = -1) -> np.ndarray:
    """Differences of a series, scaled to the standard deviation of white noise: a smooth motion is small in them.

    Parameters
    ----------
    values : array
    order : int
        How often the differences are taken. The variance of white noise grows by the sum of the squares of the
        binomial coefficients: 6, 20 and 70 for the second, third and fourth.
    axis : int, optional
        Of the rows.

    Returns
    -------
    array
        Shorter by `order` along the axis, in the unit of the values, with both signs.

    Examples
    --------
    >>> noise_by_differences(np.array([0.0, 1.0, 0.0, 1.0]), 3) * 20.0**0.5
    array([4.])
    """
    return np.diff(values, order, axis=axis) / math.comb(2 * order, order) ** 0.5


def normal_size(values: np.ndarray, axis: int | tuple[int, ...] | None = None) -> np.ndarray:
    """Standard deviation of normal values about zero, by the median of their sizes; nan is left out.

    Examples
    --------
    >>> float(normal_size(np.array([-1.0, 1.0, 1000.0])))
    1.4826
    """
    return 1.4826 * np.nanmedian(np.abs(values), axis=axis)
