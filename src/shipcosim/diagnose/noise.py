"""Noise of a log, estimated from itself, and how well a set of columns explains what is left.

A residual step is the difference of position noise plus velocity noise: a level that wanders and is seen through
noise. Its innovations, by an exponential smoother and a short autoregression, are white; columns go through
the same filters. Columns carry a normal prior: nuisances their normal size, suspects a wide one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_toeplitz
from scipy.signal import lfilter

__all__ = ["Fit", "Whitener", "fit"]

GAINS = (0.01, 0.03, 0.06, 0.12, 0.25, 0.45, 0.7, 1.0)  # of the exponential smoother; 1: the steps are white
ORDER = 6  # of the autoregression
CLIP = 4.0  # standard deviations beyond which a step counts no more


@dataclass(frozen=True)
class Whitener:
    """Filter of one axis that makes its noise white and of unit size."""

    gain: float
    coefficients: np.ndarray
    std: float

    def __call__(self, steps):
        """Whiten steps along the first axis."""
        level = lfilter([1.0], [1.0, self.gain - 1.0], steps, axis=0)
        return lfilter(np.r_[1.0, -self.coefficients], [1.0], level, axis=0) / self.std

    def response(self, count):
        """Whitened answer to a unit step at the first of `count` rows."""
        impulse = np.zeros(count)
        impulse[0] = 1.0
        return self(impulse)


@dataclass(frozen=True)
class Fit:
    """Columns fitted to residual steps.

    Parameters
    ----------
    whiteners : tuple of Whitener or None
        One an axis, None where the axis has no data.
    values, cov : (m,) and (m, m) arrays
        Estimates of the columns' sizes.
    rest : (n, 3) array
        Whitened residual after the fit.
    columns : (n, 3, m) array
        Whitened columns.
    precision : (m,) array
        Of the columns' priors.
    score : float
        Log evidence, with the noise refitted. [nats]
    """

    whiteners: tuple[Whitener | None, ...]
    values: np.ndarray
    cov: np.ndarray
    rest: np.ndarray
    columns: np.ndarray
    precision: np.ndarray
    score: float

    def whiten(self, steps):
        """Whiten steps (n, 3) or columns (n, 3, k) axis by axis."""
        white = np.zeros(steps.shape)
        for axis, whitener in enumerate(self.whiteners):
            if whitener is not None:
                white[:, axis] = whitener(steps[:, axis])
        return white

    def gain(self, columns, slab, weights=1.0):
        """Evidence that each of more columns, alone, would bring: nats, estimates, standard deviations.

        Parameters
        ----------
        columns : (n, 3, k) array
            Whitened.
        slab : float or (k,) array
            Standard deviation of the prior of their size.
        weights : float or (n, 3) array
            Weights of the whitened rows, 0 or 1.
        """
        flat = (columns * np.expand_dims(weights, -1) if np.ndim(weights) else columns).reshape(-1, columns.shape[2])
        rest, own = self.rest.ravel(), self.columns.reshape(-1, self.columns.shape[2])
        shared = own.T @ flat
        energy = np.einsum("nk,nk->k", flat, flat) - np.einsum("mk,mk->k", shared, self.cov @ shared)
        match = flat.T @ rest - shared.T @ (self.cov @ (own.T @ rest - self.precision * self.values))
        return (*evidence(match, energy, slab),)


def evidence(match, energy, slab):
    """Nats, estimates and standard deviations of single columns from their match with the data and their energy."""
    precision = np.maximum(energy, 0.0) + 1.0 / slab**2
    nats = 0.5 * match**2 / precision - 0.5 * np.log(precision * slab**2)
    return nats, match / precision, 1.0 / np.sqrt(precision)


def fit(residual: np.ndarray, known: np.ndarray, columns: np.ndarray, sizes: np.ndarray, rounds: int = 3) -> Fit:
    """Fit columns and noise to residual steps.

    Parameters
    ----------
    residual : (n, 3) array
        Residual steps.
    known : (n, 3) array of bool
        Steps with data.
    columns : (n, 3, m) array
        Columns.
    sizes : (m,) array
        Standard deviations of their priors.
    """
    values, precision = np.zeros(columns.shape[2]), 1.0 / sizes**2
    for _ in range(rounds):
        rest = residual - columns @ values
        whiteners = tuple(_whitener(rest[:, a], known[:, a]) if known[:, a].any() else None for a in range(3))
        draft = Fit(whiteners, values, np.zeros((0, 0)), rest, columns, precision, 0.0)
        white, data = draft.whiten(columns), draft.whiten(residual)
        weights = (np.abs(data - white @ values) < 1.5 * CLIP) & known if values.any() else known
        flat = (white * weights[:, :, None]).reshape(-1, columns.shape[2])
        information = flat.T @ flat + np.diag(precision)
        factor = cho_factor(information)
        values = cho_solve(factor, flat.T @ (data * weights).ravel())
    rest = np.clip(data - white @ values, -1.5 * CLIP, 1.5 * CLIP)
    cov = cho_solve(factor, np.eye(len(values)))
    scale = sum(np.sum(known[:, a]) * np.log(w.std) for a, w in enumerate(whiteners) if w is not None)
    prior = np.sum(values**2 * precision) + 2 * np.log(np.diag(factor[0])).sum() - np.log(precision).sum()
    score = -scale - 0.5 * np.sum(rest[known] ** 2) - 0.5 * prior
    return Fit(whiteners, values, cov, rest, white, precision, float(score))


def _whitener(steps, known):
    candidates = []
    for gain in GAINS:
        level = lfilter([1.0], [1.0, gain - 1.0], steps)
        limit = CLIP * _spread(level[known])
        tamed = np.clip(level, -limit, limit)
        coefficients = _autoregression(tamed)
        white = lfilter(np.r_[1.0, -coefficients], [1.0], level)[known]
        limit = CLIP * _spread(white)
        std = np.sqrt(np.mean(np.clip(white, -limit, limit) ** 2)) + 1e-12
        candidates.append(Whitener(gain, coefficients, float(std)))
    return min(candidates, key=lambda candidate: candidate.std)


def _spread(values):
    return 1.4826 * np.median(np.abs(values)) + 1e-12


def _autoregression(values):
    count = len(values)
    covariance = np.array([values[: count - k] @ values[k:] / count for k in range(ORDER + 1)])
    covariance[0] = covariance[0] * (1.0 + 1e-9) + 1e-30
    return solve_toeplitz(covariance[:-1], covariance[1:])
