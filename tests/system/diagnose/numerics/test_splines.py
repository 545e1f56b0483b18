"""Integrals of splines against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from shipcosim.diagnose.numerics import spline_integral


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6, 100, 1001])
@pytest.mark.parametrize("kind", [float, complex])
@pytest.mark.parametrize("uneven", [0.0, 0.5, 0.999])
def test_integral_is_scipys(n, kind, uneven):
    random = np.random.default_rng(n)
    time = 1e5 + np.cumsum(1.0 - uneven * random.uniform(0.0, 1.0, n))
    series = random.normal(size=(n, 2)).astype(kind)
    series = series + 1j * random.normal(size=(n, 2)) if kind is complex else series
    for values in (series, series[:, 0]):
        theirs = CubicSpline(time, values, axis=0).antiderivative()(time)
        assert np.allclose(spline_integral(time, values), theirs, rtol=1e-11, atol=1e-12 * n)


def test_a_cubic_is_integrated_exactly():
    time = np.array([0.0, 0.3, 1.0, 1.1, 2.7, 4.0])
    assert np.allclose(
        spline_integral(time, time**3 - time), 0.25 * time**4 - 0.5 * time**2, rtol=0.0, atol=1e-13
    )
