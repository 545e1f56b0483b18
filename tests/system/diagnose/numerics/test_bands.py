"""Matrices of bands against the same matrices in full."""

import numpy as np

from shipcosim.diagnose.numerics import Bands


def test_products_are_those_of_the_full_matrix():
    random = np.random.default_rng(2)
    blocks = [
        (0, random.normal(size=(9, 2))),
        (5, random.normal(size=(8, 3))),
        (20, random.normal(size=(10, 1))),
    ]
    bands, series = Bands(30, blocks), random.normal(size=30)
    full = bands.dense()
    assert (
        full.shape == (30, 6)
        and np.array_equal(full[5:13, 2:5], blocks[1][1])
        and not full[13:20].any()
    )
    assert np.allclose(bands.with_series(series), series @ full)
    assert np.allclose(bands.products(), full.T @ full) and np.allclose(
        bands.squares(), (full**2).sum(0)
    )
