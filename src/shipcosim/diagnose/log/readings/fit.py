"""A measured change fitted by the logged one: a factor, its deviation, and how likely it is.

What is left between both wanders as the noise of the logged change adds up, and is seen through noise of its own. Under a
Kalman filter of such a level what is left is white, so that all motion counts that stands out of the noise, the slow
and the fast, and a ship on her station is judged as one under way. Rows take the place of time: a time base that is
wrong by a thousand does no harm.
"""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from shipcosim.diagnose.log.checks.kinematics import Filter, after_gaps, filters, whiteness
from shipcosim.diagnose.log.thresholds import (
    CALM_SHARE,
    FEWEST_FITTED,
    FIT_CLIP,
    HEARD,
    MOST_CHANGE,
    MOST_FITTED,
    NOISIER,
    RELATION_WINDOWS,
    ROBUST_ROUNDS,
    ROBUST_SHARE,
    THROUGHOUT,
    UNKNOWN_SIZE,
    UNLABELLED,
    UNSURE_NOISE,
)
from shipcosim.diagnose.numerics import quantile

ROUGHNESS = (
    5.69  # variance of the fourth differences of a spline's integral of white noise of variance 1
)
_Key = TypeVar("_Key", bound=Hashable)


@dataclass(frozen=True)
class Relation:
    """One relation in one form: seen = c * told.

    Attributes
    ----------
    factor : complex
        Logarithm of c: of its size, and i times its angle. [1, rad]
    std : (float, float)
        Of both parts.
    evidence : float
        How much likelier what is seen is with what is told than by itself. [nats]
    throughout : bool
        Whether it holds in all of the log, not in the larger part of it.
    """

    factor: complex
    std: tuple[float, float]
    evidence: float
    throughout: bool


@dataclass(frozen=True)
class RowsFit:
    """A relation with what is needed to weigh it against others: white rows, and how likely what is left is.

    `as_labelled` is what the labels leave of the same rows. `wander` and `rows_noise` are the variance that noise of
    the reported change adds from row to row, whitened and over both axes: by what is left, and by how much its
    neighbouring rows differ.
    """

    seen: np.ndarray
    reported: np.ndarray
    factor: complex
    variance: float
    likelihood: float
    as_labelled: np.ndarray | None = None
    wander: float = 0.0
    rows_noise: float = 0.0

    @property
    def rest(self) -> np.ndarray:
        return self.seen - self.factor * self.reported


def fitted(
    time: np.ndarray,
    pairs: dict[_Key, tuple[np.ndarray, np.ndarray]],
    labelled: _Key,
    axes: int = 2,
) -> dict[_Key, Relation]:
    """Regression of observed on reported change for each pair; empty if no pair has information.

    Parameters
    ----------
    time : (n,) array
    pairs : dict of two (n,) complex arrays
    labelled : key
        Of the pair that is equal by the labels of the log.
    axes : int
        2, or 1 where both are real.
    """
    pairs = {
        key: pair
        for key, pair in pairs.items()
        if all(np.ptp(np.abs(np.diff(series))) for series in pair)
    }
    if not pairs:
        return {}
    # Thin the rows, and thin each array only once: pairs share them.
    rows = thinned(len(time), [seen for seen, _ in pairs.values()])
    few = {id(series): series[rows] for pair in pairs.values() for series in pair}
    time = time[rows]
    pairs = {key: (few[id(seen)], few[id(reported)]) for key, (seen, reported) in pairs.items()}
    # Rows after a gap start the filter anew. With too few other rows nothing can be fitted.
    starts = after_gaps(time)
    if (~starts).sum() < FEWEST_FITTED:
        return {}
    # Fit each pair, and compare it with a random walk of the observed channel alone.
    fits, alone = likeliest_fits(filters(time, starts), pairs, labelled, axes)
    best = max(fits, key=lambda key: fits[key].likelihood - alone[key])
    # Correlated residuals carry less information: divide the evidence by their correlation.
    rough = whiteness(np.column_stack([fits[best].rest.real, fits[best].rest.imag][:axes]))
    relations = {
        key: _relation(fit, (fit.likelihood - alone[key]) / rough, rough)
        for key, fit in fits.items()
    }
    return relations if relations[best].evidence > HEARD else {}


def thinned(count: int, series: Sequence[np.ndarray]) -> slice:
    """Every so many rows that there are not too many, and that a position of coarse resolution changes between them."""
    # Limit the cost of long logs. Then thin further while
    # most steps show no change of a coarse channel.
    stride = max(1, math.ceil(count / MOST_FITTED))
    while (
        count / stride > 4 * FEWEST_FITTED
        and min(np.mean(np.diff(each[::stride]) != 0.0) for each in series) < MOST_CHANGE
    ):
        stride *= 2
    return slice(None, None, stride)


def likeliest_fits(
    drafts: Sequence[Filter], pairs: dict, labelled: Hashable = None, axes: int = 2
) -> tuple[dict, dict]:
    """The `RowsFit` of each pair under the noise that suits it best, and how likely what is seen is by itself.

    `drafts`: a filter for each noise that is tried; the others as of `fitted`.
    """
    # Whiten each array only once, as columns of one matrix.
    columns = {id(series): series for pair in pairs.values() for series in pair}
    stacked = np.stack(list(columns.values()), axis=1)
    place = {name: number for number, name in enumerate(columns)}
    fits: dict = {}
    # Noise of the reported channel itself, from differences of neighbouring rows.
    noises = {id(reported): _noise_of_rows(reported, axes) for _, reported in pairs.values()}
    # Likelihood of each observed channel without any explanation, under its best noise ratio.
    alone = dict.fromkeys((id(seen) for seen, _ in pairs.values()), -np.inf)
    # Try each ratio of wander to noise, and keep for each pair the one with the largest likelihood.
    for draft in drafts:
        settled = draft.gains < 1.0
        # The Jacobian of the whitening enters the likelihood, so that ratios can be compared.
        scale = draft.scale[settled]
        white = (draft(np.real(stacked)) + 1j * draft(np.imag(stacked)))[settled]
        offset = -axes * float(np.sum(np.log(scale)))
        # White noise of a rate adds up to a random walk. This is the variance
        # that it has after the whitening, by the median gain of the filter.
        gain = float(np.median(draft.gains[settled]))
        adds_up = 1.0 / (gain * (2.0 - gain) * np.median(scale) ** 2)
        labelled_white = [white[:, place[id(series)]] for series in pairs.get(labelled, ())]
        for name in alone:
            alone[name] = max(alone[name], _likelihood(white[:, place[name]], axes)[0] + offset)
        for key, (seen, logged) in pairs.items():
            fit = _fit(white[:, place[id(seen)]], white[:, place[id(logged)]], axes, offset)
            if key not in fits or fit.likelihood > fits[key].likelihood:
                rows_noise = axes * adds_up * abs(fit.factor) ** 2 * noises[id(logged)]
                # What the labels leave can be held against it where both tell of the same rows.
                is_same = bool(labelled_white) and seen is pairs[labelled][0]
                fits[key] = replace(
                    fit,
                    as_labelled=labelled_white[0] - labelled_white[1] if is_same else None,
                    wander=axes * adds_up * draft.ratio * fit.variance,
                    rows_noise=rows_noise,
                )
    return fits, {key: alone[id(seen)] for key, (seen, _) in pairs.items()}


def _fit(seen, reported, axes, offset):
    """The factor with the smallest residual of white rows; outliers count little.

    `offset`: of the logarithm of the likelihood, by the whitening.
    """
    # Iteratively reweighted least squares with Huber weights:
    # outliers count as little as their distance requires.
    weights = np.ones(len(reported))
    for _ in range(ROBUST_ROUNDS):
        factor = np.vdot(weights * reported, seen) / max(
            np.vdot(weights * reported, reported).real, 1e-300
        )
        off = np.abs(seen - factor * reported)
        weights = np.minimum(1.0, FIT_CLIP * _spread(off, axes) / np.maximum(off, 1e-300))
    likelihood, variance = _likelihood(seen - factor * reported, axes)
    return RowsFit(seen, reported, complex(factor), variance, likelihood + offset)


def _noise_of_rows(reported, axes):
    """Variance of an axis of the noise of the logged change from row to row; too large where waves are as short as rows."""
    # The fourth difference removes the motion and leaves the noise of neighbouring rows.
    rows = np.abs(np.diff(reported, n=4))
    return _spread(rows, axes) ** 2 / ROUGHNESS


def _spread(off, axes):
    """Standard deviation of an axis, by what four in five rows are below."""
    return quantile(off, 0.8) / (1.794 if axes == 2 else 1.282) + 1e-300


def _likelihood(rest, axes):
    """Logarithm of the likelihood of white rows except for a constant, and their variance; single rows count so much."""
    # Gaussian likelihood at the estimated variance. Large
    # residuals are clipped, so outliers count little.
    off = np.abs(rest)
    variance = float(np.mean(np.minimum(off, FIT_CLIP * _spread(off, axes)) ** 2)) / axes + 1e-300
    return -0.5 * axes * len(rest) * math.log(variance), variance


def _relation(fit, evidence, rough):
    """The relation of a fit."""
    # Standard error: the larger of the jackknife over windows and
    # of that of least squares with the residuals' correlation.
    windows = np.array_split(np.arange(len(fit.reported)), RELATION_WINDOWS)
    energy = np.vdot(fit.reported, fit.reported).real
    size = max(abs(fit.factor), 1e-300)
    std = max(_jackknife(fit, windows), math.sqrt(rough * fit.variance / energy) / size)
    # Noise in the regressor attenuates the factor; correct its
    # logarithm, and add the uncertainty of the correction.
    low, unsure = _too_small(len(fit.reported) / (size**2 * energy), fit)
    factor = complex(math.log(size) + low, np.angle(fit.factor))
    # What is told at no size that one could name, explains nothing: single rows make it look so.
    evidence = evidence if std < UNKNOWN_SIZE else 0.0
    return Relation(factor, (math.hypot(std, unsure), std), evidence, _throughout(fit, windows))


def _too_small(per_row, fit):
    """By how much noise of the logged change makes the logarithm of a factor too small, and how unsure that is.

    Noise with a share of what is told makes a factor 1 - share of what it is. All that wanders can be such noise, or
    noise of what is seen; no more of it can than neighbouring rows differ by. But noise that a filter has smoothed
    hides from these: then the first is right.
    """
    most = math.log(0.5 + math.sqrt(0.25 + per_row * fit.wander))  # = share / (1 - share)^2
    least = min(most, math.log(0.5 + math.sqrt(0.25 + per_row * fit.rows_noise)))
    apart = most - least
    return most - UNSURE_NOISE[0] * apart, UNSURE_NOISE[1] * apart + UNSURE_NOISE[2] * most


def _jackknife(fit, windows):
    """Deviation of the factor by what the windows of a log say, relative to its size."""
    # Per window the energy of the regressor and its product with the residual.
    sums = np.array(
        [
            [np.vdot(fit.reported[w], fit.reported[w]).real, np.vdot(fit.reported[w], fit.rest[w])]
            for w in windows
        ]
    )
    # One window with a fault of its own may not dominate the standard error.
    tame = np.minimum(np.abs(sums[:, 1]), 4.0 * np.quantile(np.abs(sums[:, 1]), ROBUST_SHARE))
    return float(
        np.sqrt(np.sum(tame**2)) / max(np.real(sums[:, 0]).sum() * abs(fit.factor), 1e-300)
    )


def _throughout(fit, windows):
    """Whether a relation holds in all of a log."""
    # Clip single rows, so that outliers do not count as a part in which the relation fails.
    clip = FIT_CLIP**2 * fit.variance
    seen, rest = (np.minimum(np.abs(residual) ** 2, clip) for residual in (fit.seen, fit.rest))
    # Noise level of the calmer windows. Residuals
    # beyond some multiple of it are unexplained motion.
    noise = float(np.quantile([rest[w].mean() for w in windows], CALM_SHARE))
    usual = np.array([NOISIER * noise * len(w) for w in windows])
    left = np.array([rest[w].sum() for w in windows])
    if fit.as_labelled is not None:
        # The labels are right in a part in which they leave less than the relation does: a ratio of likelihoods.
        otherwise = np.minimum(np.abs(fit.as_labelled) ** 2, clip)
        kept = np.maximum([otherwise[w].sum() for w in windows], usual)
        apart = np.log(kept / np.maximum(left, usual))
        return bool(np.maximum(apart, 0.0).sum() > UNLABELLED * np.abs(apart).sum())
    # Units of what is seen: what is explained is held against what is left beyond noise; no window counts for many.
    explained_by_window = np.array([seen[w].sum() for w in windows]) - left
    # Limit the weight of one window with much motion.
    most = max(
        float(np.quantile(np.abs(explained_by_window), ROBUST_SHARE)), 2.0 * FIT_CLIP**2 * noise
    )  # noise itself says less
    explained = np.clip(explained_by_window, 0.0, most).sum()
    more = np.clip(left - usual, 0.0, most).sum()
    return bool(explained > THROUGHOUT * (explained + more))
