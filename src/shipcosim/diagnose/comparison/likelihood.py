"""How likely a reading of the commands makes the measured force, over all axes at once, with autocorrelated errors.

All thrusters have nearly one gain, of the order of 1, on all axes. Whoever reads their labels wrongly must make the
gain small or let the thrusters differ, and pays for both; where each axis has a gain of its own, a wrong reading only
says that the thrusters do nothing there.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.comparison.axes import prior_of, rest_of
from shipcosim.diagnose.comparison.causality import blocks, with_past
from shipcosim.diagnose.comparison.commanded import Commanded, moving_mass
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.regression import bounded
from shipcosim.diagnose.comparison.thresholds import (
    CAUSAL_ORDER,
    CAUSAL_STEP,
    GAIN_OF_AXES,
    GAIN_WIDTH,
    HUBER,
    LEAST_GAIN_STD,
    LEAST_LEVER,
    LEAST_OF_ALL,
    THRUSTER_WIDTH,
    WAY_WIDTH,
)
from shipcosim.diagnose.numerics import normal_size
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time

_ROUNDS = 5  # of coefficients and autocorrelation in turn
_LOG_GAINS = np.linspace(np.log(0.05), np.log(8.0), 81)


class _Axis(NamedTuple):
    """One axis between blocks: measured force (n,), all but the thrusters (n, q), and which of it has one sign (q,)."""

    force: np.ndarray
    rest: np.ndarray
    positive: np.ndarray


class _Fit(NamedTuple):
    """Log-likelihood, prior included, gain with its standard deviation, and the errors' autoregression."""

    likelihood: float
    gain: float
    std: float
    filter: np.ndarray


@dataclass(frozen=True)
class Blocks:
    """A log in blocks of rows, ready for any reading of its commands.

    Attributes
    ----------
    axes : dict of int to _Axis
        Axes that thrusters drive.
    alone : dict of int to _Fit
        The same without thrusters.
    sizes : dict of int to float
        What the thrusters do at most, root mean square.
    rows : (m,) array
        Steps between blocks with enough usable ones before.
    count : int
        Rows of a block.
    """

    axes: dict[int, _Axis]
    alone: dict[int, _Fit]
    sizes: dict[int, float]
    rows: np.ndarray
    count: int

    def between(self, series: np.ndarray) -> np.ndarray:
        """A series of rows, as its mean over two neighbouring blocks."""
        return _between(blocks(series, self.count))


def smoothed(measured: MeasuredForce) -> MeasuredForce:
    """Measured force with loads from smoothed motion, so that they do not correlate with velocity noise."""
    return replace(measured, motion=measured.smooth_motion)


def blocks_of(measured: MeasuredForce, commanded: Commanded, model: ShipModel) -> Blocks:
    """A log in blocks.

    Parameters
    ----------
    measured : MeasuredForce
    commanded : Commanded
        As logged, along the smoothed motion.
    model : ShipModel

    Returns
    -------
    Blocks
    """
    length = model.length
    # Loads from the smoothed motion, accelerations from block means: their noise is not correlated.
    motion = measured.smooth_motion
    count = max(1, round(CAUSAL_STEP * froude_time(length) / measured.kernel.step))
    # Average over blocks of a share of the ship's response time.
    speeds = blocks(measured.velocity, count)
    usable = blocks(measured.usable.astype(float), count) > 1.0 - 1e-9
    rows = with_past(usable[1:] & usable[:-1], CAUSAL_ORDER)
    # Force that the motion needs between two blocks: M nu_dot + C_RB(nu) nu.
    rates = np.diff(speeds, axis=1) / (count * measured.kernel.step)
    force = model.mass_matrix @ rates + _between(blocks(moving_mass(motion, model), count))
    listed = rest_of(motion, commanded)
    sizes = _sizes(commanded, length)
    # Only axes that thrusters drive, with rows enough for all coefficients and the autoregression.
    axes = {}
    for i in sizes:
        columns, positive = listed[i]
        rest = np.stack([_between(blocks(column, count)) for column in columns], axis=1)
        if rows.size > 4 * (rest.shape[1] + len(commanded.thrusters) + CAUSAL_ORDER):
            axes[i] = _Axis(force[i], rest, positive)
    empty = Blocks(axes, {}, sizes, rows, count)
    # Fits without thrusters are the reference of the likelihood ratios.
    return replace(empty, alone={i: _fitted(empty, i, None, np.empty((0, 0))) for i in axes})


def _sizes(commanded: Commanded, length: float) -> dict[int, float]:
    """Root mean square of the largest commanded load, on axes where it is a considerable part of the force."""
    # Loads without cancelling: thrusters that oppose each other drive the axis all the same.
    most = sum(
        (np.abs(load) for load in commanded.thrusters.values()), np.zeros_like(commanded.hull)
    )
    least = (
        LEAST_OF_ALL
        * np.array([1.0, 1.0, LEAST_LEVER * length])
        * np.sqrt(((most[0] + most[1]) ** 2).mean())
    )
    # A yaw moment compares to the force by a share of the ship's length.
    sizes = np.sqrt((most**2).mean(1))
    return {i: float(sizes[i]) for i in range(3) if sizes[i] > max(least[i], 1e-9)}


def _between(series: np.ndarray) -> np.ndarray:
    # Midpoint rule: loads at the same times as differences of block means.
    return 0.5 * (series[..., 1:] + series[..., :-1])


def likelihood_of(log: Blocks, commanded: Commanded, ahead: dict[str, np.ndarray]) -> float:
    """Log-likelihood that commands so read gain over none, over all axes. [nats]

    On each axis the measured force is explained by the commanded ones, the water, coupling and a steady force; its errors
    are autoregressive (generalized least squares: Ljung, System Identification, 2nd ed., Prentice Hall, 1999, ch. 7).
    The gain is averaged over its prior, common to the axes except for their own error.

    Parameters
    ----------
    log : Blocks
    commanded : Commanded
        Along the smoothed motion.
    ahead : dict of str to (n,) bool array
        By thruster: where it runs ahead.

    Returns
    -------
    float
    """
    # Log-normal prior of the common gain, normalised on a grid.
    gains = np.exp(_LOG_GAINS)
    total = -0.5 * (_LOG_GAINS / GAIN_WIDTH) ** 2
    total -= np.log(np.exp(total).sum())
    # Gain of an axis given the common one: a normal distribution of its logarithm, by row of the
    # grid.
    near = np.exp(-0.5 * ((_LOG_GAINS[:, None] - _LOG_GAINS[None]) / GAIN_OF_AXES) ** 2)
    near /= near.sum(1, keepdims=True)
    for i in log.axes:
        # Profile likelihood of the axis' gain, taken as normal about its estimate.
        fit = _fitted(log, i, *_columns(log, i, commanded, ahead))
        std = np.hypot(fit.std, LEAST_GAIN_STD)
        gained = fit.likelihood - log.alone[i].likelihood - 0.5 * ((gains - fit.gain) / std) ** 2
        # Integrate the axis' own gain out; the maximum is taken off before exponentials.
        total += gained.max() + np.log(near @ np.exp(gained - gained.max()) + 1e-300)
    # Integrate the common gain out.
    return float(total.max() + np.log(np.exp(total - total.max()).sum()))


def _columns(log, i, commanded, ahead):
    """The sum of the thrusters' loads, and by what they may differ from it, each with its standard deviation."""
    # Thrusters that act on this axis; ways is half the difference of thrust ahead and astern.
    loads = {name: load[i] for name, load in commanded.thrusters.items() if np.any(load[i])}
    ways = sum(
        (load * (ahead[name] - 0.5) for name, load in loads.items()),
        np.zeros(commanded.hull.shape[1]),
    )
    columns = [log.between(series) for series in (*loads.values(), ways)]
    # Deviations of thrusters and ways from the common gain have zero mean and a standard deviation
    # of the prior.
    total = sum(columns[:-1], np.zeros_like(columns[-1]))
    return total, np.stack(columns, 1), np.r_[np.full(len(loads), THRUSTER_WIDTH), WAY_WIDTH]


def _fitted(
    log: Blocks,
    i: int,
    total: np.ndarray | None,
    apart: np.ndarray,
    widths: np.ndarray | None = None,
) -> _Fit:
    """The measured force on an axis explained, with errors that are autoregressive."""
    axis = log.axes[i]
    rows = log.rows
    order = CAUSAL_ORDER
    # Forces that no model contains are of the order of what the thrusters can give.
    prior = prior_of(axis.rest, axis.positive, log.sizes[i])
    positive = axis.positive
    columns = axis.rest
    # Start the autoregression from white errors, and from that without thrusters: the alternation
    # may end in a local maximum.
    starts = [np.zeros(order)]
    if total is not None and widths is not None:
        columns = np.concatenate([total[:, None], axis.rest, apart], axis=1)
        prior = np.r_[np.inf, prior, widths]
        positive = np.r_[False, positive, np.zeros(widths.size, bool)]
        starts.append(log.alone[i].filter)
    # Series and columns with their lags, for filtering by any autoregression.
    measured = np.stack([axis.force[rows - k] for k in range(order + 1)])
    late = np.stack([columns[rows - k] for k in range(order + 1)])
    best = max(
        (_refined(measured, late, positive, prior, start) for start in starts),
        key=lambda fit: fit[0],
    )
    likelihood, coefficients, filter_, spread = best
    if total is None:
        return _Fit(likelihood, 0.0, 0.0, filter_)
    # Variance of the gain from the information matrix of the whitened columns, coefficients at
    # their bound left out.
    white = np.tensordot(np.r_[1.0, -filter_], late, 1)
    free = (coefficients != 0.0) | ~positive
    information = white[:, free].T @ white[:, free] / spread**2 + np.diag(prior[free] ** -2.0)
    variance = np.linalg.pinv(information, rcond=1e-12, hermitian=True)[0, 0]
    return _Fit(likelihood, float(coefficients[0]), float(np.sqrt(max(variance, 0.0))), filter_)


def _refined(measured, late, positive, prior, filter_):
    """Coefficients and autoregression in turn; the best (log-likelihood, coefficients, autoregression, spread)."""
    best = (-np.inf, np.zeros(positive.size), filter_, 1.0)
    spread = float(np.std(np.r_[1.0, -filter_] @ measured))
    # Cochrane-Orcutt: coefficients by generalized least squares, then the autoregression of the
    # errors.
    for _ in range(_ROUNDS):
        # Whiten series and columns by the filter 1 - a1 q^-1 - a2 q^-2 - ...
        ahead = np.r_[1.0, -filter_]
        series = ahead @ measured
        white = np.tensordot(ahead, late, 1)
        # Ridge by the prior, columns scaled to unit length, coefficients within their signs.
        scale = np.sqrt((white**2).sum(0)) + 1e-300
        unit = white / scale
        pull = spread / (prior * scale)
        coefficients = bounded(unit.T @ unit + np.diag(pull**2), unit.T @ series, positive) / scale
        # Autoregression by least squares on past errors, slightly regularised.
        errors = measured - late @ coefficients
        past = errors[1:].T
        products = past.T @ past
        filter_ = np.linalg.solve(
            products + 1e-6 * np.trace(products) / len(products) * np.eye(len(products)) + 1e-300,
            past.T @ errors[0],
        )
        # Standard deviation of the innovations, outliers clipped at a multiple of the robust one.
        left = errors[0] - past @ filter_
        spread = (
            float(np.sqrt(np.minimum(left**2, (HUBER * normal_size(left)) ** 2).mean())) + 1e-300
        )
        # Gaussian log-likelihood with the prior of the coefficients; rounds need not improve it.
        likelihood = float(-left.size * np.log(spread) - 0.5 * ((coefficients / prior) ** 2).sum())
        if likelihood > best[0]:
            best = likelihood, coefficients, filter_, spread
    return best
