"""Data to train on: commands drawn at random, records of many ships in one."""

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np


def independent(
    ranges: np.ndarray, sequences: int, samples: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw independent commands, uniform between -range and +range.

    Parameters
    ----------
    ranges : (n,) array
        Largest value of each command. [any units]
    sequences, samples : int
        How many, of how many each. [1]
    rng : numpy.random.Generator
        Generator.

    Returns
    -------
    (sequences, samples, n) array
        Commands. [the units of ranges]
    """
    return rng.uniform(-ranges, ranges, (sequences, samples, len(ranges)))


def random_walks(
    ranges: np.ndarray, steps: np.ndarray, sequences: int, samples: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw random walks of commands with uniform steps, reflected at the ends of their ranges.

    Parameters
    ----------
    ranges : (n,) array
        Largest value of each command. [any units]
    steps : (n,) array
        Largest step. [the units of ranges]
    sequences, samples : int
        How many, of how many each. [1]
    rng : numpy.random.Generator
        Generator.

    Returns
    -------
    (sequences, samples, n) array
        Commands. [the units of ranges]
    """
    # Uniform steps; the first sample is uniform over the range, so a walk may start anywhere.
    moves = rng.uniform(-steps, steps, (sequences, samples, len(ranges)))
    moves[:, 0] = rng.uniform(-ranges, ranges, (sequences, len(ranges)))
    # Reflect the walk into [-range, range]: a triangle wave of period 4 ranges.
    free = np.cumsum(moves, axis=1)
    return ranges - abs((free + ranges) % (4.0 * ranges) - 2.0 * ranges)


def digest(array: np.ndarray) -> str:
    """Hash of an array: equal data give equal hashes, so reports show which data was used.

    Parameters
    ----------
    array : array
        Any array.

    Returns
    -------
    str
        First 16 digits of its SHA-256.
    """
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()[:16]


def mapped(function: Any, record: Any) -> Any:
    """Apply a function to each array in nested tuples; None stays None."""
    if not isinstance(record, tuple):
        # Leaves: arrays, or None for what is not known.
        return None if record is None else function(record)
    parts = [mapped(function, part) for part in record]
    # Named tuples keep their type.
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def stacked(records: Sequence[Any], library: Any, axis: int = 0) -> Any:
    """Join nested tuples of one form, their arrays stacked along a new axis, by torch or numpy."""
    first = records[0]
    if not isinstance(first, tuple):
        return None if first is None else library.stack(list(records), axis)
    parts = [stacked([record[k] for record in records], library, axis) for k in range(len(first))]
    return type(first)(*parts) if hasattr(first, "_fields") else tuple(parts)
