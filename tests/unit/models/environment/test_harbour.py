"""Wind and current in a harbour: limits at the berth, at sea, and in the river."""

from dataclasses import replace

import numpy as np
import pytest

from shipcosim.models.environment.harbour import HarbourParameters, local_current, local_wind

BERTH = HarbourParameters(
    wind_shelter=0.6,
    land_towards=np.pi / 2,
    tide_shelter=0.5,
    channel=0.0,
    river_speed=0.4,
    river_to=0.0,
    river_x=100.0,
)


def test_without_land_and_river_harbour_is_open_sea():
    assert local_wind(3.0, 4.0, -5.0, 2.0, harbour=HarbourParameters()) == (-5.0, 2.0)
    far = local_current(5000.0, 0.0, 0.3, -0.1, harbour=HarbourParameters())
    assert far == pytest.approx((0.3, -0.1))


def test_land_takes_from_wind_off_it_and_nothing_from_wind_along_or_onto_it():
    off = local_wind(0.0, 0.0, 0.0, -10.0, harbour=BERTH)  # from the east, where land is
    assert off == pytest.approx((0.0, -4.0))
    for onto in ((0.0, 10.0), (10.0, 0.0)):
        assert local_wind(0.0, 0.0, *onto, harbour=BERTH) == pytest.approx(onto)


def test_tide_at_the_berth_flows_along_the_channel_alone():
    berth = replace(BERTH, river_speed=0.0)
    assert local_current(0.0, 0.0, 0.3, 0.2, harbour=berth) == pytest.approx((0.15, 0.0))


def test_jet_of_the_river_keeps_its_momentum():
    """The flux of momentum through any section ahead of the mouth is the same: a free plane jet."""
    across = np.linspace(-3000.0, 3000.0, 20001)
    speeds = [
        local_current(100.0 + s, across, 0.0, 0.0, harbour=BERTH)[0] for s in (0.0, 200.0, 800.0)
    ]
    momentum = [np.trapezoid(speed**2, across) for speed in speeds]
    assert momentum == pytest.approx([momentum[0]] * 3, rel=1e-6)
    assert max(speeds[2]) < max(speeds[0]) == pytest.approx(0.4)
