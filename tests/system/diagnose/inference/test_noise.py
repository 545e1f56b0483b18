"""Levels of noise are found from the log alone."""

import warnings

import numpy as np
import pytest
from diagnose import twin
from scipy.stats import chi2

from shipcosim.diagnose.inference.innovations import Noise, innovations
from shipcosim.diagnose.inference.linearisation import Regressor, linearise
from shipcosim.diagnose.inference.noise import first_noise, tuned
from shipcosim.diagnose.inference.parts import explained
from shipcosim.diagnose.ship.inputs import first_motion, record_of

TRUTH = Noise(
    2.0 * twin.WHITE,
    np.array([0.02, 0.02, 2e-3]),
    np.array([1e-3, 1e-3, 5e-5]),
    4.0 * twin.WHITE[3:],
    1.2,
)
NO_LIMIT = np.full(3, 1.0)


@pytest.fixture(scope="module")
def problem():
    record = record_of(twin.logs()["healthy"], twin.model())
    motion = first_motion(record)
    linear = linearise(motion, record, twin.model(), [])
    return record, twin.drawn(3, linear, TRUTH, record)


def test_the_first_guess_of_the_channels_is_their_white_noise():
    """By third differences, that the motion of a ship hardly has."""
    found = first_noise(record_of(twin.logs()["healthy"], twin.model()), 33.9)
    np.testing.assert_allclose(found.white, twin.WHITE, rtol=0.2)


def test_a_channel_without_data_or_noise_gets_a_level_that_hurts_nobody():
    log = twin.logs()["healthy"].drop_vars("yaw_rate")
    log = log.assign(surge=0.0 * log["surge"])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = first_noise(record_of(log, twin.model()), 33.9)
    assert found.white[5] == 1.0 and found.white[3] == 3e-3


def likelihood(noise, record, linear):
    found = innovations(linear, noise, record)
    return -0.5 * ((found.white[..., 0] ** 2).sum() + found.log_determinant.sum())


@pytest.mark.parametrize("off", [0.5, 2.0])
def test_levels_that_were_planted_are_found_from_either_side(problem, off):
    """361 rows leave some 4 % in a level of white noise, and hardly say how fast an unexplained force walks."""
    record, linear = problem
    start = Noise(off * TRUTH.white, off * TRUTH.jolt, off * TRUTH.walk, off * TRUTH.wave)
    found = tuned(start, linear, record, most_walk=NO_LIMIT, rounds=8)
    np.testing.assert_allclose(found.white[:3], TRUTH.white[:3], rtol=0.12)
    whole = [
        np.hypot(noise.white[3:], noise.wave) for noise in (found, TRUTH)
    ]  # at 1 Hz waves hide what is white
    np.testing.assert_allclose(*whole, rtol=0.12)
    np.testing.assert_allclose(found.jolt, TRUTH.jolt, rtol=0.25)
    np.testing.assert_allclose(found.wave, TRUTH.wave, rtol=0.25)
    more = likelihood(found, *problem) - likelihood(TRUTH, *problem)
    assert 0.0 < more < 0.5 * chi2.ppf(0.999, df=13)  # as 13 levels may gain on the true ones
    assert found.wave_frequency == pytest.approx(TRUTH.wave_frequency, rel=0.05)


def test_an_unexplained_force_is_kept_from_swallowing_causes(problem):
    record, linear = problem
    most = np.array([2e-4, 2e-4, 1e-5])
    found = tuned(TRUTH, linear, record, most_walk=most)
    assert (found.walk <= most).all()


def test_no_channel_and_no_acceleration_is_less_noisy_than_the_least(problem):
    record, linear = problem
    least = dict(least_white=2.0 * TRUTH.white, least_jolt=2.0 * TRUTH.jolt)
    found = tuned(TRUTH, linear, record, most_walk=NO_LIMIT, **least)
    assert (found.white >= 2.0 * TRUTH.white).all() and (found.jolt >= 2.0 * TRUTH.jolt).all()


def test_what_is_explained_is_taken_out():
    """A problem whose log is twice its second column is left with nothing."""
    record = record_of(twin.logs()["healthy"], twin.model())
    motion = first_motion(record)
    linear = linearise(motion, record, twin.model(), [Regressor({"vessel.mass_scale": 0.1})])
    doubled = linear._replace(
        driven=linear.driven[..., [1, 1]] * [2.0, 1.0], seen=linear.seen[..., [1, 1]]
    )
    left = explained(doubled, np.array([2.0])).whole()
    assert left.driven.shape[-1] == left.seen.shape[-1] == 1
    assert np.abs(left.driven).max() == 0.0
