"""One wrap of angles for all rooms."""

import math

import numpy as np
import pytest

from shipcosim.angles import TURN, unwrap_series, wrap, wrap_series


@pytest.mark.parametrize("angle", [-9.0, -math.pi, -1.0, 0.0, 3.0, math.pi, 40.0])
def test_wrap_keeps_the_direction_and_lands_in_its_range(angle):
    wrapped = wrap(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle)) and math.sin(
        wrapped
    ) == pytest.approx(math.sin(angle))


def test_wrap_of_half_a_turn_is_its_negative():
    assert wrap(math.pi) == -math.pi


@pytest.mark.parametrize("turn", [360.0, TURN])
def test_wrapped_series_keep_their_direction_and_land_in_their_range(turn):
    angles = turn * np.linspace(-2.0, 2.0, 41)
    wrapped = wrap_series(angles, turn)
    assert np.all((-0.5 * turn <= wrapped) & (wrapped < 0.5 * turn))
    np.testing.assert_allclose(
        np.exp(2j * np.pi * wrapped / turn), np.exp(2j * np.pi * angles / turn), atol=1e-12
    )


def test_both_wraps_agree_to_rounding():
    angles = np.linspace(-20.0, 20.0, 4001)
    np.testing.assert_allclose(wrap_series(angles, TURN), wrap(angles), atol=1e-14)


def test_an_unwrapped_series_has_no_jumps_across_samples_that_are_missing():
    angles = np.linspace(0.0, 20.0, 101)
    seen = np.where(np.arange(101) % 7 == 3, np.nan, wrap(angles))
    np.testing.assert_allclose(
        unwrap_series(seen), np.where(np.isnan(seen), np.nan, angles), atol=1e-12
    )
