"""The offline optimum against scipy's general optimiser and a calculation by hand."""

from math import pi, radians

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.allocation import optimal
from shipcosim.models.allocation.static_optimum import static_optimum

UNITS = optimal.design(parameters(optimal.OptimalParameters)).units
CONES = [[(radians(-80), radians(80)), (radians(100), radians(260))]] * 2 + [[]]
REQUESTS = np.random.default_rng(1).normal(size=(12, 3)) * [6e3, 8e3, 6e4]


def test_surge_alone_is_shared_by_two_azimuths_that_point_ahead():
    found = static_optimum(np.array([[8e3, 0.0, 0.0]]), UNITS, CONES, yaw_lever=14.0)
    np.testing.assert_allclose(found.thrusts[0], [4e3, 4e3, 0.0], atol=1.0)
    assert found.power[0] == pytest.approx(2.0 * 4e3**1.5, rel=1e-4)


def test_thrusts_and_angles_give_the_load():
    found = static_optimum(REQUESTS, UNITS, CONES, yaw_lever=14.0)
    X = (found.thrusts * np.cos(found.azimuths)).sum(-1)
    np.testing.assert_allclose(X + found.missed[:, 0], REQUESTS[:, 0], atol=1e-6)
    assert np.abs(found.missed).max() < 0.5
    aside = np.abs(
        np.degrees(np.arctan2(np.sin(found.azimuths[:, :2]), np.cos(found.azimuths[:, :2])))
    )
    assert not ((aside > 80.001) & (aside < 99.999) & (found.thrusts[:, :2] > 1e-3)).any()


def test_scipy_finds_nothing_cheaper():
    minimize = pytest.importorskip("scipy.optimize").minimize
    found = static_optimum(REQUESTS, UNITS, CONES, yaw_lever=14.0)
    draw = np.random.default_rng(2)

    def load(v):
        X, Y = v[0] + v[2], v[1] + v[3] + v[4]
        N = (
            sum(UNITS[i].x * v[2 * i + 1] - UNITS[i].y * v[2 * i] for i in range(2))
            + UNITS[2].x * v[4]
        )
        return np.array([X, Y, N / 14.0])

    def power(v):
        sizes = np.hypot(v[[0, 2]], v[[1, 3]]) ** 2 + 1e-12
        return (sizes**0.75).sum() + UNITS[2].price * (v[4] ** 2 + 1e-12) ** 0.75

    for tau, best in zip(REQUESTS, found.power, strict=True):
        goal, cheapest = tau / [1e3, 1e3, 14e3], np.inf
        for ahead in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            edges = [
                {
                    "type": "ineq",
                    "fun": lambda v, i=i, s=s, e=e: (
                        s * v[2 * i] - e * v[2 * i + 1] / np.tan(radians(80))
                    ),
                }
                for i, s in enumerate(ahead)
                for e in (1, -1)
            ]
            edges.append({"type": "eq", "fun": lambda v, goal=goal: load(v) - goal})
            for _ in range(2):
                tried = minimize(
                    power, draw.normal(size=5), constraints=edges, options={"maxiter": 300}
                )
                if tried.success:
                    cheapest = min(cheapest, tried.fun * 1e3**1.5)
        assert best == pytest.approx(cheapest, rel=2e-3)


def test_what_cannot_be_given_is_missed_least():
    found = static_optimum(np.array([[500e3, 0.0, 0.0]]), UNITS, CONES, yaw_lever=14.0)
    assert found.thrusts[0, :2] == pytest.approx([60e3, 60e3], rel=1e-6)
    assert found.missed[0, 0] == pytest.approx(380e3, rel=1e-4)


def test_interval_that_is_not_convex_is_refused():
    with pytest.raises(ValueError, match="more than half a circle"):
        static_optimum(np.zeros((1, 3)), UNITS, [[(0.0, 1.2 * pi)]] * 2 + [[]], yaw_lever=14.0)
