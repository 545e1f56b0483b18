"""Own clocks and own noise: what a component samples and draws depends on time and seed, never on the step size."""

from functools import lru_cache
from math import floor
from zlib import crc32

import numpy as np

_BLOCK = 256
_TOLERANCE = 1e-6  # of a period: the time of a master that adds up its steps falls short by 5e-10 s in 1100 s


def samples_due(t, period):
    """How many samples are due at time t: sample k is due from k * period on, the first at 0.

    Parameters
    ----------
    t : float
        Time. [s]
    period : float
        Sample period, above 0. [s]

    Returns
    -------
    int
        Number of samples due in [0, t].

    Examples
    --------
    >>> [samples_due(t, 0.1) for t in (0.0, 0.05, 0.3, 3 * 0.1)]
    [1, 1, 4, 4]
    """
    return floor(t / period + _TOLERANCE) + 1


def tidy_time(t):
    """Time to 10 ns, so that it does not matter how a master comes by it: one that adds up its steps drifts.

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


def generator(purpose, seed, block=0):
    """Random generator of its own for a purpose and a seed.

    Parameters
    ----------
    purpose : str
        What the numbers are for; components that share a seed draw different numbers.
    seed : int
        Seed, not negative.
    block : int
        Number of the block of draws.

    Returns
    -------
    numpy.random.Generator
    """
    if seed < 0:
        raise ValueError(f"seed of the {purpose} is {seed}; it must be 0 or above")
    return np.random.default_rng((crc32(purpose.encode()), int(seed), int(block)))


def normals(purpose, seed, k, width):
    """Standard normal numbers of sample k: the same for the same arguments, independent between samples.

    Parameters
    ----------
    purpose : str
        What the numbers are for.
    seed : int or (m,) array of int
        Seed; an array gives every variation its own numbers.
    k : int
        Number of the sample, from 0.
    width : int
        How many numbers the sample needs.

    Returns
    -------
    sequence of `width` floats or (m,) arrays
    """
    if isinstance(seed, int):
        return _block(purpose, seed, k // _BLOCK, width)[k % _BLOCK]
    return _blocks(purpose, tuple(np.ravel(seed).tolist()), k // _BLOCK, width)[k % _BLOCK]


@lru_cache(maxsize=64)
def _block(purpose, seed, block, width):
    return generator(purpose, seed, block).standard_normal((_BLOCK, width)).tolist()


@lru_cache(maxsize=2)
def _blocks(purpose, seeds, block, width):
    """(256, width, m) array: the block of every seed."""
    return np.stack([generator(purpose, seed, block).standard_normal((_BLOCK, width)) for seed in seeds], axis=-1)
