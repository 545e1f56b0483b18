"""Sensors: sizes and spectra of their errors, their clock; and the FMU."""

from dataclasses import fields, replace
from importlib.util import module_from_spec, spec_from_file_location
from math import degrees, pi, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose
from ships import equipped
from ships import parameters as parameters_of

from shipcosim.models.core.sampling import normals, samples_due
from shipcosim.models.ship.sensors import SensorParameters, Truth, start, step

REST = Truth(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0)
ALL = parameters_of(SensorParameters)
PERFECT = replace(
    ALL, **{field.name: 0.0 for field in fields(SensorParameters) if field.name.endswith(("_std", "_noise"))}
)


def record(truth, parameters, duration, h=0.1):
    """Measurements after every step, (steps + 1, 8); `truth` is a function of time."""
    state = start(0.0, truth(0.0), parameters=parameters)
    rows = [state.measured]
    for k in range(round(duration / h)):
        state = step(k * h, state, truth(k * h), parameters=parameters)
        rows.append(state.measured)
    return np.array(rows)


def test_wandering_error_keeps_its_stationary_size_and_forgets_with_its_time_constant():
    parameters = replace(PERFECT, position_drift_std=0.1, position_drift_time=4.0)
    error = record(lambda t: REST, parameters, 8000.0)[1:, :2]  # 1000 independent pieces per axis
    assert_allclose(np.std(error, axis=0), 0.1, rtol=0.09)  # 4 standard errors
    for lag in (2.0, 4.0, 8.0):
        k = round(lag / 0.1)
        correlation = np.mean(error[k:] * error[:-k], axis=0) / np.mean(error**2, axis=0)
        assert_allclose(correlation, np.exp(-lag / 4.0), atol=0.12)


def test_wandering_error_has_its_stationary_size_from_the_first_sample_on():
    first = [start(0.0, REST, parameters=replace(PERFECT, position_drift_std=0.1, seed=k)).measured for k in range(800)]
    assert_allclose(np.std(np.array(first)[:, :2], axis=0), 0.1, rtol=0.1)  # 4 standard errors


def test_white_errors_have_the_sizes_of_the_sheet_and_no_memory():
    parameters = replace(ALL, position_drift_std=0.0, heading_drift_std=0.0)
    error = record(lambda t: REST, parameters, 2000.0)[1:] - REST
    expected = [0.2, 0.2, radians(0.1), 0.02, 0.02, radians(0.05), 0.02 * 10.0, radians(1.0)]
    assert_allclose(np.std(error, axis=0), expected, rtol=0.02)  # 4 standard errors of 20 000 samples
    correlation = np.corrcoef(np.hstack([error[:-1], error[1:]]).T) - np.eye(16)
    assert np.max(np.abs(correlation)) < 0.035  # 5 standard errors; 120 pairs


def test_biases_shift_position_and_heading():
    parameters = replace(PERFECT, x_bias=0.2, y_bias=-0.1, psi_bias=radians(0.1))
    assert_allclose(start(0.0, REST, parameters=parameters).measured[:3], [0.2, -0.1, radians(0.1)])


def test_half_the_step_gives_the_same_measurements():
    def truth(t):
        angle = 2.0 * pi * t / 7.0
        return Truth(np.sin(angle), 5.0, 3.1 + 0.1 * np.sin(angle), 0.3, 0.1, 0.0, 9.0 + np.sin(angle), 1.0)

    coarse, fine = (record(truth, ALL, 300.0, h) for h in (0.05, 0.025))
    assert_allclose(fine[::2], coarse, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("h", [0.01, 0.03, 0.05, 0.1, 0.25])
def test_every_sample_is_taken_once_whatever_the_step(h):
    state = start(0.0, REST, parameters=ALL)
    for k in range(1, 3001):
        state = step(k * h, state, REST, parameters=ALL)
        assert state.taken == (1000 * k * round(1000 * h)) // 100_000 + 1


def test_samples_are_counted_without_rounding():
    assert [samples_due(k * 0.1, 0.1) for k in range(100_000)] == list(range(1, 100_001))
    assert [samples_due(k * 0.05, 0.1) for k in range(1000)] == [k // 2 + 1 for k in range(1000)]


def test_measurement_is_the_truth_at_the_sample_time():
    values = record(lambda t: REST._replace(x=t), PERFECT, 1.0, 0.025)[:, 0]
    shown = [0.1 * ((k - 1) // 4) if k else 0.0 for k in range(41)]
    assert_allclose(values, shown, atol=1e-12)


def test_measured_heading_stays_within_half_a_turn():
    psi = record(lambda t: REST._replace(psi=pi), ALL, 100.0)[:, 2]
    assert np.all((psi >= -pi) & (psi < pi)) and psi.min() < -3.0 and psi.max() > 3.0


def test_wind_is_the_mean_of_3_s():
    wind = record(lambda t: REST._replace(apparent_wind_speed=4.0 if t < 9.95 else 10.0), PERFECT, 20.0)[:, 6]
    time = 0.1 * np.arange(len(wind))
    assert_allclose(wind, np.interp(time, [10.0, 13.0], [4.0, 10.0]), atol=1e-9)


def test_wind_that_swings_about_the_stern_does_not_average_to_the_bow():
    side = [radians(170.0), radians(-170.0)]
    wind = record(lambda t: REST._replace(apparent_wind_from=side[round(t / 0.1) % 2]), PERFECT, 6.0)[40:, 7]
    assert_allclose(np.abs(np.degrees(wind)), 180.0, atol=0.5)


def test_random_numbers_depend_on_purpose_seed_and_sample_alone():
    assert normals("sensors", 1, 700, 3) == normals("sensors", 1, 700, 3)
    others = [normals("sensors", 2, 700, 3), normals("sensors", 1, 701, 3), normals("waves", 1, 700, 3)]
    assert all(other[0] != normals("sensors", 1, 700, 3)[0] for other in others)


def test_floats_arrays_and_tensors_agree():
    torch = pytest.importorskip("torch")
    truths = np.array(
        [[3.0, -4.0], [1.0, 2.0], [3.14, -1.0], [0.4, 0.0], [0.1, 0.0], [0.0, 0.1], [9.0, 3.0], [3.1, 0.2]]
    )

    def results(truth, seed):
        parameters = replace(ALL, seed=seed)
        state = start(0.0, truth, parameters=parameters)
        return step(0.5, state, truth, parameters=parameters).measured

    expected = [results(Truth(*truths[:, i].tolist()), 6 + i) for i in range(2)]
    assert_allclose(np.transpose(results(Truth(*truths), np.array([6, 7]))), expected)
    tensors = results(Truth(*[torch.tensor(row) for row in truths]), 6)
    assert_allclose(torch.stack(tensors, -1)[0], expected[0])


@pytest.fixture
def sensors(root):
    """A new instance of the FMU's class."""
    spec = spec_from_file_location("sensors_under_test", root / "fmus/sensors/sensors.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return equipped(module.Sensors(), "sensors")


def test_fmu_measures_the_sum_of_low_frequency_and_wave_motion(sensors):
    for name in ("position_drift_std", "position_noise_std", "heading_drift_std", "heading_noise_std"):
        setattr(sensors, name, 0.0)
    sensors.velocity_noise_std = sensors.yaw_rate_noise_std = 0.0
    sensors.x, sensors.x_wave, sensors.psi, sensors.psi_wave, sensors.u, sensors.u_wave = 3.0, 0.2, pi, 0.1, 0.5, -0.2
    sensors.start()
    assert sensors.x_meas == pytest.approx(3.2) and sensors.u_meas == pytest.approx(0.3)
    assert degrees(sensors.psi_meas) == pytest.approx(degrees(0.1 - pi))


def test_fmu_starts_again_the_same_and_holds_between_samples(sensors):
    sensors.start()
    first = sensors.x_meas
    sensors.step(0.0, 0.05)
    sensors.step(0.05, 0.05)
    assert sensors.x_meas == first
    sensors.step(0.1, 0.05)
    assert sensors.x_meas != first
    sensors.start()
    assert sensors.x_meas == first
