"""Numbers of a craft by regression of the accelerations that logs show, with and without each part of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.regression import bounded, rows_per_independent
from shipcosim.diagnose.comparison.thresholds import HUBER
from shipcosim.diagnose.craft.logged import CraftLog
from shipcosim.diagnose.craft.numbers import CraftNumber
from shipcosim.diagnose.craft.thresholds import LARGEST_STEP, STEPS


@dataclass(frozen=True)
class Normal:
    """The accelerations of logs, linear in the coordinates of numbers: normal equations without each part.

    Attributes
    ----------
    numbers : sequence of CraftNumber
    about : (p,) array
        Coordinates that they are linear about.
    matrix, right : (parts + 1, p, p) and (parts + 1, p) arrays
        Without each part; the last of all rows.
    """

    numbers: Sequence[CraftNumber]
    about: np.ndarray
    matrix: np.ndarray
    right: np.ndarray

    def solved(self, free: Sequence[int]) -> np.ndarray:
        """Coordinates without each part, and of all rows, (parts + 1, p); numbers that are not free are the file's."""
        free = list(free)
        # Numbers that are not free keep their start values and enter the right-hand side.
        start = np.array([number.start for number in self.numbers])
        fixed = np.ones(start.size, bool)
        fixed[free] = False
        positive = [number.sign != 0 and not number.is_factor for number in self.numbers]
        coordinates = np.tile(start, (len(self.matrix), 1))
        if not free:
            return coordinates
        for row, matrix, right in zip(coordinates, self.matrix, self.right, strict=True):
            # Least squares of what is left and of the distance from the file's numbers, which is one for each.
            towards = right + matrix @ self.about - matrix[:, fixed] @ start[fixed]
            inner = matrix[np.ix_(free, free)] + np.eye(len(free))
            row[free] = bounded(inner, (towards + start)[free], np.array(positive)[free])
        return coordinates

    def values(self, coordinates: np.ndarray) -> np.ndarray:
        """Values of the numbers by their coordinates, along the last axis."""
        columns = np.moveaxis(coordinates, -1, 0)
        values = [
            number.value(column) for number, column in zip(self.numbers, columns, strict=True)
        ]
        return np.stack(values, axis=-1)


def normal_about(
    logs: Sequence[CraftLog], numbers: Sequence[CraftNumber], about: np.ndarray
) -> Normal:
    """Normal equations of logs about some coordinates; what these leave is the noise."""
    pairs = [log.slopes(numbers, about) for log in logs]
    # Variance of what is left on each axis: residuals of all logs together, the largest 5 % left out; 1.3
    # makes up for the part of the variance they carry.
    joined = np.concatenate(
        [left[:, log.measured.usable] for log, (left, _) in zip(logs, pairs, strict=True)], axis=1
    )
    sound = np.sort(np.abs(joined), axis=1)[:, : int(0.95 * joined.shape[1])]
    variance = (sound**2).mean(1) * 1.3 + 1e-18
    # Rows from one independent residual to the next.
    block = max(4 * logs[0].measured.kernel.reach, logs[0].counts[-1])
    apart = np.array([rows_per_independent(axis, block) for axis in joined])
    count = 1 + max(int(log.parts[-1]) for log in logs)
    matrix = np.zeros((count + 1, about.size, about.size))
    right = np.zeros((count + 1, about.size))
    for log, (left, slopes) in zip(logs, pairs, strict=True):
        # Residuals beyond HUBER standard deviations count less; neighbours that go together count as one.
        size = np.abs(left) / np.sqrt(variance)[:, None]
        weight = np.minimum(1.0, HUBER / np.maximum(size, 1e-12)) / (variance * apart)[:, None]
        parts = set(log.parts)
        # Normal equations without each part in turn, for the jackknife and for held-out errors.
        for part in range(count + 1):
            rows = log.trained_without(part) if part in parts else log.measured.usable
            heavy = (slopes * weight)[:, :, rows]
            matrix[part] += np.einsum("iaj,kaj->ik", heavy, slopes[:, :, rows])
            right[part] += np.einsum("iaj,aj->i", heavy, left[:, rows])
    return Normal(numbers, about, matrix, right)


def fitted(
    logs: Sequence[CraftLog],
    numbers: Sequence[CraftNumber],
    free: Sequence[int],
    near: np.ndarray | None = None,
) -> Normal:
    """Normal equations about the coordinates that fit all rows, searched from those of the file or from near ones."""
    # Gauss-Newton from the file's numbers, with limited steps of numbers that enter as logarithms.
    about = np.array([number.start for number in numbers]) if near is None else near
    is_bent = [number.is_factor for number in numbers]
    normal = normal_about(logs, numbers, about)
    for _ in range(STEPS if near is None else 1):
        step = normal.solved(free)[-1] - about
        about = about + np.where(is_bent, np.clip(step, -LARGEST_STEP, LARGEST_STEP), step)
        normal = normal_about(logs, numbers, about)
    return normal
