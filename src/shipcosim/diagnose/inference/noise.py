"""How noisy a log is: levels of its channels and of what jolts the ship, by maximum likelihood."""

from dataclasses import fields, replace

import numpy as np

from shipcosim.diagnose.inference.innovations import Noise, log_likelihoods, oscillation
from shipcosim.diagnose.inference.linearisation import Linear
from shipcosim.diagnose.numerics import noise_by_differences, normal_size
from shipcosim.diagnose.ship.inputs import Record

_GROUPS = (
    ("white", (0, 1)),
    ("white", (2,)),
    ("white", (3, 4)),
    ("white", (5,)),
    ("jolt", (0, 1)),
    ("jolt", (2,)),
    ("walk", (0, 1)),
    ("walk", (2,)),
    ("wave", (0,)),
    ("wave", (1,)),
    ("wave", (2,)),
    ("wave_frequency", ()),
)
_FREQUENCIES = np.geomspace(0.4, 2.5, 8)  # rad/s, of waves
_LEVELS = (
    (1.0, 1.0),
    (0.5, 1.0),
    (0.5, 0.5),
)  # of white noise in velocities and of waves, to begin with
_STRIDE = 0.2  # of the natural logarithm
_LONGEST = 0.8
_SHARES = np.array([1.0, 0.5, 0.2, 0.0])  # of a move, that are tried


def first_noise(record: Record, length: float) -> Noise:
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
    # Third differences remove the motion, and leave the noise.
    third = noise_by_differences(record.measured, 3, axis=-2)
    silent = ~np.any(np.isfinite(third), axis=-2, keepdims=True)
    white = normal_size(np.where(silent, 0.0, third), axis=-2)
    # A floor, as a rounded or constant channel would appear free of noise; a channel without
    # measurements gets 1.
    least = np.array([0.02, 0.02, 5e-4, 3e-3, 3e-3, 1e-4])
    white = np.where(silent[..., 0, :], 1.0, np.maximum(white, least))
    # Start values of accelerations; those in yaw by a lever of a quarter of the length.
    turning = 4.0 / length  # 1/m, from accelerations to those in yaw
    jolt = np.array([1e-3, 1e-3, 1e-3 * turning])
    walk = np.array([1e-5, 1e-5, 1e-5 * turning])
    return Noise(white, jolt, walk, 0.7 * white[..., 3:], np.ones(white.shape[:-1]))


def tuned(
    noise: Noise,
    left: Linear,
    record: Record,
    *,
    most_walk: np.ndarray,
    most_white: np.ndarray | float = np.inf,
    least_white: np.ndarray | float = 0.0,
    least_jolt: np.ndarray | float = 0.0,
    rounds: int = 4,
) -> Noise:
    """The noise under which what is left of a log is likeliest.

    Parameters
    ----------
    noise : Noise
        To start from.
    left : Linear
        What of the log is not explained, without columns.
    record : Record
    most_walk : (3,) array
        No unexplained force may walk faster, or it would swallow every cause.
    most_white : (6,) array, optional
        No channel may be noisier: what position and velocity agree upon, or a wrong model would pass as noise.
    least_white, least_jolt : (6,) and (3,) array, optional
        No channel and no acceleration may be less noisy: a simulated log without noise shows the error of its own step.
    rounds : int

    Returns
    -------
    Noise
    """
    noise = _begun(noise, left, record)
    # Newton's method in the logarithms of the levels, one diagonal Hessian entry each: all steps up
    # and down are evaluated in one call.
    for _ in range(rounds):
        steps = np.zeros((2 * len(_GROUPS) + 1, len(_GROUPS)))
        for i in range(len(_GROUPS)):
            steps[1 + 2 * i, i], steps[2 + 2 * i, i] = _STRIDE, -_STRIDE
        score = log_likelihoods(left, _scaled(noise, steps), record)
        up = score[1::2]
        down = score[2::2]
        # Slope and curvature by central differences.
        slope = (up - down) / (2 * _STRIDE)
        bend = (up + down - 2 * score[0]) / _STRIDE**2
        # Newton step where the likelihood is concave, else the longest step uphill.
        move = np.where(bend < -1e-3, -slope / np.minimum(bend, -1e-3), np.sign(slope) * _LONGEST)
        move = np.clip(move, -_LONGEST, _LONGEST)
        # Line search: the whole step, shares of it, or none.
        tries = _scaled(noise, _SHARES[:, None] * move)
        # Limits keep waves in their band, and force and channel noise from absorbing what causes
        # should explain.
        frequency = np.clip(tries.wave_frequency, *_FREQUENCIES[[0, -1]])
        tries = replace(
            tries,
            walk=np.minimum(tries.walk, most_walk),
            white=np.clip(tries.white, least_white, most_white),
            jolt=np.maximum(tries.jolt, least_jolt),
            wave_frequency=frequency,
        )
        scores = log_likelihoods(left, tries, record)
        move = _SHARES[scores.argmax()] * move
        noise = _of(tries, scores.argmax())
        if np.abs(move).max() < 0.05:
            break
    return noise


def _begun(noise: Noise, left: Linear, record: Record) -> Noise:
    """The noise with the frequency of waves, and their share in the noise of the velocities, that suit a log best."""
    # Newton's method only finds a local maximum, so it starts from the best point of a grid over
    # wave frequency and levels.
    rows = [(frequency, *levels) for frequency in _FREQUENCIES for levels in _LEVELS]
    frequency, white, wave = np.array(rows).T
    many = _scaled(noise, np.zeros((len(rows), len(_GROUPS))))
    many.white[:, 3:] *= white[:, None]
    tries = replace(many, wave=many.wave * wave[:, None], wave_frequency=frequency)
    return _of(tries, log_likelihoods(left, tries, record).argmax())


def _of(noise: Noise, which: int | np.integer) -> Noise:
    """One of several."""
    return Noise(*(getattr(noise, part.name)[which] for part in fields(Noise)))


def waves_of(
    noise: Noise, h: float, shape: tuple[int, int], rng: np.random.Generator
) -> np.ndarray:
    """First-order wave motion, drawn: place and velocity in the ship's axes.

    Parameters
    ----------
    noise : Noise
        Of one log.
    h : float
        Step. [s]
    shape : tuple of int
        Number of rows n and of logs m.
    rng : numpy.random.Generator

    Returns
    -------
    (n, m, 6) array
        [m, m, rad, m/s, m/s, rad/s]
    """
    n, m = shape
    # Conditional draw from the step's covariance: velocity given place, by the regression
    # coefficient along, then the rest (Cholesky factor of two).
    (a, b, c, d), (place, both, speed) = oscillation(noise, h)
    along = np.divide(both, place, out=np.zeros(3), where=place > 0.0)
    kicks = (
        rng.standard_normal((2, n, m, 3))
        * np.sqrt(np.stack([place, speed - along * both]))[:, None, None]
    )
    # Start from the stationary distribution.
    velocity = rng.standard_normal((m, 3)) * noise.wave
    where = rng.standard_normal((m, 3)) * noise.wave / noise.wave_frequency
    motion = np.empty((n, m, 6))
    # Transition of the oscillator with its correlated increments.
    for k in range(n):
        motion[k] = np.concatenate([where, velocity], axis=-1)
        first, second = kicks[:, k]
        where, velocity = (
            a * where + b * velocity + first,
            c * where + d * velocity + along * first + second,
        )
    return motion


def _scaled(noise: Noise, steps: np.ndarray) -> Noise:
    """Noise for each row of steps, which are in natural logarithms of the groups."""
    names = [part.name for part in fields(Noise)]
    # One copy of every entry for each row of steps.
    parts = {
        name: np.repeat(np.asarray(getattr(noise, name))[None], len(steps), axis=0)
        for name in names
    }
    # Groups of array entries, and the frequency, which has no entries.
    for i, (name, entries) in enumerate(_GROUPS):
        if entries:
            parts[name][:, list(entries)] *= np.exp(steps[:, i])[:, None]
        else:
            parts[name] = parts[name] * np.exp(steps[:, i])
    return Noise(**parts)
