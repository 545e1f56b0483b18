"""Waves, wave loads and wave motion against closed forms, direct sums and integrals."""

from math import pi, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose

from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.environment.wave_loads import drift, drift_table, mean_drift
from shipcosim.models.environment.wave_motion import wave_response
from shipcosim.models.environment.waves import (
    COMPONENTS,
    Waves,
    components,
    elevation,
    jonswap,
)

SHIP = dict(length=33.9, breadth=9.6, draught=2.7)
# X = 1000 cos, Y = 5000 sin, N = 40 000 sin of twice the heading, all growing linearly with frequency; every 10 deg
TABLE = drift_table(
    ";".join(
        f"{omega} {heading} {1e3 * omega * np.cos(radians(heading))} {5e3 * omega * np.sin(radians(heading))} "
        f"{4e4 * omega * np.sin(radians(2 * heading))}"
        for omega in (0.2, 1.0, 2.6)
        for heading in range(0, 181, 10)
    )
)


def regular(amplitude, omega, direction, phase=0.0):
    """One sinusoidal wave."""
    omega = np.array([omega])
    return Waves(np.array([amplitude]), omega, omega**2 / GRAVITY, np.array([phase]), direction)


@pytest.mark.parametrize(
    "height, period, peak_enhancement", [(0.5, 6.0, 3.3), (0.3, 5.0, 1.0), (4.0, 11.0, 7.0)]
)
def test_four_roots_of_the_variance_of_the_components_are_the_significant_height(
    height, period, peak_enhancement
):
    sea = components(height, period, 0.3, peak_enhancement, 7)
    assert 4.0 * np.sqrt(np.sum(sea.amplitude**2) / 2.0) == pytest.approx(height, rel=1e-12)


@pytest.mark.parametrize("peak_enhancement", [1.0, 2.0, 3.3, 5.0])
def test_jonswap_integrates_to_the_significant_height(peak_enhancement):
    omega = np.linspace(0.2, 40.0, 400_000)
    variance = np.sum(jonswap(omega, 2.0, 8.0, peak_enhancement)) * (omega[1] - omega[0])
    assert 4.0 * np.sqrt(variance) == pytest.approx(
        2.0, rel=2e-3
    )  # the factor 1 - 0.287 ln gamma is itself a fit


def test_records_of_the_elevation_have_the_jonswap_spectrum():
    height, period, step, number = 0.5, 6.0, 0.5, 2048
    sea = components(height, period, 0.0, 3.3, np.arange(1, 101))
    record = np.array(
        [elevation(step * k, np.zeros(100), np.zeros(100), sea) for k in range(number)]
    )
    window = np.hanning(number)[:, None]
    power = np.mean(np.abs(np.fft.rfft(record * window, axis=0)) ** 2, axis=1)
    power *= 2.0 / (number * np.sum(window**2))
    omega = 2.0 * pi * np.fft.rfftfreq(number, step)
    variance = height**2 / 16.0
    for low, high in [
        (0.4, 0.8),
        (0.8, 0.95),
        (0.95, 1.05),
        (1.05, 1.2),
        (1.2, 1.6),
        (1.6, 2.4),
        (2.4, 5.0),
    ]:
        fine = np.linspace(low, high, 2001)
        asked = np.mean(jonswap(fine, height, period, 3.3)) * (high - low)
        found = np.sum(power[(omega >= low) & (omega < high)])
        # one of 40 components more or less in a band is 2.5 % of the variance; 100 seeds make 0.25 % of it
        assert abs(found - asked) < 0.012 * variance, (low, high)


def test_waves_travel_with_the_phase_speed_of_deep_water_away_from_where_they_come():
    wave = regular(0.7, 1.3, components(1.0, 5.0, radians(30.0), 3.3, 1).direction)
    speed = GRAVITY / 1.3
    north, east = np.cos(radians(210.0)) * speed, np.sin(radians(210.0)) * speed
    for t in (0.0, 1.7, 40.0):
        assert elevation(t, 5.0 + north * t, -3.0 + east * t, wave) == pytest.approx(
            elevation(0.0, 5.0, -3.0, wave)
        )


def test_components_obey_the_dispersion_of_deep_water():
    sea = components(0.5, 6.0, 0.0, 3.3, 1)
    assert_allclose(GRAVITY * sea.wavenumber, sea.omega**2)


def test_the_same_sea_is_the_same_object_and_another_seed_is_another_sea():
    assert components(0.5, 6.0, 0.0, 3.3, 1) is components(0.5, 6.0, 0.0, 3.3, 1)
    assert np.all(
        components(0.5, 6.0, 0.0, 3.3, 1).phase != components(0.5, 6.0, 0.0, 3.3, 2).phase
    )


def test_a_calm_sea_does_exactly_nothing():
    sea = components(0.0, 0.0, 0.4, 3.3, 1)
    assert elevation(3.0, 1.0, 2.0, sea) == 0.0
    loads, motions = wave_response(3.0, 1.0, 2.0, 0.5, 0.1, 0.2, sea, TABLE, **SHIP)
    assert loads == (0.0,) * 3 and motions == (0.0,) * 6
    assert mean_drift(0.5, sea, TABLE) == (0.0,) * 3


def test_drift_of_a_regular_wave_is_constant_and_its_coefficient_times_the_amplitude_squared():
    wave = regular(0.4, 1.0, radians(70.0))
    expected = 0.16 * np.array(
        [1e3 * np.cos(radians(60.0)), 5e3 * np.sin(radians(60.0)), 4e4 * np.sin(radians(120.0))]
    )
    for t in (0.0, 2.3, 77.0):
        assert_allclose(drift(t, 4.0, -9.0, radians(10.0), wave, TABLE), expected, rtol=1e-12)


def test_drift_of_gunnerus_in_a_beam_wave_is_that_of_the_published_table(shared):
    rows = np.loadtxt(
        shared / "reference/data/gunnerus_33p9_veres_wave_drift_U0.csv",
        delimiter=",",
        skiprows=2,
        comments="#",
    )
    table = drift_table("; ".join(" ".join(map(repr, row)) for row in rows.tolist()))
    _, Y, _ = drift(0.0, 0.0, 0.0, 0.0, regular(1.0, 1.5708, pi / 2.0), table)
    assert Y == pytest.approx(118.3e3, rel=1e-6)  # parameter sheet 7


def test_slow_drift_is_newmans_double_sum():
    sea, t, x, y, psi = components(0.8, 5.0, radians(200.0), 3.3, 3), 31.0, 4.0, -7.0, radians(25.0)
    theta = (
        sea.phase
        + sea.omega * t
        - sea.wavenumber * (x * np.cos(sea.direction) + y * np.sin(sea.direction))
    )
    beating = np.outer(sea.amplitude, sea.amplitude) * np.cos(theta[:, None] - theta)
    # each component alone, divided by its amplitude squared, gives its coefficients
    D = np.array(
        [
            drift(0.0, 0.0, 0.0, psi, regular(1.0, omega, sea.direction), TABLE)
            for omega in sea.omega.tolist()
        ]
    )
    expected = [np.sum(beating * (Dk[:, None] + Dk) / 2.0) for Dk in D.T]
    assert_allclose(drift(t, x, y, psi, sea, TABLE), expected, rtol=1e-10)


def test_drift_averages_to_its_closed_form_mean():
    sea, psi = components(0.5, 6.0, radians(120.0), 3.3, 5), radians(20.0)
    times = np.random.default_rng(1).uniform(0.0, 1e6, 40_000)
    loads = np.array(drift(times, 0.0, 0.0, psi, sea, TABLE))
    error = np.std(loads, axis=1) / np.sqrt(len(times))
    assert np.all(np.abs(np.mean(loads, axis=1) - mean_drift(psi, sea, TABLE)) < 4.0 * error)


def test_mean_drift_averages_over_seeds_to_the_integral_of_spectrum_and_coefficient():
    seas = components(0.5, 6.0, 0.0, 3.3, np.arange(500))
    X, _, _ = mean_drift(np.zeros(500), seas, TABLE)
    omega = np.linspace(0.4, 2.6, 20_001)
    integrand = jonswap(omega, 0.5, 6.0, 3.3) * -1e3 * omega  # head sea
    assert np.mean(X) == pytest.approx(2.0 * np.sum(integrand) * (omega[1] - omega[0]), rel=5e-3)


def test_frequencies_above_the_converged_range_give_no_drift():
    assert drift(1.0, 0.0, 0.0, 0.3, regular(1.0, 2.61, 1.0), TABLE) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("degrees", [0.0, 37.0, 90.0, 135.0, 180.0])
def test_waves_from_port_mirror_waves_from_starboard(degrees):
    def response(side):
        sea = components(0.6, 5.0, side * radians(degrees), 3.3, 2)
        loads, motions = wave_response(
            12.0, 3.0, side * 4.0, 0.0, 0.3, side * 0.2, sea, TABLE, **SHIP
        )
        return np.array([*loads, *motions])

    mirror = np.array([1, -1, -1, 1, -1, -1, 1, -1, -1])
    assert_allclose(response(1.0), mirror * response(-1.0), rtol=1e-9, atol=1e-9)


def first_order_motion(t, x, y, psi, waves, u=0.0, v=0.0):
    """Motion alone, of the response."""
    return wave_response(t, x, y, psi, u, v, waves, TABLE, **SHIP)[1]


def test_a_ship_in_very_long_waves_follows_the_water():
    wave = regular(1.5, 0.05, radians(50.0), phase=0.8)  # 25 km long
    slope = 1.5 * wave.wavenumber[0] * np.sin(radians(40.0)) * np.cos(radians(40.0))
    for t in (0.0, 20.0, 55.0):
        s, c = np.sin(0.05 * t + 0.8), np.cos(0.05 * t + 0.8)
        x, y, psi, u, v, r = first_order_motion(t, 0.0, 0.0, radians(10.0), wave)
        assert_allclose(
            [x, y], [1.5 * s * np.cos(radians(50.0)), 1.5 * s * np.sin(radians(50.0))], rtol=1e-3
        )
        assert_allclose(
            [u, v], np.array([np.cos(radians(40.0)), np.sin(radians(40.0))]) * 0.075 * c, rtol=1e-3
        )
        assert_allclose(
            [psi, r], [-slope * c, 0.05 * slope * s], rtol=1e-3
        )  # turned as a line of water particles


@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0, 160.0])
def test_first_order_motion_is_the_waters_averaged_over_the_waterplane(degrees):
    a, omega, t, phase = 0.5, 1.4, 2.0, 0.3
    k = omega**2 / GRAVITY
    cells = (np.arange(800) + 0.5) / 800 - 0.5
    ahead, aside = np.meshgrid(33.9 * cells, 9.6 * cells, indexing="ij")
    c, s = np.cos(radians(degrees)), np.sin(radians(degrees))
    angle = omega * t + phase - k * (ahead * c + aside * s)
    water = a * np.exp(-k * 2.7 / 2.0) * np.sin(angle)
    x, y, psi, *_ = first_order_motion(t, 0.0, 0.0, 0.0, regular(a, omega, radians(degrees), phase))
    assert_allclose([x, y], [np.mean(water) * c, np.mean(water) * s], rtol=1e-4, atol=1e-9)
    along_keel = a * np.exp(-k * 2.7 / 2.0) * np.sin(omega * t + phase - k * 33.9 * cells * c) * s
    # at the beam the limit q -> 0 is replaced by a value 1e-6 away
    assert psi == pytest.approx(np.polyfit(33.9 * cells, along_keel, 1)[0], rel=1e-4, abs=1e-6)


def test_rates_of_first_order_motion_are_its_derivative_on_a_moving_ship():
    sea, psi, u, v, h = components(0.8, 5.0, 0.6, 3.3, 4), 0.4, 2.0, -0.5, 1e-4
    c, s = np.cos(psi), np.sin(psi)

    def at(t):
        x, y = 3.0 + (c * u - s * v) * t, 5.0 + (s * u + c * v) * t
        return np.array(first_order_motion(t, x, y, psi, sea, u, v))

    north, east, psi_dot = ((at(9.0 + h) - at(9.0 - h)) / (2.0 * h))[:3]
    assert_allclose(at(9.0)[3:], [c * north + s * east, -s * north + c * east, psi_dot], rtol=1e-6)


def test_load_of_the_response_is_drift():
    sea = components(0.5, 6.0, 0.3, 3.3, 1)
    loads, _ = wave_response(8.0, 1.0, 2.0, 0.7, 0.4, 0.1, sea, TABLE, **SHIP)
    assert loads == drift(8.0, 1.0, 2.0, 0.7, sea, TABLE)


STATES = np.array(
    [[0.0, 3.0, -8.0], [1.0, -4.0, 20.0], [0.2, 3.0, -3.1], [0.5, 0.0, -0.3], [0.1, 0.0, 0.2]]
)
HEIGHTS, PERIODS, FROM, GAMMA, SEEDS = (
    (0.5, 0.8, 0.3),
    (6.0, 5.0, 7.5),
    (0.1, -2.0, 3.0),
    (3.3, 1.0, 5.0),
    (1, 2, 9),
)


def one_by_one():
    """Responses of three ships, each in its own sea, in floats: (3, 10)."""
    rows = []
    for state, *sea in zip(STATES.T.tolist(), HEIGHTS, PERIODS, FROM, GAMMA, SEEDS, strict=True):
        sea = components(*sea)
        loads, motions = wave_response(21.0, *state, sea, TABLE, **SHIP)
        rows.append(
            [*loads, *motions, elevation(21.0, *state[:2], sea), *mean_drift(state[2], sea, TABLE)]
        )
    assert all(isinstance(value, float) for row in rows for value in row)
    return np.array(rows)


def at_once(states, sea):
    loads, motions = wave_response(21.0, *states, sea, TABLE, **SHIP)
    return [*loads, *motions, elevation(21.0, *states[:2], sea), *mean_drift(states[2], sea, TABLE)]


def test_ships_at_once_each_in_its_own_sea_are_the_ships_one_by_one():
    seas = components(*(np.array(values) for values in (HEIGHTS, PERIODS, FROM, GAMMA, SEEDS)))
    assert seas.amplitude.shape == (3, COMPONENTS)
    assert_allclose(np.transpose(at_once(list(STATES), seas)), one_by_one(), rtol=1e-9, atol=1e-12)


def test_ships_at_once_in_a_common_sea_are_the_ships_one_by_one():
    sea = components(0.5, 6.0, 0.1, 3.3, 1)
    rows = [at_once(state, sea) for state in STATES.T.tolist()]
    assert_allclose(np.transpose(at_once(list(STATES), sea)), rows, rtol=1e-9, atol=1e-12)


def test_tensors_give_what_floats_give_and_have_gradients():
    torch = pytest.importorskip("torch")
    states = [torch.tensor(row, dtype=torch.float64) for row in STATES]
    height = torch.tensor(HEIGHTS, dtype=torch.float64, requires_grad=True)
    period, wave_from = (torch.tensor(values, dtype=torch.float64) for values in (PERIODS, FROM))
    found = at_once(states, components(height, period, wave_from, np.array(GAMMA), np.array(SEEDS)))
    assert_allclose(torch.stack(found, -1).detach().numpy(), one_by_one(), rtol=1e-9, atol=1e-12)
    found[1].sum().backward()
    assert_allclose(
        height.grad, 2.0 * one_by_one()[:, 1] / HEIGHTS, rtol=1e-9
    )  # drift grows with the height squared


def test_a_tensor_ship_in_a_sea_of_floats_has_gradients():
    torch = pytest.importorskip("torch")
    sea = components(0.5, 6.0, 0.1, 3.3, 1)
    psi = torch.tensor(0.7, dtype=torch.float64, requires_grad=True)
    zero = torch.zeros((), dtype=torch.float64)
    _, Y, _ = drift(5.0, zero, zero, psi, sea, TABLE)
    Y.backward()
    ahead, behind = (drift(5.0, 0.0, 0.0, 0.7 + h, sea, TABLE)[1] for h in (1e-5, -1e-5))
    assert Y.item() == pytest.approx(drift(5.0, 0.0, 0.0, 0.7, sea, TABLE)[1])
    assert psi.grad.item() == pytest.approx((ahead - behind) / 2e-5, rel=1e-6)


@pytest.mark.parametrize(
    "arguments, said",
    [
        ((-0.1, 6.0, 0.0, 3.3, 1), "significant wave height is -0.1"),
        ((0.5, 0.0, 0.0, 3.3, 1), "peak period of the waves is 0.0"),
        ((0.5, 6.0, 0.0, 0.5, 1), "peak enhancement of the waves is 0.5"),
        ((0.5, 6.0, 0.0, 3.3, -1), "seed of the waves is -1"),
    ],
)
def test_an_impossible_sea_is_refused_by_name(arguments, said):
    with pytest.raises(ValueError, match=said):
        components(*arguments)


@pytest.mark.parametrize(
    "text, said",
    [
        ("1 0 1 0 0; 1 90 1 1 1", "from 0.0 to 90.0; must go from 0 to 180"),
        ("1 0 1 0 0; 1 180 1 1 1; 2 0 1 1 1", "every heading at every frequency"),
        ("1 0 1 0; 1 180 1 1", "rows 'omega heading X Y N'"),
    ],
)
def test_a_drift_table_that_is_no_full_grid_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        drift_table(text)
