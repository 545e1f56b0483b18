"""Whitened innovations of the linear problem: the noise of a log, and the filter that is built of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from shipcosim.diagnose.inference import kalman
from shipcosim.diagnose.inference.linearisation import SLOW_STD, SLOW_TIME, STATES, Linear
from shipcosim.diagnose.inference.parts import InParts, in_parts
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.models.control.wave_filter import wave_transition
from shipcosim.models.core.motion import Motion

_SLOW = range(9, 12)  # states of slow errors
_PLACE = range(12, 15)  # of what waves add to position and heading
_SPEED = range(15, 18)  # and to the velocity
WAVE_DAMPING = 0.1
"""Damping ratio of the oscillator that stands for first-order wave motion (Fossen 2011, section 8.2.6)."""


@dataclass(frozen=True)
class Noise:
    """Noise of a log; every entry an array whose leading axes are those of the logs.

    Attributes
    ----------
    white : (..., 6) array
        Standard deviation of the channels. [m, m, rad, m/s, m/s, rad/s]
    jolt : (..., 3) array
        White acceleration: what gusts and thrusters do that the model does not follow. [m/s^1.5, m/s^1.5, rad/s^1.5]
    walk : (..., 3) array
        Random walk of the unexplained acceleration. [m/s^2.5, m/s^2.5, rad/s^2.5]
    wave : (..., 3) array
        Standard deviation of the velocity of first-order wave motion. [m/s, m/s, rad/s]
    wave_frequency : (...) array
        Where that motion is largest. [rad/s]
    """

    white: Any
    jolt: Any
    walk: Any
    wave: Any = (0.0, 0.0, 0.0)
    wave_frequency: Any = 1.0


class Innovations(NamedTuple):
    """Result of the filter.

    Attributes
    ----------
    white : (n, ..., 6, 1 + p) array
        Whitened innovations: of the log in the first column, of each θ in the others.
    log_determinant : (n, ...) array
        Of their covariance, per row.
    filtered : (n, ..., 18) array
        Deviations of the first column at each row by what was known until then.
    """

    white: np.ndarray
    log_determinant: np.ndarray
    filtered: np.ndarray = np.empty(0)

    @property
    def squares(self) -> np.ndarray:
        """Sum of the squared innovations of the log in each row."""
        return (self.white[..., 0] ** 2).sum(-1)


def innovations(linear: Linear | InParts, noise: Noise, record: Record) -> Innovations:
    """Filter every column.

    Parameters
    ----------
    linear : Linear or InParts
    noise : Noise
    record : Record

    Returns
    -------
    Innovations
    """
    parts = [part for _, part in _by_parts(linear, noise, record)]
    return Innovations(*(np.concatenate(fields) for fields in zip(*parts, strict=True)))


def inner_products(linear: Linear | InParts, noise: Noise, record: Record, parts: int = 8) -> Gram:
    """Inner products of the innovations of every column, which are never all in memory.

    Parameters
    ----------
    linear : Linear or InParts
    noise : Noise
    record : Record
    parts : int
        Number of blocks.

    Returns
    -------
    Gram
    """
    return gram(_by_parts(linear, noise, record), record.time.size, parts)


def _by_parts(linear, noise, record):
    """First row and innovations of each part of a log, in order."""
    passing = _Filter(in_parts(linear), noise, record)
    for rows in passing.linear.slices():
        passed = passing.over(rows)
        yield (
            rows.start,
            Innovations(
                *map(passing.by_log, (passed.white, passed.log_determinant, passed.states))
            ),
        )


def smoothed(
    linear: Linear | InParts, noise: Noise, record: Record, motion: Motion
) -> tuple[Motion, np.ndarray]:
    """Motion by all rows of a log, and what else is smoothed.

    Parameters
    ----------
    linear : Linear or InParts
        Of which the first column counts.
    noise : Noise
    record : Record
    motion : Motion
        That the problem was linearised about.

    Returns
    -------
    tuple of Motion, (..., n, 12) array
        (..., n) arrays; unexplained acceleration, slow errors and waves.
    """
    # Forward pass without keeping covariances: only the state at the start of each part is stored.
    passing = _Filter(in_parts(linear).chosen([]), noise, record)
    begun = []
    slices = list(passing.linear.slices())
    for rows in slices:
        begun.append(passing.state)
        if rows is not slices[-1]:
            passing.over(rows)
    # Backward pass over the parts: each is filtered again with covariances, then smoothed by the
    # adjoint variable that comes from the part behind it.
    states_of_parts = []
    pull = None
    for rows, state in zip(reversed(slices), reversed(begun), strict=True):
        passing.state = state
        passed = passing.over(rows, keep=True)
        pull = np.zeros(passed.states.shape[1:]) if pull is None else pull
        of_filter = (
            passed.gain,
            passed.root,
            passed.states,
            passed.covariances,
            record.is_last[rows],
        )
        states_of_parts.append(
            kalman.smoothed(
                passed.A, passing.steady, passed.H, passed.white[..., 0].copy(), *of_filter, pull
            )
        )
    # Smoothed deviations are added to the motion that was linearised about.
    states = np.moveaxis(passing.by_log(np.concatenate(states_of_parts[::-1])), 0, -2)
    return Motion(*(value + states[..., i] for i, value in enumerate(motion))), states[..., 6:]


class _Passed(NamedTuple):
    """What the filter finds over some rows, of (k, m, ...) arrays for m logs; A and H as it takes them."""

    A: np.ndarray
    H: np.ndarray
    gain: np.ndarray
    root: np.ndarray
    log_determinant: np.ndarray
    covariances: np.ndarray
    white: np.ndarray
    states: np.ndarray


class _Filter:
    """The filter of a problem, over one part of its rows after the other.

    Attributes
    ----------
    linear : InParts
    state : tuple of (m, 18, 18) array and (m, 18, c) array, or None
        Covariance and state of each column at the row after the last part; None before the first.
    steady : (m, 18, 18) array
        What of the transition does not change from row to row.
    uncertain : (m, 18, 18) array
        Covariance where a stretch of the log begins.
    """

    def __init__(self, linear: InParts, noise: Noise, record: Record):
        self.linear = linear
        self.noise = noise
        self.record = record
        self.state = None

    def over(self, rows: slice, keep: bool = False) -> _Passed:
        """Go over a part of the rows, the covariances kept or not."""
        linear = self.linear.part(rows)
        noise = self.noise
        record = self.record
        begun = self._begun(linear) if self.state is None else self.state
        A, B, H, Z = (_by_log(values, self.lead, 2) for values in linear[:4])
        C, x = (value.copy() for value in begun)
        # An output that is missing has infinite variance, so it gets no weight.
        white = np.asarray(noise.white).reshape(1, -1, 6)
        R = np.where(_by_log(linear.whole, self.lead, 1), white**2, np.inf)
        R = np.require(np.broadcast_to(R, (len(R), len(C), 6)), requirements=["C", "W"])
        with_value = np.asarray(record.usable)[rows]
        is_last = record.is_last[rows]
        # Gains and covariances do not depend on the columns: computed once, they filter the log and
        # all regressors.
        weights = kalman.weights(
            A,
            self.steady,
            H,
            R,
            self.process,
            C,
            with_value,
            _lost(),
            is_last,
            self.uncertain,
            keep,
        )
        gain, root, log_determinant, covariances = weights
        filtered = kalman.whitened(A, self.steady, B, H, Z, gain, root, is_last, x)
        self.state = C, x
        return _Passed(A, H, gain, root, log_determinant, covariances, *filtered)

    def _begun(self, linear):
        """Shape of the logs, and the state before the first row."""
        noise = self.noise
        step = self.record.step
        self.lead = np.broadcast_shapes(linear.seen.shape[1:-2], np.shape(noise.white)[:-1])
        of_noise = _steady(noise, step), _process(noise, step), _uncertain(noise)
        self.steady, self.process, self.uncertain = (
            _of_logs(values, self.lead) for values in of_noise
        )
        return self.uncertain, np.zeros((len(self.uncertain), STATES, linear.seen.shape[-1]))

    def by_log(self, values: np.ndarray) -> np.ndarray:
        """(k, m, ...) array with the axes of the logs."""
        return values.reshape(len(values), *self.lead, *values.shape[2:])


def log_likelihoods(linear: Linear, noises: Noise, record: Record) -> np.ndarray:
    """Log-likelihood of the first column of a problem of one log under several noises, up to a constant.

    Parameters
    ----------
    linear : Linear
    noises : Noise
        Of (m, ...) arrays.
    record : Record

    Returns
    -------
    (m,) array
    """
    of_noise = _steady(noises, record.step), _process(noises, record.step), _uncertain(noises)
    # Logs last, contiguous in memory: the compiled filter works on all noises side by side.
    W, Q, P = (np.ascontiguousarray(np.moveaxis(values, 0, -1)) for values in of_noise)
    R = np.ascontiguousarray(noises.white.T) ** 2
    b, z = (np.ascontiguousarray(values[..., 0]) for values in (linear.driven, linear.seen))
    rows = np.asarray(record.usable), _lost(), record.is_last
    return kalman.log_likelihoods(
        linear.transition, W, b, linear.output, z, linear.whole, R, Q, P, *rows
    )


def _by_log(values: np.ndarray, lead: tuple[int, ...], tail: int) -> np.ndarray:
    """(n, ..., *tail) array, whose middle axes broadcast to those of the logs, as (n, m or 1, *tail) array."""
    # Logs that share values keep one copy; others are broadcast to all logs.
    shape = values.shape[values.ndim - tail :]
    middle = values.shape[1 : values.ndim - tail]
    if middle != lead and np.prod(middle) > 1:
        values = values.reshape(len(values), *(1,) * (len(lead) - len(middle)), *middle, *shape)
        values = np.broadcast_to(values, (len(values), *lead, *shape))
    logs = int(np.prod(values.shape[1 : values.ndim - tail]))
    return np.require(values, requirements=["C", "W"]).reshape(len(values), logs, *shape)


def _of_logs(values: np.ndarray, lead: tuple[int, ...]) -> np.ndarray:
    """(..., 18, 18) array that broadcasts to the logs, as (m, 18, 18) array."""
    values = np.broadcast_to(values, (*lead, STATES, STATES))
    return np.require(values, requirements=["C", "W"]).reshape(-1, STATES, STATES)


def oscillation(
    noise: Noise, h: float
) -> tuple[tuple[Any, Any, Any, Any], tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """First-order waves over a step.

    Returns
    -------
    tuple of four (..., 1) arrays, tuple of three (..., 3) arrays
        Transition from place and velocity to place, then to velocity; what a step adds to the variance of the place, to
        the covariance of both, to the variance of the velocity.
    """
    # Exact transition of a damped oscillator over the step.
    a, b, c, d = wave_transition(h, np.asarray(noise.wave_frequency)[..., None], WAVE_DAMPING)
    place, speed = _waves(noise)
    # The process is stationary: what a step adds is the stationary covariance less its part carried
    # over, Q = P - Φ P Φ'.
    added = (
        place - a * a * place - b * b * speed,
        -a * c * place - b * d * speed,
        speed - c * c * place - d * d * speed,
    )
    return (a, b, c, d), added


def _steady(noise: Noise, h: float) -> np.ndarray:
    """Part of a transition that is the same at all rows: slow errors fade, waves swing; (..., 18, 18)."""
    a, b, c, d = oscillation(noise, h)[0]
    # First-order Gauss-Markov processes for slow errors, exp(-h / T), and the oscillator of the
    # waves.
    W = np.zeros((*a.shape[:-1], STATES, STATES))
    W[..., _SLOW, _SLOW] = np.exp(-h / SLOW_TIME)
    W[..., _PLACE, _PLACE], W[..., _PLACE, _SPEED] = a, b
    W[..., _SPEED, _PLACE], W[..., _SPEED, _SPEED] = c, d
    return W


def _process(noise: Noise, h: float) -> np.ndarray:
    """Covariance of what happens over a step."""
    # White noise integrated over the step: variance grows with h.
    jolt = np.asarray(noise.jolt) ** 2 * h
    walk = np.asarray(noise.walk) ** 2 * h
    # Position integrates the velocity: h^3 / 3 of the acceleration's intensity, with a little to
    # keep the matrix regular.
    place = jolt * h * h / 3.0 + 1e-10
    # Stationary Gauss-Markov process: what a step adds keeps the variance at its stationary value.
    slow = np.broadcast_to(SLOW_STD**2 * (1.0 - np.exp(-2.0 * h / SLOW_TIME)), jolt.shape)
    still = np.zeros(jolt.shape)
    Q = np.concatenate([place, jolt, walk, slow, still, still], axis=-1)[..., None] * np.eye(STATES)
    _, (Q[..., _PLACE, _PLACE], both, Q[..., _SPEED, _SPEED]) = oscillation(noise, h)
    Q[..., _PLACE, _SPEED] = Q[..., _SPEED, _PLACE] = both
    # Correlation of position and velocity, h^2 / 2 of the intensity.
    Q[..., 2, 5] = Q[..., 5, 2] = (
        0.5 * h * jolt[..., 2]
    )  # along surge and sway it would turn with the ship
    return Q


def _waves(noise: Noise) -> tuple[np.ndarray, np.ndarray]:
    """Variance of the place and of the velocity of wave motion."""
    speed = np.asarray(noise.wave) ** 2
    return speed / np.asarray(noise.wave_frequency)[..., None] ** 2, speed


def _uncertain(noise: Noise) -> np.ndarray:
    """Covariance at the first row."""
    # The unexplained force starts as uncertain as its random walk becomes in 600 s.
    walk = np.asarray(noise.walk) ** 2 * 600.0
    white = np.broadcast_to(np.asarray(noise.white) ** 2, (*walk.shape[:-1], 6))
    waves = (np.broadcast_to(values, walk.shape) for values in _waves(noise))
    # The measurements fix the motion: it starts with 100 times their variance. Slow errors and
    # waves start from their stationary variance.
    first = np.concatenate(
        [100.0 * white, walk, np.broadcast_to(SLOW_STD**2, walk.shape), *waves], axis=-1
    )
    return first[..., None] * np.eye(STATES)


def _lost() -> np.ndarray:
    """Process noise that is added over steps with unknown inputs."""
    return np.diag([25.0, 25.0, 0.1, 0.25, 0.25, 1e-3, *[0.0] * 12])


@dataclass(frozen=True)
class Gram:
    """Inner products of the innovations' columns, the log's own first; of (..., p + 1, p + 1) arrays.

    Attributes
    ----------
    products : (..., 1 + p, 1 + p) array
    blocks : (b, ..., 1 + p, 1 + p) array
        The same by consecutive parts of the log.
    log_determinant : (...) array
    """

    products: np.ndarray
    blocks: np.ndarray
    log_determinant: np.ndarray

    @property
    def free(self) -> np.ndarray:
        """Log-likelihood of the log without any parameter, up to a constant."""
        return -0.5 * (self.products[..., 0, 0] + self.log_determinant)


def gram(stretches: Iterable[tuple[int, Innovations]], rows: int, parts: int = 8) -> Gram:
    """Inner products of innovations.

    Parameters
    ----------
    stretches : iterable of tuple of int and Innovations
        First row and innovations of consecutive stretches of a log.
    rows : int
        Of the log.
    parts : int
        Number of blocks.

    Returns
    -------
    Gram
    """
    # Blocks by equal shares of the rows, wherever the parts of the filter begin.
    edges = np.linspace(0, rows, parts + 1).astype(int)
    blocks = [np.zeros(())] * parts
    log_determinant = np.zeros(())
    for first, stretch in stretches:
        log_determinant = log_determinant + stretch.log_determinant.sum(0)
        # Rows of this part that fall into each block.
        places = np.clip(edges - first, 0, len(stretch.white))
        for i, (a, b) in enumerate(zip(places[:-1], places[1:], strict=True)):
            if b > a:
                # Sum of products over rows and channels: Y' Y of the whitened columns.
                white = np.moveaxis(stretch.white[a:b], 0, -3)
                flat = white.reshape(*white.shape[:-3], -1, white.shape[-1])
                blocks[i] = blocks[i] + np.swapaxes(flat, -1, -2) @ flat
    stacked = np.stack(np.broadcast_arrays(*blocks))
    return Gram(stacked.sum(0), stacked, log_determinant)
