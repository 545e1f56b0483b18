"""Observer of the low-frequency ship: Kalman filter with wave filter and bias force, gains constant and computed once.

The ship's position is followed in north-east-down, everything else in the body frame, so one set of gains fits every
heading.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.maths import cos, sin
from shipcosim.models.core.parameters import quantity

DEGREE = math.pi / 180.0


@dataclass(frozen=True)
class DpShip:
    """The ship as observer and control law know her."""

    mass_surge: float = quantity(557.55e3, "kg", "M11, mass with added mass", "m + A11, gunnerus-33m9", minimum=1.0)
    mass_sway: float = quantity(743.4e3, "kg", "M22, mass with added mass", "m + A22, gunnerus-33m9", minimum=1.0)
    mass_sway_yaw: float = quantity(-637.2e3, "kg.m", "M26 = M62, coupling of sway and yaw", "A26, gunnerus-33m9")
    mass_yaw: float = quantity(
        62.12e6, "kg.m2", "M66, inertia with added inertia", "Iz + A66, gunnerus-33m9", minimum=1.0
    )
    damping_surge: float = quantity(
        6e3, "N.s/m", "linear damping in surge", "side force of two azimuths at +-45 deg and 10 kN", minimum=0.0
    )
    damping_sway: float = quantity(6e3, "N.s/m", "linear damping in sway", "as damping_surge", minimum=0.0)
    damping_yaw: float = quantity(
        1.2e6, "N.m.s/rad", "linear damping in yaw", "as damping_surge, times 14 m squared", minimum=0.0
    )


@dataclass(frozen=True)
class ObserverParameters:
    """Noise, waves and disturbances as the observer assumes them."""

    sample_period: float = quantity(0.1, "s", "period of observer and control law", "the sensors' 10 Hz", minimum=1e-3)
    position_noise: float = quantity(
        0.2, "m", "white noise of measured positions", "Skulstad 2021, paper II, Table I", minimum=1e-6
    )
    heading_noise: float = quantity(
        0.1 * DEGREE, "rad", "white noise of measured heading", "Skulstad 2021, paper II, Table I", minimum=1e-9
    )
    velocity_noise: float = quantity(
        0.02, "m/s", "white noise of measured velocity", "TMR4240, parameter sheet 7", minimum=1e-6
    )
    rate_noise: float = quantity(
        0.05 * DEGREE, "rad/s", "white noise of measured yaw rate", "TMR4240, parameter sheet 7", minimum=1e-9
    )
    wave_frequency: float = quantity(
        1.1, "rad/s", "middle frequency of the motion in waves", "peak periods of 5 to 6 s", minimum=0.1
    )
    wave_damping: float = quantity(
        0.2, "1", "relative damping of the wave model: its bandwidth", "assumed", minimum=0.01
    )
    wave_motion: float = quantity(
        0.05, "m", "standard deviation of surge and sway in waves", "the model's motion at Hs 0.5 m", minimum=0.0
    )
    wave_yaw: float = quantity(
        0.3 * DEGREE, "rad", "standard deviation of yaw in waves", "the model's motion at Hs 0.5 m", minimum=0.0
    )
    velocity_disturbance: float = quantity(
        1e-6,
        "m2/s3",
        "intensity of the white disturbance of velocity",
        "thrust that is not delivered as allocated; tuned on 20 seeds of the four corners",
        minimum=1e-18,
    )
    rate_disturbance: float = quantity(
        1e-8,
        "rad2/s3",
        "intensity of the white disturbance of yaw rate",
        "tuned on 20 seeds of the four corners",
        minimum=1e-18,
    )
    bias_drift: float = quantity(
        2e-7,
        "m2/s5",
        "intensity of the random walk of the bias force over mass",
        "tuned on 20 seeds of the four corners",
        minimum=1e-18,
    )
    bias_drift_yaw: float = quantity(
        1e-8,
        "rad2/s5",
        "intensity of the random walk of the bias moment over inertia",
        "tuned on 20 seeds of the four corners",
        minimum=1e-18,
    )


class Estimate(NamedTuple):
    """Low-frequency ship, bias load (north, east, yaw), and wave motion in body axes with its rate."""

    x: float
    y: float
    psi: float
    u: float = 0.0
    v: float = 0.0
    r: float = 0.0
    bias_north: float = 0.0
    bias_east: float = 0.0
    bias_N: float = 0.0
    surge_wave: float = 0.0
    sway_wave: float = 0.0
    yaw_wave: float = 0.0
    u_wave: float = 0.0
    v_wave: float = 0.0
    r_wave: float = 0.0


class AxisGains(NamedTuple):
    """What one unit of innovation adds to the wave's motion and rate, position, velocity and bias acceleration.

    First the five for the innovation of position, then the five for that of velocity.
    """

    wave_position: float
    rate_position: float
    position_position: float
    velocity_position: float
    bias_position: float
    wave_velocity: float
    rate_velocity: float
    position_velocity: float
    velocity_velocity: float
    bias_velocity: float


class Design(NamedTuple):
    """What the observer computes once: gains, the wave model's transition over a sample, the inverse of the mass."""

    horizontal: AxisGains
    yaw: AxisGains
    wave: tuple
    inverse_mass: tuple


def design(ship, parameters):
    """Steady Kalman gains of the observer.

    Parameters
    ----------
    ship : DpShip
    parameters : ObserverParameters
        Fields may be arrays of one shape.

    Returns
    -------
    Design

    Notes
    -----
    Each axis is taken alone, with acceleration as input: a wave motion p'' + 2 ζ ω p' + ω² p = noise, and a ship
    x' = u, u' = b + noise, b' = noise; measured are x + p and u + p'. The gain solves the Riccati equation.
    """
    p = parameters
    dt = p.sample_period
    wave = wave_transition(dt, p.wave_frequency, p.wave_damping)
    horizontal = _axis_gains(
        dt,
        wave,
        p.wave_motion,
        p.wave_frequency,
        p.velocity_disturbance,
        p.bias_drift,
        p.position_noise,
        p.velocity_noise,
    )
    yaw = _axis_gains(
        dt, wave, p.wave_yaw, p.wave_frequency, p.rate_disturbance, p.bias_drift_yaw, p.heading_noise, p.rate_noise
    )
    determinant = ship.mass_sway * ship.mass_yaw - ship.mass_sway_yaw * ship.mass_sway_yaw
    inverse = (
        1.0 / ship.mass_surge,
        ship.mass_yaw / determinant,
        -ship.mass_sway_yaw / determinant,
        ship.mass_sway / determinant,
    )
    return Design(horizontal, yaw, wave, inverse)


def wave_transition(dt, frequency, damping):
    """Exact transition (a11, a12, a21, a22) of p'' + 2 ζ ω p' + ω² p = 0 over `dt`, for damping below 1."""
    decay = np.exp(-damping * frequency * dt)
    free = frequency * np.sqrt(1.0 - damping * damping)
    c, s = decay * np.cos(free * dt), decay * np.sin(free * dt) / free
    shift = damping * frequency * s
    return _floats(c + shift, s, -frequency * frequency * s, c - shift)


def kalman_gain(transition, noise, output, output_noise):
    """Steady gain of the measurement update of a Kalman filter.

    Parameters
    ----------
    transition : (..., n, n) array
        State over one sample.
    noise : (..., n, n) array
        Covariance that a sample adds.
    output : (m, n) array
        Measured combination of states.
    output_noise : (..., m, m) array
        Covariance of the measurements.

    Returns
    -------
    (..., n, m) array

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


def at_rest(measured):
    """Estimate at the start: the ship as measured, standing still, no bias, no waves."""
    zero = 0.0 * measured.x
    return Estimate(measured.x, measured.y, measured.psi, *(zero,) * 12)


def step(estimate, measured, load, *, ship, parameters, design):
    """Advance the estimate by one sample and correct it with what was measured at its end.

    Parameters
    ----------
    estimate : Estimate
        Estimate at the start.
    measured : Motion
        Measurement at the end.
    load : tuple of three
        Known load over the sample, thrusters and wind, body frame. [N, N, N.m]
    ship : DpShip
    parameters : ObserverParameters
    design : Design
        Made of the same ship and parameters by `design`.

    Returns
    -------
    Estimate

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 13.4.
    """
    predicted = _predict(estimate, load, dt=parameters.sample_period, ship=ship, design=design)
    return _correct(predicted, measured, ship=ship, design=design)


def _predict(e, load, *, dt, ship, design):
    """Estimate after a sample without measurement: the acceleration held, waves exactly."""
    c, s = cos(e.psi), sin(e.psi)
    X = load[0] - ship.damping_surge * e.u + c * e.bias_north + s * e.bias_east
    Y = load[1] - ship.damping_sway * e.v - s * e.bias_north + c * e.bias_east
    N = load[2] - ship.damping_yaw * e.r + e.bias_N
    i11, i22, i26, i66 = design.inverse_mass
    u_dot = i11 * X + e.r * e.v
    v_dot = i22 * Y + i26 * N - e.r * e.u
    r_dot = i26 * Y + i66 * N
    surge, sway = dt * (e.u + 0.5 * dt * u_dot), dt * (e.v + 0.5 * dt * v_dot)
    w11, w12, w21, w22 = design.wave
    return Estimate(
        e.x + c * surge - s * sway,
        e.y + s * surge + c * sway,
        e.psi + dt * (e.r + 0.5 * dt * r_dot),
        e.u + dt * u_dot,
        e.v + dt * v_dot,
        e.r + dt * r_dot,
        e.bias_north,
        e.bias_east,
        e.bias_N,
        w11 * e.surge_wave + w12 * e.u_wave,
        w11 * e.sway_wave + w12 * e.v_wave,
        w11 * e.yaw_wave + w12 * e.r_wave,
        w21 * e.surge_wave + w22 * e.u_wave,
        w21 * e.sway_wave + w22 * e.v_wave,
        w21 * e.yaw_wave + w22 * e.r_wave,
    )


def _correct(e, measured, *, ship, design):
    """Estimate corrected by the innovations, each in body axes; biases are accelerations times mass."""
    c, s = cos(e.psi), sin(e.psi)
    dx, dy = measured.x - e.x, measured.y - e.y
    surge, du = c * dx + s * dy - e.surge_wave, measured.u - e.u - e.u_wave
    sway, dv = c * dy - s * dx - e.sway_wave, measured.v - e.v - e.v_wave
    yaw, dr = wrap(measured.psi - e.psi - e.yaw_wave), measured.r - e.r - e.r_wave
    g, k = design.horizontal, design.yaw
    move_surge = g.position_position * surge + g.position_velocity * du
    move_sway = g.position_position * sway + g.position_velocity * dv
    bias_u = g.bias_position * surge + g.bias_velocity * du
    bias_v = g.bias_position * sway + g.bias_velocity * dv
    bias_r = k.bias_position * yaw + k.bias_velocity * dr
    X, Y = ship.mass_surge * bias_u, ship.mass_sway * bias_v + ship.mass_sway_yaw * bias_r
    return Estimate(
        e.x + c * move_surge - s * move_sway,
        e.y + s * move_surge + c * move_sway,
        e.psi + k.position_position * yaw + k.position_velocity * dr,
        e.u + g.velocity_position * surge + g.velocity_velocity * du,
        e.v + g.velocity_position * sway + g.velocity_velocity * dv,
        e.r + k.velocity_position * yaw + k.velocity_velocity * dr,
        e.bias_north + c * X - s * Y,
        e.bias_east + s * X + c * Y,
        e.bias_N + ship.mass_sway_yaw * bias_v + ship.mass_yaw * bias_r,
        e.surge_wave + g.wave_position * surge + g.wave_velocity * du,
        e.sway_wave + g.wave_position * sway + g.wave_velocity * dv,
        e.yaw_wave + k.wave_position * yaw + k.wave_velocity * dr,
        e.u_wave + g.rate_position * surge + g.rate_velocity * du,
        e.v_wave + g.rate_position * sway + g.rate_velocity * dv,
        e.r_wave + k.rate_position * yaw + k.rate_velocity * dr,
    )


def _axis_gains(dt, wave, wave_std, wave_frequency, disturbance, bias_drift, position_noise, velocity_noise):
    """Gains of one axis. The noise that drives the wave model is scaled so that its motion has `wave_std`."""
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
