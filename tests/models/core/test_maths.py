"""The functions that models are written in, against the standard library and closed forms."""

import math

import numpy as np
import pytest

from shipcosim.models.core import maths


@pytest.mark.parametrize("angle", [-9.0, -math.pi, -1.0, 0.0, 3.0, math.pi, 40.0])
def test_wrap_keeps_the_direction_and_lands_in_its_range(angle):
    wrapped = maths.wrap(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle)) and math.sin(wrapped) == pytest.approx(math.sin(angle))


def test_wrap_of_half_a_turn_is_its_negative():
    assert maths.wrap(math.pi) == -math.pi


def test_interpolation_meets_the_table_and_is_constant_beyond_it():
    xs, ys = (0.0, 1.0, 3.0), (2.0, 4.0, 0.0)
    assert [maths.interp(x, xs, ys) for x in (-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0)] == [
        2.0,
        2.0,
        3.0,
        4.0,
        2.0,
        0.0,
        0.0,
    ]


def test_columns_interpolated_together_are_columns_interpolated_alone():
    xs, columns = (0.0, 1.0, 3.0), ((2.0, 4.0, 0.0), (-1.0, 0.0, 7.0))
    for x in (-1.0, 0.0, 0.3, 1.0, 2.9, 3.0, 5.0):
        assert maths.interp_columns(x, xs, *columns) == [maths.interp(x, xs, column) for column in columns]


@pytest.mark.parametrize("few", [5, 1000])
def test_sine_and_cosine_together_are_those_of_the_standard_library(few):
    angles = np.concatenate([np.linspace(-3000.0, 3000.0, few), 0.5 * np.pi * np.arange(-8, 9)])
    sines, cosines = maths.sincos(angles)
    np.testing.assert_allclose(sines, [math.sin(angle) for angle in angles], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(cosines, [math.cos(angle) for angle in angles], rtol=0.0, atol=1e-15)


def test_a_table_with_even_abscissae_is_interpolated_like_any_other():
    xs = np.linspace(-1.0, 2.0, 7)
    columns = np.sin(xs), np.cos(3.0 * xs)
    table = maths.even_table(xs, *columns)
    for x in (-1.0, -0.99, -0.5, 0.3, 1.999, 2.0):
        assert maths.interp_even(x, table) == pytest.approx([np.interp(x, xs, column) for column in columns], abs=1e-14)


def test_runge_kutta_is_of_fourth_order():
    """x'' = -x over one second against cos and sin: half the step, a sixteenth of the error."""

    def error(parts):
        state = (1.0, 0.0)
        for _ in range(parts):
            state = maths.rk4(lambda x, v: (v, -x), state, 1.0 / parts)
        return math.hypot(state[0] - math.cos(1.0), state[1] + math.sin(1.0))

    assert error(10) / error(20) == pytest.approx(16.0, rel=0.05)


def test_runge_kutta_of_a_pair_is_that_of_any_state_with_time_as_part_of_it():
    """x' = -x + t², y' = x y: what is known in advance enters as a third state, t."""

    def rates(x, y, t):
        return -x + t * t, x * y

    wanted = maths.rk4(lambda x, y, t: (*rates(x, y, t), 1.0), (1.0, 2.0, 0.5), 0.2)
    assert maths.rk4_pair(rates, 1.0, 2.0, 0.2, (0.5,), (0.6,), (0.7,)) == pytest.approx(wanted[:2], abs=1e-15)


@pytest.mark.parametrize("h, parts", [(0.05, 1), (0.1, 1), (0.1000001, 2), (0.3, 3), (1.0, 10)])
def test_substeps_are_no_longer_than_allowed_and_as_few_as_that_takes(h, parts):
    assert maths.substeps(h, 0.1) == parts


def test_a_choice_between_numbers_by_a_tensor_keeps_their_digits():
    torch = pytest.importorskip("torch")
    chosen = maths.where(torch.tensor([True, False]), 0.3, 0.7)
    assert chosen.tolist() == [0.3, 0.7]


def test_clip_of_arrays_is_that_of_numpy():
    x = np.linspace(-3.0, 3.0, 13)
    np.testing.assert_array_equal(maths.clip(x, -1.0, 2.0), np.clip(x, -1.0, 2.0))
