"""The regression keeps signs, is not moved by a few wild rows, and its errors are as large as they turn out to be."""

import numpy as np

from shipcosim.diagnose.comparison.regression import regressed

ROWS, BLOCK = 2000, 50


def drawn(seed, keep=0.95):
    """Two columns, and noise that remembers."""
    random = np.random.default_rng(seed)
    columns = np.stack([np.sin(np.arange(ROWS) / 40.0), np.cos(np.arange(ROWS) / 90.0)], axis=1)
    noise = np.zeros(ROWS)
    for row, kick in enumerate(random.standard_normal(ROWS)):
        noise[row] = keep * noise[row - 1] + kick
    return columns, columns @ [2.0, 1.0] + 0.3 * noise


def test_errors_count_for_autocorrelation():
    found = [
        regressed(series, columns, np.zeros(2, bool), BLOCK)
        for columns, series in map(drawn, range(60))
    ]
    spread = np.std([one.coefficients[0] for one in found])
    assert 0.6 < np.mean([one.std[0] for one in found]) / spread < 1.4
    assert 20.0 < np.mean([one.apart for one in found]) < 60.0  # (1 + 0.95) / (1 - 0.95) = 39 rows


def test_a_coefficient_that_must_not_be_negative_is_zero_instead():
    columns, series = drawn(1)
    found = regressed(-series, columns, np.array([True, False]), BLOCK)
    assert found.coefficients[0] == 0.0 and found.std[0] == 0.0 and found.coefficients[1] < -0.5


def test_a_few_wild_rows_do_not_count():
    columns, series = drawn(2)
    wild = series.copy()
    wild[::100] += 500.0
    found, clean = (regressed(one, columns, np.zeros(2, bool), BLOCK) for one in (wild, series))
    np.testing.assert_allclose(found.coefficients, clean.coefficients, atol=0.5)


def test_a_prior_pulls_towards_zero():
    columns, series = drawn(3)
    found = regressed(series, columns, np.zeros(2, bool), BLOCK, np.array([1e-3, np.inf]))
    assert abs(found.coefficients[0]) < 0.1
