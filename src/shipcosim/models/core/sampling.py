"""Sampling and random numbers of components: by time and seed, never by step size.

References
----------
Definition. Sample times by integer counts: nominal model, sensors.
"""

from collections.abc import Sequence
from functools import lru_cache
from math import floor
from zlib import crc32

import numpy as np

from shipcosim.models.core.maths import Arithmetic, is_single, row_of
from shipcosim.models.core.memoize import kept

_BLOCK = 256
_TOLERANCE = 1e-6  # of a period: the time of a master that adds up its steps falls short by 5e-10 s in 1100 s


def samples_due(t: float, period: float) -> int:
    """Number of samples that are due at time t: sample k is due from k times the period on, the first at 0.

    Parameters
    ----------
    t : float
        Time. [s]
    period : float
        Sample period, above 0. [s]

    Returns
    -------
    int
        Number of samples due in [0, t]. [1]

    Examples
    --------
    >>> [samples_due(t, 0.1) for t in (0.0, 0.05, 0.3, 3 * 0.1)]
    [1, 1, 4, 4]
    """
    # The tolerance absorbs rounding of a master that adds up its steps.
    return floor(t / period + _TOLERANCE) + 1


def tidy_time(t: float) -> float:
    """Time rounded to 10 ns, so that summed and multiplied steps give the same time.

    Parameters
    ----------
    t : float
        Time. [s]

    Returns
    -------
    float
        Time. [s]

    Examples
    --------
    >>> tidy_time(1099.9999999995457)
    1100.0
    """
    return round(t, 8)


def generator(purpose: str, seed: int, block: int = 0) -> np.random.Generator:
    """Random generator that depends only on purpose, seed and block.

    Parameters
    ----------
    purpose : str
        What the numbers are for; components that share a seed draw different numbers.
    seed : int
        Seed, not negative. [1]
    block : int
        Number of the block of draws. [1]

    Returns
    -------
    numpy.random.Generator
        The generator, at its start.

    Raises
    ------
    ValueError
        The seed is negative; the message names the purpose.
    """
    # A checksum of the purpose keeps the streams of components with one seed apart.
    if seed < 0:
        raise ValueError(f"seed of the {purpose} is {seed}; it must be 0 or above")
    return np.random.default_rng((crc32(purpose.encode()), int(seed), int(block)))


def normals(purpose: str, seed: int | np.ndarray, k: int, width: int) -> Sequence[Arithmetic]:
    """Standard normal numbers of sample k: the same for the same arguments, independent between samples.

    Parameters
    ----------
    purpose : str
        What the numbers are for.
    seed : int or (m,) array of int
        Seed, not negative; an array gives every variation its own numbers. [1]
    k : int
        Number of the sample, from 0. [1]
    width : int
        How many numbers the sample needs. [1]

    Returns
    -------
    sequence of `width` floats or (m,) arrays
        The numbers. [1]

    Raises
    ------
    ValueError
        A seed is negative.
    """
    # Numbers are drawn in blocks, because making a generator costs more than drawing.
    if is_single(seed):
        return row_of(_block(purpose, seed, k // _BLOCK, width), k % _BLOCK).tolist()
    return _blocks(purpose, tuple(np.ravel(seed).tolist()), k // _BLOCK, width)[k % _BLOCK]


@kept(64)
def _block(purpose, seed, block, width):
    """256 rows of `width` numbers: one block of a seed."""
    return generator(purpose, seed, block).standard_normal((_BLOCK, width))


@lru_cache(maxsize=2)
def _blocks(purpose, seeds, block, width):
    """(256, width, m) array: the block of each seed."""
    return np.stack(
        [generator(purpose, seed, block).standard_normal((_BLOCK, width)) for seed in seeds],
        axis=-1,
    )
