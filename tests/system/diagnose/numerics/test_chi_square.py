"""The tail of the chi-square distribution against SciPy's, and beyond where that is 0."""

import numpy as np
import pytest
from scipy.special import gammaincc
from scipy.stats import chi2

from shipcosim.diagnose.numerics import log_survival, survival

DEGREES = [0.3, 1.0, 2.0, 3.7, 10.0, 55.5, 1000.0, 40000.0]


@pytest.mark.parametrize("degrees", DEGREES)
def test_survival_is_scipys(degrees):
    values = np.concatenate(
        [degrees * np.geomspace(1e-6, 1e3, 200), degrees + np.linspace(-5, 5, 21), [1e-300, 1e-9]]
    )
    for value in values[values >= 0.0].tolist():
        theirs = chi2.sf(value, degrees)
        if theirs > 1e-290:
            assert survival(value, degrees) == pytest.approx(
                theirs, rel=2e-12 + 1e-14 * (degrees + value), abs=0.0
            )
            assert log_survival(value, degrees) == pytest.approx(
                np.log(theirs), rel=1e-12, abs=1e-14 * (degrees + value)
            )


def test_the_far_tail_follows_its_closed_form():
    """Of four degrees of freedom: exp(-x / 2) (1 + x / 2)."""
    for value in (2e3, 1e5, 1e9):
        assert log_survival(value, 4.0) == pytest.approx(
            -value / 2.0 + np.log1p(value / 2.0), rel=1e-13
        )


def test_ends_of_the_range():
    assert (survival(0.0, 3.0), survival(np.inf, 3.0)) == (1.0, 0.0)
    assert np.isnan(survival(np.nan, 3.0)) and gammaincc(1.5, 0.0) == 1.0
