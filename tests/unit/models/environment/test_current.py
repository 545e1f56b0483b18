"""A varying current: its ends, its way between them, and the shorter turn."""

from math import cos, degrees, hypot, radians, sin

import numpy as np
import pytest

from shipcosim.models.environment.current import varying_current

SPAN = dict(time_start=100.0, time_end=300.0)


def vector(speed, to):
    return speed * cos(radians(to)), speed * sin(radians(to))


@pytest.mark.parametrize(("t", "end"), [(0.0, 0), (100.0, 0), (300.0, 1), (900.0, 1)])
def test_it_is_the_given_one_at_and_beyond_its_ends(t, end):
    ends = (0.3, -0.1), (-0.05, 0.2)
    speed, to = varying_current(t, *ends[0], *ends[1], **SPAN)
    assert (speed * cos(to), speed * sin(to)) == pytest.approx(ends[end])


def test_speed_and_direction_change_at_constant_rates_the_shorter_way():
    """From 0.2 m/s at 150 deg to 0.4 m/s at -140 deg: 70 deg through south."""
    t = np.linspace(100.0, 300.0, 21)
    speed, to = varying_current(t, *vector(0.2, 150.0), *vector(0.4, -140.0), **SPAN)
    np.testing.assert_allclose(speed, np.linspace(0.2, 0.4, 21))
    np.testing.assert_allclose(np.unwrap(to), np.radians(np.linspace(150.0, 220.0, 21)))


@pytest.mark.parametrize("still_first", [True, False])
def test_a_current_that_grows_or_dies_down_keeps_its_direction(still_first):
    ends = ((0.0, 0.0), (0.1, -0.3)) if still_first else ((0.1, -0.3), (0.0, 0.0))
    speed, to = varying_current(200.0, *ends[0], *ends[1], **SPAN)
    assert speed == pytest.approx(0.5 * hypot(0.1, -0.3))
    assert degrees(to) == pytest.approx(degrees(np.arctan2(-0.3, 0.1)))


def test_no_current_at_both_ends_is_none():
    assert varying_current(200.0, 0.0, 0.0, 0.0, 0.0, **SPAN)[0] == 0.0
