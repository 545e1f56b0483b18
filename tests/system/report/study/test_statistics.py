"""Statistics of the page against closed forms, SciPy, and what they promise of many samples."""

import numpy as np
import pytest
from scipy import stats

from shipcosim.report.study.statistics import (
    distribution,
    explained,
    pareto_front,
)
from shipcosim.sweep.summary import mean, wilson


@pytest.mark.parametrize(("count", "of"), [(0, 10), (3, 10), (10, 10), (57, 64)])
def test_interval_of_a_share_is_that_of_scipy(count, of):
    interval = stats.binomtest(count, of).proportion_ci(method="wilson")
    assert wilson(count, of)[1:] == pytest.approx((interval.low, interval.high), abs=1e-6)


def test_interval_of_a_mean_covers_it_in_95_of_100_samples():
    samples = np.random.default_rng(1).normal(3.0, 2.0, (4000, 60))
    inside = [low <= 3.0 <= high for _, low, high in map(mean, samples)]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.015)


def test_band_holds_the_whole_distribution_in_at_least_95_of_100_samples():
    generator, inside = np.random.default_rng(2), []
    for _ in range(1500):
        reached, share, half = distribution(generator.uniform(size=40))
        inside.append(
            max(np.abs(share - reached).max(), np.abs(share - 1 / 40 - reached).max()) <= half
        )
    assert np.mean(inside) >= 0.94


def test_what_is_never_reached_keeps_the_curve_below_one():
    _, share, _ = distribution([1.0, np.nan, np.inf, 2.0])
    assert share.tolist() == [0.25, 0.5]


def test_explained_share_of_a_known_mixture_and_of_chance():
    generator = np.random.default_rng(3)
    level = generator.integers(0, 4, 20_000).astype(float)
    values = level + generator.normal(0, np.sqrt(level.var()), len(level))
    assert explained(values, level, True) == pytest.approx(0.5, abs=0.02)
    assert explained(values, level + generator.normal(0, 1e-6, len(level)), False) == pytest.approx(
        0.5, abs=0.04
    )
    chance = [
        explained(generator.normal(size=60), generator.integers(0, 6, 60), True) for _ in range(400)
    ]
    assert np.mean([share > 0.0 for share in chance]) < 0.1


def test_too_few_runs_explain_nothing():
    assert np.isnan(explained([1.0, 2.0], [0.0, 1.0], True))
    assert np.isnan(explained([1.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0], True))


@pytest.mark.parametrize("dimensions", [2, 3])
def test_front_is_that_of_comparing_every_point_with_every_other(dimensions):
    points = np.random.default_rng(4).integers(0, 12, (300, dimensions)).astype(float)
    points[::50] = np.nan
    beaten = [
        any((other <= one).all() and (other < one).any() for other in points) for one in points
    ]
    known = np.isfinite(points).all(axis=1)
    assert pareto_front(list(points.T)).tolist() == (~np.array(beaten) & known).tolist()
