"""What waves and gusts share: arrays whose last axis is the component of a sum of sinusoids.

One sea or one wind has arrays (n,); m variations at once have values (m,) and arrays (n,) or (m, n).
"""

from functools import lru_cache

import numpy as np

from shipcosim.models.core.maths import library_of


def column(x):
    """x with a last axis for the components; a single number stays as it is."""
    return x if isinstance(x, (float, int)) else x[..., None]


def total(a, b):
    """Sum of a b over the components; a float where both are (n,) arrays."""
    if isinstance(a, np.ndarray):
        return float(a.dot(b)) if a.ndim == b.ndim == 1 else np.einsum("...n,...n->...", a, b)
    return (a * b).sum(-1)


def tensors_if_any(arrays, *values):
    """The arrays as tensors of the kind of the first tensor among the values; as they are where there is none."""
    if library_of(*values) is np:
        return arrays
    tensor = next(value for value in values if hasattr(value, "new_tensor"))
    return tuple(tensor.new_tensor(array) for array in arrays)


def per_seed(draw, seed):
    """What `draw(seed)` gives, a tuple of (n,) arrays; stacked to (m, n) for an (m,) array of seeds."""
    if isinstance(seed, int):
        return draw(seed)
    return _stacked(draw, tuple(np.ravel(seed).tolist()), np.shape(seed))


@lru_cache(maxsize=8)
def _stacked(draw, seeds, shape):
    draws = [draw(int(seed)) for seed in seeds]
    return tuple(np.reshape(part, (*shape, -1)) for part in zip(*draws, strict=True))
