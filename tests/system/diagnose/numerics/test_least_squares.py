"""Least squares with bounds against SciPy's, and the conditions that tell the solution."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear, nnls

from shipcosim.diagnose.numerics import least_squares


@pytest.mark.parametrize("n, p", [(1, 1), (5, 3), (30, 12), (200, 25)])
@pytest.mark.parametrize("seed", range(20))
def test_solution_is_scipys(n, p, seed):
    random = np.random.default_rng([n, seed])
    columns = random.normal(size=(n, p)) * 10.0 ** random.uniform(-3.0, 3.0, p)
    series = columns @ random.normal(size=p) + random.normal(size=n)
    found = least_squares(columns, series)
    assert np.allclose(
        columns @ found, columns @ nnls(columns, series)[0], atol=1e-9 * np.linalg.norm(series)
    )
    positive = random.random(p) < 0.5
    found = least_squares(columns, series, positive)
    theirs = lsq_linear(
        columns / np.abs(columns).max(0),
        series,
        (np.where(positive, 0.0, -np.inf), np.inf),
        tol=1e-14,
    )
    assert np.sum((columns @ found - series) ** 2) <= 2.0 * theirs.cost * (1.0 + 1e-9) + 1e-18
    assert (found[positive] >= 0.0).all()


@pytest.mark.parametrize("seed", range(20))
def test_slopes_vanish_in_free_columns_and_point_down_in_the_others(seed):
    random = np.random.default_rng(seed)
    columns, series, positive = (
        random.normal(size=(60, 9)),
        random.normal(size=60),
        random.random(9) < 0.7,
    )
    found = least_squares(columns, series, positive)
    slope = columns.T @ (series - columns @ found)
    assert (
        np.allclose(slope[found != 0.0], 0.0, atol=1e-12)
        and (slope[(found == 0.0) & positive] <= 1e-12).all()
    )


def test_columns_that_say_the_same_or_nothing_are_no_trouble():
    column = np.arange(1.0, 6.0)
    columns = np.stack([column, column, np.zeros(5), -column], axis=1)
    assert np.allclose(columns @ least_squares(columns, 3.0 * column), 3.0 * column)
    assert np.allclose(columns @ least_squares(columns, -3.0 * column), -3.0 * column)
    assert (
        not least_squares(columns[:, :3], -column).any()
        and not least_squares(columns, np.zeros(5)).any()
    )
