import numpy as np
import pytest

from truth import sensors
from truth.knobs import NEUTRAL, SENSOR
from truth.weather import Weather, draw_weather, elevation, gauss_markov, wind_series

CALM = Weather(6.0, 0.5, 0.1, 0.0, 5.0, 0.5)
ROWS, GRID = 601, np.arange(-240.0, 730.0, 0.5)
WHEN = (np.arange(ROWS),) * 3


def knobs(**turned):
    return np.array([np.full(GRID.size, turned.get(name, NEUTRAL[name])) for name in SENSOR])


def silent():
    """Instruments without noise and without averaging."""
    ticks = 1000
    zero = np.zeros
    return sensors.Noise(zero((3, ticks)), zero((8, ticks)), zero((8, ROWS)), zero((5, ROWS)), 0.5)


def turning(rate=0.02, speed=1.0):
    """Record of a ship that sails a circle, and where it is."""
    psi = rate * GRID
    still = np.zeros(GRID.size)
    record = {
        "x": speed / rate * np.sin(psi),
        "y": -speed / rate * np.cos(psi),
        "psi": psi,
        "u": still + speed,
    }
    record |= {"v": still, "r": still + rate, "roll": still, "roll_rate": still}
    return record | {name: still + 10.0 * i for i, name in enumerate(sensors.THRUSTER_ROWS)}


def log(wind=(0.0, 0.0), record=None, **turned):
    record = (record or turning()) | {"sensor": knobs(**turned)}
    wind = np.repeat(np.array(wind)[:, None], GRID.size, axis=1)
    return sensors.log_channels(
        record, GRID, WHEN, CALM, wind, np.zeros(GRID.size, complex), silent()
    )


def test_without_noise_the_log_is_the_truth():
    channels = log()
    t = np.arange(ROWS)
    np.testing.assert_allclose(channels["north"], 50 * np.sin(0.02 * t), atol=0.01)
    np.testing.assert_allclose(channels["heading"], np.degrees(0.02 * t))
    np.testing.assert_allclose(channels["surge"], 1.0)
    np.testing.assert_allclose(channels["sway"], 0.0, atol=1e-12)
    np.testing.assert_allclose(channels["yaw_rate"], np.degrees(0.02))


def test_a_heading_bias_turns_the_velocities_too():
    channels = log(heading_bias=np.radians(5.0))
    np.testing.assert_allclose(channels["heading"] - log()["heading"], 5.0)
    np.testing.assert_allclose(channels["surge"], np.cos(np.radians(5)))
    np.testing.assert_allclose(channels["sway"], -np.sin(np.radians(5)))
    np.testing.assert_allclose(channels["north"], log()["north"])


def test_position_and_velocity_are_of_the_antenna():
    channels = log(lever_x=6.0, lever_y=-2.0)
    np.testing.assert_allclose(channels["surge"], 1.0 + 0.02 * 2.0)
    np.testing.assert_allclose(channels["sway"], 0.02 * 6.0)
    t = np.arange(ROWS)
    arm = 6 * np.cos(0.02 * t) + 2 * np.sin(0.02 * t)
    np.testing.assert_allclose(channels["north"] - log()["north"], arm, atol=0.01)
    rate = np.gradient(channels["north"])[1:-1]
    heading = np.radians(channels["heading"][1:-1])
    seen = np.cos(heading) * channels["surge"][1:-1] - np.sin(heading) * channels["sway"][1:-1]
    np.testing.assert_allclose(rate, seen, atol=0.005)


def test_velocity_scale_is_logged_over_true():
    np.testing.assert_allclose(log(velocity_scale=1.1)["surge"], 1.1)
    np.testing.assert_allclose(log(velocity_scale=1.1)["north"], log()["north"])


def test_a_moving_ship_in_a_calm_feels_wind_from_ahead():
    channels = log()
    np.testing.assert_allclose(channels["wind_speed"], 1.0)
    np.testing.assert_allclose(np.mod(channels["wind_from"] + 1, 360), 1.0, atol=1e-6)


def test_wind_to_the_east_comes_from_port_of_a_ship_that_heads_north():
    still = turning() | {name: np.zeros(GRID.size) for name in ("psi", "u", "r")}
    assert np.mod(log(wind=(0.0, 8.0), record=still)["wind_from"][5], 360) == pytest.approx(270.0)
    off = log(wind=(0.0, 8.0), record=still, wind_direction=np.radians(10.0))["wind_from"][5]
    assert np.mod(off, 360) == pytest.approx(280.0)


def test_headings_wrap_and_channels_have_their_resolution():
    rounded = sensors.wrap_and_round(
        {"heading": np.array([359.96, -10.04]), "port_azimuth": np.array([190.0, -190.0])}
    )
    np.testing.assert_allclose(rounded["heading"], [0.0, 350.0])
    np.testing.assert_allclose(rounded["port_azimuth"], [-170.0, 170.0])


def test_running_mean_looks_back():
    ramp = np.arange(100.0)[None, :] * 0.5
    np.testing.assert_allclose(sensors.running_mean(ramp, 2.0, 0.5)[0, 10:], ramp[0, 10:] - 0.75)


def test_slow_noise_has_the_stated_size_and_memory():
    noise = gauss_markov(np.random.default_rng(0), 400_000, 1.0, 60.0)
    assert noise.std() == pytest.approx(1.0, rel=0.05)
    assert np.mean(noise[60:] * noise[:-60]) == pytest.approx(np.exp(-1), rel=0.1)
    starts = [gauss_markov(np.random.default_rng(s), 2, 1.0, 60.0)[0] for s in range(2000)]
    assert np.std(starts) == pytest.approx(1.0, rel=0.05)


def test_wind_gusts_by_the_stated_turbulence():
    mast, ship = wind_series(
        Weather(8.0, 0.3, 0.12, 0.2, 5.0, 0.3), np.random.default_rng(1), 200_000, 0.5
    )
    speed = np.hypot(*mast)
    assert speed.mean() == pytest.approx(8.0, rel=0.02)
    assert speed.std() / 8.0 == pytest.approx(0.12, rel=0.1)
    assert np.hypot(*ship).std() < speed.std()


def test_sea_has_its_height_and_period():
    weather = Weather(6.0, 0.0, 0.1, 0.3, 4.0, 0.0)
    sea = elevation(weather, np.random.default_rng(2), 200_000, 0.5)
    assert 4 * sea.real.std() == pytest.approx(0.3, rel=0.05)
    upwards = np.sum((sea.real[:-1] < 0) & (sea.real[1:] >= 0))
    assert 100_000 / upwards == pytest.approx(4.0, rel=0.05)


def test_weather_is_within_what_the_ship_can_hold():
    drawn = [draw_weather(np.random.default_rng(seed)) for seed in range(300)]
    assert max(w.wind_speed for w in drawn) <= 9.0 and max(w.wave_height for w in drawn) <= 0.3
