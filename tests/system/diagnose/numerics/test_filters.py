"""Filters against SciPy's."""

import numpy as np
import pytest
from scipy import ndimage

from shipcosim.diagnose.numerics import gaussian_filter, moving_average


@pytest.mark.parametrize("ends, mode", [("reflected", "reflect"), ("held", "nearest")])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("n, width", [(1, 2.0), (7, 0.1), (7, 30.0), (500, 3.7), (500, 200.0)])
def test_gaussian_filter_is_scipys(ends, mode, order, n, width):
    series = np.random.default_rng(n).normal(size=(n, 2, 3))
    for axis in (0, -1):
        theirs = ndimage.gaussian_filter1d(series, width, order=order, mode=mode, axis=axis)
        ours = gaussian_filter(series, width, order=order, ends=ends, axis=axis)
        assert np.allclose(ours, theirs, rtol=1e-12, atol=1e-13 * width**-order)


@pytest.mark.parametrize(
    "n, rows", [(1, 1), (1, 4), (9, 2), (9, 3), (9, 40), (2000, 41), (2000, 300)]
)
def test_moving_average_is_scipys(n, rows):
    series = np.random.default_rng(rows).normal(size=n)
    assert np.allclose(
        moving_average(series, rows), ndimage.uniform_filter1d(series, rows), rtol=1e-12, atol=1e-13
    )


def test_a_row_without_a_value_spoils_only_the_rows_about_it():
    series = np.arange(50.0)
    series[20] = np.nan
    assert np.flatnonzero(np.isnan(moving_average(series, 5))).tolist() == [18, 19, 20, 21, 22]
