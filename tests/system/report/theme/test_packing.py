"""Series in whole steps: nothing that a figure shows is lost."""

import numpy as np
import pytest

from shipcosim.report.theme.packing import most_rows, packed_data, packed_series


def unpacked(packed):
    """As the script of the pages does it."""
    if isinstance(packed, list):
        return np.array(packed, float)
    counts, count = [], 0
    for step in packed["steps"]:
        count += step or 0
        counts.append(np.nan if step is None else count * packed["step"])
    return np.array(counts)


@pytest.mark.parametrize("offset", [0.0, 6.5e6, -273.15])
def test_series_is_true_to_a_ten_thousandth_of_its_range(offset):
    values = offset + np.random.default_rng(1).normal(size=500).cumsum()
    packed = packed_series(values)
    assert (
        np.abs(unpacked(packed) - values).max()
        <= 0.5 * packed["step"] * 1.001
        <= np.ptp(values) / 10_000
    )


def test_gaps_and_what_is_not_finite_stay_gaps():
    values = np.array([np.nan, 1.0, np.inf, 3.0, 1e300, -np.inf, 2.0])
    np.testing.assert_allclose(
        unpacked(packed_series(values)), [np.nan, 1.0, np.nan, 3.0, np.nan, np.nan, 2.0]
    )


def test_a_spike_does_not_coarsen_the_rest():
    values = np.random.default_rng(2).normal(size=1000)
    values[500] = 500.0
    assert np.abs(unpacked(packed_series(values)) - values).max() < 0.01


def test_what_happened_before_a_run_diverged_can_be_looked_at():
    values = np.concatenate([np.sin(np.arange(1000) / 50.0), 10.0 ** np.arange(0.0, 30.0)])
    np.testing.assert_allclose(unpacked(packed_series(values)), values, rtol=1e-5)


@pytest.mark.parametrize("values", [[], [4.2], [4.2, 4.2, np.nan], [np.nan, np.nan], [0.0, 5e-324]])
def test_series_without_a_range_are_as_they_were(values):
    np.testing.assert_allclose(unpacked(packed_series(values)), values, atol=1e-300)


def test_times_are_exact():
    time = np.arange(22_001) * 0.05
    assert np.abs(unpacked(packed_series(time, 1e9)) - time).max() < 1e-9


def test_what_a_page_may_hold_keeps_to_its_budget_for_noise_and_takes_more_of_what_is_smooth():
    noise = np.random.default_rng(3).uniform(size=(10, 20_000))
    rows = most_rows(list(noise), 200_000)
    assert len(packed_data([packed_series(column[:rows]) for column in noise])) <= 200_000
    smooth = [np.sin(np.arange(2 * rows) / 500.0 + k) for k in range(10)]
    assert most_rows(smooth, 200_000) == 2 * rows
