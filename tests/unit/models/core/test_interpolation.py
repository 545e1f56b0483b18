"""Interpolation in tables, against NumPy and closed forms."""

import numpy as np
import pytest

from shipcosim.models.core.interpolation import even_table, interp, interp_columns, interp_even


def test_interpolation_meets_the_table_and_is_constant_beyond_it():
    xs, ys = (0.0, 1.0, 3.0), (2.0, 4.0, 0.0)
    assert [interp(x, xs, ys) for x in (-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0)] == [
        2.0,
        2.0,
        3.0,
        4.0,
        2.0,
        0.0,
        0.0,
    ]


def test_no_number_gives_no_number_in_every_arithmetic():
    xs, ys = (0.0, 1.0, 3.0), (2.0, 4.0, 0.0)
    assert np.isnan([interp(np.nan, xs, ys), *interp_columns(np.nan, xs, ys)]).all()
    assert np.isnan(interp(np.array([np.nan]), xs, ys)).all()


def test_columns_interpolated_together_are_columns_interpolated_alone():
    xs, columns = (0.0, 1.0, 3.0), ((2.0, 4.0, 0.0), (-1.0, 0.0, 7.0))
    for x in (-1.0, 0.0, 0.3, 1.0, 2.9, 3.0, 5.0):
        assert interp_columns(x, xs, *columns) == [interp(x, xs, column) for column in columns]


def test_a_table_with_even_abscissae_is_interpolated_like_any_other():
    xs = np.linspace(-1.0, 2.0, 7)
    columns = np.sin(xs), np.cos(3.0 * xs)
    table = even_table(xs, *columns)
    for x in (-1.0, -0.99, -0.5, 0.3, 1.999, 2.0):
        assert interp_even(x, table) == pytest.approx(
            [np.interp(x, xs, column) for column in columns], abs=1e-14
        )
