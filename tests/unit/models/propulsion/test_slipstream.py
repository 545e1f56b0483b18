"""Where a slipstream goes, and how it falls off beside its axis."""

from math import atan2, e, pi, radians

import numpy as np
import pytest

from shipcosim.models.propulsion.slipstream import slipstream_share

WIDTH = radians(20.0)


def share(x, y, azimuth, rpm=120.0):
    return slipstream_share(x, y, radians(azimuth), rpm, width=WIDTH)


@pytest.mark.parametrize(
    ("azimuth", "x", "y"),
    [(0.0, -5.0, 0.0), (90.0, 0.0, -4.0), (-90.0, 0.0, 4.0), (180.0, 3.0, 0.0), (45.0, -2.0, -2.0)],
)
def test_the_water_goes_opposite_to_the_thrust(azimuth, x, y):
    """Pushing ahead it goes aft, pushing to starboard it goes to port."""
    assert share(x, y, azimuth) == pytest.approx(1.0)
    assert share(-x, -y, azimuth) < 1e-30


def test_astern_it_goes_where_the_unit_points():
    assert share(0.0, 4.0, 90.0, rpm=-120.0) == pytest.approx(1.0)
    assert share(0.0, -4.0, 90.0, rpm=-120.0) < 1e-30


def test_a_shaft_that_stands_has_none():
    assert share(0.0, -4.0, 90.0, rpm=0.0) == 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_falls_to_one_e_th_one_width_off_its_axis_at_any_distance(side):
    for distance in (1.0, 30.0):
        assert share(0.0, -distance, 90.0 + side * 20.0) == pytest.approx(1.0 / e)
        assert share(0.0, -distance, 90.0 + side * 40.0) == pytest.approx(1.0 / e**4)


def test_integrated_over_all_directions_it_is_a_gaussian():
    angles = np.linspace(-180.0, 180.0, 3601)[:-1]
    found = slipstream_share(1.0, 2.0, np.radians(angles), 80.0, width=WIDTH)
    assert np.sum(found) * radians(0.1) == pytest.approx(WIDTH * pi**0.5, rel=1e-6)
    assert angles[np.argmax(found)] == pytest.approx(np.degrees(atan2(2.0, 1.0)) - 180.0, abs=0.1)
