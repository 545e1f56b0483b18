"""Robust regression with coefficients that must not be negative, and errors honest about autocorrelation."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.thresholds import HUBER, ROBUST_ROUNDS, SOUND
from shipcosim.diagnose.numerics import least_squares


@dataclass(frozen=True)
class Regression:
    """A regression of one series on some columns.

    Attributes
    ----------
    coefficients : (p,) array
    covariance : (p, p) array
        By blocks; of coefficients at their bound 0.
    left : (n,) array
        Residuals.
    squares : float
        Mean of Huber's loss of them, twice: their mean square without outliers.
    apart : float
        Rows from one independent residual to the next.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    left: np.ndarray
    squares: float
    apart: float

    @property
    def independent(self) -> float:
        """Number of independent residuals."""
        return self.left.size / self.apart

    @property
    def std(self) -> np.ndarray:
        """Standard deviations of the coefficients."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def regressed(
    series: np.ndarray,
    columns: np.ndarray,
    positive: np.ndarray,
    block: int,
    prior: np.ndarray | None = None,
) -> Regression:
    """Regress a series on columns.

    Parameters
    ----------
    series : (n,) array
    columns : (n, p) array
    positive : (p,) bool array
        Coefficients that must not be negative.
    block : int
        Rows of a block whose errors are taken together: longer than errors are correlated.
    prior : (p,) array, optional
        Standard deviations of the coefficients about 0; infinite where nothing is known.

    Returns
    -------
    Regression
    """
    # Scale the columns to unit root mean square; one that is zero stays.
    scale = np.sqrt((columns**2).mean(0))
    scale = np.where(scale > 0.0, scale, 1.0)
    unit = columns / scale
    # Iteratively reweighted least squares with Huber's weights.
    weights = np.ones(series.size)
    pull = np.zeros(scale.size)
    for _ in range(ROBUST_ROUNDS):
        heavy = unit * (weights**2)[:, None]
        # Ridge by the prior, and coefficients within their signs.
        coefficients = bounded(unit.T @ heavy + np.diag(pull**2), heavy.T @ series, positive)
        left = series - unit @ coefficients
        # Standard deviation of the residuals without their largest.
        size = np.sort(np.abs(left))[: int(SOUND * left.size)]
        spread = (
            np.sqrt((size**2).mean()) + 1e-300
        )  # not the median: a craft that lies idle would hide what she does
        # Huber: full weight within a multiple of the spread, then inversely by size.
        weights = np.sqrt(np.minimum(1.0, HUBER * spread / np.maximum(np.abs(left), 1e-300)))
        # Prior in units of the residual, whose variance grows by the rows per independent residual.
        if prior is not None:
            pull = np.sqrt(np.mean((weights * left) ** 2) * rows_per_independent(left, block)) / (
                prior * scale
            )
    # Standard errors must allow for correlated residuals; at a bound there is none.
    covariance = _by_blocks(
        unit, left * weights**2, weights, pull, (coefficients != 0.0) | ~positive, block
    )
    # Twice Huber's loss, from weight and residual: w r^2 (2 - w) with w the squared weight here.
    squares = float((weights**2 * left**2 * (2.0 - weights**2)).mean())
    return Regression(
        coefficients / scale,
        covariance / np.outer(scale, scale),
        left,
        squares,
        rows_per_independent(left, block),
    )


def bounded(products: np.ndarray, with_series: np.ndarray, positive: np.ndarray) -> np.ndarray:
    """Least squares, from inner products, with some coefficients that must not be negative.

    Parameters
    ----------
    products : (p, p) array
        Of the columns.
    with_series : (p,) array
        Of the columns with the series.
    positive : (p,) bool array

    Returns
    -------
    (p,) array
    """
    # Normal equations as a least-squares problem: factor the matrix by its eigenvalues, tiny ones
    # raised so that dependent columns do no harm.
    size, turn = np.linalg.eigh(products)
    root = np.sqrt(np.maximum(size, 1e-12 * size.max() + 1e-300))
    upper = root[:, None] * turn.T
    target = (turn.T @ with_series) / root
    return least_squares(upper, target, positive)


def _by_blocks(unit, errors, weights, pull, free, block):
    """Covariance of the coefficients that are not at their bound, from sums over blocks of rows."""
    # Scores X' r summed by block: blocks are taken as independent, rows within one are not.
    count = max(-(-errors.size // block), 2)
    number = np.minimum(np.arange(errors.size) // block, count - 1)
    sums = np.zeros((count, unit.shape[1]))
    np.add.at(sums, number, unit * errors[:, None])
    # Curvature of the robust loss with the prior, for the coefficients that are free.
    inside = np.flatnonzero(free)
    normal = (unit[:, inside] * weights[:, None] ** 2).T @ unit[:, inside]
    normal += np.diag(pull[inside] ** 2)
    inverse = np.linalg.pinv(normal, rcond=1e-10, hermitian=True)
    # Sandwich estimator, with the small-sample factor b / (b - 1).
    bread = inverse @ (sums[:, inside].T @ sums[:, inside]) @ inverse * count / (count - 1.0)
    covariance = np.zeros((free.size, free.size))
    covariance[np.ix_(inside, inside)] = bread
    return covariance


def rows_per_independent(left: np.ndarray, block: int) -> float:
    """Integral of the autocorrelation of residuals. [rows]"""
    most = min(4 * block, left.size // 2)
    # Autocorrelation by the spectrum (Wiener-Khinchin), padded so that it does not wrap round.
    centred = left - left.mean()
    spectrum = np.abs(np.fft.rfft(centred, 2 * left.size)) ** 2
    correlation = np.fft.irfft(spectrum)[:most]
    correlation = correlation / max(correlation[0], 1e-300)
    # Sum it to its first zero crossing; beyond it is mostly noise.
    negative = np.flatnonzero(correlation < 0.0)
    return float(1.0 + 2.0 * correlation[1 : negative[0] if negative.size else most].sum())
