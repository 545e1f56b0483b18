"""What DP will do is predicted, once it is told: in co-simulation, with all that the ship does not know."""

import numpy as np
import pytest

LEGS = {
    "B": (2.0, 250.0),
    "C": (252.0, 450.0),
    "D": (452.0, 650.0),
    "E": (652.0, 850.0),
    "F": (852.0, 1100.0),
}


@pytest.mark.parametrize("leg", LEGS)
def test_four_corners_are_predicted_a_minute_ahead(run_scenario, leg):
    """From when each is told. Other ships and weather: docs/generated/dp_prediction.md."""
    table, (told, ended) = run_scenario("four_corner"), LEGS[leg]
    time, ahead = table["time"].values, 120  # rows in 60 s
    rows = np.flatnonzero((time >= told) & (time + 60.0 <= ended) & (time % 1.0 == 0.0))
    off = [
        table[f"predictor.{axis}_60"].values[rows] - table[f"vessel.{axis}"].values[rows + ahead]
        for axis in "xy"
    ]
    assert np.hypot(*off).mean() < 0.3
    turned = table["predictor.psi_60"].values[rows] - table["vessel.psi"].values[rows + ahead]
    assert np.degrees(np.abs(turned)).mean() < 1.0
