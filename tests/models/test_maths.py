"""The functions that models are written in, against the standard library and closed forms."""

import math

import numpy as np
import pytest

from shipcosim.models import maths


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


def test_runge_kutta_is_of_fourth_order():
    """x'' = -x over one second against cos and sin: half the step, a sixteenth of the error."""

    def error(parts):
        state = (1.0, 0.0)
        for _ in range(parts):
            state = maths.rk4(lambda x, v: (v, -x), state, 1.0 / parts)
        return math.hypot(state[0] - math.cos(1.0), state[1] + math.sin(1.0))

    assert error(10) / error(20) == pytest.approx(16.0, rel=0.05)


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
