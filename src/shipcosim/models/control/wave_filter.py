"""Wave filter of the observer: a model of the wave motion of one axis, and the steady Kalman gains with it.

Each axis is taken alone, with acceleration as input: a wave motion p'' + 2 ζ ω p' + ω² p = noise, and a ship x' = u,
u' = b + noise, b' = noise; measured are x + p and u + p' as they were when the sample was taken. The gains are computed
once over a range of ω and read from a table, so that the filter can follow the sea.

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 13.4.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.interpolation import EvenTable, even_table, interp_even
from shipcosim.models.core.maths import Arithmetic, library_of, mapped, times


class AxisGains(NamedTuple):
    """Kalman gains of one axis: change of each state per unit of innovation.

    First the five states for the innovation of position, then the five for that of velocity. For yaw, m is rad.

    Parameters
    ----------
    wave_position, rate_position : float or (...) array
        Wave motion and its rate, per innovation of position. [1, 1/s]
    position_position, velocity_position, bias_position : float or (...) array
        Position, velocity and bias acceleration, per innovation of position. [1, 1/s, 1/s2]
    wave_velocity, rate_velocity : float or (...) array
        Wave motion and its rate, per innovation of velocity. [s, 1]
    position_velocity, velocity_velocity, bias_velocity : float or (...) array
        Position, velocity and bias acceleration, per innovation of velocity. [s, 1, 1/s]
    """

    wave_position: Arithmetic
    rate_position: Arithmetic
    position_position: Arithmetic
    velocity_position: Arithmetic
    bias_position: Arithmetic
    wave_velocity: Arithmetic
    rate_velocity: Arithmetic
    position_velocity: Arithmetic
    velocity_velocity: Arithmetic
    bias_velocity: Arithmetic


def wave_transition(
    dt: Arithmetic, frequency: Arithmetic, damping: Arithmetic
) -> tuple[Arithmetic, Arithmetic, Arithmetic, Arithmetic]:
    """Exact transition of the wave model p'' + 2 ζ ω p' + ω² p = 0 over a sample.

    Parameters
    ----------
    dt : float or (...) array
        Sample period. [s]
    frequency : like dt
        ω. [rad/s]
    damping : like dt
        ζ, below 1. [1]

    Returns
    -------
    tuple of four, like dt
        Elements 11, 12, 21, 22 of the transition of (p, p'). [1, s, 1/s, 1]
    """
    # Damped oscillator: free frequency ω √(1 - ζ²), decay exp(-ζ ω t).
    decay = np.exp(-damping * frequency * dt)
    free = frequency * np.sqrt(1.0 - damping * damping)
    c = decay * np.cos(free * dt)
    s = decay * np.sin(free * dt) / free
    shift = damping * frequency * s
    first, second, third, fourth = _floats(c + shift, s, -frequency * frequency * s, c - shift)
    return first, second, third, fourth


def kalman_gain(
    transition: np.ndarray, noise: np.ndarray, output: np.ndarray, output_noise: np.ndarray
) -> np.ndarray:
    """Steady gain of the measurement update of a Kalman filter.

    Parameters
    ----------
    transition : (..., n, n) array
        State over one sample. [units of the states over those of the states]
    noise : (..., n, n) array
        Covariance that a sample adds. [products of the units of the states]
    output : (..., m, n) array
        Measured combination of states. [units of the measurements over those of the states]
    output_noise : (..., m, m) array
        Covariance of the measurements. [products of the units of the measurements]

    Returns
    -------
    (..., n, m) array
        The gain. [units of the states over those of the measurements]

    Notes
    -----
    The Riccati equation is solved by doubling: each round covers twice as many samples as the last.

    References
    ----------
    Anderson and Moore, Optimal Filtering, Prentice-Hall, 1979, section 6.7.
    """
    # Doubling algorithm for the discrete Riccati equation: after k rounds it covers 2ᵏ samples. 20
    # rounds are a million samples, so the covariance is steady.
    a = np.swapaxes(transition, -1, -2)
    h = noise
    transposed = np.swapaxes(output, -1, -2)
    g = transposed @ np.linalg.inv(output_noise) @ output
    eye = np.eye(output.shape[-1])

    def doubled(state):
        g, h, a = state
        # (I + G H)⁻¹ is common to all three updates.
        inverse = np.linalg.inv(eye + g @ h)
        at = np.swapaxes(a, -1, -2)
        return g + a @ inverse @ g @ at, h + at @ h @ inverse @ a, a @ inverse @ a

    g, h, a = times(20, doubled, (g, h, a))
    # Kalman gain K = P Cᵀ (C P Cᵀ + R)⁻¹, with the predicted covariance P.
    return h @ transposed @ np.linalg.inv(output @ h @ transposed + output_noise)


class AxisNoise(NamedTuple):
    """Assumptions of the filter of one axis. For yaw, m is rad.

    Parameters
    ----------
    period, delay : float
        Time from one measurement to the next, and age of a new one. [s, s]
    position, velocity : float
        Standard deviations of the measurements. [m, m/s]
    wave : float or (n,) array
        Standard deviation of the wave motion. [m]
    disturbance : float or (n,) array
        Intensity of the white disturbance of velocity. [m2/s3]
    bias_drift : float or (n,) array
        Intensity of the random walk of the bias acceleration. [m2/s5]
    """

    period: float
    delay: float
    position: float
    velocity: float
    wave: Arithmetic
    disturbance: Arithmetic
    bias_drift: Arithmetic


def axis_gains(frequency: Arithmetic, damping: float, noise: AxisNoise) -> AxisGains:
    """Steady Kalman gains of one axis; the wave model's noise gives its motion a set deviation.

    Parameters
    ----------
    frequency : float or (...) array
        Middle frequency of the wave motion. [rad/s]
    damping : float
        Relative damping of the wave model. [1]
    noise : AxisNoise
        Measurements, waves and disturbances.

    Returns
    -------
    AxisGains
        The gains, Python floats where the frequency is one.

    Notes
    -----
    A measurement of age d corrects the estimate of its time; the correction now is that one, moved on over d by the
    model: the transition over d times the usual gain.
    """
    transition = _transition(noise.period, frequency, damping)
    # Measured: position = ship + wave motion, velocity = ship + wave rate.
    output = np.array([[1.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 1.0, 0.0]])
    one = frequency / frequency
    size = noise.wave * noise.wave * one
    # Stationary covariance S of the wave model: variance σ² of the motion, σ² ω² of its rate. The
    # noise that keeps it is S - Φ S Φᵀ.
    stationary = _diagonal(size, size * frequency * frequency, 0.0, 0.0, 0.0)
    added = stationary - transition @ stationary @ np.swapaxes(transition, -1, -2)
    # White disturbances of velocity and bias add their intensity times the period.
    added = added + _diagonal(
        0.0, 0.0, 0.0, noise.disturbance * noise.period, noise.bias_drift * noise.period
    )
    then = kalman_gain(transition, added, output, np.diag([noise.position**2, noise.velocity**2]))
    # An old measurement corrects the old state; the model carries the correction to now.
    gain = _transition(noise.delay, frequency, damping) @ then
    return AxisGains(
        *_floats(*(gain[..., state, measured] for measured in (0, 1) for state in range(5)))
    )


class WaveFilter(NamedTuple):
    """The observer's wave model and gains at one frequency.

    Parameters
    ----------
    wave : tuple of four floats or (...) arrays or tensors
        Transition of the wave model over a sample of the observer, as `wave_transition`. [1, s, 1/s, 1]
    horizontal_age, yaw_age : like wave
        The same backwards, over the age of a measurement of surge and sway, and of yaw. [1, s, 1/s, 1]
    horizontal, yaw : AxisGains
        Gains of surge and sway, gains of yaw.
    """

    wave: tuple
    horizontal_age: tuple
    yaw_age: tuple
    horizontal: AxisGains
    yaw: AxisGains


def filter_table(
    frequencies: np.ndarray,
    damping: float,
    sample_period: float,
    noise_at: Callable[[Arithmetic], tuple[AxisNoise, AxisNoise]],
) -> EvenTable:
    """Wave models and gains over a range of frequencies, for `filter_at`.

    Parameters
    ----------
    frequencies : (n,) array, evenly spaced
        Middle frequencies of the wave motion. [rad/s]
    damping : float
        Relative damping of the wave model. [1]
    sample_period : float
        Period of the observer. [s]
    noise_at : callable
        From a frequency to the assumptions of the filters of surge and sway, and of yaw.

    Returns
    -------
    EvenTable
        The table.
    """

    def columns(frequency):
        horizontal, yaw = noise_at(frequency)
        # The model over one sample, and backwards over the ages of the measurements.
        spans = sample_period, -horizontal.delay, -yaw.delay
        models = [part for span in spans for part in wave_transition(span, frequency, damping)]
        gains = [axis_gains(frequency, damping, noise) for noise in (horizontal, yaw)]
        return [*models, *gains[0], *gains[1]]

    # All frequencies at once, but one by one while the computation is recorded.
    if hasattr(library_of(frequencies), "mapped"):
        rows = mapped(columns, frequencies)
        return even_table(frequencies, *map(np.array, zip(*rows, strict=True)))
    return even_table(frequencies, *columns(frequencies))


def filter_at(frequency: Arithmetic, table: EvenTable) -> WaveFilter:
    """Wave model and gains at a frequency, by interpolation.

    Parameters
    ----------
    frequency : float or (...) array or tensor
        Middle frequency of the wave motion, within the table. [rad/s]
    table : EvenTable
        Made by `filter_table`.

    Returns
    -------
    WaveFilter
        Its values like the frequency.
    """
    row = tuple(interp_even(frequency, table))
    return WaveFilter(row[:4], row[4:8], row[8:12], AxisGains(*row[12:22]), AxisGains(*row[22:]))


def _transition(dt, frequency, damping):
    """(..., 5, 5) transition of wave motion, its rate, position, velocity and bias acceleration."""
    # Wave model and ship are decoupled; the ship is a triple integrator of the bias.
    w11, w12, w21, w22 = wave_transition(dt, frequency, damping)
    return _matrix(
        [
            [w11, w12, 0.0, 0.0, 0.0],
            [w21, w22, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, dt, 0.5 * dt * dt],
            [0.0, 0.0, 0.0, 1.0, dt],
            [0.0, 0.0, 0.0, 0.0, 1.0],
        ]
    )


def _matrix(rows):
    """(..., n, m) array of rows of scalars or arrays of one shape."""
    rows = [np.broadcast_arrays(*row) for row in rows]
    return np.stack(np.broadcast_arrays(*(np.stack(row, axis=-1) for row in rows)), axis=-2)


def _diagonal(*values):
    """(..., n, n) array with the values on its diagonal."""
    return np.stack(np.broadcast_arrays(*values), axis=-1)[..., None] * np.eye(len(values))


def _floats(*values):
    """Python floats for scalars, so that an FMU computes with floats."""
    return tuple(float(value) if np.ndim(value) == 0 else value for value in values)
