"""The linear problem is the derivative of the ship's motion; its filter and smoother are those of Gaussian theory."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from diagnose import twin
from scipy.linalg import expm

from shipcosim.diagnose.inference.innovations import (
    WAVE_DAMPING,
    Noise,
    _lost,
    _process,
    _steady,
    _uncertain,
    innovations,
    log_likelihoods,
    oscillation,
    smoothed,
)
from shipcosim.diagnose.inference.linearisation import (
    STATES,
    Linear,
    Regressor,
    advanced,
    linearise,
    rows_first,
)
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.models.core.motion import Motion

NOISE = Noise(twin.WHITE, twin.JOLT, np.array([1e-5, 1e-5, 1e-6]), 2.0 * twin.WHITE[3:], 1.1)
WRONG = {
    "port.thrust_loss": 0.1,
    "instruments.heading_bias": 0.03,
    "instruments.lever_x": 3.0,
    "instruments.velocity_scale": 1.05,
    "water.current_north": 0.2,
}
COLUMNS = [
    {"water.current_north": 0.2},
    {"vessel.mass_scale": 0.1},
    {"starboard.thrust_loss": 0.2},
    {"vessel.cross_flow_scale": 0.3},
    {"water.tow_east": 2000.0},
    {"instruments.thruster_lag": 0.5},
    {"instruments.lever_y": 4.0},
    {"instruments.heading_bias": 0.05},
]
REGRESSORS = [Regressor(changes) for changes in COLUMNS]


@cache
def about():
    """Record, ship and motion that the ship is linearised about, and the linear problem."""
    record = record_of(twin.logs()["healthy"], twin.model())
    model = twin.model().with_values(WRONG)
    motion = first_motion(record)
    return record, model, motion, linearise(motion, record, model, REGRESSORS)


def start_of_steps(motion):
    return Motion(*(value[:-1] for value in motion))


def close(found, expected, positions, velocities):
    """Within a share of the largest effect over the log, in position and heading of what the velocity does over 1 s."""
    for place, rate in (([0, 1], [3, 4]), ([2], [5])):
        scale = np.abs(expected[..., rate]).max() + 1e-12
        assert np.abs((found - expected)[..., rate]).max() < velocities * scale
        assert np.abs((found - expected)[..., place]).max() < positions * max(
            scale, np.abs(expected[..., place]).max()
        )


@pytest.mark.parametrize("state", Motion._fields)
def test_transition_is_the_derivative_of_a_step(state):
    """Up to third order of the step: 1 s against the ship's quickest mode of about 2 s at full speed."""
    record, model, motion, linear = about()
    start, small = start_of_steps(motion), 1e-4
    moved = (
        advanced(start._replace(**{state: getattr(start, state) + s}), record, model)
        for s in (small, -small)
    )
    up, down = (rows_first(rows) for rows in moved)
    found = linear.transition[:, :6, Motion._fields.index(state)]
    close(found, (up - down) / (2 * small), positions=0.08, velocities=0.04)


def test_a_slow_end_of_a_varying_current_is_not_turned_round_by_its_own_columns():
    """Both columns together, along the end itself, do what growing by a tenth does; the typical size is 15 times it."""
    record, model, motion, _ = about()
    ends = {
        "water.north_start": 0.15,
        "water.east_start": -0.1,
        "water.north_end": 0.012,
        "water.east_end": -0.008,
    }
    slow = replace(model, span=(record.time[0], record.time[-1])).with_values(ends)
    names = list(ends)
    pairs = dict.fromkeys(names[:2], tuple(names[:2])) | dict.fromkeys(names[2:], tuple(names[2:]))
    linear = linearise(
        motion, record, slow, [Regressor({name: 0.2}, vector=pair) for name, pair in pairs.items()]
    )
    ahead = (
        advanced(
            start_of_steps(motion),
            record,
            slow.with_values({name: by * ends[name] for name in list(ends)[2:]}),
        )
        for by in (1.05, 0.95)
    )
    up, down = (rows_first(rows) for rows in ahead)
    found = linear.driven[..., 3] * 0.012 / 0.2 - linear.driven[..., 4] * 0.008 / 0.2
    close(found, (down - up) / 0.1, positions=0.1, velocities=0.1)


def test_unexplained_acceleration_moves_the_ship_as_a_force_that_lasts_over_the_step():
    record, model, motion, linear = about()
    start, h, k = start_of_steps(motion), record.step, 100
    here = Motion(*(value[k] for value in start))
    inputs = [_at(record.inputs(model, share), k) for share in (0.0, 0.5, 1.0)]
    per_force = (
        np.stack(
            [
                np.array(motion_rates(here, inputs[0], model, tuple(1e3 * row)))[3:]
                for row in np.eye(3)
            ],
            axis=-1,
        )
        - np.array(motion_rates(here, inputs[0], model))[3:, None]
    )
    for axis in range(3):
        wanted = np.eye(3)[axis] * 1e-3
        force = tuple(1e3 * np.linalg.solve(per_force, wanted))
        brute = np.array(_step(here, inputs, model, h, force)) - np.array(
            _step(here, inputs, model, h, (0, 0, 0))
        )
        np.testing.assert_allclose(
            linear.transition[k, :6, 6 + axis] * 1e-3, brute, atol=0.05 * np.abs(brute).max()
        )


def _at(inputs, k):
    units = {name: (n[k], azimuth[k]) for name, (n, azimuth) in inputs.units.items()}
    return inputs._replace(
        time=inputs.time[k],
        units=units,
        wind_speed=inputs.wind_speed[k],
        wind_from=inputs.wind_from[k],
    )


def _step(motion, inputs, model, h, force):
    """A hundred Euler steps, with the inputs of the nearest of start, middle and end."""
    for i in range(100):
        rates = motion_rates(motion, inputs[round(i / 50)], model, force)
        motion = Motion(
            *(value + h / 100 * rate for value, rate in zip(motion, rates, strict=True))
        )
    return motion


def test_the_first_column_is_by_how_much_the_ship_misses_the_motion():
    record, model, motion, linear = about()
    ahead = Motion(*(value[1:] for value in motion))
    np.testing.assert_allclose(
        linear.driven[:, :6, 0],
        rows_first(advanced(start_of_steps(motion), record, model)) - rows_first(ahead),
    )
    np.testing.assert_allclose(
        linear.seen[..., 0], record.measured - rows_first(readings(motion, model))
    )


@pytest.mark.parametrize("column", range(6))
def test_what_a_number_does_over_a_step_is_the_difference_of_steps(column):
    record, model, motion, linear = about()
    ((path, size),) = COLUMNS[column].items()
    start = start_of_steps(motion)
    up, down = (
        rows_first(
            advanced(start, record, model.with_values({path: model.get(path) + sign * 0.05 * size}))
        )
        for sign in (1.0, -1.0)
    )
    brute = (down - up) / (0.1 * size) * size
    # lags over rows whose inputs have corners: linear between rows, so differences see one slope or the other
    share = 0.15 if path.endswith("_lag") else 0.05
    close(linear.driven[:, :6, 1 + column][5:-5], brute[5:-5], positions=share, velocities=share)
    assert (linear.seen[..., 1 + column] == 0.0).all()


@pytest.mark.parametrize("column", [6, 7])
def test_what_an_instrument_shows_is_the_difference_of_what_is_shown(column):
    record, model, motion, linear = about()
    ((path, size),) = COLUMNS[column].items()
    up, down = (
        rows_first(
            readings(motion, model.with_values({path: model.get(path) + sign * 0.01 * size}))
        )
        for sign in (1.0, -1.0)
    )
    close(linear.seen[..., 1 + column], (up - down) / 0.02, positions=0.01, velocities=0.01)
    assert (linear.driven[..., 1 + column] == 0.0).all()


@pytest.mark.parametrize("state", Motion._fields)
def test_output_is_the_derivative_of_what_is_shown_and_of_slow_errors(state):
    record, model, motion, linear = about()
    up, down = (
        rows_first(readings(motion._replace(**{state: getattr(motion, state) + s}), model))
        for s in (1e-5, -1e-5)
    )
    i = Motion._fields.index(state)
    np.testing.assert_allclose(linear.output[..., i], (up - down) / 2e-5, atol=2e-3)
    np.testing.assert_array_equal(
        linear.output[:, :3, 9:12], np.broadcast_to(np.eye(3), (motion.x.size, 3, 3))
    )
    assert (linear.output[:, 3:, 9:12] == 0.0).all()


def test_waves_move_the_ship_in_her_own_axes():
    """A place 1 m ahead is seen along the heading; their velocity as it is."""
    _, model, motion, linear = about()
    psi = np.asarray(readings(motion, model).psi)
    np.testing.assert_allclose(
        linear.output[:, :3, 12], np.stack([np.cos(psi), np.sin(psi), 0.0 * psi], axis=-1)
    )
    np.testing.assert_allclose(
        linear.output[:, :3, 13], np.stack([-np.sin(psi), np.cos(psi), 0.0 * psi], axis=-1)
    )
    np.testing.assert_array_equal(
        linear.output[:, 3:, 15:], np.broadcast_to(np.eye(3), (psi.size, 3, 3))
    )
    np.testing.assert_array_equal(linear.output[:, 2, 14], 1.0)


def test_waves_are_an_oscillator_moved_by_white_noise():
    """Transition by the matrix exponential, what a step adds by Van Loan's (1978) block exponential."""
    h, w, z = 0.7, 1.1, WAVE_DAMPING
    noise = Noise(np.ones(6), np.ones(3), np.ones(3), np.array([0.3, 0.2, 0.1]), w)
    transition, added = oscillation(noise, h)
    F = np.array([[0.0, 1.0], [-w * w, -2.0 * z * w]])
    np.testing.assert_allclose(np.concatenate(transition).reshape(2, 2), expm(F * h), rtol=1e-12)
    for i, speed in enumerate(noise.wave):
        strength = np.diag(
            [0.0, 4.0 * z * w * speed**2]
        )  # so that the variance of the velocity stays speed**2
        block = expm(np.block([[-F, strength], [np.zeros((2, 2)), F.T]]) * h)
        Q = block[2:, 2:].T @ block[:2, 2:]
        np.testing.assert_allclose(
            [entry[i] for entry in added], Q[[0, 0, 1], [0, 1, 1]], rtol=1e-9
        )


def test_steps_over_which_nothing_is_known_teach_nothing():
    record, model, motion, _ = about()
    known = record.usable.copy()
    known[50:60] = False
    linear = linearise(motion, _with(record, known), model, REGRESSORS)
    assert (linear.driven[50:60] == 0.0).all() and (linear.driven[49] != 0.0).any()


def _with(record, known):
    return type(record)(record.time, record.measured, record.units, record.wind, known)


@cache
def tiny(n=5):
    """A problem of a few rows with rows of everything: channels missing, a step not known, two columns besides."""
    random, record = np.random.default_rng(4), about()[0]
    known = np.ones(n, bool)
    known[2] = False
    record = type(record)(np.arange(float(n)), np.zeros((n, 6)), {}, None, known)
    whole = random.uniform(size=(n, 6)) > 0.2
    A = np.eye(STATES) + 0.2 * random.standard_normal((n - 1, STATES, STATES))
    A -= A * (_steady(Noise(0.0, 0.0, 0.0), 1.0) != 0.0)  # those are the same at all rows
    H = random.standard_normal((n, 6, STATES))
    B, Z = (
        random.standard_normal((n - 1, STATES, 3)),
        random.standard_normal((n, 6, 3)) * whole[..., None],
    )
    levels = random.uniform(0.3, 1.0, 6), random.uniform(0.1, 0.5, 3), random.uniform(0.01, 0.1, 3)
    noise = Noise(*levels, random.uniform(0.2, 0.4, 3), 1.1)
    return Linear(A, B, H, Z, whole), noise, record


@cache
def dense():
    """The same without a filter: the covariance of all measurements, their deviations, and that of states with them."""
    (A, B, H, Z, whole), noise, record = tiny()
    n, A = len(Z), A + _steady(noise, record.step)
    covariance = {(0, 0): _uncertain(noise)}
    mean = [np.zeros((STATES, Z.shape[-1]))]
    for k in range(n - 1):
        mean.append(A[k] @ mean[k] + B[k])
        Q = _process(noise, record.step) + (0.0 if record.usable[k] else 1.0) * _lost()
        for j in range(k + 1):
            covariance[k + 1, j] = A[k] @ covariance[k, j]
            covariance[j, k + 1] = covariance[k + 1, j].T
        covariance[k + 1, k + 1] = A[k] @ covariance[k, k] @ A[k].T + Q
    P = np.block([[covariance[i, j] for j in range(n)] for i in range(n)])
    rows = whole.ravel()
    big = np.zeros((n * 6, n * STATES))
    for k in range(n):
        big[6 * k : 6 * k + 6, STATES * k : STATES * (k + 1)] = H[k]
    big = big[rows]
    S = big @ P @ big.T + np.diag(np.tile(noise.white**2, n)[rows])
    means = np.concatenate(mean)
    return S, Z.reshape(n * 6, -1)[rows] - big @ means, P @ big.T, means


def test_log_likelihood_is_that_of_the_joint_normal():
    linear, noise, record = tiny()
    found, (S, deviations, _, _) = innovations(linear, noise, record), dense()
    assert found.log_determinant.sum() == pytest.approx(np.linalg.slogdet(S)[1], rel=1e-9)
    white = found.white.reshape(-1, 3)
    np.testing.assert_allclose(
        white.T @ white, deviations.T @ np.linalg.solve(S, deviations), rtol=1e-8
    )


def test_log_likelihoods_under_several_noises_are_those_of_the_joint_normal():
    linear, noise, record = tiny()
    levels = noise.white, noise.jolt, noise.walk, noise.wave
    noises = Noise(
        *(np.stack([2.0 * level, level]) for level in levels), np.array([0.7, noise.wave_frequency])
    )
    S, deviations, _, _ = dense()
    expected = -0.5 * (
        deviations[:, 0] @ np.linalg.solve(S, deviations[:, 0]) + np.linalg.slogdet(S)[1]
    )
    other, alone = log_likelihoods(linear, noises, record)
    assert alone == pytest.approx(expected, rel=1e-9)
    assert other != pytest.approx(expected, rel=1e-2)


def test_smoothed_motion_is_the_mean_given_all_measurements():
    linear, noise, record = tiny()
    n = record.time.size
    motion = Motion(*np.arange(6.0 * n).reshape(6, n))
    (smooth, slow), (S, deviations, cross, means) = smoothed(linear, noise, record, motion), dense()
    expected = (means + cross @ np.linalg.solve(S, deviations))[:, 0].reshape(n, STATES)
    np.testing.assert_allclose(
        np.stack(smooth, axis=-1) - np.stack(motion, axis=-1), expected[:, :6], atol=1e-7
    )
    np.testing.assert_allclose(slow, expected[:, 6:], atol=1e-7)


def test_filtered_motion_is_the_mean_given_the_measurements_until_then():
    linear, noise, record = tiny()
    kept = innovations(linear, noise, record).filtered
    for k in range(1, record.time.size):
        rows = linear.whole[: k + 1].sum()
        S, deviations, cross, means = dense()
        at = slice(STATES * k, STATES * (k + 1))
        expected = means[at, 0] + cross[at, :rows] @ np.linalg.solve(
            S[:rows, :rows], deviations[:rows, 0]
        )
        np.testing.assert_allclose(kept[k], expected, atol=1e-7)


def test_a_level_alone_is_filtered_as_in_the_textbook():
    """Local level: K = P/(P + R), P -> P (1 - K) + Q. Only the first channel and the first state."""
    n, random = 40, np.random.default_rng(5)
    level, R = np.cumsum(random.standard_normal(n)) + 3.0, 0.5**2
    H, Z, whole = np.zeros((n, 6, STATES)), np.zeros((n, 6, 1)), np.zeros((n, 6), bool)
    H[:, 0, 0], Z[:, 0, 0], whole[:, 0] = 1.0, level, True
    noise = Noise(np.full(6, 0.5), np.full(3, 1.5), np.full(3, 1e-3))
    record = type(about()[0])(np.arange(float(n)), np.zeros((n, 6)), {}, None, np.ones(n, bool))
    linear = Linear(
        np.tile(np.eye(STATES), (n - 1, 1, 1)), np.zeros((n - 1, STATES, 1)), H, Z, whole
    )
    found = innovations(linear, noise, record)
    x, P, Q = (
        0.0,
        100.0 * R,
        1.5**2 / 3.0 + 1e-10,
    )  # of a white acceleration over 1 s: its share in the position
    for k in range(n):
        S = P + R
        assert found.white[k, 0, 0] == pytest.approx((level[k] - x) / np.sqrt(S), abs=1e-9)
        assert found.log_determinant[k] == pytest.approx(np.log(S))
        x, P = x + P / S * (level[k] - x), P - P * P / S + Q


def test_innovations_of_what_the_model_draws_are_white_and_of_unit_variance():
    """Five deviations: 361 rows leave 0.07 in a variance and 0.05 in a correlation."""
    record, _, _, linear = about()
    white = innovations(twin.drawn(6, linear, NOISE, record), NOISE, record).white[..., 0]
    assert np.abs((white**2).mean(0) - 1.0).max() < 0.35
    assert (white**2).mean() == pytest.approx(1.0, abs=0.15)
    for lag in (1, 2, 5):
        assert np.abs((white[lag:] * white[:-lag]).mean(0)).max() < 0.25
    assert np.abs(np.corrcoef(white.T) - np.eye(6)).max() < 0.25


def test_several_logs_and_levels_of_noise_at_once_give_what_each_gives_alone():
    record, _, _, linear = about()
    levels = [
        np.stack([level, 2.0 * level])
        for level in (NOISE.white, NOISE.jolt, NOISE.walk, NOISE.wave)
    ]
    both = Noise(*levels, np.array([0.9, 1.3]))
    together = innovations(linear, both, record)
    for i in range(2):
        alone = innovations(
            linear, Noise(*(level[i] for level in levels), both.wave_frequency[i]), record
        )
        np.testing.assert_allclose(together.white[:, i], alone.white, atol=1e-9)
        np.testing.assert_allclose(together.log_determinant[:, i], alone.log_determinant, atol=1e-9)
