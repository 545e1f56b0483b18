"""Between which bounds one motion is a multiple of another, when both are seen through noise.

Regression of position on noisy velocity gives too small a slope, of velocity on position too large a one; the true
slope lies between. A ship that hardly moves has wide bounds and cannot be blamed for a wrong scale.
"""

from __future__ import annotations

import numpy as np

__all__ = ["slope_bounds"]

SPANS = (1, 3, 10, 30, 100)  # steps over which motions are compared
MARGIN = 3.0  # standard errors
LEAST = 8  # independent spans


def slope_bounds(seen: np.ndarray, motion: np.ndarray, known: np.ndarray) -> tuple[float, float]:
    """Lower and upper bound of b in seen = b * motion + noise, where motion has noise of its own.

    Parameters
    ----------
    seen, motion : (n, k) arrays
        Steps.
    known : (n, k) array of bool
        Steps with data; the others count as no motion.
    """
    low, high = -np.inf, np.inf
    seen, motion = np.where(known, seen, 0.0), np.where(known, motion, 0.0)
    for span in SPANS:
        if len(seen) < LEAST * span:
            break
        sums = [np.cumsum(np.vstack([np.zeros(x.shape[1]), x]), axis=0)[:: max(1, span // 4)] for x in (seen, motion)]
        lag = span // max(1, span // 4)
        y, x = ((s[lag:] - s[:-lag]).ravel() for s in sums)
        below, above = _bounds(x, y, known.sum() / span)
        low, high = max(low, below), min(high, above)
    return low, high


def _bounds(x, y, count):
    """Both regression slopes less and plus their margins."""
    xx, yy, xy = x @ x, y @ y, x @ y
    if xx <= 0.0 or yy <= 0.0:
        return -np.inf, np.inf
    spread = np.sqrt(max(xx * yy - xy**2, 0.0) / max(count, 1.0))
    if abs(xy) < MARGIN * spread:
        return -np.inf, np.inf
    forward, reverse = sorted((xy / xx, yy / xy), key=abs)
    error = MARGIN * spread
    bounds = forward - np.sign(xy) * error / xx, reverse + np.sign(xy) * error * yy / xy**2
    return min(bounds), max(bounds)
