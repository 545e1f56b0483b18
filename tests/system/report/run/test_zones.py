"""Zones of a panel over time: beyond a limit of thrust, in a forbidden sector."""

import numpy as np
import pytest
import xarray as xr

from shipcosim.report.run.zones import Zone, angle_zones, thrust_zones


def shown(values, unit="kN", factor=1e-3):
    time = np.arange(len(values), dtype=float)
    return xr.Dataset(
        {"a": ("time", np.array(values, float), {"units": unit, "factor": factor})}, {"time": time}
    )


def test_limit_that_is_far_away_is_not_drawn():
    assert not thrust_zones(shown([-5.0, 20.0]), ["a"], (-30e3, 60e3))


def test_zone_begins_at_the_limit_and_goes_past_the_curve():
    (zone,) = thrust_zones(shown([0.0, 45.0]), ["a"], (-30e3, 60e3))
    assert zone.lower == 60.0 and zone.upper > 60.0
    (zone,) = thrust_zones(shown([-40.0, 0.0]), ["a"], (-30e3, 60e3))
    assert zone.upper == -30.0 and zone.lower < -40.0


def test_unit_that_pushes_one_way_has_no_zone_on_the_other():
    assert not thrust_zones(shown([-1.0, 0.0]), ["a"], (0.0, 60e3))


def test_nothing_is_drawn_of_a_unit_without_limits():
    assert not thrust_zones(shown([0.0, 45.0]), ["a"], None)
    assert not thrust_zones(shown([np.nan]), ["a"], (-1.0, 1.0))


@pytest.mark.parametrize(
    "angles, zones",
    [
        ([0.0, 20.0], []),
        ([0.0, 70.0], [Zone(80.0, 100.0)]),
        ([-70.0, 70.0], [Zone(80.0, 100.0), Zone(-100.0, -80.0)]),
        ([0.0, 50.0], [Zone(80.0, 95.0)]),
        ([170.0, 190.0], []),
        ([350.0, 420.0], [Zone(440.0, 460.0)]),
    ],
)
def test_sectors_are_drawn_beside_the_angles_that_come_near_however_often_they_turned(
    angles, zones
):
    sectors = [tuple(np.radians(sector)) for sector in ((80.0, 100.0), (-100.0, -80.0))]
    found = angle_zones(shown(angles, "deg", 180.0 / np.pi), ["a"], sectors)
    assert [(zone.lower, zone.upper) for zone in found] == [
        pytest.approx((z.lower, z.upper)) for z in zones
    ]
