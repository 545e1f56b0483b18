"""Between which bounds one motion is a multiple of another, when both are seen through noise.

Regression of position on noisy velocity gives too small a slope, of velocity on position too large a one; the true
slope lies between. A ship that hardly moves has wide bounds and cannot be blamed for a wrong scale.
"""

from __future__ import annotations

import numpy as np

__all__ = ["FAST_SPANS", "SLOW_SPANS", "noise_share", "slope_bounds"]

FAST_SPANS, SLOW_SPANS = (1, 3), (10, 30, 100)  # steps over which motions are compared
MARGIN = 3.0  # standard errors
LEAST = 8  # independent spans


def slope_bounds(
    seen: np.ndarray, motion: np.ndarray, known: np.ndarray, spans: tuple[int, ...] = FAST_SPANS + SLOW_SPANS
) -> tuple[float, float]:
    """Lower and upper bound of b in seen = b * motion + noise, where motion has noise of its own.

    Parameters
    ----------
    seen, motion : (n, k) arrays
        Steps.
    known : (n, k) array of bool
        Steps with data; the others count as no motion.
    spans : tuple of int
        Numbers of steps over which motions are compared.
    """
    bounds = [_bounds(*products) for products in _products(seen, motion, known, spans)]
    return max((low for low, _ in bounds), default=-np.inf), min((high for _, high in bounds), default=np.inf)


def noise_share(seen: np.ndarray, motion: np.ndarray, known: np.ndarray, spans: tuple[int, ...]) -> float:
    """Largest share of the motion that can be noise, by the span in which both agree best; 1 where nothing is known."""
    shares = [1.0 - xy**2 / (xx * yy) for xx, yy, xy, _ in _products(seen, motion, known, spans) if xx * yy > 0.0]
    return float(min(shares, default=1.0))


def _products(seen, motion, known, spans):
    """Sums of squares and products over spans: of motion, of what is seen, mixed; and the number of spans."""
    seen, motion = np.where(known, seen, 0.0), np.where(known, motion, 0.0)
    for span in spans:
        if len(seen) >= LEAST * span:
            stride = max(1, span // 4)
            sums = [np.cumsum(np.vstack([np.zeros(x.shape[1]), x]), axis=0)[::stride] for x in (seen, motion)]
            y, x = ((s[span // stride :] - s[: -(span // stride)]).ravel() for s in sums)
            yield x @ x, y @ y, x @ y, max(known.sum() / span, 1.0)


def _bounds(xx, yy, xy, count):
    """Both regression slopes less and plus their margins."""
    if xx <= 0.0 or yy <= 0.0:
        return -np.inf, np.inf
    error = MARGIN * np.sqrt(max(xx * yy - xy**2, 0.0) / count)
    if abs(xy) < error:
        return -np.inf, np.inf
    forward, reverse = sorted((xy / xx, yy / xy), key=abs)
    bounds = forward - np.sign(xy) * error / xx, reverse + np.sign(xy) * error * yy / xy**2
    return min(bounds), max(bounds)
