"""How many rare events may happen by chance before a rate is doubted."""

import numpy as np

CHANCE = 3e-4  # that one of the three tests fails although the rates hold: together once in a thousand weeks


def most(chances, allowed=CHANCE):
    """Number of events that is only exceeded with the allowed chance, where each has its own chance.

    >>> most([0.5] * 10, 1 / 1024)
    9
    """
    distribution = np.ones(1)
    for chance in chances:
        distribution = np.convolve(distribution, [1.0 - chance, chance])
    beyond = 1.0 - np.cumsum(distribution)
    return int(np.argmax(beyond < allowed + 1e-12))
