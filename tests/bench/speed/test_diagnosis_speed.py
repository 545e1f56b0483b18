"""The compiled filter of the diagnosis against the same filter in NumPy: CPU time over 40 minutes at 1 Hz, in one run.

NumPy takes all columns, or all levels of noise, in one call for each row and each step of the filter; the rest is its
calls. Both give the same likelihoods.
"""

import numpy as np
import pytest

from shipcosim.diagnose.inference import innovations as noise_of
from shipcosim.diagnose.inference.innovations import Noise, innovations, log_likelihoods
from shipcosim.diagnose.inference.linearisation import STATES, Linear
from speed.measure import cpu_seconds, reported

ROWS, COLUMNS, LEVELS, REPEATS = 2400, 60, 24, 5
COLUMNS_TO_REACH, LEVELS_TO_REACH = 3.0, 3.0  # 1, 1


class Log:
    """What the filter asks of a record."""

    step, known, is_last = 1.0, np.ones(ROWS, bool), np.arange(ROWS) == ROWS - 1


def test_columns_are_filtered_3_times_as_fast_as_by_numpy():
    linear, noise = drawn(COLUMNS), levels(1)
    alone = Noise(
        *(
            values[0]
            for values in (noise.white, noise.jolt, noise.walk, noise.wave, noise.wave_frequency)
        )
    )
    white = innovations(linear, alone, Log).white
    _, theirs = in_numpy(linear, noise)
    np.testing.assert_allclose(white, theirs[:, 0], rtol=1e-6, atol=1e-6 * np.abs(white).max())
    ours, theirs = lambda: innovations(linear, alone, Log), lambda: in_numpy(linear, noise)
    assert ratio(f"{COLUMNS} columns", ours, theirs, COLUMNS_TO_REACH) >= COLUMNS_TO_REACH


def test_levels_of_noise_are_compared_3_times_as_fast_as_by_numpy():
    linear, noises = drawn(1), levels(LEVELS)
    found = log_likelihoods(linear, noises, Log)
    np.testing.assert_allclose(found, in_numpy(linear, noises)[0], rtol=1e-9)
    ours, theirs = lambda: log_likelihoods(linear, noises, Log), lambda: in_numpy(linear, noises)
    assert ratio(f"{LEVELS} levels of noise", ours, theirs, LEVELS_TO_REACH) >= LEVELS_TO_REACH


def ratio(what, ours, theirs, to_reach):
    ratios = [cpu_seconds(theirs) / cpu_seconds(ours) for _ in range(REPEATS)]
    return reported(f"{what} over {ROWS} rows", ratios, "times as fast as NumPy", f"{to_reach:.0f}")


def drawn(columns):
    """A problem with the zeros of a ship's: position, heading and velocity move, all else stays or fades."""
    random = np.random.default_rng(0)
    A, H = np.zeros((ROWS - 1, STATES, STATES)), np.zeros((ROWS, 6, STATES))
    A[:, :6, :6] = np.eye(6)
    A[:, :6, 2:6] += 0.01 * random.standard_normal((ROWS - 1, 6, 4))
    A[:, :6, 6:9] = 0.5 * A[:, :6, 3:6]
    A[:, range(6, 9), range(6, 9)] = 1.0
    H[:, range(6), range(6)] = H[:, range(3), range(9, 12)] = 1.0
    H[:, range(3), range(12, 15)] = H[:, range(3, 6), range(15, 18)] = 1.0
    driven, seen = (
        1e-3 * random.standard_normal((ROWS - 1, 6, columns)),
        random.standard_normal((ROWS, 6, columns)),
    )
    return Linear(A, driven, H, seen, np.ones((ROWS, 6), bool))


def levels(count):
    """Levels of noise, some twice as large as others."""
    size = np.linspace(1.0, 2.0, count)[:, None]
    white, jolt, walk = (
        size * np.full((count, n), level) for n, level in ((6, 0.1), (3, 1e-3), (3, 1e-5))
    )
    return Noise(white, jolt, walk, 0.05 * np.ones((count, 3)), np.linspace(0.8, 1.2, count))


def in_numpy(linear, noises):
    """Log-likelihoods of the first column (m,), and white innovations of all columns (n, m, 6, c)."""
    m = len(noises.white)
    A = linear.transition[:, None] + noise_of._steady(noises, Log.step)
    Q, C = noise_of._process(noises, Log.step), noise_of._uncertain(noises)
    R = noises.white[..., None] ** 2 * np.eye(6)
    x, white, found = np.zeros((m, STATES, linear.seen.shape[-1])), [], np.zeros(m)
    for k in range(ROWS):
        H = linear.output[k]
        CHt = C @ H.T
        L = np.linalg.cholesky(H @ CHt + R)
        Li = np.linalg.inv(L)
        white.append(Li @ (linear.seen[k] - H @ x))
        gain = CHt @ np.swapaxes(Li, -1, -2)
        found -= 0.5 * (white[k][..., 0] ** 2).sum(-1) + np.log(
            np.diagonal(L, axis1=-2, axis2=-1)
        ).sum(-1)
        x, C = x + gain @ white[k], C - gain @ np.swapaxes(gain, -1, -2)
        if k < ROWS - 1:
            x = A[k] @ x
            x[:, :6] += linear.driven[k]
            C = A[k] @ C @ np.swapaxes(A[k], -1, -2) + Q
    return found, np.stack(white)
