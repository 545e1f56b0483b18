"""Random streams of a log: one for each part of it, and how they go on when the log does."""

import zlib

import numpy as np


def stream(kind, seed, name):
    """Random generator of its own for one part of one log."""
    return np.random.default_rng([seed, zlib.crc32(kind.encode()), zlib.crc32(name.encode())])


class Lengthened:
    """A generator whose series go on after they would have ended, what comes before staying as it was.

    Parameters
    ----------
    first, then : numpy.random.Generator
        Of the series as they were, and of what comes after.
    lengths : dict of int to int
        By the length of a series, how long it was.
    """

    def __init__(self, first, then, lengths):
        self.first, self.then, self.lengths = first, then, lengths
        self.uniform = first.uniform

    def standard_normal(self, size=None):
        """Normal numbers; the last axis of a series is time."""
        shape = () if size is None else np.atleast_1d(size)
        if not len(shape) or shape[-1] not in self.lengths:
            return self.first.standard_normal(size)
        short = self.lengths[int(shape[-1])]
        parts = (self.first, short), (self.then, shape[-1] - short)
        return np.concatenate(
            [rng.standard_normal((*shape[:-1], rows)) for rng, rows in parts], axis=-1
        )
