"""Allocation over rectangular force components: loads are met, limits kept, units turn no faster than they may."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.angles import wrap
from shipcosim.models.allocation.extended import ExtendedParameters, at_rest, design, step
from shipcosim.models.allocation.pseudo_inverse import effect

PARAMETERS = parameters(ExtendedParameters)
ALL = (True, True, True)
LONG = 1e3  # s, a step in which limits of rates do not matter


def allocate(tau, available=ALL, parameters=PARAMETERS, h=LONG, state=None):
    state = state or at_rest((0.0, 0.0, 0.0), parameters=parameters)
    return step(state, tau, available, h, parameters=parameters, design=design(parameters))


def requests(number, X, Y, N, seed=1):
    return [
        tuple(row)
        for row in (
            np.random.default_rng(seed).uniform(-1.0, 1.0, (number, 3)) * [X, Y, N]
        ).tolist()
    ]


def load_of(state, parameters=PARAMETERS):
    """Load of thrusts at their angles, by the configuration matrix of the fixed angles."""
    turned = replace(
        parameters, port_azimuth=state.azimuths[0], starboard_azimuth=state.azimuths[1]
    )
    return np.array(effect(turned)).T @ state.thrusts


def test_commands_give_what_was_asked_within_the_limits():
    for tau in requests(200, 15e3, 10e3, 100e3):
        state = allocate(tau)
        small = min(math.hypot(*force) for force in forces_of(state)) < PARAMETERS.turning_thrust
        np.testing.assert_allclose(state[2:5], tau, rtol=1e-9, atol=1e-6 if not small else 1e4)
        np.testing.assert_allclose(load_of(state), state[2:5], rtol=1e-9, atol=1e-6)
        assert not state.saturated


def forces_of(state):
    return [
        (f * math.cos(a), f * math.sin(a))
        for f, a in zip(state.thrusts[:2], state.azimuths[:2], strict=True)
    ]


def test_no_other_thrusts_give_the_load_at_a_lower_price():
    """Against the closed form of the least norm, B⁺ τ."""
    matrix = np.array(design(PARAMETERS).effect).T
    for tau in requests(50, 15e3, 10e3, 100e3, seed=2):
        least = np.linalg.norm(np.linalg.pinv(matrix) @ tau)
        assert np.linalg.norm(allocate(tau).thrusts) == pytest.approx(least, rel=0.01)


def test_starboard_mirrors_port():
    ahead, mirrored = allocate((4e3, 7e3, 50e3)), allocate((4e3, -7e3, -50e3))
    assert mirrored.thrusts == pytest.approx(
        (ahead.thrusts[1], ahead.thrusts[0], -ahead.thrusts[2])
    )
    assert mirrored.azimuths[:2] == pytest.approx((-ahead.azimuths[1], -ahead.azimuths[0]))


def test_limits_of_thrust_are_kept_and_said():
    for tau in requests(200, 200e3, 100e3, 2e6):
        state = allocate(tau)
        assert max(state.thrusts[:2]) <= 60e3 + 1e-6 and abs(state.thrusts[2]) <= 21.6e3 + 1e-6
        missed = (np.array(tau) - load_of(state)) / [1.0, 1.0, PARAMETERS.yaw_lever]
        assert state.saturated or np.linalg.norm(missed) <= 1.01


def test_units_turn_and_push_no_faster_than_they_may_however_the_request_jumps():
    state, h = at_rest((0.0, 0.0, 0.0), parameters=PARAMETERS), 0.05
    made = design(PARAMETERS)
    for tau in requests(500, 100e3, 60e3, 1e6, seed=3):
        new = step(state, tau, ALL, h, parameters=PARAMETERS, design=made)
        for a, b in zip(state.azimuths, new.azimuths, strict=True):
            assert abs(wrap(b - a)) <= PARAMETERS.azimuth_rate_max * h * (1.0 + 1e-9)
        for a, b in zip(state.thrusts, new.thrusts, strict=True):
            assert abs(b - a) <= PARAMETERS.thrust_rate_max * h * (1.0 + 1e-9)
        assert -30e3 <= min(new.thrusts[:2])
        np.testing.assert_allclose(load_of(new), new[2:5], atol=1e-6)
        state = new


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_a_missing_unit_gives_nothing_and_the_others_hold_her_in_place(missing):
    available = tuple(unit != missing for unit in range(3))
    state = allocate((3e3, -4e3, 20e3), available)
    assert state.thrusts[missing] == 0.0
    assert state[2:4] == pytest.approx((3e3, -4e3), abs=100.0)
    # two azimuths have four components for three loads; one and the tunnel have three
    assert state.tau_N == pytest.approx(20e3, abs=50.0) and not state.saturated


def test_a_small_force_turns_no_unit():
    state = allocate((100.0, -100.0, 0.0))
    assert state.azimuths[:2] == pytest.approx(
        (PARAMETERS.port_azimuth, PARAMETERS.starboard_azimuth)
    )


def test_many_at_once_get_what_each_gets():
    rows, tunnel = requests(40, 60e3, 60e3, 600e3), np.arange(40) % 3 > 0
    start = at_rest((np.zeros(40),) * 3, parameters=PARAMETERS)
    together = allocate(tuple(np.array(rows).T), (True, True, tunnel), state=start)
    for i, row in enumerate(rows):
        alone = allocate(row, (True, True, bool(tunnel[i])))
        found = [part[i] for part in (*together.thrusts, *together.azimuths[:2], *together[2:])]
        np.testing.assert_allclose(
            found, (*alone.thrusts, *alone.azimuths[:2], *alone[2:]), rtol=1e-9, atol=1e-6
        )


def test_the_sides_price_is_what_it_says():
    dear = allocate((0.0, 10e3, 0.0), parameters=replace(PARAMETERS, sway_price=4.0))
    cheap = allocate((0.0, 10e3, 0.0))
    side = [sum(abs(force[1]) for force in forces_of(state)) for state in (dear, cheap)]
    assert side[0] <= side[1]
