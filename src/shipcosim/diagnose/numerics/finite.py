"""Values that are known."""

import numpy as np


def finite(values: np.ndarray) -> np.ndarray:
    """The values that are finite numbers, in their order."""
    return values[np.isfinite(values)]
