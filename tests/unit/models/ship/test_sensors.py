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
from shipcosim.models.ship import sensors as model
from shipcosim.models.ship.mast import MastParameters, wind_at_mast, wind_from_mast
from shipcosim.models.ship.sensors import (
    CompassFailure,
    ReferenceFailure,
    SensorFailures,
    SensorParameters,
    Truth,
    WindFailure,
)

REST = Truth(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0)
HEALTHY = SensorFailures()
AT_ORIGIN = MastParameters(mast_x=0.0, mast_y=0.0, mast_height=10.0)
AS_SHE_HAS_IT = parameters_of(SensorParameters)
ALL = replace(  # every channel at 10 Hz and at once, so that one table holds all
    AS_SHE_HAS_IT,
    heading_latency=0.0,
    position_period=0.1,
    position_latency=0.0,
    wind_period=0.1,
    wind_latency=0.0,
)
PERFECT = replace(
    ALL,
    **{
        field.name: 0.0
        for field in fields(SensorParameters)
        if field.name.endswith(("_std", "_noise"))
    },
)


def start(t, truth, parameters, failures=HEALTHY, mast=AT_ORIGIN):
    return model.start(t, truth, failures, parameters=parameters, mast=mast)


def step(t, state, truth, parameters, failures=HEALTHY, mast=AT_ORIGIN):
    return model.step(t, state, truth, failures, parameters=parameters, mast=mast)


def measured(state, reference=0):
    """x, y, psi, u, v, r, wind speed and direction, by one position reference and the first compass."""
    given = state.telegrams
    fix = given.positions[reference]
    return (fix.x, fix.y, given.compasses[0].psi, fix.u, fix.v, given.r, *given.wind[:2])


def states(truth, parameters, duration, h=0.1, failures=lambda t: HEALTHY):
    """State at the start and after every step; `truth` and `failures` are functions of time."""
    found = [start(0.0, truth(0.0), parameters, failures(0.0))]
    for k in range(round(duration / h)):
        found.append(step(k * h, found[-1], truth(k * h), parameters, failures(k * h)))
    return found


def record(truth, parameters, duration, h=0.1):
    """Measurements after every step, (steps + 1, 8)."""
    return np.array([measured(state) for state in states(truth, parameters, duration, h)])


def test_wandering_error_keeps_its_stationary_size_and_forgets_with_its_time_constant():
    parameters = replace(PERFECT, position_drift_std=0.1, position_drift_time=4.0)
    h = 0.5  # s; four of 0.1 s between would tell no more
    error = record(lambda t: REST, parameters, 8000.0, h)[
        1:, :2
    ]  # 1000 independent pieces per axis
    assert_allclose(np.std(error, axis=0), 0.1, rtol=0.09)  # 4 standard errors
    for lag in (2.0, 4.0, 8.0):
        k = round(lag / h)
        correlation = np.mean(error[k:] * error[:-k], axis=0) / np.mean(error**2, axis=0)
        assert_allclose(correlation, np.exp(-lag / 4.0), atol=0.12)


def test_wandering_error_has_its_stationary_size_from_the_first_sample_on():
    first = [
        measured(start(0.0, REST, replace(PERFECT, position_drift_std=0.1, seed=k)))
        for k in range(800)
    ]
    assert_allclose(np.std(np.array(first)[:, :2], axis=0), 0.1, rtol=0.1)  # 4 standard errors


def test_white_errors_have_the_sizes_of_the_sheet_and_no_memory():
    parameters = replace(ALL, position_drift_std=0.0, heading_drift_std=0.0)
    error = record(lambda t: REST, parameters, 2000.0)[1:] - REST
    expected = [0.2, 0.2, radians(0.1), 0.02, 0.02, radians(0.05), 0.02 * 10.0, radians(1.0)]
    assert_allclose(
        np.std(error, axis=0), expected, rtol=0.02
    )  # 4 standard errors of 20 000 samples
    correlation = np.corrcoef(np.hstack([error[:-1], error[1:]]).T) - np.eye(16)
    assert np.max(np.abs(correlation)) < 0.035  # 5 standard errors; 120 pairs


def test_half_the_step_gives_the_same_measurements():
    def truth(t):
        angle = 2.0 * pi * t / 7.0
        return Truth(
            np.sin(angle), 5.0, 3.1 + 0.1 * np.sin(angle), 0.3, 0.1, 0.0, 9.0 + np.sin(angle), 1.0
        )

    coarse, fine = (record(truth, ALL, 300.0, h) for h in (0.05, 0.025))
    assert_allclose(fine[::2], coarse, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("h", [0.01, 0.03, 0.05, 0.1, 0.25])
def test_every_sample_is_taken_once_whatever_the_step(h):
    state = start(0.0, REST, ALL)
    for k in range(1, 3001):
        state = step(k * h, state, REST, ALL)
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
    wind = record(
        lambda t: REST._replace(apparent_wind_speed=4.0 if t < 9.95 else 10.0), PERFECT, 20.0
    )[:, 6]
    time = 0.1 * np.arange(len(wind))
    assert_allclose(wind, np.interp(time, [10.0, 13.0], [4.0, 10.0]), atol=1e-9)


def test_wind_that_swings_about_the_stern_does_not_average_to_the_bow():
    side = [radians(170.0), radians(-170.0)]
    wind = record(
        lambda t: REST._replace(apparent_wind_from=side[round(t / 0.1) % 2]), PERFECT, 6.0
    )[40:, 7]
    assert_allclose(np.abs(np.degrees(wind)), 180.0, atol=0.5)


def test_random_numbers_depend_on_purpose_seed_and_sample_alone():
    assert normals("sensors", 1, 700, 3) == normals("sensors", 1, 700, 3)
    others = [
        normals("sensors", 2, 700, 3),
        normals("sensors", 1, 701, 3),
        normals("waves", 1, 700, 3),
    ]
    assert all(other[0] != normals("sensors", 1, 700, 3)[0] for other in others)


def test_three_references_and_two_compasses_err_apart_from_each_other():
    parameters = replace(ALL, position_drift_time=1.0, heading_drift_time=1.0)
    given = [state.telegrams for state in states(lambda t: REST, parameters, 2000.0)]
    errors = [
        [*(value for fix in g.positions for value in fix[:4]), *(c.psi for c in g.compasses)]
        for g in given
    ]
    correlation = np.corrcoef(np.transpose(errors)) - np.eye(14)
    assert (
        np.max(np.abs(correlation)) < 0.06
    )  # 5 standard errors of the drifts, whose samples are not independent


def test_each_channel_has_its_period_and_latency():
    """Positions each second, 0.3 s late; headings each 0.1 s, 0.1 s late; wind each second, 0.5 s late."""
    parameters = replace(
        PERFECT,
        heading_latency=0.1,
        position_period=1.0,
        position_latency=0.3,
        wind_period=1.0,
        wind_latency=0.5,
    )
    parameters = replace(parameters, wind_average_time=0.1)

    def truth(t):
        return REST._replace(x=t, psi=0.1 * t, apparent_wind_speed=t)

    for k, state in enumerate(states(truth, parameters, 5.0)[1:]):
        given, t = state.telegrams, 0.1 * k
        times = (
            max(0.0, np.floor(t - 0.3 + 1e-9)),
            max(0.0, t - 0.1),
            max(0.0, np.floor(t - 0.5 + 1e-9)),
        )
        assert_allclose(given[4:], times, atol=1e-9)
        shown = given.positions[0].x, given.compasses[1].psi / 0.1, given.wind.speed
        assert_allclose(shown, times, atol=1e-9)


def test_half_the_step_gives_the_same_telegrams_as_the_ship_has_them():
    def truth(t):
        return REST._replace(x=np.sin(t), psi=0.1 * np.sin(t), apparent_wind_speed=9.0 + np.sin(t))

    def failures(t):
        return SensorFailures(
            positions=(ReferenceFailure(north_rate=0.1 if t >= 4.0 else 0.0),) * 3
        )

    coarse, fine = (states(truth, AS_SHE_HAS_IT, 60.0, h, failures) for h in (0.05, 0.025))
    given = [[[*fix[:4]] for fix in state.telegrams.positions] for state in coarse]
    assert_allclose(
        [[[*fix[:4]] for fix in state.telegrams.positions] for state in fine[::2]],
        given,
        atol=1e-12,
    )
    assert [state.telegrams[1:] for state in fine[::2]] == [state.telegrams[1:] for state in coarse]


def failing(positions=(), compasses=(), **wind):
    """Failures from 5 s on: of the first sensors as given, nothing of the others."""
    positions = (*positions, *HEALTHY.positions)[:3]
    failed = SensorFailures(positions, (*compasses, *HEALTHY.compasses)[:2], WindFailure(**wind))
    given = [
        s.telegrams
        for s in states(moving, PERFECT, 20.0, failures=lambda t: failed if t > 4.95 else HEALTHY)
    ]
    return given[-1], given[50]


def moving(t):
    return REST._replace(x=0.3 * t, psi=0.01 * t, apparent_wind_speed=5.0 + 0.1 * t)


def test_a_lost_reference_says_so_and_a_frozen_one_does_not():
    late, at = failing([ReferenceFailure(lost=True), ReferenceFailure(frozen=True)])
    lost, frozen, healthy = late.positions
    assert (lost.valid, frozen.valid, healthy.valid) == (0.0, 1.0, 1.0)
    assert frozen.x == at.positions[1].x == lost.x and healthy.x == pytest.approx(0.3 * 19.9)


def test_a_reference_jumps_by_its_offset_and_drifts_from_when_it_is_told():
    late, _ = failing(
        [ReferenceFailure(north=4.0, east=-3.0), ReferenceFailure(north_rate=0.1, east_rate=-0.2)]
    )
    jumped, drifted, healthy = late.positions
    assert_allclose((jumped.x - healthy.x, jumped.y), (4.0, -3.0))
    assert_allclose(
        (drifted.x - healthy.x, drifted.y), (1.5, -3.0), atol=0.03
    )  # 15 s, one sample more or less


def test_a_drift_that_ends_leaves_nothing():
    def failures(t):
        return SensorFailures(
            (ReferenceFailure(north_rate=0.1 if 2.0 < t < 8.0 else 0.0), *HEALTHY.positions[1:])
        )

    given = [
        state.telegrams.positions
        for state in states(lambda t: REST, PERFECT, 10.0, failures=failures)
    ]
    assert given[80][0].x > 0.5 and given[-1][0].x == 0.0


def test_a_compass_is_lost_frozen_offset_or_runs_off():
    late, at = failing(compasses=[CompassFailure(lost=True), CompassFailure(frozen=True)])
    assert [c.valid for c in late.compasses] == [0.0, 1.0] and late.compasses[
        1
    ].psi == at.compasses[1].psi
    late, _ = failing(compasses=[CompassFailure(offset=0.2), CompassFailure(rate=0.01)])
    assert_allclose([c.psi for c in late.compasses], [0.199 + 0.2, 0.199 + 0.15], atol=2e-3)


def test_the_anemometer_is_lost_sticks_or_is_scaled():
    lost, stuck, wrong = (
        failing(**{name: value})[0].wind
        for name, value in (("lost", True), ("frozen", True), ("scale", 2.0))
    )
    healthy, at = failing()
    assert (lost.valid, stuck.valid) == (0.0, 1.0)
    assert stuck.speed == at.wind.speed < healthy.wind.speed and wrong.speed == pytest.approx(
        2.0 * healthy.wind.speed
    )


def test_wind_at_the_mast_is_stronger_with_height_and_has_the_turn_of_the_ship():
    mast = MastParameters(mast_x=5.0, mast_y=-2.0, mast_height=20.0)
    ahead, starboard = wind_at_mast(10.0, 0.0, 0.0, 0.0, 0.1, mast=mast)
    assert_allclose((ahead, starboard), (10.0 * 2.0**0.12 + 0.2, 0.5))


def test_a_ship_that_moves_in_calm_air_has_her_own_wind_at_any_height():
    """The profile is of the air over ground: her own speed is not multiplied."""
    mast = MastParameters(mast_x=0.0, mast_y=0.0, mast_height=20.0)
    assert_allclose(wind_at_mast(5.0, 0.0, 5.0, 0.0, 0.0, mast=mast), (5.0, 0.0), atol=1e-12)


def test_the_wind_on_the_ship_is_found_again_from_the_mast():
    mast, motion = MastParameters(mast_x=5.0, mast_y=-2.0, mast_height=20.0), (0.8, -0.3, 0.05)
    ahead, starboard = wind_at_mast(7.0, 2.1, *motion, mast=mast)
    found = wind_from_mast(
        np.hypot(ahead, starboard), np.arctan2(starboard, ahead), *motion, mast=mast
    )
    assert_allclose(found, (7.0, 2.1))


def test_floats_arrays_and_tensors_agree():
    torch = pytest.importorskip("torch")
    truths = np.array(
        [
            [3.0, -4.0],
            [1.0, 2.0],
            [3.14, -1.0],
            [0.4, 0.0],
            [0.1, 0.0],
            [0.0, 0.1],
            [9.0, 3.0],
            [3.1, 0.2],
        ]
    )

    def results(truth, seed):
        parameters = replace(AS_SHE_HAS_IT, seed=seed)
        state = step(1.5, start(0.0, truth, parameters), truth, parameters)
        return measured(state, 2)

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
    for name in (
        "position_drift_std",
        "position_noise_std",
        "heading_drift_std",
        "heading_noise_std",
    ):
        setattr(sensors, name, 0.0)
    sensors.velocity_noise_std = sensors.yaw_rate_noise_std = 0.0
    sensors.x, sensors.x_wave, sensors.psi, sensors.psi_wave, sensors.u, sensors.u_wave = (
        3.0,
        0.2,
        pi,
        0.1,
        0.5,
        -0.2,
    )
    sensors.start()
    assert sensors.x_1_meas == sensors.x_3_meas == pytest.approx(
        3.2
    ) and sensors.u_2_meas == pytest.approx(0.3)
    assert (
        degrees(sensors.psi_1_meas)
        == degrees(sensors.psi_2_meas)
        == pytest.approx(degrees(0.1 - pi))
    )


def test_fmu_takes_failures_by_reference(sensors):
    sensors.start()
    sensors.position_2_lost, sensors.compass_1_lost, sensors.wind_lost, sensors.position_3_north = (
        True,
        True,
        True,
        9.0,
    )
    for k in range(40):
        sensors.step(k * 0.05, 0.05)
    assert (sensors.position_1_valid, sensors.position_2_valid, sensors.position_3_valid) == (
        True,
        False,
        True,
    )
    assert (sensors.compass_1_valid, sensors.compass_2_valid, sensors.wind_valid) == (
        False,
        True,
        False,
    )
    assert sensors.x_3_meas > 7.0 > sensors.x_1_meas


def test_fmu_starts_again_the_same_and_holds_between_samples(sensors):
    sensors.start()
    first = sensors.r_meas
    for k in range(3):
        sensors.step(k * 0.05, 0.05)
    assert sensors.r_meas == first and sensors.heading_time_meas == 0.0
    for k in range(3, 5):
        sensors.step(k * 0.05, 0.05)
    assert sensors.r_meas != first and sensors.heading_time_meas == pytest.approx(0.1)
    sensors.start()
    assert sensors.r_meas == first
