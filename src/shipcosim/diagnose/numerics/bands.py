"""Tall matrices whose columns are zero except for some neighbouring rows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Bands:
    """An (n, k) matrix of blocks of columns, each zero outside of its own rows.

    Attributes
    ----------
    rows : int
        n.
    blocks : sequence of (int, (m, p) array)
        First row and values, from the first column to the last.
    """

    rows: int
    blocks: Sequence[tuple[int, np.ndarray]]

    def with_series(self, series: np.ndarray) -> np.ndarray:
        """Inner products of the columns with a series (n,), (k,)."""
        return np.concatenate(
            [series[first : first + len(values)] @ values for first, values in self.blocks]
        )

    def squares(self) -> np.ndarray:
        """Sum of squares of each column, (k,)."""
        return np.concatenate([(values**2).sum(axis=0) for _, values in self.blocks])

    def products(self) -> np.ndarray:
        """Inner products of the columns with each other, (k, k)."""
        return np.block(
            [[_product(block, other) for other in self.blocks] for block in self.blocks]
        )

    def dense(self) -> np.ndarray:
        """All of the matrix, (n, k)."""
        parts = [np.zeros((self.rows, values.shape[1])) for _, values in self.blocks]
        for part, (first, values) in zip(parts, self.blocks, strict=True):
            part[first : first + len(values)] = values
        return np.hstack(parts)


def _product(first_band, other):
    (first, values) = first_band
    (second, others) = other
    # Only rows that both blocks share contribute.
    begin = max(first, second)
    end = min(first + len(values), second + len(others))
    if begin >= end:
        return np.zeros((values.shape[1], others.shape[1]))
    return values[begin - first : end - first].T @ others[begin - second : end - second]
