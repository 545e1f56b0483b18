"""The elementary functions of the models, against the standard library and closed forms."""

import math

import numpy as np
import pytest

from shipcosim.models.core import maths


@pytest.mark.parametrize("few", [5, 1000])
def test_sine_and_cosine_together_are_those_of_the_standard_library(few):
    angles = np.concatenate([np.linspace(-3000.0, 3000.0, few), 0.5 * np.pi * np.arange(-8, 9)])
    sines, cosines = maths.sincos(angles)
    np.testing.assert_allclose(sines, [math.sin(angle) for angle in angles], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(cosines, [math.cos(angle) for angle in angles], rtol=0.0, atol=1e-15)


def test_a_choice_between_numbers_by_a_tensor_keeps_their_digits():
    torch = pytest.importorskip("torch")
    chosen = maths.where(torch.tensor([True, False]), 0.3, 0.7)
    assert chosen.tolist() == [0.3, 0.7]


def test_clip_of_arrays_is_that_of_numpy():
    x = np.linspace(-3.0, 3.0, 13)
    np.testing.assert_array_equal(maths.clip(x, -1.0, 2.0), np.clip(x, -1.0, 2.0))
