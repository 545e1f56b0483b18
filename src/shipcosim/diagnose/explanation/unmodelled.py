"""Unmodelled errors: whether a force on the ship, or an error of a channel, is left that no known cause explains."""

import numpy as np

from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.parts import with_columns
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
from shipcosim.diagnose.numerics import log_survival
from shipcosim.diagnose.ship.environment import piecewise_linear_basis
from shipcosim.diagnose.ship.measured_motion import readings

FORCES = ("slow", "with the heading", "periodic")
"""Kinds of unmodelled errors that push the ship."""
_SHAPES = 3
"""Ways in which a channel can be wrong."""


def is_healthy(problem: IdentificationProblem, fit: Fit) -> bool:
    """Whether a fit has no cause, and no unmodelled error stands out beside it."""
    return not fit.hypotheses and max(unmodelled_gains(problem, fit).values()) < UNMODELLED


def unmodelled_gains(problem: IdentificationProblem, fit: Fit) -> dict[str, float]:
    """Gain in log-evidence of unmodelled errors beside a fit.

    Forces of three kinds: slow ones in the body frame (a few basis functions over time), ones that go with the heading,
    and single sinusoids of any period, for which the search over periods is paid. Channels that are off by a
    constant, by a factor, or drift. Whether the causes of the fit are as large in each part of the log. And whether
    the numbers of the ship lie, taken together, within their tolerances. What a reference has of forces and channels
    is taken off.

    Parameters
    ----------
    problem : IdentificationProblem
    fit : Fit

    Returns
    -------
    dict of str to float
        By kind. [nats]
    """
    # Number of columns of each kind: forces by their basis functions, channels by their shapes.
    kinds = {
        kind: [basis.shape[-1] for basis in group]
        for kind, group in _bases(problem, fit, slice(0, 1)).items()
    }
    kinds |= {"in a channel": [_SHAPES] * 6}
    # Columns for all kinds at once, so that one pass of the filter suffices.
    shown = np.stack(readings(fit.motion, fit.model), axis=-1)
    linear = with_columns(
        fit.linear, sum(map(sum, kinds.values())), lambda rows: _columns(problem, fit, shown, rows)
    )
    products = problem.gram(linear).products
    base = len(fit.columns)
    # The fit's columns keep their priors; unmodelled ones are switched on in turn.
    prior = np.concatenate(
        [[column.prior for column in fit.columns], np.zeros(linear.columns - base)]
    )
    centre = np.zeros(prior.size)
    centre[:base] = fit.theta - fit.left
    nothing = evidence(products, prior, centre)[0]
    gains = {}
    place = base
    # Best of each kind, less the logarithm of how many were tried and less what a reference
    # expects.
    for kind, group in kinds.items():
        scores = []
        for size in group:
            here = prior.copy()
            here[place : place + size] = 1.0
            place += size
            scores.append(evidence(products, here, centre)[0] - nothing)
        gains[kind] = float(
            max(scores) - np.log(len(scores)) - problem.model.ordinary_errors.get(kind, 0.0)
        )
    return gains | errors_of_the_fit(fit)


def errors_of_the_fit(fit: Fit) -> dict[str, float]:
    """Those of the unmodelled errors that show in a fit by itself, by kind. [nats]"""
    return {
        "from part to part": _differs_by_part(fit),
        "beyond tolerances": _beyond_tolerances(fit),
    }


def _differs_by_part(fit):
    """Evidence that a cause's size differs from part to part of the log by more than a tenth. [nats]

    Each part pulls at the estimate; what it would pull by chance is known, and the least likely pull counts.
    """
    # Residual products by block: the pull of a part is the gradient of its log-likelihood.
    blocks = fit.products.blocks
    place = len(fit.columns)
    unlikely = []
    for hypothesis in reversed(fit.hypotheses):
        place -= len(hypothesis.parameters)
        places = range(place, place + len(hypothesis.parameters))
        size = np.linalg.norm([fit.theta[i] for i in places])
        for i in places:
            # By chance the pull has the variance of the part's information, more where sizes may
            # differ by some share.
            information = blocks[:, 1 + i, 1 + i]
            pull = blocks[:, 1 + i, 0] - blocks[:, 1 + i, 1:] @ fit.left
            chance = information * (1.0 + (SIZE_FROM_PART_TO_PART * size) ** 2 * information) + 1e-9
            unlikely.append(log_survival((pull**2 / chance).sum(), len(blocks)))
    # The least likely of several p-values: times their number (Bonferroni).
    return _most_evidence(min(unlikely, default=0.0) + np.log(max(len(unlikely), 1)))


def _beyond_tolerances(fit):
    """Evidence that the known numbers lie beyond their tolerances. [nats]

    In units of the tolerances the posterior mean has, in each direction, the variance that the log took from that of
    the prior; the sum of its squares is taken as a scaled chi-square of the same mean and variance.
    """
    ship_count = len(fit.columns) - sum(len(hypothesis.parameters) for hypothesis in fit.hypotheses)
    # Share of the prior variance that the log has removed, in each principal direction.
    prior = np.array([column.prior for column in fit.columns[:ship_count]])
    informed = np.clip(
        1.0 - np.linalg.eigvalsh(fit.covariance[:ship_count, :ship_count] / prior[:, None] / prior),
        1e-9,
        None,
    )
    # Match mean and variance of the weighted sum by a scaled chi-square (Satterthwaite).
    mean = informed.sum()
    half_variance = (informed**2).sum()
    squares = ((fit.theta[:ship_count] / prior) ** 2).sum()
    return _most_evidence(log_survival(squares * mean / half_variance, mean**2 / half_variance))


def _most_evidence(log_p):
    """The most evidence that a p-value can be: -log(-e p log p) (Sellke, Bayarri and Berger 2001). [nats]"""
    log_p = max(log_p, LEAST_LOG_P)
    return float(-1.0 - log_p - np.log(-log_p)) if log_p < -1.0 else 0.0


def _bases(problem, fit, rows):
    """Accelerations in the body frame over some rows: by kind a list of (k, 3, p) arrays."""
    every = problem.record.time
    time = every[rows]
    psi = fit.motion.psi[rows]
    # Slow forces: piecewise linear functions of time.
    slow = piecewise_linear_basis(np.linspace(0.0, 1.0, every.size)[rows], BASIS_FUNCTIONS).T
    # Forces by heading: first and second harmonics, and cubes.
    c = np.cos(psi)
    s = np.sin(psi)
    heading = np.stack([c, s, np.cos(2 * psi), np.sin(2 * psi), c**3, s**3], axis=-1)
    # Sinusoids of any phase, periods evenly spaced on a logarithmic scale.
    periods = np.geomspace(SHORTEST_PERIOD, every[-1] - every[0], PERIODS)
    waves = [
        np.stack([np.sin(2 * np.pi * time / p), np.cos(2 * np.pi * time / p)], axis=-1)
        for p in periods
    ]
    return {
        "slow": [_each_axis(slow)],
        "with the heading": [_each_axis(heading)],
        "periodic": [_each_axis(wave) for wave in waves],
    }


def _each_axis(shapes):
    """Shapes over time (n, p), on each of surge, sway and yaw: (n, 3, 3 p)."""
    n, p = shapes.shape
    columns = np.zeros((n, 3, 3 * p))
    for axis in range(3):
        columns[:, axis, axis * p : (axis + 1) * p] = shapes
    return columns


def _channels(problem, shown, rows):
    """Columns of errors of a channel in some rows: (k, 6, p), as many for each channel in turn.

    `shown` is what the instruments show at all rows, (n, 6).
    """
    every = problem.record.time
    # Time as a share of the log.
    share = (every[rows] - every[0]) / (every[-1] - every[0])
    columns = np.zeros((share.size, 6, 6, _SHAPES))
    # Position and heading: slow sines and cosines. Velocities: constant, drift, scale.
    for i, size in enumerate(CHANNEL_SIZES):
        moved = shown[rows, i] - shown[:, i].mean()
        shapes = [np.sin(np.pi * share), np.cos(np.pi * share), np.cos(2 * np.pi * share)]
        if i > 2:
            shapes = [np.ones_like(share), share - 0.5, 0.1 * moved / size]
        columns[:, i, i] = size * np.stack(shapes, axis=-1)
    # A channel error shows only where the channel was measured.
    return (
        columns.reshape(share.size, 6, 6 * _SHAPES)
        * np.isfinite(problem.record.measured[rows])[..., None]
    )


def _columns(problem, fit, shown, rows):
    """A column for each acceleration and for each error of a channel, `driven` and `seen` of some rows."""
    h = problem.record.step
    n = problem.record.time.size
    # Typical size of an unmodelled force as acceleration, in yaw by the gyradius.
    size = FORCE_SIZE * np.array(
        [1.0, 1.0, LENGTHS_PER_GYRADIUS / problem.model.parts["hull"].length]
    )
    # One more row, for the mean of each step's ends.
    groups = _bases(problem, fit, slice(rows.start, min(rows.stop + 1, n))).values()
    accelerations = np.concatenate([basis for group in groups for basis in group], axis=-1)
    channels = _channels(problem, shown, rows)
    steps = len(accelerations) - 1
    forces = accelerations.shape[-1]
    driven = np.zeros((steps, 6, forces + channels.shape[-1]))
    # Change of velocity over the step; the sign is that of δ' = A δ + b - B θ.
    driven[:, 3:6, :forces] = -h * size[:, None] * 0.5 * (accelerations[:-1] + accelerations[1:])
    return driven, np.concatenate([np.zeros((len(channels), 6, forces)), channels], axis=-1)
