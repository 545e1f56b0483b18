"""Drift tables against their source."""

import numpy as np

from shipcosim.models.core.tables import parse
from shipcosim.models.ship.load_tables import DRIFT_28M9, DRIFT_33M9


def test_drift_is_that_of_the_source_at_its_frequencies_and_near_between_them(shared):
    """Peaks: 36 kN/m2 in X, 162 kN/m2 in Y, 369 kN.m/m2 in N. The table keeps four digits."""
    path = shared / "reference/data/gunnerus_33p9_veres_wave_drift_U0.csv"
    source = np.genfromtxt(path, delimiter=",", skip_header=2)
    source = source[source[:, 0] <= 2.6].reshape(-1, 19, 5)
    table = np.array(parse(DRIFT_33M9)).reshape(-1, 19, 5)
    kept = np.isin(source[:, 0, 0], table[:, 0, 0])
    np.testing.assert_allclose(table, source[kept], rtol=5e-4, atol=0.08)
    for column, tolerance in ((2, 19.0), (3, 48.0), (4, 30.0)):
        for heading in range(19):
            between = np.interp(source[:, 0, 0], table[:, 0, 0], table[:, heading, column])
            np.testing.assert_allclose(between, source[:, heading, column], rtol=5e-4, atol=tolerance)


def test_drift_of_the_short_ship_is_scaled_with_length():
    long, short = np.array(parse(DRIFT_33M9)), np.array(parse(DRIFT_28M9))
    scale = 28.9 / 33.9
    np.testing.assert_allclose(short, long * [1.0, 1.0, scale, scale, scale**2], rtol=1e-4)
