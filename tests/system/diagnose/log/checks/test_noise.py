"""A channel that is much noisier in a part of a log is said with both sizes; motion and single rows are not."""

import numpy as np
import pytest

from shipcosim.diagnose.log.checks.noise import noisier_parts

TIME = np.arange(1200.0)


def log_of(role, values):
    return {"time": TIME, role: values}


def drawn(seed, scale=1.0):
    return scale * np.random.default_rng(seed).standard_normal(len(TIME))


def in_a_third(seed, factor):
    return drawn(seed) * np.where((TIME >= 400.0) & (TIME < 800.0), factor, 1.0)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("factor", [5.0, 20.0])
def test_both_sizes_and_the_times_are_said(seed, factor):
    (text,) = noisier_parts(log_of("north", 0.1 * in_a_third(seed, factor)))
    larger = float(text.split("noise of ")[1].split()[0])
    first, last = (float(word) for word in text.split("from ")[1].split(" s,")[0].split(" to "))
    assert larger == pytest.approx(0.1 * factor, rel=0.15)
    assert first == pytest.approx(400.0, abs=5.0) and last == pytest.approx(799.0, abs=5.0)


@pytest.mark.parametrize("seed", range(20))
def test_even_noise_needs_no_remark(seed):
    assert noisier_parts(log_of("heading", (drawn(seed) + 359.0) % 360.0)) == []


@pytest.mark.parametrize("seed", range(5))
def test_twice_the_noise_is_ordinary(seed):
    assert noisier_parts(log_of("surge", in_a_third(seed, 2.0))) == []


def test_motion_and_single_outliers_are_no_noise():
    turns = np.where(TIME > 600.0, 30.0 * np.sin(TIME / 20.0), 0.0)
    spikes = np.where(np.isin(TIME, [100.0, 700.0, 710.0, 720.0]), 80.0, 0.0)
    assert noisier_parts(log_of("north", turns + spikes + drawn(1, 0.1))) == []


def test_a_rounded_channel_is_compared_with_its_rounding():
    still = np.where(TIME < 600.0, 0.0, np.round(drawn(3, 0.6)))
    assert noisier_parts(log_of("sway", still)) == []


def test_a_channel_without_values_is_passed_over():
    assert noisier_parts(log_of("yaw_rate", np.full(len(TIME), np.nan))) == []
