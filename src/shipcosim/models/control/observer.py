"""Observer of the low-frequency ship: Kalman filter with wave filter and bias force, with constant gains.

The position is estimated in north-east-down, everything else in the body frame, so that one set of gains fits every
heading.

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 13.4.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control.wave_filter import AxisGains, axis_gains, wave_transition
from shipcosim.models.core.maths import Arithmetic, cos, sin
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import required

DEGREE = math.pi / 180.0


@dataclass(frozen=True, kw_only=True)
class DpShip:
    """Model of the ship in observer and control law."""

    mass_surge: float = required("kg", "M11, mass with added mass", minimum=1.0)
    mass_sway: float = required("kg", "M22, mass with added mass", minimum=1.0)
    mass_sway_yaw: float = required("kg.m", "M26 = M62, coupling of sway and yaw")
    mass_yaw: float = required("kg.m2", "M66, inertia with added inertia", minimum=1.0)
    damping_surge: float = required("N.s/m", "linear damping in surge", minimum=0.0)
    damping_sway: float = required("N.s/m", "linear damping in sway", minimum=0.0)
    damping_yaw: float = required("N.m.s/rad", "linear damping in yaw", minimum=0.0)


@dataclass(frozen=True, kw_only=True)
class ObserverParameters:
    """Noise, waves and disturbances as the observer assumes them."""

    sample_period: float = required("s", "period of observer and control law", minimum=1e-3)
    position_noise: float = required("m", "white noise of measured positions", minimum=1e-6)
    heading_noise: float = required("rad", "white noise of measured heading", minimum=1e-9)
    velocity_noise: float = required("m/s", "white noise of measured velocity", minimum=1e-6)
    rate_noise: float = required("rad/s", "white noise of measured yaw rate", minimum=1e-9)
    wave_frequency: float = required("rad/s", "middle frequency of the motion in waves", minimum=0.1)
    wave_damping: float = required("1", "relative damping of the wave model: its bandwidth", minimum=0.01)
    wave_motion: float = required("m", "standard deviation of surge and sway in waves", minimum=0.0)
    wave_yaw: float = required("rad", "standard deviation of yaw in waves", minimum=0.0)
    velocity_disturbance: float = required("m2/s3", "intensity of the white disturbance of velocity", minimum=1e-18)
    rate_disturbance: float = required("rad2/s3", "intensity of the white disturbance of yaw rate", minimum=1e-18)
    bias_drift: float = required("m2/s5", "intensity of the random walk of the bias force over mass", minimum=1e-18)
    bias_drift_yaw: float = required(
        "rad2/s5", "intensity of the random walk of the bias moment over inertia", minimum=1e-18
    )


class Measurement(NamedTuple):
    """What the observer is given at a sample: the measured motion, and which parts of it are new and trusted.

    Parameters
    ----------
    motion : Motion
        Measured position, heading and velocity over ground; a part that is not new may hold any finite value.
    position_new, heading_new : float or (...) array or tensor
        1 where position and velocity, or heading and yaw rate, are a new sample that is trusted, 0 elsewhere: there the
        observer runs on its model. [1]
    """

    motion: Motion
    position_new: Arithmetic = 1.0
    heading_new: Arithmetic = 1.0


class Estimate(NamedTuple):
    """Estimated state: low-frequency ship, bias load, wave motion in body axes with its rate.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position and heading of the low-frequency ship. [m, m, rad]
    u, v, r : like x
        Velocity of the low-frequency ship in body axes. [m/s, m/s, rad/s]
    bias_north, bias_east, bias_N : like x
        Bias load. [N, N, N.m]
    surge_wave, sway_wave, yaw_wave : like x
        Wave motion in body axes. [m, m, rad]
    u_wave, v_wave, r_wave : like x
        Rates of the wave motion. [m/s, m/s, rad/s]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    u: Arithmetic = 0.0
    v: Arithmetic = 0.0
    r: Arithmetic = 0.0
    bias_north: Arithmetic = 0.0
    bias_east: Arithmetic = 0.0
    bias_N: Arithmetic = 0.0
    surge_wave: Arithmetic = 0.0
    sway_wave: Arithmetic = 0.0
    yaw_wave: Arithmetic = 0.0
    u_wave: Arithmetic = 0.0
    v_wave: Arithmetic = 0.0
    r_wave: Arithmetic = 0.0


class Design(NamedTuple):
    """What the observer computes once from its parameters.

    Parameters
    ----------
    horizontal, yaw : AxisGains
        Gains of surge and sway, gains of yaw.
    wave : tuple of four floats or (...) arrays
        Transition of the wave model over a sample, as `wave_filter.wave_transition`. [1, s, 1/s, 1]
    inverse_mass : tuple of four floats or (...) arrays
        Elements 11, 22, 26, 66 of the inverse of the mass matrix. [1/kg, 1/kg, 1/(kg.m), 1/(kg.m2)]
    """

    horizontal: AxisGains
    yaw: AxisGains
    wave: tuple
    inverse_mass: tuple


def design(ship: DpShip, parameters: ObserverParameters) -> Design:
    """Gains, wave model and inverse of the mass matrix for a ship.

    Parameters
    ----------
    ship : DpShip
        The ship; fields may be arrays of one shape.
    parameters : ObserverParameters
        Noise, waves and disturbances; fields may be arrays of one shape.

    Returns
    -------
    Design
        What `step` needs.
    """
    p = parameters
    dt = p.sample_period
    wave = wave_transition(dt, p.wave_frequency, p.wave_damping)
    horizontal = axis_gains(
        dt,
        wave,
        p.wave_motion,
        p.wave_frequency,
        p.velocity_disturbance,
        p.bias_drift,
        p.position_noise,
        p.velocity_noise,
    )
    yaw = axis_gains(
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


def at_rest(measured: Motion) -> Estimate:
    """Estimate at the start: the ship as measured, standing still, no bias, no waves.

    Parameters
    ----------
    measured : Motion
        First measurement.

    Returns
    -------
    Estimate
        The estimate.
    """
    zero = 0.0 * measured.x
    return Estimate(measured.x, measured.y, measured.psi, *(zero,) * 12)


def step(
    estimate: Estimate,
    measurement: Measurement,
    load: Load,
    *,
    ship: DpShip,
    parameters: ObserverParameters,
    design: Design,
) -> Estimate:
    """Estimate one sample later: predicted with the known load, corrected with the measurement at its end.

    Parameters
    ----------
    estimate : Estimate
        Estimate at the start.
    measurement : Measurement
        Measurement at the end.
    load : tuple of three
        Known load over the sample, thrusters and wind, body frame. [N, N, N.m]
    ship : DpShip
        The ship.
    parameters : ObserverParameters
        Of which the sample period is used here.
    design : Design
        Made of the same ship and parameters by `design`.

    Returns
    -------
    Estimate
        Estimate at the end.
    """
    predicted = _predict(estimate, load, dt=parameters.sample_period, ship=ship, design=design)
    return _correct(predicted, measurement, ship=ship, design=design)


def _predict(e, load, *, dt, ship, design):
    """Estimate after a sample without measurement: acceleration held, wave model integrated exactly."""
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


def _correct(e, measurement, *, ship, design):
    """Estimate corrected by the innovations, each in body axes; biases are accelerations times mass."""
    measured, position, heading = measurement
    c, s = cos(e.psi), sin(e.psi)
    dx, dy = measured.x - e.x, measured.y - e.y
    surge, du = c * dx + s * dy - e.surge_wave, measured.u - e.u - e.u_wave
    sway, dv = c * dy - s * dx - e.sway_wave, measured.v - e.v - e.v_wave
    surge, sway, du, dv = position * surge, position * sway, position * du, position * dv
    yaw, dr = heading * wrap(measured.psi - e.psi - e.yaw_wave), heading * (measured.r - e.r - e.r_wave)
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
