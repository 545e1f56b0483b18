"""Quantiles are those of NumPy, to the last bit."""

import numpy as np

from shipcosim.diagnose.numerics import quantile


def test_quantiles_are_those_of_numpy():
    random = np.random.default_rng(1)
    for count in (1, 2, 3, 4, 10, 11, 1200):
        values = random.normal(size=count) * 10.0 ** random.integers(-3, 5)
        for share in (0.0, 0.2, 0.4, 0.5, 0.8, 0.95, 1.0, random.random()):
            assert quantile(values, share) == np.quantile(values, share)


def test_a_series_is_not_changed():
    values = np.array([3.0, 1.0, 2.0])
    assert quantile(values, 0.5) == 2.0 and values.tolist() == [3.0, 1.0, 2.0]
