"""How noisy a log is: levels of its channels and of what jolts the ship, by maximum likelihood."""

import numpy as np

from shipcosim.diagnose.linear import Linear, Noise, innovations

__all__ = ["explained", "first_noise", "tuned"]

_GROUPS = (
    ("white", (0, 1)),
    ("white", (2,)),
    ("white", (3, 4)),
    ("white", (5,)),
    ("jolt", (0, 1)),
    ("jolt", (2,)),
    ("walk", (0, 1)),
    ("walk", (2,)),
)
_STRIDE = 0.2  # of the natural logarithm
_LONGEST = 0.8


def first_noise(record, length):
    """Noise to start from: channels by their differences from row to row, the rest by the size of the ship.

    Parameters
    ----------
    record : Record
    length : float
        Of the ship. [m]

    Returns
    -------
    Noise
    """
    third = np.diff(record.measured, 3, axis=-2)
    silent = ~np.isfinite(third).any(axis=-2, keepdims=True)
    white = np.sqrt(np.nanmedian(np.where(silent, 0.0, third**2), axis=-2) / 0.455 / 20.0)
    least = np.array([0.02, 0.02, 5e-4, 3e-3, 3e-3, 1e-4])
    white = np.where(silent[..., 0, :], 1.0, np.maximum(white, least))
    turning = 4.0 / length  # 1/m, from accelerations to those in yaw
    return Noise(white, np.array([1e-3, 1e-3, 1e-3 * turning]), np.array([1e-5, 1e-5, 1e-5 * turning]))


def tuned(noise, linear, record, theta, *, most_walk, rounds=4):
    """The noise under which what is left of a log is likeliest.

    Parameters
    ----------
    noise : Noise
        To start from.
    linear : Linear
    record : Record
    theta : (p,) array
        What explains the log, in units of its columns; taken out first.
    most_walk : (3,) array
        No unexplained force may walk faster, or it would swallow every cause.
    rounds : int

    Returns
    -------
    Noise
    """
    left = explained(linear, theta)
    for _ in range(rounds):
        steps = np.zeros((2 * len(_GROUPS) + 1, len(_GROUPS)))
        for i in range(len(_GROUPS)):
            steps[1 + 2 * i, i], steps[2 + 2 * i, i] = _STRIDE, -_STRIDE
        found = innovations(left, _scaled(noise, steps), record)
        score = -0.5 * ((found.white[..., 0] ** 2).sum((0, -1)) + found.log_determinant.sum(0))
        up, down = score[1::2], score[2::2]
        slope, bend = (up - down) / (2 * _STRIDE), (up + down - 2 * score[0]) / _STRIDE**2
        move = np.where(bend < -1e-3, -slope / np.minimum(bend, -1e-3), np.sign(slope) * _LONGEST)
        move = np.clip(move, -_LONGEST, _LONGEST)
        noise = _scaled(noise, move[None])
        noise = Noise(noise.white[0], noise.jolt[0], np.minimum(noise.walk[0], most_walk))
        if np.abs(move).max() < 0.05:
            break
    return noise


def explained(linear, theta):
    """The problem with only its first column, from which the effect of θ is taken out."""
    weights = np.concatenate([[1.0], -np.asarray(theta)])
    return Linear(
        linear.transition, linear.driven @ weights[:, None], linear.output, linear.seen @ weights[:, None], linear.whole
    )


def _scaled(noise, steps):
    """Noise for each row of steps, which are in natural logarithms of the groups."""
    parts = {name: np.repeat(getattr(noise, name)[None], len(steps), axis=0) for name in ("white", "jolt", "walk")}
    for i, (name, entries) in enumerate(_GROUPS):
        parts[name][:, list(entries)] *= np.exp(steps[:, i])[:, None]
    return Noise(**parts)
