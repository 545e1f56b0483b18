"""Sums of sinusoids for waves and gusts: arrays whose last axis is the component.

One sea or one wind has arrays (n,); m variations at once have values (m,) and arrays (n,) or (m, n).

References
----------
Definition.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from shipcosim.models.core.maths import Arithmetic, is_single, library_of


def column(x: Arithmetic) -> Arithmetic:
    """Values with a last axis for the components; a single number stays.

    Parameters
    ----------
    x : float or (m,) array or tensor
        Values. [any unit]

    Returns
    -------
    float or (m, 1) array or tensor
        The values. [the unit of x]
    """
    return x if isinstance(x, (float, int)) else x[..., None]


def total(a: Arithmetic, b: Arithmetic) -> Arithmetic:
    """Sum of the products a b over the components.

    Parameters
    ----------
    a, b : (n,) or (m, n) array or tensor
        Factors. [any units]

    Returns
    -------
    float or (m,) array or tensor
        The sum; a float where both factors are (n,) arrays. [unit of a times unit of b]
    """
    # The dot product is fastest for one variation; `einsum` multiplies row by row.
    if isinstance(a, np.ndarray):
        return a.dot(b).item() if a.ndim == b.ndim == 1 else np.einsum("...n,...n->...", a, b)
    return (a * b).sum(-1)


def tensors_if_any(arrays: tuple, *values: Arithmetic) -> tuple:
    """Arrays as tensors like the first tensor among some values; unchanged if there is none.

    Parameters
    ----------
    arrays : tuple of arrays
        What is to be combined with the values. [any units]
    values : float or (m,) array or tensor
        Values that decide. [any units]

    Returns
    -------
    tuple of arrays or tensors
        The same numbers. [the units of arrays]
    """
    if not hasattr(library_of(*values), "Tensor"):
        return arrays
    tensor = next(value for value in values if hasattr(value, "new_tensor"))
    return tuple(tensor.new_tensor(array) for array in arrays)


def per_seed(draw: Callable[[Any], tuple], seed: int | np.ndarray) -> tuple:
    """Random arrays of one seed, or of several seeds as rows.

    Parameters
    ----------
    draw : callable
        ``draw(seed)`` gives a tuple of (n,) arrays.
    seed : int or (m,) array of int
        Seed, not negative. [1]

    Returns
    -------
    tuple of (n,) or (m, n) arrays
        What `draw` gives; one row per seed. [the units of what draw gives]
    """
    if is_single(seed):
        return draw(seed)
    return _stacked(draw, tuple(np.ravel(seed).tolist()), np.shape(seed))


@lru_cache(maxsize=8)
def _stacked(draw, seeds, shape):
    draws = [draw(int(seed)) for seed in seeds]
    return tuple(np.reshape(part, (*shape, -1)) for part in zip(*draws, strict=True))
