"""The level between position and integrated velocity leaves white innovations of unit size."""

import numpy as np
import pytest

from shipcosim.diagnose.log.checks.kinematics import (
    Filter,
    filter_for,
    heading_motion,
    is_clear,
    whiteness,
)
from shipcosim.diagnose.log.readings.parts import mislabelled

TIME = np.arange(4000.0)


def log(heading_noise, rate_noise, turning=1.0, seed=1):
    random = np.random.default_rng(seed)
    true = 20.0 * turning * np.sin(TIME / 60.0)
    rate = turning * np.cos(TIME / 60.0) / 3.0
    heading = true + heading_noise * random.normal(size=len(TIME))
    return {
        "time": TIME,
        "heading": heading,
        "yaw_rate": rate + rate_noise * random.normal(size=len(TIME)),
    }


@pytest.mark.parametrize(("heading_noise", "rate_noise"), [(0.1, 0.05), (1.0, 0.01), (0.1, 0.1)])
def test_innovations_of_a_right_log_are_white_and_of_unit_size(heading_noise, rate_noise):
    motion = heading_motion(log(heading_noise, rate_noise))
    white = filter_for(motion)[0](motion.level)[20:, 0]
    assert np.std(white) == pytest.approx(1.0, abs=0.1)
    for lag in (1, 2, 5):
        assert abs(np.corrcoef(white[lag:], white[:-lag])[0, 1]) < 0.1
    assert whiteness(white[:, None]) < 1.3


def test_the_filter_is_the_recursion_of_kalman():
    random = np.random.default_rng(2)
    gains, level = random.uniform(0.1, 0.9, 50), random.normal(size=(50, 2))
    gains[[0, 20]] = 1.0
    state, expected = level[0], []
    for row, gain in zip(level, gains, strict=True):
        expected.append((row - state) * (gain < 1.0))
        state = state + gain * (row - state)
    assert Filter(gains, np.ones(50))(level) == pytest.approx(np.array(expected), abs=1e-12)


def test_a_wave_of_six_seconds_is_integrated_at_one_hertz():
    wave = {"time": TIME, "heading": TIME, "yaw_rate": np.cos(TIME * 2 * np.pi / 6.0)}
    motion = heading_motion(wave)
    way = (motion.seen - motion.level)[:, 0]
    exact = np.sin(TIME * 2 * np.pi / 6.0) * 6.0 / (2 * np.pi)
    assert np.max(np.abs(way - exact)[10:-10]) < 0.02


def test_rows_across_a_hole_are_not_compared():
    holed = {role: np.delete(values, slice(100, 140)) for role, values in log(0.1, 0.05).items()}
    assert heading_motion(holed).starts.nonzero()[0].tolist() == [0, 100]


def test_only_a_ship_that_moves_can_show_units():
    for turning, clear in ((1.0, True), (0.0, False)):
        motion = heading_motion(log(0.1, 0.05, turning))
        assert is_clear(motion, filter_for(motion)[0]) is clear


def test_innovations_that_hang_together_count_less():
    random = np.random.default_rng(3).normal(size=5000)
    smooth = np.convolve(random, np.ones(5) / 5**0.5, "same")
    assert whiteness(smooth[:, None]) == pytest.approx(5.0, rel=0.3)


@pytest.mark.parametrize("digits", [4, 5])
@pytest.mark.parametrize("lost", [False, True])
def test_what_rounding_leaves_of_a_ship_at_rest_is_no_wrong_label(digits, lost):
    """As AIS has it: positions to some metres, speed to 0.1 kn, heading to a degree."""
    time = np.arange(600.0)
    north = 8.0 * np.tanh((time - 100.0) / 60.0)
    east = -8.0 * np.tanh((time - 300.0) / 60.0)
    speeds = [np.gradient(way, time) + 0.01 * np.sin(time / 11.0) for way in (north, east)]
    step = 111320.0 * 10.0**-digits
    rounded = {
        "time": time,
        "north": np.round(north / step) * step,
        "east": np.round(east / step) * step,
        "heading": np.round(3.0 * np.sin(time / 70.0)),
        "surge": np.round(speeds[0] / 0.05144) * 0.05144,
        "sway": np.round(speeds[1] / 0.05144) * 0.05144,
    }
    if lost:
        rounded["heading"][50:60] = np.nan
    assert mislabelled(rounded, {})[0] == []
