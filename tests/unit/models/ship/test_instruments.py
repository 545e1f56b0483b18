"""What a log shows: against motion differentiated by hand, its inverse, and a lag against the motion itself."""

from math import cos, pi, radians, sin

import pytest

from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.instruments import history_with, motion_at, readings, true_motion

TURN = dict(speed=2.0, rate=0.05)


def circle(t):
    """A ship going round ahead at a steady rate, crabbing by 0.3 m/s to starboard."""
    speed, rate = TURN["speed"], TURN["rate"]
    psi = 0.4 + rate * t
    x = (speed * (sin(psi) - sin(0.4)) + 0.3 * (cos(psi) - cos(0.4))) / rate
    y = (speed * (cos(0.4) - cos(psi)) + 0.3 * (sin(psi) - sin(0.4))) / rate
    return x, y, (psi + pi) % (2.0 * pi) - pi, speed, 0.3, rate


def test_a_perfect_log_shows_the_ship():
    assert readings(*circle(30.0)) == pytest.approx(circle(30.0))


def test_position_and_velocity_are_both_the_antennas():
    """The shown velocity, turned north and east, is the rate of the shown position."""
    lever = dict(lever_x=6.0, lever_y=-3.0)
    before, now, after = (readings(*circle(t), **lever) for t in (19.99, 20.0, 20.01))
    north, east = (after.x - before.x) / 0.02, (after.y - before.y) / 0.02
    c, s = cos(now.psi), sin(now.psi)
    assert (c * now.u - s * now.v, s * now.u + c * now.v) == pytest.approx((north, east), abs=1e-5)
    at_rest = readings(10.0, 20.0, pi / 2, 0.0, 0.0, 0.0, lever_x=6.0, lever_y=0.0)
    assert (at_rest.x, at_rest.y) == pytest.approx((10.0, 26.0))


@pytest.mark.parametrize("bias", [-0.2, 0.1])
def test_with_a_wrong_heading_the_shown_velocity_still_leads_where_the_ship_goes(bias):
    """Surge and sway are resolved with the measured heading: turned back with it, they are the true velocity."""
    true, log = circle(50.0), readings(*circle(50.0), heading_bias=bias)
    assert (log.psi - true[2] + pi) % (2.0 * pi) - pi == pytest.approx(bias)
    c, s = cos(log.psi), sin(log.psi)
    C, S = cos(true[2]), sin(true[2])
    earth = C * true[3] - S * true[4], S * true[3] + C * true[4]
    assert (c * log.u - s * log.v, s * log.u + c * log.v) == pytest.approx(earth)


def test_velocity_scale_is_logged_over_true_and_leaves_position_and_rate():
    true, log = circle(10.0), readings(*circle(10.0), velocity_scale=1.1)
    assert log == pytest.approx((*true[:3], 1.1 * true[3], 1.1 * true[4], true[5]))


def test_motion_of_is_the_inverse():
    errors = dict(heading_bias=0.2, lever_x=5.0, lever_y=-2.0, velocity_scale=0.9)
    for t in (0.0, 40.0, 77.0):
        assert true_motion(*readings(*circle(t), **errors), **errors) == pytest.approx(circle(t))


@pytest.mark.parametrize(
    ("lag", "off"), [(0.0, 3e-4), (0.03, 2e-4), (0.05, 1e-4), (0.4, 1e-4), (1.13, 1e-4)]
)
def test_recalled_lag_ago_is_the_motion_lag_ago(lag, off):
    """Stepped at 0.05 s through a heading of 180 deg; linear between steps leaves 1e-4 m, and beyond the last more."""
    h, history = 0.05, ((0.0, Motion(*circle(0.0))),)
    for k in range(1400):
        history = history_with(history, k * h, Motion(*circle(k * h)), (k + 1) * h - lag)
        then = (k + 1) * h - lag
        if then >= 0.0 and k > 0:
            assert motion_at(history, then) == pytest.approx(circle(then), abs=off), then
    assert len(history) <= lag / h + 3


def test_before_the_start_all_is_as_at_the_start():
    first = Motion(*circle(0.0))
    history = history_with(((0.0, first),), 0.0, first, -2.0)
    assert motion_at(history, -1.5) == pytest.approx(first)


def test_a_heading_is_interpolated_the_shorter_way():
    at = [Motion(0.0, 0.0, radians(angle), 0.0, 0.0, 0.0) for angle in (179.0, -179.0)]
    assert abs(motion_at(((0.0, at[0]), (1.0, at[1])), 0.25).psi) == pytest.approx(radians(179.5))
