"""Tridiagonal systems against SciPy's solver of banded ones."""

import numpy as np
import pytest
from scipy.linalg import solve_banded

from shipcosim.diagnose.numerics import solve_tridiagonal


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 8, 33, 1000, 4097])
@pytest.mark.parametrize("shape", [(), (3,), (2, 2)])
def test_solution_is_that_of_scipy(n, shape):
    random = np.random.default_rng(n)
    lower, upper = random.uniform(-1.0, 1.0, (2, n))
    diagonal = random.choice([-1.0, 1.0], n) * (
        np.abs(lower) + np.abs(upper) + random.uniform(1e-3, 1.0, n)
    )
    right = random.normal(size=(n, *shape)) * 10.0 ** random.uniform(
        -6.0, 6.0, (n, *[1] * len(shape))
    )
    bands = np.array([np.r_[0.0, upper[:-1]], diagonal, np.r_[lower[1:], 0.0]])
    theirs = solve_banded((1, 1), bands, right.reshape(n, -1)).reshape(right.shape)
    assert np.allclose(
        solve_tridiagonal(lower, diagonal, upper, right), theirs, rtol=1e-10, atol=1e-11
    )


@pytest.mark.parametrize("gain", [1e-9, 0.01, 1.0])
def test_a_recursion_is_followed_to_rounding(gain):
    """x[k + 1] = (1 - g) x[k] + g y[k], with gains from nearly nothing to all."""
    random = np.random.default_rng(1)
    n, y = 3000, random.normal(size=3000)
    gains = gain * random.uniform(0.5, 1.0, n)
    x = np.zeros(n)
    x[0] = y[0]
    for k in range(n - 1):
        x[k + 1] = (1.0 - gains[k]) * x[k] + gains[k] * y[k]
    right = np.r_[y[0], gains[:-1] * y[:-1]]
    found = solve_tridiagonal(np.r_[0.0, gains[:-1] - 1.0], np.ones(n), np.zeros(n), right)
    assert np.allclose(found, x, rtol=1e-12, atol=1e-13)
