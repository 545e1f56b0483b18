"""The worlds of paper II's test."""

import math
from collections.abc import Sequence

import numpy as np

from shipcosim.learn.dead_reckoning.worlds import SEA_STATES, World, world_of


def tested(seed: int, sea_state: int, direction: float) -> World:
    """A world of paper II's test: one sea state and direction, after the previous one.

    Parameters
    ----------
    seed : int
        Seed of all that is random. [1]
    sea_state : int
        Row of `SEA_STATES`. [1]
    direction : float
        Where wind and waves come from; the ship heads north. [rad]

    Returns
    -------
    World
    """
    # The wind before the change is that of the previous sea state in the sequence.
    first = sea_state == 0
    wind = (
        SEA_STATES[sea_state - 1][1],
        SEA_STATES[sea_state][1],
    )  # -1: the last of the direction before
    # The first sea state of a direction comes from 30 deg before it; then the direction holds.
    towards = direction - math.radians(30.0) if first else direction, direction
    return world_of(
        seed, SEA_STATES[sea_state][0], wind, towards, np.random.default_rng([26, seed])
    )


def worlds_of_test(seeds: Sequence[int]) -> list[World]:
    """Worlds of the test, direction by direction, with rising sea states: 48 of 48 seeds."""
    return [tested(seed, n % 4, math.radians(30.0 * (n // 4 % 12))) for n, seed in enumerate(seeds)]
