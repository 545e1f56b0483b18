"""Evidence is the integral over what a cause may be: as large as needed, but paid for."""

import numpy as np
import pytest

from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.innovations import Innovations, gram


def problem(n, truth, seed=0):
    """Innovations y = G θ + w."""
    random = np.random.default_rng(seed)
    G = random.standard_normal((n, len(truth)))
    return G @ np.asarray(truth) + random.standard_normal(n), G


def products(y, G):
    columns = np.column_stack([y, G])
    return columns.T @ columns


def log_normal(y, S):
    return -0.5 * (y @ np.linalg.solve(S, y) + np.linalg.slogdet(S)[1])


@pytest.mark.parametrize("prior", [(1.0, 2.0), (0.1, 0.0), (0.0, 5.0)])
def test_it_is_the_likelihood_of_the_log_with_the_parameters_integrated_out(prior):
    """Closed form: y is normal with covariance I + G diag(prior²) G'."""
    y, G = problem(30, (0.7, -1.1))
    prior = np.array(prior)
    S = np.eye(30) + (G * prior**2) @ G.T
    score, mean, covariance = evidence(products(y, G), prior)
    assert score == pytest.approx(log_normal(y, S) - log_normal(y, np.eye(30)), rel=1e-9)
    expected = prior[:, None] ** 2 * G.T @ np.linalg.solve(S, y[:, None])
    np.testing.assert_allclose(mean, expected[:, 0], atol=1e-9)
    spread = np.diag(prior**2) - (prior[:, None] ** 2 * G.T) @ np.linalg.solve(S, G * prior**2)
    np.testing.assert_allclose(covariance, spread, atol=1e-9)


def test_it_is_the_integral_by_brute_force():
    y, G = problem(12, (0.4, -0.6), seed=1)
    prior = np.array([0.5, 1.2])
    one, other = np.linspace(-4, 4, 801) * prior[0], np.linspace(-4, 4, 801) * prior[1]
    theta = np.stack(np.meshgrid(one, other, indexing="ij"), axis=-1)
    left = y - theta @ G.T
    density = np.exp(-0.5 * (left**2).sum(-1) - 0.5 * ((theta / prior) ** 2).sum(-1)) / (
        2 * np.pi * prior.prod()
    )
    volume = (one[1] - one[0]) * (other[1] - other[0])
    score, mean, _ = evidence(products(y, G), prior)
    assert score == pytest.approx(np.log(density.sum() * volume) + 0.5 * y @ y, abs=1e-3)
    np.testing.assert_allclose(
        mean, (theta * density[..., None]).sum((0, 1)) / density.sum(), atol=1e-3
    )


@pytest.mark.parametrize("centre", [(0.5, -1.0), (3.0, 0.0)])
def test_where_a_linear_problem_is_linearised_changes_nothing(centre):
    y, G = problem(30, (0.7, -1.1), seed=2)
    prior, centre = np.array([1.0, 2.0]), np.array(centre)
    score, mean, covariance = evidence(products(y, G), prior)
    moved = y - G @ centre  # what is left of the log about that ship
    again = evidence(products(moved, G), prior, centre)
    assert again[0] - 0.5 * moved @ moved == pytest.approx(score - 0.5 * y @ y, rel=1e-9)
    np.testing.assert_allclose(again[1], mean, atol=1e-9)
    np.testing.assert_allclose(again[2], covariance, atol=1e-9)


def test_a_small_error_is_explained_by_tolerance_and_no_cause():
    """A coefficient known to 0.05 that is off by 0.05 gains with its tolerance; a cause of size 1 costs more."""
    y, G = problem(4000, (0.05,), seed=3)
    spike, slab = (evidence(products(y, G), np.array([size]))[0] for size in (0.05, 1.0))
    assert spike > 1.0 and spike > slab + 1.5


def test_a_large_error_is_a_cause():
    y, G = problem(4000, (0.8,), seed=3)
    spike, slab = (evidence(products(y, G), np.array([size]))[0] for size in (0.05, 1.0))
    assert slab > spike + 50.0


def test_a_cause_that_the_log_does_not_show_gains_nothing():
    y, G = problem(50, (0.0,), seed=4)
    assert evidence(products(y, 0.0 * G), np.array([1.0])) == (0.0, [0.0], [[1.0]])


def test_a_cause_that_is_not_there_costs_what_its_freedom_is_worth():
    """Occam: at the size of a thousand rows a parameter costs half the logarithm of one plus their information."""
    costs = [
        evidence(products(*problem(1000, (0.0,), seed=s)), np.array([1.0]))[0] for s in range(200)
    ]
    assert np.mean(costs) == pytest.approx(0.5 - 0.5 * np.log(1001.0), abs=0.15)


def test_two_causes_that_do_the_same_share_the_blame():
    y, G = problem(400, (1.0,), seed=5)
    _, mean, covariance = evidence(products(y, np.column_stack([G, G])), np.ones(2))
    assert mean[0] == pytest.approx(mean[1]) and mean.sum() == pytest.approx(1.0, abs=0.15)
    assert covariance[0, 1] < -0.4


def test_products_are_those_of_all_channels_and_rows_and_add_up_by_parts():
    random = np.random.default_rng(6)
    white, determinants = random.standard_normal((50, 2, 6, 4)), random.standard_normal((50, 2))
    found = gram([(0, Innovations(white, determinants))], 50, parts=8)
    for i in range(2):
        rows = white[:, i].reshape(-1, 4)
        np.testing.assert_allclose(found.products[i], rows.T @ rows)
        assert found.free[i] == pytest.approx(
            -0.5 * ((rows[:, 0] ** 2).sum() + determinants[:, i].sum())
        )
    np.testing.assert_allclose(found.blocks.sum(0), found.products)
    first = white[:6, 0].reshape(-1, 4)
    np.testing.assert_allclose(found.blocks[0, 0], first.T @ first)
    stretches = [(a, Innovations(white[a : a + 17], determinants[a : a + 17])) for a in (0, 17, 34)]
    np.testing.assert_allclose(gram(stretches, 50, parts=8).blocks, found.blocks)
