"""At night: dead reckoning learned: worlds apart, inputs, networks, filter, regions."""

import pytest

from shipcosim.learn.dead_reckoning import worlds


def test_records_are_repeated_to_the_digit():
    one, other = (worlds.recorded([worlds.drawn(1)], 60.0, lambda *_: None) for _ in range(2))
    assert all((one.measured[name] == other.measured[name]).all() for name in worlds.MEASURED)
