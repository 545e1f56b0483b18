"""Observer against textbook solutions and a plant written apart."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.control import observer
from shipcosim.models.control.observer import DpShip, ObserverParameters, design
from shipcosim.models.control.wave_filter import filter_at, kalman_gain, wave_transition
from shipcosim.models.core.motion import Motion

SHIP, PARAMETERS = parameters(DpShip), parameters(ObserverParameters)
DESIGN = design(SHIP, PARAMETERS)
IN_TIME = replace(PARAMETERS, position_delay=0.0, heading_delay=0.0)
PROMPT = replace(IN_TIME, position_period=0.1)
MASS = np.array(
    [
        [SHIP.mass_surge, 0.0, 0.0],
        [0.0, SHIP.mass_sway, SHIP.mass_sway_yaw],
        [0.0, SHIP.mass_sway_yaw, SHIP.mass_yaw],
    ]
)
DAMPING = np.diag([SHIP.damping_surge, SHIP.damping_sway, SHIP.damping_yaw])


def at_rest(measured):
    return observer.at_rest(measured, parameters=PARAMETERS)


def step(estimate, measured, load=(0.0, 0.0, 0.0), **new):
    return _step(estimate, observer.Measurement(measured, **new), load, PROMPT)


@cache
def _design(parameters):
    return design(SHIP, parameters)


def _step(estimate, measurement, load, parameters):
    return observer.step(
        estimate, measurement, load, ship=SHIP, parameters=parameters, design=_design(parameters)
    )


def test_gain_solves_the_riccati_equation():
    linalg = pytest.importorskip("scipy.linalg")
    transition = np.array([[1.0, 0.1, 0.0], [0.0, 0.98, 0.1], [0.0, 0.0, 1.0]])
    noise, output, output_noise = (
        np.diag([0.0, 1e-4, 1e-6]),
        np.array([[1.0, 0.0, 0.0]]),
        np.array([[0.04]]),
    )
    covariance = linalg.solve_discrete_are(transition.T, output.T, noise, output_noise)
    expected = covariance @ output.T / (output @ covariance @ output.T + output_noise)
    np.testing.assert_allclose(
        kalman_gain(transition, noise, output, output_noise), expected, rtol=1e-9
    )


def test_gains_between_two_frequencies_of_the_table_are_nearly_those_of_the_frequency():
    for frequency in (0.52, 0.87, 1.33):
        p = replace(PARAMETERS, wave_frequency_min=frequency, wave_frequency_max=frequency + 0.1)
        exact, found = design(SHIP, p).filters.rows[0], filter_at(frequency, DESIGN.filters)
        flat = [*found.wave, *found.horizontal_age, *found.yaw_age, *found.horizontal, *found.yaw]
        np.testing.assert_allclose(flat, [value for value, _ in exact], rtol=0.02, atol=1e-6)


def test_wave_model_moves_as_a_damped_oscillator():
    expm = pytest.importorskip("scipy.linalg").expm
    found = np.reshape(wave_transition(0.3, 1.1, 0.2), (2, 2))
    np.testing.assert_allclose(
        found, expm(0.3 * np.array([[0.0, 1.0], [-1.21, -0.44]])), rtol=1e-12
    )


def plant(position, velocity, load, force, steps):
    """Measurements without noise of a linear ship with an unknown force in north-east-down. The load is body-fixed."""
    h = 0.01
    for _ in range(steps):
        for _ in range(10):
            c, s = math.cos(position[2]), math.sin(position[2])
            body = np.array([c * force[0] + s * force[1], c * force[1] - s * force[0], force[2]])
            u, v, r = velocity
            frame = np.array([r * v, -r * u, 0.0])
            velocity = velocity + h * (
                np.linalg.solve(MASS, load + body - DAMPING @ velocity) + frame
            )
            u, v, r = velocity
            position = position + h * np.array([c * u - s * v, s * u + c * v, r])
        yield Motion(*position, *velocity)


@pytest.mark.parametrize("heading", [0.0, 2.5])
def test_unknown_force_is_found_with_its_size_and_direction(heading):
    force, load = np.array([4e3, -3e3, 2e4]), np.array([1e3, 0.0, -2e4])
    measured = list(plant(np.array([1.0, 2.0, heading]), np.zeros(3), load, force, 6000))
    estimate = at_rest(measured[0])
    for one in measured:
        estimate = step(estimate, one, tuple(load))
    assert (estimate.bias_north, estimate.bias_east) == pytest.approx((4e3, -3e3), rel=0.03)
    assert estimate.bias_N == pytest.approx(2e4, rel=0.03)
    assert estimate[:6] == pytest.approx(measured[-1], abs=0.02)


def test_estimate_of_a_resting_ship_stays_there():
    measured = Motion(3.0, -2.0, 1.0, 0.0, 0.0, 0.0)
    estimate = at_rest(measured)
    for _ in range(100):
        estimate = step(estimate, measured)
    assert estimate[:18] == pytest.approx(at_rest(measured)[:18], abs=1e-9)  # ship, bias and waves
    assert estimate.wave_power < at_rest(measured).wave_power


@pytest.mark.parametrize("period", [5.0, 6.0])
def test_less_than_a_fifth_of_the_wave_motion_passes(period):
    w, amplitude = 2.0 * math.pi / period, 0.05
    estimate, found = at_rest(Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)), []
    for k in range(4000):
        swing, rate = amplitude * math.sin(w * 0.1 * k), amplitude * w * math.cos(w * 0.1 * k)
        estimate = step(estimate, Motion(swing, 0.0, 0.0, rate, 0.0, 0.0))
        found.append((estimate.x, estimate.u))
    x, u = np.abs(found[2000:]).max(axis=0)
    assert x < 0.2 * amplitude
    assert u < 0.2 * amplitude * w


def test_noise_of_the_sensors_is_filtered_to_centimetres():
    """Positions are the mean of three references, at each second sample; heading and rate are of each."""
    random, third = np.random.default_rng(1), 3.0**-0.5
    noise = random.normal(size=(6000, 6)) * [
        0.2,
        0.2,
        0.1 * observer.DEGREE,
        0.02,
        0.02,
        0.05 * observer.DEGREE,
    ]
    estimate, found = at_rest(Motion(*(0.0,) * 6)), []
    for k, (x, y, psi, u, v, r) in enumerate(noise):
        motion = Motion(third * x, third * y, psi, third * u, third * v, r)
        measured = observer.Measurement(motion, float(k % 2 == 0))
        estimate = _step(estimate, measured, (0.0, 0.0, 0.0), IN_TIME)
        found.append(estimate[:6])
    x, y, psi, u, v, r = np.std(found[1000:], axis=0)
    assert max(x, y) < 0.04 and max(u, v) < 0.005
    assert psi < 0.03 * observer.DEGREE and r < 0.012 * observer.DEGREE


def test_heading_through_south_does_not_jump():
    estimate = at_rest(Motion(0.0, 0.0, math.pi - 0.01, 0.0, 0.0, 0.002))
    for k in range(300):
        heading = math.remainder(math.pi - 0.01 + 0.002 * 0.1 * k, 2.0 * math.pi)
        estimate = step(estimate, Motion(0.0, 0.0, heading, 0.0, 0.0, 0.002))
    assert math.remainder(estimate.psi - heading, 2.0 * math.pi) == pytest.approx(0.0, abs=2e-3)
    assert estimate.r == pytest.approx(0.002, abs=2e-4)


def test_what_is_not_new_corrects_nothing():
    start = at_rest(Motion(1.0, 2.0, 0.5, 0.0, 0.0, 0.0))._replace(
        u=0.3, v=-0.1, r=0.01, bias_north=2e3
    )
    away = Motion(50.0, -80.0, 2.0, 3.0, -2.0, 0.3)
    alone = step(start, away, position_new=0.0, heading_new=0.0)
    assert alone == step(
        start, Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), position_new=0.0, heading_new=0.0
    )
    assert (alone.x, alone.y) == pytest.approx((1.03, 2.0), abs=0.02)
    turned = step(start, away, position_new=0.0)
    assert turned[:2] == alone[:2] and turned.psi != alone.psi
    moved = step(start, away, heading_new=0.0)
    assert moved.psi == alone.psi and moved.x != alone.x


def test_late_measurements_at_rates_of_their_own_leave_no_lag():
    """The ship as measured 0.4 s ago each second, her heading 0.2 s ago: the estimate is of now."""
    slow = replace(PARAMETERS, position_period=1.0, position_delay=0.4, heading_delay=0.2)
    load = np.array([1e4, -5e3, 1e4])
    ship = list(plant(np.zeros(3), np.zeros(3), load, np.zeros(3), 1200))
    estimate = at_rest(ship[0])
    for k, _ in enumerate(ship):
        late, later = ship[max(0, k - 2)], ship[max(0, k - 4)]
        motion = Motion(later.x, later.y, late.psi, later.u, later.v, late.r)
        estimate = _step(
            estimate, observer.Measurement(motion, float(k % 10 == 4)), tuple(load), slow
        )
    assert math.hypot(ship[-1].u, ship[-1].v) > 1.0
    assert estimate[:6] == pytest.approx(tuple(ship[-1]), abs=0.02)


def test_wave_frequency_follows_the_sea_and_returns_in_calm_water():
    """A little below the frequency of regular waves: the ratio of peak and mean is that of irregular ones."""
    estimate, found = at_rest(Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)), []
    for period in (12.0, 5.0):
        w = 2.0 * math.pi / period
        for k in range(10000):
            s, c = 0.2 * math.sin(w * 0.1 * k), 0.2 * w * math.cos(w * 0.1 * k)
            estimate = step(estimate, Motion(s, 0.5 * s, 0.1 * s, c, 0.5 * c, 0.1 * c))
        found.append(estimate.wave_frequency / w)
    assert 0.75 < found[0] < 1.0 and 0.75 < found[1] < 1.0
    for _ in range(30000):
        estimate = step(estimate, Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert estimate.wave_frequency == pytest.approx(PARAMETERS.wave_frequency, rel=0.03)
