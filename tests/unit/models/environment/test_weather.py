"""Weather: rates, ways round, directions; and its FMU."""

from importlib.util import module_from_spec, spec_from_file_location
from math import degrees, hypot, pi, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose

from shipcosim.models.environment.gusts import gust_std
from shipcosim.models.environment.weather import (
    EnvironmentParameters,
    EnvironmentState,
    air_velocity,
    step,
    water_velocity,
)

RATES = EnvironmentParameters(
    wind_speed_rate=0.7,
    wind_turn_rate=radians(9.0),
    current_speed_rate=0.01,
    current_turn_rate=radians(0.3),
)


def run(state, setpoints, duration, h):
    """Means at every step, (steps + 1, 4)."""
    states = [state]
    for _ in range(round(duration / h)):
        states.append(step(h, states[-1], *setpoints, parameters=RATES))
    return np.array(states)


def test_wind_turns_from_east_to_north_east_within_5_s_where_the_rate_says_so():
    means = run(EnvironmentState(10.0, pi / 2.0, 0.0, 0.0), (10.0, pi / 4.0, 0.0, 0.0), 6.0, 0.05)
    turned = means[:, 1]
    assert np.max(np.abs(np.diff(turned))) <= RATES.wind_turn_rate * 0.05 * (1.0 + 1e-9)
    assert (
        turned[99] > pi / 4.0
        and turned[101] == pytest.approx(pi / 4.0)
        and turned[-1] == pytest.approx(pi / 4.0)
    )


@pytest.mark.parametrize(
    "start, setpoint, quarter",
    [(170.0, -170.0, 175.0), (-170.0, 170.0, -175.0), (350.0, 10.0, -5.0)],
)
def test_directions_take_the_shortest_way_round(start, setpoint, quarter):
    state = EnvironmentState(10.0, radians(start), 0.5, radians(start))
    setpoints = 10.0, radians(setpoint), 0.5, radians(setpoint)
    assert degrees(run(state, setpoints, 5.0 / 9.0, 5.0 / 9.0)[-1, 1]) == pytest.approx(quarter)
    assert degrees(run(state, setpoints, 5.0 / 0.3, 5.0 / 0.3)[-1, 3]) == pytest.approx(quarter)


def test_speeds_ramp_at_their_rates_and_stop_at_the_setpoint():
    means = run(EnvironmentState(5.0, 0.0, 0.5, 0.0), (12.0, 0.0, 0.2, 0.0), 40.0, 0.1)
    time = 0.1 * np.arange(len(means))
    assert_allclose(means[:, 0], np.minimum(5.0 + 0.7 * time, 12.0), rtol=1e-9)
    assert_allclose(means[:, 2], np.maximum(0.5 - 0.01 * time, 0.2), rtol=1e-9)


def test_means_do_not_depend_on_the_step():
    state, setpoints = EnvironmentState(5.0, 3.0, 0.1, -3.0), (12.0, -2.0, 0.5, 1.0)
    assert_allclose(
        run(state, setpoints, 30.0, 0.05)[::2], run(state, setpoints, 30.0, 0.1), rtol=1e-9
    )


def test_air_goes_away_from_where_the_wind_comes_from_and_water_to_where_it_flows():
    means = EnvironmentState(
        8.0, radians(45.0), 0.3, pi
    )  # four corners: wind from north-east, current to the south
    wind = air_velocity(0.0, means, gust_scale=0.0, seed=1)
    assert_allclose(wind, [-8.0 / np.sqrt(2.0)] * 2)
    assert_allclose(water_velocity(means), [-0.3, 0.0], atol=1e-12)


def test_gusts_blow_along_the_mean_wind_with_their_scale():
    means = EnvironmentState(10.0, radians(30.0), 0.0, 0.0)
    once, twice = (air_velocity(7.0, means, gust_scale=scale, seed=4) for scale in (1.0, 2.0))
    assert once[1] / once[0] == pytest.approx(np.tan(radians(30.0)))
    assert hypot(*twice) - 10.0 == pytest.approx(2.0 * (hypot(*once) - 10.0))


def test_floats_arrays_and_tensors_agree():
    torch = pytest.importorskip("torch")
    states = np.array([[5.0, 10.0], [0.3, -3.1], [0.2, 0.4], [3.0, 1.0]])
    setpoints = np.array([[7.0, 9.99], [0.1, 3.1], [0.0, 0.4], [-3.0, 1.5]])

    def results(state, setpoint, seed):
        means = step(0.1, EnvironmentState(*state), *setpoint, parameters=RATES)
        return [
            *means,
            *air_velocity(3.0, means, gust_scale=1.0, seed=seed),
            *water_velocity(means),
        ]

    expected = [results(states[:, i].tolist(), setpoints[:, i].tolist(), i) for i in range(2)]
    assert_allclose(np.transpose(results(list(states), list(setpoints), np.arange(2))), expected)
    tensors = [[torch.tensor(row) for row in rows] for rows in (states, setpoints)]
    assert_allclose(torch.stack(results(*tensors, np.arange(2)), -1), expected)


@pytest.fixture
def environment(root):
    """A new instance of the FMU's class in the weather of a scenario."""
    spec = spec_from_file_location(
        "environment_under_test", root / "fmus/environment/environment.py"
    )
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    fmu = module.Environment()
    fmu.wind_speed, fmu.wind_from, fmu.current_speed, fmu.current_to = 10.0, 1.0, 0.5, 2.0
    fmu.significant_wave_height, fmu.peak_period, fmu.waves_from = 0.5, 6.0, 1.0
    return fmu


def test_fmu_starts_in_the_weather_that_is_set_and_starts_again_the_same(environment):
    environment.start()
    first = dict(vars(environment))
    assert environment.wind_speed_mean == 10.0 and environment.current_north == pytest.approx(
        0.5 * np.cos(2.0)
    )
    environment.step(0.0, 0.05)
    environment.start()
    assert {name: value for name, value in vars(environment).items() if name != "model"} == {
        name: value for name, value in first.items() if name != "model"
    }


def test_fmu_gives_gusts_and_waves_of_the_size_asked_for(environment):
    environment.start()
    rows = []
    for k in range(24_000):
        environment.step(0.1 * k, 0.1)
        rows.append((environment.wind_north, environment.wind_east, environment.elevation))
    north, east, elevation = np.transpose(rows)
    # one record of 2400 s: 4 periods of the slowest gust, some 10 independent groups of waves
    assert np.std(np.hypot(north, east)) == pytest.approx(gust_std(10.0), rel=0.15)
    assert 4.0 * np.std(elevation) == pytest.approx(0.5, rel=0.1)


def test_half_the_step_gives_the_same_weather(environment):
    def weather(h):
        environment.wind_speed = 10.0
        environment.start()
        environment.wind_speed, rows = 14.0, []
        for k in range(round(20.0 / h)):
            environment.step(k * h, h)
            rows.append((environment.wind_north, environment.wind_east, environment.elevation))
        return np.array(rows)

    assert_allclose(weather(0.05)[1::2], weather(0.1), rtol=0.0, atol=1e-9)
