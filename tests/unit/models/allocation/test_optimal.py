"""The optimal allocator: limits that hold whatever is requested, requests that are met, and its power.

The reference for power is `static_optimum`, which is itself held against scipy.
"""

from dataclasses import replace
from math import degrees, inf, pi, radians

import numpy as np
import pytest
from optimal_allocator import (
    ALL,
    ALWAYS,
    DESIGN,
    PARAMETERS,
    SETTLED,
    H,
    held,
    many,
    start,
    step,
    violations,
)
from static_optimum import static_optimum

from shipcosim.models.allocation import optimal


def extremes(draw, number):
    """Requests from nothing to many times what the ship can give, some along one axis only."""
    size = 10.0 ** draw.uniform(0.0, 7.0, number)
    tau = draw.normal(size=(3, number)) * size * np.array([[1.0], [1.0], [15.0]])
    return tuple(tau * (draw.random((3, number)) < 0.8))


def keep_limits(runs, steps, seed, h=H, always=False):
    """Violations in `runs` x `steps` requests that jump, with units that come and go."""
    design = ALWAYS if always else DESIGN
    draw = np.random.default_rng(seed)
    state, count = many(runs), 0
    available = [np.ones(runs, bool)] * 3
    for k in range(steps):
        if k % 7 == 0:
            tau = extremes(draw, runs)
        if k % 11 == 5:
            available = [draw.random(runs) < 0.9 for _ in range(3)]
        new = step(state, tau, tuple(available), h, design)
        count += violations(state, new, h, available, always)
        assert all(np.isfinite(value).all() for value in (*new.thrusts, *new.azimuths))
        state = new
    return count


@pytest.mark.parametrize("always", [False, True])
def test_no_limit_is_broken_on_random_requests(always):
    assert keep_limits(1000, 40, 1, always=always) == 0


@pytest.mark.parametrize("always", [False, True])
@pytest.mark.parametrize("h", [0.01, 0.5, 3.0])
def test_no_limit_is_broken_with_other_steps(h, always):
    assert keep_limits(100, 100, 2, h, always) == 0


def test_a_unit_gives_no_thrust_until_it_is_within_its_angles_and_turns_there():
    state = start(azimuths=(radians(-45), radians(45), 0.5 * pi))
    for k in range(400):
        new = step(state, (3e3, 6e3, 2e4))
        assert violations(state, new) == 0
        if k * H < 5.4:
            assert new.thrusts[1] == 0.0
        state = new
    assert 100.0 <= degrees(state.azimuths[1]) <= 260.0
    assert state.thrusts[1] >= PARAMETERS.azimuth_thrust_least
    np.testing.assert_allclose(state[2:5], (3e3, 6e3, 2e4), atol=1.0)


def test_many_at_once_get_what_each_gets():
    draw = np.random.default_rng(4)
    together, tunnel = many(20), np.arange(20) % 3 > 0
    alone = [start(azimuths=tuple(float(a[i]) for a in together.azimuths)) for i in range(20)]
    for _ in range(5):
        tau = extremes(draw, 20)
        together = step(together, tau, (True, True, tunnel), 1.0)
        for i in range(20):
            row = tuple(float(load[i]) for load in tau)
            alone[i] = step(alone[i], row, (True, True, bool(tunnel[i])), 1.0)
            np.testing.assert_allclose(
                [f[i] for f in together.thrusts], alone[i].thrusts, rtol=1e-6, atol=1e-3
            )
            np.testing.assert_allclose(
                [a[i] for a in together.azimuths], alone[i].azimuths, rtol=1e-6, atol=1e-6
            )


def test_loads_that_a_step_can_reach_are_met():
    """From settled states, loads of commands drawn within the limits of one step."""
    draw, errors, runs = np.random.default_rng(5), [], 40
    state, tau = many(runs), draw.normal(size=(3, runs)) * [[4e3], [8e3], [6e4]]
    for _ in range(80):
        state = step(state, tuple(tau), h=0.25)
    for _ in range(10):
        X = Y = N = 0.0
        for unit, f, a in zip(DESIGN.units, state.thrusts, state.azimuths, strict=True):
            f = f + draw.uniform(-1, 1, runs) * unit.thrust_rate * H
            a = a + draw.uniform(-1, 1, runs) * unit.azimuth_rate * H
            f, a = np.clip(f, unit.least, unit.most), np.clip(a, unit.first, unit.last)
            X, Y, N = (
                X + f * np.cos(a),
                Y + f * np.sin(a),
                N + f * (unit.x * np.sin(a) - unit.y * np.cos(a)),
            )
        new = step(state, (X, Y, N))
        errors.append([abs(X - new.tau_X), abs(Y - new.tau_Y), abs(N - new.tau_N)])
    assert (np.mean(errors, axis=(0, 2)) < [5.0, 5.0, 10.0]).all()


def test_a_request_that_stays_costs_what_the_static_optimum_with_these_cones_costs():
    own = [[(unit.first, unit.last)] for unit in DESIGN.units]
    bold = optimal.design(replace(PARAMETERS, azimuth_thrust_least=0.0))
    draw = np.random.default_rng(6)
    for tau in draw.normal(size=(12, 3)) * [4e3, 8e3, 6e4]:
        state = start()
        for _ in range(300):
            state = optimal.step(
                state, tuple(tau.tolist()), ALL, 0.25, parameters=PARAMETERS, design=bold
            )
        best = static_optimum(tau[None], bold.units, own, yaw_lever=14.0)
        power = sum(
            unit.price * abs(f) ** 1.5 for unit, f in zip(bold.units, state.thrusts, strict=True)
        )
        assert abs(best.missed).max() < 1.0
        assert power == pytest.approx(float(best.power[0]), rel=0.01)


def test_a_unit_that_pushes_much_keeps_its_cone():
    """Its thrust would be missed for too long."""
    state = held((0.0, -75e3, -1e5), steps=4000)
    assert [np.sign(np.cos(a)) for a in state.azimuths[:2]] == [1.0, -1.0]
    assert min(state.thrusts[:2]) > 15e3


def test_cones_stay_where_no_gain_is_enough():
    stays = optimal.design(replace(PARAMETERS, cone_margin=1.0))
    state = start()
    for _ in range(1500):
        state = optimal.step(state, (3e3, 0.0, 0.0), ALL, 0.2, parameters=PARAMETERS, design=stays)
        assert DESIGN.units[1].first <= state.azimuths[1] <= DESIGN.units[1].last


def test_starboard_mirrors_port_where_their_cones_are_exchanged():
    other = replace(
        PARAMETERS,
        **{"port_azimuth_first": radians(100), "port_azimuth_last": radians(260)},
        **{"starboard_azimuth_first": radians(-80), "starboard_azimuth_last": radians(80)},
    )
    one, mirrored = start(), start(azimuths=(radians(-135), radians(-45), 0.5 * pi))
    mirrored = mirrored._replace(azimuths=(radians(225), radians(-45), 0.5 * pi))
    for _ in range(200):
        one = step(one, (2e3, 7e3, 5e4))
        mirrored = optimal.step(
            mirrored, (2e3, -7e3, -5e4), ALL, H, parameters=other, design=optimal.design(other)
        )
    port, starboard, tunnel = one.thrusts
    assert mirrored.thrusts == pytest.approx((starboard, port, -tunnel), rel=1e-6)


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_missing_unit_gives_nothing_at_once_keeps_its_angle_and_the_forces_are_held(missing):
    state = held((3e3, 6e3, 5e4))
    available = tuple(unit != missing for unit in range(3))
    angle = state.azimuths[missing]
    state = step(state, (3e3, 6e3, 5e4), available)
    assert state.thrusts[missing] == 0.0 and state.azimuths[missing] == angle
    for _ in range(1200):
        state = step(state, (3e3, 6e3, 5e4), available)
    assert state.azimuths[missing] == angle
    assert abs(6e3 - state.tau_Y) < 600.0  # two units: position before heading


def test_one_azimuth_in_its_cone_reverses_and_no_more_when_the_other_is_back():
    state, alone = start(), (True, False, True)
    for tau in ((3e3, 6e3, 5e4), (-3e3, 6e3, 5e4)):
        for _ in range(1000):
            state = step(state, tau, alone, design=ALWAYS)
        np.testing.assert_allclose(state[2:4], tau[:2], atol=150.0)
    assert state.thrusts[0] < -2e3
    for _ in range(1000):
        state = step(state, (-3e3, 6e3, 5e4), design=ALWAYS)
    assert state.thrusts[0] >= PARAMETERS.azimuth_thrust_least
    np.testing.assert_allclose(state[2:5], (-3e3, 6e3, 5e4), atol=1.0)


def test_an_azimuth_alone_pushes_abeam_unless_sectors_hold_always():
    """Its wash meets no running azimuth. The other one, when it is back, waits until it has left the sector."""
    alone, abeam, small = (True, False, False), (0.0, 6e3, 0.0), (3e3, 6e3, 5e4)
    asides = []
    for design in (ALWAYS, DESIGN):
        state = start()
        for _ in range(160):
            state = step(state, abeam, alone, 0.25, design)
        asides.append(degrees(state.azimuths[0]))
    assert asides[0] <= 80.0 + 1e-9
    assert asides[1] == pytest.approx(90.0, abs=0.1)
    np.testing.assert_allclose(state[2:4], abeam[:2], atol=30.0)  # position before heading
    for _ in range(400):
        new = step(state, small, ALL, 0.25)
        assert violations(state, new, 0.25) == 0
        state = new
    np.testing.assert_allclose(state[2:5], small, atol=1.0)


def test_heading_is_held_too_where_the_units_left_hold_both():
    """One azimuth and the tunnel hold the first load, not the second: there position goes before heading."""
    alone, both, too_much = (True, False, True), (3e3, 6e3, 5e4), (3e3, 20e3, 5e4)
    np.testing.assert_allclose(_held_alone(both, alone), both, atol=1.0)
    np.testing.assert_allclose(_held_alone(too_much, alone)[:2], too_much[:2], atol=150.0)


def _held_alone(tau, available):
    state = start()
    for _ in range(1000):
        state = step(state, tau, available, 0.25)
    return state[2:5]


def test_power_limits_are_kept_at_once():
    state = held((8e3, 20e3, 5e4))
    limited = step(state, (8e3, 20e3, 5e4), shares=(0.05, 1.0, 0.1))
    assert limited.thrusts[0] <= 0.05 * 60e3 and abs(limited.thrusts[2]) <= 0.1 * 21.6e3


def test_saturated_says_that_no_time_would_help():
    assert held((3e3, 6e3, 5e4)).saturated is False
    state = start()
    assert step(state, (3e3, 6e3, 5e4)).saturated is False  # on its way
    assert held((0.0, 0.0, 5e6), steps=2000).saturated is True


def test_no_azimuth_reverses_and_small_loads_are_met_in_noise_around_nothing():
    draw, state, missed = np.random.default_rng(7), held((0.0, 0.0, 0.0), steps=400), []
    for _ in range(500):
        tau = tuple((draw.normal(size=3) * [5.0, 5.0, 50.0]).tolist())
        state = step(state, tau)
        assert min(state.thrusts[:2]) >= PARAMETERS.azimuth_thrust_least
        missed.append(np.abs(np.array(tau) - state[2:5]))
    assert (np.mean(missed, axis=0) < [5.0, 5.0, 10.0]).all()


def test_numbered_units_give_what_named_ones_give():
    p = PARAMETERS
    numbered = optimal.OptimalUnitsParameters(
        **{
            "x_1": p.port_x,
            "y_1": p.port_y,
            "azimuth_1": SETTLED[0],
            "x_2": p.starboard_x,
            "y_2": p.starboard_y,
        },
        **{
            "azimuth_2": SETTLED[1],
            "x_3": p.tunnel_x,
            "azimuth_3": 0.5 * pi,
            "thrust_min_3": -21.6e3,
        },
        **{
            "thrust_max_1": 60e3,
            "thrust_max_2": 60e3,
            "thrust_max_3": 21.6e3,
            "thrust_rate_1": 1e3,
        },
        **{
            "thrust_rate_2": 1e3,
            "thrust_rate_3": 1e3,
            "azimuth_rate_1": radians(10),
            "azimuth_rate_2": radians(10),
        },
        **{
            "azimuth_first_1": radians(-80),
            "azimuth_last_1": radians(80),
            "thrust_least_1": p.azimuth_thrust_least,
            "thrust_least_2": p.azimuth_thrust_least,
        },
        **{
            "azimuth_first_2": radians(100),
            "azimuth_last_2": radians(260),
            "yaw_lever": p.yaw_lever,
        },
        specific_power_3=4.77 * (21.6 / 60.0) ** 0.5,
    )
    design = optimal.design(numbered)
    one, other = start(), optimal.at_rest((0.0, 0.0, 0.0), parameters=numbered)
    for _ in range(100):
        one = step(one, (2e3, 7e3, 5e4))
        other = optimal.step(
            other, (2e3, 7e3, 5e4), (True,) * 6, H, parameters=numbered, design=design
        )
    assert (
        other.thrusts[:3] == pytest.approx(one.thrusts, rel=1e-6)
        and other.thrusts[3:] == (0.0,) * 3
    )
    assert other.azimuths[:2] == pytest.approx(one.azimuths[:2], abs=1e-6)


def test_unit_without_an_interval_turns_all_round():
    free = optimal.OptimalUnitsParameters(
        **{
            "x_1": -10.0,
            "thrust_max_1": 1e4,
            "thrust_rate_1": 1e3,
            "azimuth_rate_1": 0.2,
            "yaw_lever": 10.0,
        }
    )
    design = optimal.design(free)
    assert design.units[0].first == -inf
    state = optimal.at_rest((0.0, 0.0, 0.0), parameters=free)
    for _ in range(600):
        state = optimal.step(
            state, (-3e3, 100.0, -1e3), (True,) * 6, 0.1, parameters=free, design=design
        )
    assert state.tau_X == pytest.approx(-3e3, abs=30.0)
