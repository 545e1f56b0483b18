"""Wave filter of the observer: a model of the wave motion of one axis, and the steady Kalman gains with it.

Each axis is taken alone, with acceleration as input: a wave motion p'' + 2 ζ ω p' + ω² p = noise, and a ship x' = u,
u' = b + noise, b' = noise; measured are x + p and u + p'.

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 13.4.
"""

from typing import NamedTuple

import numpy as np

from shipcosim.models.core.maths import Arithmetic


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
    decay = np.exp(-damping * frequency * dt)
    free = frequency * np.sqrt(1.0 - damping * damping)
    c, s = decay * np.cos(free * dt), decay * np.sin(free * dt) / free
    shift = damping * frequency * s
    first, second, third, fourth = _floats(c + shift, s, -frequency * frequency * s, c - shift)
    return first, second, third, fourth


def kalman_gain(transition: np.ndarray, noise: np.ndarray, output: np.ndarray, output_noise: np.ndarray) -> np.ndarray:
    """Steady gain of the measurement update of a Kalman filter.

    Parameters
    ----------
    transition : (..., n, n) array
        State over one sample. [units of the states over those of the states]
    noise : (..., n, n) array
        Covariance that a sample adds. [products of the units of the states]
    output : (m, n) array
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
    a, h = np.swapaxes(transition, -1, -2), noise
    g = output.T @ np.linalg.inv(output_noise) @ output
    eye = np.eye(output.shape[-1])
    for _ in range(20):
        inverse = np.linalg.inv(eye + g @ h)
        at = np.swapaxes(a, -1, -2)
        g, h, a = g + a @ inverse @ g @ at, h + at @ h @ inverse @ a, a @ inverse @ a
    return h @ output.T @ np.linalg.inv(output @ h @ output.T + output_noise)


def axis_gains(
    dt: Arithmetic,
    wave: tuple[Arithmetic, Arithmetic, Arithmetic, Arithmetic],
    wave_std: Arithmetic,
    wave_frequency: Arithmetic,
    disturbance: Arithmetic,
    bias_drift: Arithmetic,
    position_noise: Arithmetic,
    velocity_noise: Arithmetic,
) -> AxisGains:
    """Steady Kalman gains of one axis; the noise of the wave model is scaled so that its motion has a given deviation.

    Parameters
    ----------
    dt : float or (...) array
        Sample period. [s]
    wave : tuple of four, like dt
        Transition of the wave model over a sample, as `wave_transition`. [1, s, 1/s, 1]
    wave_std : like dt
        Standard deviation of the wave motion. [m or rad]
    wave_frequency : like dt
        Middle frequency of the wave motion. [rad/s]
    disturbance : like dt
        Intensity of the white disturbance of velocity. [m2/s3 or rad2/s3]
    bias_drift : like dt
        Intensity of the random walk of the bias acceleration. [m2/s5 or rad2/s5]
    position_noise, velocity_noise : like dt
        Standard deviations of the measurements. [m or rad, m/s or rad/s]

    Returns
    -------
    AxisGains
        The gains, Python floats where the arguments are scalars.
    """
    one, zero = dt / dt, 0.0 * dt
    w11, w12, w21, w22 = wave
    transition = _matrix(
        [
            [w11, w12, zero, zero, zero],
            [w21, w22, zero, zero, zero],
            [zero, zero, one, dt, 0.5 * dt * dt],
            [zero, zero, zero, one, dt],
            [zero, zero, zero, zero, one],
        ]
    )
    output = np.array([[1.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 1.0, 0.0]])
    stationary = _diagonal(wave_std**2, (wave_std * wave_frequency) ** 2, zero, zero, zero)
    noise = stationary - transition @ stationary @ np.swapaxes(transition, -1, -2)
    noise = noise + _diagonal(zero, zero, zero, disturbance * dt, bias_drift * dt)
    gain = kalman_gain(transition, noise, output, _diagonal(position_noise**2, velocity_noise**2))
    return AxisGains(*_floats(*(gain[..., state, measured] for measured in (0, 1) for state in range(5))))


def _matrix(rows):
    """(..., n, m) array of rows of scalars or arrays of one shape."""
    rows = [np.broadcast_arrays(*row) for row in rows]
    return np.stack(np.broadcast_arrays(*(np.stack(row, axis=-1) for row in rows)), axis=-2)


def _diagonal(*values):
    """(..., n, n) array with the values on its diagonal."""
    return np.stack(np.broadcast_arrays(*values), axis=-1)[..., None] * np.eye(len(values))


def _floats(*values):
    """Python floats where the values are scalars, so that an FMU stays with the arithmetic of floats."""
    return tuple(float(value) if np.ndim(value) == 0 else value for value in values)
