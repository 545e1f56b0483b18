"""Regions that contain the truth in a wanted share of cases: split conformal prediction.

References
----------
As `models.prediction.regions`.
"""

from math import ceil

import numpy as np

SHARE = 0.9
"""Share of the cases that a region should contain. [1]"""


def conformal(scores: np.ndarray, level: float = SHARE, more: int = 0) -> float:
    """Size of a region in which a share of the cases is.

    Parameters
    ----------
    scores : array
        Errors of the calibration over the factors that widen the region; NaN where there is none. [any unit]
    level : float
        The share. [1]
    more : int
        1 to count the next case among those of the calibration. [1]

    Returns
    -------
    float
        The score of rank ceil(level n), at most the largest. [the unit of scores]
    """
    ordered = np.sort(scores[np.isfinite(scores)])
    rank = ceil(level * (len(ordered) + more))
    return float(ordered[min(len(ordered), rank) - 1])
