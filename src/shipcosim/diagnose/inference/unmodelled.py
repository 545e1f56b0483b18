"""Unmodelled errors: whether a force on the ship, or an error of a channel, is left that no known cause explains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from shipcosim.diagnose.inference.evidence import evidence, gram
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import with_columns
from shipcosim.diagnose.inference.thresholds import (
    BASIS_FUNCTIONS,
    CHANNEL_SIZES,
    FORCE_SIZE,
    LEAST_LOG_P,
    LENGTHS_PER_GYRADIUS,
    PERIODS,
    SHORTEST_PERIOD,
    SIZE_FROM_PART_TO_PART,
    UNMODELLED,
)
from shipcosim.diagnose.ship.environment import piecewise_linear_basis
from shipcosim.diagnose.ship.instruments import readings

if TYPE_CHECKING:
    from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem

__all__ = ["FORCES", "is_healthy", "unmodelled_gains"]

FORCES = ("slow", "with the heading", "periodic")
"""Kinds of unmodelled errors that push the ship."""


def is_healthy(problem: IdentificationProblem, fit: Fit) -> bool:
    """Whether a fit has no cause, and no unmodelled error stands out beside it."""
    return not fit.hypotheses and max(unmodelled_gains(problem, fit).values()) < UNMODELLED


def unmodelled_gains(problem: IdentificationProblem, fit: Fit) -> dict[str, float]:
    """Gain in log-evidence of unmodelled errors beside a fit.

    Forces of three kinds: slow ones in the body frame (a few basis functions over time), ones that go with the heading,
    and single sinusoids of any period, for which the search over periods is paid. Channels that are off by a
    constant, by a factor, or drift. Whether the causes of the fit are as large in each part of the log. And whether
    the numbers of the ship lie, taken together, within their tolerances.

    Parameters
    ----------
    problem : IdentificationProblem
    fit : Fit

    Returns
    -------
    dict of str to float
        By kind. [nats]
    """
    forces, channels = _bases(problem, fit), _channels(problem, fit)
    linear = _with(
        fit.linear, np.concatenate([b for group in forces.values() for b in group], axis=-1), channels, problem
    )
    kinds = forces | {"in a channel": [channels[..., i] for i in np.split(np.arange(channels.shape[-1]), 6)]}
    products = gram(innovations(linear, problem.noise, problem.record)).products
    base = len(fit.columns)
    prior = np.concatenate([[column.prior for column in fit.columns], np.zeros(linear.driven.shape[-1] - 1 - base)])
    centre = np.zeros(prior.size)
    centre[:base] = fit.theta - fit.left
    nothing, found, place = evidence(products, prior, centre)[0], {}, base
    for kind, group in kinds.items():
        scores = []
        for basis in group:
            here = prior.copy()
            here[place : place + basis.shape[-1]] = 1.0
            place += basis.shape[-1]
            scores.append(evidence(products, here, centre)[0] - nothing)
        found[kind] = float(max(scores) - np.log(len(scores)))
    return found | {"from part to part": _differs_by_part(fit), "beyond tolerances": _beyond_tolerances(fit)}


def _differs_by_part(fit):
    """Evidence that a cause's size differs from part to part of the log by more than a tenth. [nats]

    Each part pulls at the estimate; what it would pull by chance is known, and the least likely pull counts.
    """
    blocks, place, unlikely = fit.products.blocks, len(fit.columns), []
    for hypothesis in reversed(fit.hypotheses):
        place -= len(hypothesis.parameters)
        own = range(place, place + len(hypothesis.parameters))
        size = np.linalg.norm([fit.theta[i] for i in own])
        for i in own:
            known = blocks[:, 1 + i, 1 + i]
            pull = blocks[:, 1 + i, 0] - blocks[:, 1 + i, 1:] @ fit.left
            chance = known * (1.0 + (SIZE_FROM_PART_TO_PART * size) ** 2 * known) + 1e-9
            unlikely.append(chi2.logsf((pull**2 / chance).sum(), len(blocks)))
    return _most_evidence(min(unlikely, default=0.0) + np.log(max(len(unlikely), 1)))


def _beyond_tolerances(fit):
    """Evidence that the known numbers lie farther off what they are known as than their tolerances say. [nats]

    In units of the tolerances the posterior mean has, in each direction, the variance that the log took from that of
    the prior; the sum of its squares is taken as a scaled chi-square of the same mean and variance.
    """
    known = len(fit.columns) - sum(len(hypothesis.parameters) for hypothesis in fit.hypotheses)
    told = np.clip(1.0 - np.linalg.eigvalsh(fit.covariance[:known, :known]), 1e-9, None)
    mean, half_variance = told.sum(), (told**2).sum()
    squares = (fit.theta[:known] ** 2).sum()
    return _most_evidence(chi2.logsf(squares * mean / half_variance, mean**2 / half_variance))


def _most_evidence(log_p):
    """The most evidence that a p-value can be: -log(-e p log p) (Sellke, Bayarri and Berger 2001). [nats]"""
    log_p = max(log_p, LEAST_LOG_P)
    return float(-1.0 - log_p - np.log(-log_p)) if log_p < -1.0 else 0.0


def _bases(problem, fit):
    """Accelerations in the body frame over the rows: by kind a list of (n, 3, p) arrays."""
    time, psi = problem.record.time, fit.motion.psi
    n = time.size
    slow = piecewise_linear_basis(np.linspace(0.0, 1.0, n), BASIS_FUNCTIONS).T
    c, s = np.cos(psi), np.sin(psi)
    heading = np.stack([c, s, np.cos(2 * psi), np.sin(2 * psi), c**3, s**3], axis=-1)
    span = time[-1] - time[0]
    periods = np.geomspace(SHORTEST_PERIOD, span, PERIODS)
    waves = [np.stack([np.sin(2 * np.pi * time / p), np.cos(2 * np.pi * time / p)], axis=-1) for p in periods]
    return {
        "slow": [_each_axis(slow)],
        "with the heading": [_each_axis(heading)],
        "periodic": [_each_axis(wave) for wave in waves],
    }


def _each_axis(shapes):
    """Shapes over time (n, p), on each of surge, sway and yaw: (n, 3, 3 p)."""
    n, p = shapes.shape
    found = np.zeros((n, 3, 3 * p))
    for axis in range(3):
        found[:, axis, axis * p : (axis + 1) * p] = shapes
    return found


def _channels(problem, fit):
    """What a channel shows too much: (n, 6, p), as many columns for each channel in turn."""
    time, motion = problem.record.time, np.stack(readings(fit.motion, fit.model), axis=-1)
    share = (time - time[0]) / (time[-1] - time[0])
    found = np.zeros((time.size, 6, 6, 3))
    for i, size in enumerate(CHANNEL_SIZES):
        moved = motion[:, i] - motion[:, i].mean()
        shapes = [np.sin(np.pi * share), np.cos(np.pi * share), np.cos(2 * np.pi * share)]
        if i > 2:
            shapes = [np.ones_like(share), share - 0.5, 0.1 * moved / size]
        found[:, i, i] = size * np.stack(shapes, axis=-1)
    return found.reshape(time.size, 6, 18) * fit.linear.whole[..., None]


def _with(linear, accelerations, channels, problem):
    """The problem with a column for each acceleration, and for each error of a channel."""
    h, n = problem.record.step, problem.record.time.size
    size = FORCE_SIZE * np.array([1.0, 1.0, LENGTHS_PER_GYRADIUS / problem.model.parts["hull"].length])
    driven = np.zeros((n - 1, 6, accelerations.shape[-1]))
    driven[:, 3:6] = -h * size[:, None] * 0.5 * (accelerations[:-1] + accelerations[1:])
    driven = np.concatenate([driven, np.zeros((n - 1, 6, channels.shape[-1]))], axis=-1)
    seen = np.concatenate([np.zeros((n, 6, accelerations.shape[-1])), channels], axis=-1)
    return with_columns(linear, driven, seen)
