"""Gusts against the spectrum asked for, integrated and measured."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.signal import welch

from shipcosim.models.environment.gusts import FREQUENCY_MAX, FREQUENCY_MIN, gust, gust_std, norsok


def variance(low, high, mean_speed):
    """Integral of the spectrum, over the logarithm of the frequency."""
    return quad(
        lambda p: norsok(np.exp(p), mean_speed) * np.exp(p), np.log(low), np.log(high), limit=200
    )[0]


@pytest.mark.parametrize("mean_speed, percent", [(10.0, 10.2), (20.0, 13.2)])
def test_whole_spectrum_has_the_turbulence_intensity_of_the_parameter_sheet(mean_speed, percent):
    found = 100.0 * np.sqrt(variance(1e-6, 10.0, mean_speed)) / mean_speed
    assert found == pytest.approx(percent, abs=0.1)


@pytest.mark.parametrize("mean_speed", [3.0, 10.0, 25.0])
def test_variance_of_the_gusts_is_the_integral_of_the_spectrum_over_the_band(mean_speed):
    assert gust_std(mean_speed) ** 2 == pytest.approx(
        variance(FREQUENCY_MIN, FREQUENCY_MAX, mean_speed), rel=2e-3
    )


def test_a_long_record_has_that_variance_and_no_mean():
    record = gust(0.5 * np.arange(400_000), 10.0, 3)
    assert np.std(record) == pytest.approx(gust_std(10.0), rel=0.01)
    assert abs(np.mean(record)) < 0.01


def test_records_have_the_norsok_spectrum():
    step, speed = 0.5, np.full(40, 10.0)
    record = np.array([gust(step * k, speed, np.arange(40)) for k in range(8192)])
    frequency, density = welch(record, fs=1.0 / step, nperseg=4096, axis=0, detrend=False)
    density = np.mean(density, axis=1)
    edges = (8.0 * 2.0 ** np.arange(7) - 0.5) * frequency[
        1
    ]  # octaves from 0.0037 to 0.25 Hz, each of 7 sinusoids
    for low, high in zip(edges, edges[1:], strict=False):
        inside = (frequency >= low) & (frequency < high)
        found = np.sum(density[inside]) * frequency[1]
        # a sinusoid more or less in the octave is 14 % of it: 2 % over 40 seeds; the rest is the window's leakage
        assert found == pytest.approx(variance(low, high, 10.0), rel=0.06), (low, high)


def test_calm_air_has_no_gusts():
    assert gust(12.0, 0.0, 1) == 0.0


def test_gusts_follow_the_seed():
    assert gust(12.0, 10.0, 1) == gust(12.0, 10.0, 1) != gust(12.0, 10.0, 2)
    with pytest.raises(ValueError, match="seed of the gusts is -3"):
        gust(12.0, 10.0, -3)


def test_floats_arrays_and_tensors_agree():
    torch = pytest.importorskip("torch")
    speeds, seeds = [4.0, 10.0, 17.0], [1, 2, 3]
    expected = [gust(8.0, speed, seed) for speed, seed in zip(speeds, seeds, strict=True)]
    assert all(isinstance(value, float) for value in expected)
    assert_allclose(gust(8.0, np.array(speeds), np.array(seeds)), expected)
    assert_allclose(gust(8.0, torch.tensor(speeds, dtype=torch.float64), np.array(seeds)), expected)
    assert_allclose(gust_std(np.array(speeds)), [gust_std(speed) for speed in speeds])
    assert_allclose(
        gust_std(torch.tensor(speeds, dtype=torch.float64)), [gust_std(speed) for speed in speeds]
    )
