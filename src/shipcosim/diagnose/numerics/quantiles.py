"""Quantiles of short series, where a call of NumPy costs more than the search itself."""

import numpy as np


def quantile(values: np.ndarray, share: float) -> float:
    """Value that a share of a series is below, between two rows by linear interpolation.

    Equal to `numpy.quantile` to the last bit, and several times faster for a thousand rows.

    Parameters
    ----------
    values : (n,) array of float
        At least one, none of them NaN; not changed.
    share : float
        From 0 to 1.

    Returns
    -------
    float

    Examples
    --------
    >>> quantile(np.array([3.0, 1.0, 2.0, 4.0]), 0.5)
    2.5
    """
    last = len(values) - 1
    place = last * share
    below = int(place)
    above = min(below + 1, last)
    # Only the two rows beside the place are sorted.
    ordered = np.partition(values, (below, above))
    part = place - below
    change = ordered[above] - ordered[below]
    # From the nearer row, as NumPy does it, so that rounding is the same.
    if part >= 0.5:
        return float(ordered[above] - change * (1.0 - part))
    return float(ordered[below] + change * part)
