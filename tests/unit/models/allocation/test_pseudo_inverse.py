"""Allocation against hand calculation and scipy's bounded least squares."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.allocation import pseudo_inverse as allocation
from shipcosim.models.allocation.pseudo_inverse import (
    AllocationParameters,
    at_rest,
    design,
    effect,
    load,
)

PARAMETERS = parameters(AllocationParameters)
ALL = (True, True, True)
LONG = 1e3  # s, a step in which the limit of the rate does not matter


def allocate(tau, available=ALL, parameters=PARAMETERS, h=LONG, state=None):
    state = state or at_rest((0.0, 0.0, 0.0), parameters=parameters)
    return allocation.step(
        state, tau, available, h, parameters=parameters, design=design(parameters)
    )


def requests(number, X, Y, N, seed=1):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (number, 3)) * [X, Y, N]


def test_effect_of_each_unit_is_that_of_a_calculation_by_hand():
    half = math.sqrt(0.5)
    port, starboard, tunnel = effect(PARAMETERS)
    assert port == pytest.approx((half, -half, 14.02 * half + 2.0 * half))
    assert starboard == pytest.approx((half, half, -14.02 * half - 2.0 * half))
    assert tunnel == (0.0, 1.0, 14.48)


def test_commands_give_exactly_what_was_asked_within_the_limits():
    for tau in requests(200, 10e3, 10e3, 100e3):
        state = allocate(tuple(tau))
        np.testing.assert_allclose(state[2:5], tau, rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(
            load(state.thrusts, effect(PARAMETERS)), tau, rtol=1e-9, atol=1e-6
        )
        assert not state.saturated


def test_starboard_mirrors_port():
    ahead, mirrored = allocate((4e3, 7e3, 50e3)), allocate((4e3, -7e3, -50e3))
    assert mirrored.thrusts == pytest.approx(
        (ahead.thrusts[1], ahead.thrusts[0], -ahead.thrusts[2])
    )


def test_limits_are_kept_and_said():
    for tau in requests(200, 200e3, 100e3, 2e6):
        state = allocate(tuple(tau))
        assert -30e3 - 1e-6 <= min(state.thrusts[:2]) <= max(state.thrusts[:2]) <= 60e3 + 1e-6
        assert abs(state.thrusts[2]) <= 21.6e3 + 1e-6
        assert state.saturated == (np.linalg.norm((tau - state[2:5]) / [1.0, 1.0, 14.0]) > 1.0)


def test_what_one_unit_cannot_give_is_shared_nearly_as_well_as_scipy_does():
    lsq_linear = pytest.importorskip("scipy.optimize").lsq_linear
    scale = np.diag([1.0, 1.0, 1.0 / PARAMETERS.yaw_lever])
    matrix = scale @ np.array(effect(PARAMETERS)).T
    low, high = [-30e3, -30e3, -21.6e3], [60e3, 60e3, 21.6e3]
    excess = []
    for tau in requests(300, 20e3, 60e3, 600e3):
        best = lsq_linear(matrix, scale @ tau, (low, high))
        found = np.linalg.norm(scale @ (tau - allocate(tuple(tau))[2:5]))
        excess.append(found - np.linalg.norm(best.fun))
    assert min(excess) > -1.0  # N: it cannot do better than the best
    assert np.median(excess) < 1.0 and max(excess) < 3e3


def test_where_several_thrusts_give_the_load_the_cheapest_are_taken():
    minimize = pytest.importorskip("scipy.optimize").minimize
    astride = replace(
        PARAMETERS, port_azimuth=0.5 * math.pi, starboard_azimuth=0.5 * math.pi, tunnel_weight=3.0
    )
    matrix = np.array(effect(astride)).T[1:]  # nothing gives surge; sway and yaw have three units
    state = allocate((0.0, 9e3, 20e3), parameters=astride)
    price = np.array([1.0, 1.0, 3.0])
    demand = {"type": "eq", "fun": lambda f: (matrix @ (1e3 * f) - [9e3, 20e3]) / [1e3, 14e3]}
    best = minimize(lambda f: f @ (price * f), np.zeros(3), constraints=[demand], tol=1e-12)
    np.testing.assert_allclose(state.thrusts, 1e3 * best.x, rtol=1e-4, atol=0.1)


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_missing_unit_gets_nothing_and_the_others_still_give_the_forces(missing):
    available = tuple(unit != missing for unit in range(3))
    state = allocate((3e3, -4e3, 20e3), available)
    assert state.thrusts[missing] == 0.0
    assert state[2:4] == pytest.approx((3e3, -4e3), abs=100.0)  # the moment weighs a little too
    assert state.saturated  # the moment is missed, which is said


def test_without_any_unit_there_is_no_command():
    state = allocate((3e3, -4e3, 20e3), (False, False, False))
    assert (*state.thrusts, *state[2:5]) == (0.0,) * 6


def test_failed_unit_is_given_up_at_once_and_taken_back_at_the_rate():
    before = allocate((8e3, 4e3, 0.0))
    failed = allocate((8e3, 4e3, 0.0), (True, True, False), h=0.05, state=before)
    back = allocate((8e3, 4e3, 0.0), h=0.05, state=failed)
    assert failed.thrusts[2] == 0.0 and abs(before.thrusts[2]) > 100.0
    assert abs(back.thrusts[2]) == pytest.approx(50.0)


def test_commands_move_no_faster_than_the_rate_and_their_load_is_that_of_the_moved_commands():
    state = allocate((20e3, 5e3, 0.0), h=0.05)
    assert max(abs(f) for f in state.thrusts) == pytest.approx(50.0)
    np.testing.assert_allclose(
        state[2:5], np.array(effect(PARAMETERS)).T @ state.thrusts, atol=1e-9
    )
    assert not state.saturated


def test_many_at_once_get_what_each_gets():
    tau = requests(50, 40e3, 60e3, 600e3)
    tunnel = np.arange(50) % 3 > 0
    start = at_rest((np.zeros(50),) * 3, parameters=PARAMETERS)
    together = allocate(tuple(tau.T), (True, True, tunnel), state=start)
    for i, row in enumerate(tau):
        alone = allocate(tuple(row.tolist()), (True, True, bool(tunnel[i])))
        found = [part[i] for part in (*together.thrusts, *together[2:])]
        np.testing.assert_allclose(found, (*alone.thrusts, *alone[2:]), rtol=1e-9, atol=1e-6)


def test_each_variation_may_have_its_own_angles():
    angles = np.array([-0.5, -1.0])
    together = allocate((np.full(2, 5e3),) * 3, parameters=replace(PARAMETERS, port_azimuth=angles))
    alone = allocate((5e3,) * 3, parameters=replace(PARAMETERS, port_azimuth=-1.0))
    assert [part[1] for part in together.thrusts] == pytest.approx(list(alone.thrusts))
