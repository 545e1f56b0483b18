"""Data to train on."""

import numpy as np

from shipcosim.learn.datasets import digest, independent, random_walks

RANGES, STEPS = np.array([10.0, 180.0]), np.array([1.0, 10.0])


def test_independent_commands_fill_their_ranges_and_know_nothing_of_one_another():
    drawn = independent(RANGES, 400, 50, np.random.default_rng(0)) / RANGES
    assert abs(drawn).max() <= 1.0
    np.testing.assert_allclose(drawn.std((0, 1)), 3**-0.5, rtol=0.02)
    assert abs(np.mean(drawn[:, 1:] * drawn[:, :-1])) < 0.01


def test_walks_stay_in_their_ranges_fill_them_and_take_no_step_that_is_too_long():
    drawn = random_walks(RANGES, STEPS, 400, 50, np.random.default_rng(0))
    assert (abs(drawn) <= RANGES).all()
    assert (abs(np.diff(drawn, axis=1)) <= STEPS + 1e-9).all()
    np.testing.assert_allclose((drawn / RANGES).std((0, 1)), 3**-0.5, rtol=0.05)


def test_a_walk_turns_back_at_the_end_of_its_range():
    drawn = random_walks(np.array([1.0]), np.array([0.5]), 1, 2000, np.random.default_rng(0))[
        0, :, 0
    ]
    assert drawn.max() > 0.9 and drawn.min() < -0.9


def test_the_digest_tells_data_apart():
    one = np.arange(4.0)
    assert digest(one) == digest(one.copy()) != digest(one + 1e-12)
