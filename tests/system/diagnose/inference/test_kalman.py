"""Two ways through the same filter agree, on long logs of a ship that nothing holds too."""

import numpy as np
import pytest

from shipcosim.diagnose.inference import kalman

ROWS, KNOWN, LOST, WHOLE = 1500, np.ones(1500, bool), np.zeros((2, 2)), np.zeros(1500, bool)
GROWING = np.array([[1.05, 0.1], [0.0, 1.05]])
MEASURED = np.array([[1.0, 0.0]])


def by_all_outputs_at_once(z, R, Q, P, is_last=WHOLE):
    """Log-likelihood, up to what is the same for both."""
    A, H = (
        np.broadcast_to(GROWING, (ROWS - 1, 1, 2, 2)).copy(),
        np.broadcast_to(MEASURED, (ROWS, 1, 1, 2)).copy(),
    )
    still, nothing = np.zeros((1, 2, 2)), np.zeros((ROWS - 1, 1, 2, 1))
    variance = np.full((ROWS, 1, 1), R)
    start = P[None].copy(), KNOWN, LOST, is_last, P[None], False
    gain, root, logdet, _ = kalman.weights(A, still, H, variance, Q[None], *start)
    state = np.zeros((1, 2, 1))
    white, _ = kalman.whitened(
        A, still, nothing, H, z[:, None, :, None], gain, root, is_last, state
    )
    return -0.5 * ((white**2).sum() + logdet.sum())


def output_by_output(z, R, Q, P, is_last=WHOLE):
    A, H = (
        np.broadcast_to(GROWING, (ROWS - 1, 2, 2)).copy(),
        np.broadcast_to(MEASURED, (ROWS, 1, 2)).copy(),
    )
    W, b, whole = np.zeros((2, 2, 1)), np.zeros((ROWS - 1, 2)), np.ones((ROWS, 1), bool)
    one = np.full((1, 1), R), Q[..., None].copy(), P[..., None].copy()
    return kalman.log_likelihoods(A, W, b, H, z, whole, *one, KNOWN, LOST, is_last)[0]


def test_what_rounding_takes_from_symmetry_does_not_grow():
    """Where motion grows by itself, an antisymmetric part of the covariance grows with it and no measurement ends it.

    It ended in NaN on a log of 47 minutes.
    """
    z = 0.1 * np.random.default_rng(5).normal(size=(ROWS, 1))
    noise = 0.01, 4e-4 * np.eye(2), np.eye(2)
    assert output_by_output(z, *noise) == pytest.approx(by_all_outputs_at_once(z, *noise), rel=1e-9)


def test_stretches_of_a_log_are_filtered_as_logs_of_their_own():
    z = 0.1 * np.random.default_rng(6).normal(size=(ROWS, 1))
    noise, is_last = (0.01, 4e-4 * np.eye(2), np.eye(2)), np.arange(ROWS) == 699
    both = by_all_outputs_at_once(z, *noise, is_last)
    assert output_by_output(z, *noise, is_last) == pytest.approx(both, rel=1e-9)
    unknown = np.zeros((ROWS, 1))
    first, second = np.r_[z[:700], unknown[700:]], np.r_[unknown[:700], z[700:]]
    ends = [by_all_outputs_at_once(part, *noise, is_last) for part in (first, second, unknown)]
    assert both == pytest.approx(ends[0] + ends[1] - ends[2], rel=1e-9)
