"""Single samples that are no measurement, at the ends of a log too."""

import numpy as np
import pytest

from shipcosim.diagnose.log.checks.samples import outliers

SURGE = 1.0 + 0.02 * np.random.default_rng(1).standard_normal(300)


@pytest.mark.parametrize("row", [0, 100, -1])
def test_a_start_up_row_is_an_outlier_like_any_other(row):
    """As logged by an Otter: 900 km/s in the first row."""
    surge = SURGE.copy()
    surge[row] = 9e5
    assert np.flatnonzero(outliers({"surge": surge})["surge"]).tolist() == [row % 300]


def test_a_ship_that_accelerates_at_the_end_has_no_outlier():
    surge = SURGE + np.maximum(np.arange(300) - 290, 0) * 0.1
    assert not outliers({"surge": surge})["surge"].any()
    assert not outliers({"surge": np.arange(9.0)})["surge"].any()
