"""Root mean square of a series."""

import numpy as np


def root_mean_square(series: np.ndarray) -> float:
    """Root of the mean of the squares of all values.

    Examples
    --------
    >>> root_mean_square(np.array([3.0, -3.0]))
    3.0
    """
    return float(np.sqrt((series**2).mean()))
