"""The optimal allocator over long requests: limits that hold, power over the rose, changes of cones.

The reference for power is `static_optimum`, which is itself held against scipy.
"""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
from optimal_allocator import CONES, DESIGN, PARAMETERS, many, start, step, violations
from ships import parameters
from static_optimum import static_optimum

from shipcosim.models.allocation import optimal
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads


def adversary(state):
    """Request that pulls every unit the way it may least go: back, and across the nearest sector."""
    X = Y = N = 0.0
    for unit, f, a in zip(DESIGN.units, state.thrusts, state.azimuths, strict=True):
        away = np.where(np.sin(a) > 0.0, 1.0, -1.0) * 1e6
        X, Y = X - np.cos(a) * (1e6 + f), Y - np.sin(a) * f + away
        N = N + unit.x * away
    return X, Y, N


def test_no_limit_is_broken_on_requests_made_of_the_state_to_break_them():
    state = many(300)
    for k in range(150):
        new = step(state, tuple((-1.0 if k % 40 > 20 else 1.0) * load for load in adversary(state)))
        assert violations(state, new) == 0
        state = new


def recorded():
    """Requests every 0.05 s of three minutes: the wind's turn of stationkeeping, and of four_corner the second leg and
    the turn on the spot. Recorded with fixed angles and seed 21; the controller sends ten a second.
    """
    rows = np.loadtxt(Path(__file__).with_name("requests.csv"), delimiter=",", skiprows=1)
    return [tuple(row) for part in np.split(rows, 3) for row in np.repeat(part, 2, axis=0).tolist()]


def test_recorded_requests_are_met_at_nearly_the_least_power_without_a_reversal():
    """Some requests change more quickly than thrusts may, hence medians of what is missed."""
    requests, state = recorded(), start()
    for _ in range(400):
        state = step(state, requests[0])
    used, missed, thrusts = [], [], []
    for k, tau in enumerate(requests):
        new = step(state, tau)
        assert violations(state, new) == 0
        state = new
        if k % 1200 < 400:  # settles after a jump from one part to the next
            continue
        used.append(
            sum(
                unit.price * abs(f) ** 1.5
                for unit, f in zip(DESIGN.units, state.thrusts, strict=True)
            )
        )
        missed.append(np.abs(np.array(tau) - state[2:5]))
        thrusts.append(state.thrusts)
    chosen = [tau for k, tau in enumerate(requests) if k % 1200 >= 400]
    best = static_optimum(
        np.array(chosen)[::10], DESIGN.units, CONES, yaw_lever=PARAMETERS.yaw_lever
    ).power
    assert np.mean(used) / np.mean(best) < 1.035
    assert (np.median(missed, axis=0) < [0.1, 0.1, 1.0]).all()
    assert np.min(np.array(thrusts)[:, :2]) >= PARAMETERS.azimuth_thrust_least


def of_wind(speed, wind_from):
    """Loads that balance the mean wind from some directions, (n, 3). [m/s, rad] -> [N, N, N.m]"""
    air = -speed * np.cos(wind_from), -speed * np.sin(wind_from)
    loads = wind_loads(*apparent_wind(0.0, 0.0, 0.0, *air), wind=parameters(WindParameters))
    return -np.stack(loads, -1)


def test_wind_from_all_around_costs_nearly_what_the_static_optimum_with_all_cones_costs():
    """24 directions, two wind speeds; each state settles from rest, and changes its cones where that pays."""
    around = np.radians(np.arange(0.0, 360.0, 15.0))
    tau = np.concatenate([of_wind(speed, around) for speed in (8.0, 12.0)])
    state = start(tuple(tau.T))
    for _ in range(1000):
        new = step(state, tuple(tau.T), h=0.25)
        assert violations(state, new, 0.25) == 0
        state = new
    used = sum(
        unit.price * np.abs(f) ** 1.5 for unit, f in zip(DESIGN.units, state.thrusts, strict=True)
    )
    best = static_optimum(tau, DESIGN.units, CONES, yaw_lever=PARAMETERS.yaw_lever)
    np.testing.assert_allclose(np.stack(state[2:5], -1), tau, atol=1.0)
    for ratio in np.split(used / best.power, 2):
        assert ratio.mean() < 1.01 and ratio.max() < 1.05


def test_a_change_of_cones_goes_through_no_thrust_one_unit_at_a_time():
    """Wind from ahead brings starboard ahead; when it has turned to astern both azimuths turn astern."""
    state = start()
    crossed = []
    for k in range(4500):
        tau = of_wind(10.0, np.radians([0.0 if k < 1500 else 180.0]))[0]
        new = step(state, tuple(tau.tolist()), h=0.1)
        assert violations(state, new, 0.1) == 0
        assert sum(f == 0.0 for f in new.thrusts[:2]) <= 1 or k == 0
        ahead = [np.cos(a) > 0.0 for a in new.azimuths[:2]]
        was = [np.cos(a) > 0.0 for a in state.azimuths[:2]]
        crossed += [(unit, k) for unit in (0, 1) if ahead[unit] != was[unit]]
        state = new
    units = [unit for unit, _ in crossed]
    assert units[0] == 1 and sorted(units[1:]) == [0, 1] and crossed[0][1] < 1500 < crossed[1][1]
    np.testing.assert_allclose(state[2:5], tau, atol=1.0)


def test_no_limit_is_broken_while_cones_change():
    """Requests like those of wind from all around, for a minute or two each, with units that come and go."""
    eager = optimal.design(replace(PARAMETERS, cone_wait=2.0, cone_average=3.0))
    draw = np.random.default_rng(8)
    runs, h = 100, 0.25
    state, changes = many(runs), 0
    available = [np.ones(runs, bool)] * 3
    for k in range(600):
        if k % 150 == 0:
            tau = of_wind(draw.uniform(3.0, 16.0, runs), draw.uniform(-pi, pi, runs)).T
        if k % 90 == 0:
            available = [draw.random(runs) < 0.93 for _ in range(3)]
        noisy = tuple(tau + draw.normal(size=tau.shape) * [[300.0], [300.0], [3e3]])
        new = optimal.step(state, noisy, tuple(available), h, parameters=PARAMETERS, design=eager)
        assert violations(state, new, h, available) == 0
        changes += sum(
            np.sum(np.cos(a) * np.cos(b) < 0.0)
            for a, b in zip(state.azimuths[:2], new.azimuths[:2], strict=True)
        )
        state = new
    assert changes > runs
