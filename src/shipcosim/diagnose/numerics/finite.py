"""Values that are known."""

import numpy as np


def usual_rise(values: np.ndarray, otherwise: float) -> float:
    """Median of the steps by which values rise; `otherwise` where they never do."""
    steps = np.diff(values)
    return float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else otherwise


def finite(values: np.ndarray) -> np.ndarray:
    """The values that are finite numbers, in their order."""
    return values[np.isfinite(values)]
