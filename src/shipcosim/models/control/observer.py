"""Observer of the low-frequency ship: Kalman filter with wave filter and bias force, with steady gains.

The position is estimated in north-east-down, everything else in the body frame, so that one set of gains fits every
heading. Measurements come at rates of their own and late: each is compared with the estimate of the time it is of,
which is the estimate now run backwards. The frequency of the wave filter follows the sea.

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 13.4.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.control.wave_filter import AxisNoise, filter_at, filter_table
from shipcosim.models.core.interpolation import EvenTable
from shipcosim.models.core.maths import Arithmetic, clip, cos, minimum, sin
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import required

DEGREE = math.pi / 180.0
FREQUENCIES = 129
"""Number of frequencies in the table of gains."""
CALM = 0.01
"""Wave power below which the frequency rather returns to its default than follows. [1/s2]"""
OUTLIER = 3.0
"""Motion over its mean square beyond which it is less and less taken for waves. [1]"""
FORGETTING = 0.4
"""Rate at which the swing forgets: below all waves, above slow errors of the estimated rates. [1/s]"""


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
    """Rates, ages and noise of the measurements, waves and disturbances as the observer assumes them."""

    sample_period: float = required("s", "period of observer and control law", minimum=1e-3)
    position_period: float = required(
        "s", "time from one new position and velocity to the next", minimum=1e-3
    )
    heading_period: float = required(
        "s", "time from one new heading and yaw rate to the next", minimum=1e-3
    )
    position_delay: float = required("s", "age of a new position and velocity", minimum=0.0)
    heading_delay: float = required("s", "age of a new heading and yaw rate", minimum=0.0)
    position_noise: float = required("m", "white noise of measured positions", minimum=1e-6)
    heading_noise: float = required("rad", "white noise of measured heading", minimum=1e-9)
    velocity_noise: float = required("m/s", "white noise of measured velocity", minimum=1e-6)
    rate_noise: float = required("rad/s", "white noise of measured yaw rate", minimum=1e-9)
    wave_frequency: float = required(
        "rad/s",
        "middle frequency of the motion in waves: at the start, and in calm water",
        minimum=0.1,
    )
    wave_frequency_min: float = required(
        "rad/s", "lowest frequency that the wave filter goes to", minimum=0.1
    )
    wave_frequency_max: float = required(
        "rad/s", "highest frequency that the wave filter goes to", minimum=0.1
    )
    full_frequency: float = required(
        "rad/s",
        "wave frequency below which observer and law slow down in proportion to it",
        minimum=0.1,
    )
    wave_time: float = required(
        "s", "time in which the wave filter's frequency follows the sea", minimum=1.0
    )
    wave_peak_ratio: float = required(
        "1", "peak frequency over that at which the motion in waves swings", minimum=0.5
    )
    wave_damping: float = required(
        "1", "relative damping of the wave model: its bandwidth", minimum=0.01
    )
    wave_motion: float = required(
        "m", "standard deviation of surge and sway in short waves", minimum=1e-6
    )
    wave_yaw: float = required("rad", "standard deviation of yaw in short waves", minimum=1e-9)
    velocity_disturbance: float = required(
        "m2/s3", "intensity of the white disturbance of velocity", minimum=1e-18
    )
    rate_disturbance: float = required(
        "rad2/s3", "intensity of the white disturbance of yaw rate", minimum=1e-18
    )
    bias_drift: float = required(
        "m2/s5", "intensity of the random walk of the bias force over mass", minimum=1e-18
    )
    bias_drift_yaw: float = required(
        "rad2/s5", "intensity of the random walk of the bias moment over inertia", minimum=1e-18
    )


class Measurement(NamedTuple):
    """Input of the observer at a sample: measured motion, and which parts are new and trusted.

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


class StateEstimate(NamedTuple):
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
    surge_swing, sway_swing, yaw_swing : like x
        Rates of the wave motion, integrated with forgetting: tells the frequency. [m, m, rad]
    wave_frequency : like x
        Middle frequency of the wave motion. [rad/s]
    wave_power : like x
        Mean square of the rates of the wave motion, each over the motion that the observer assumes. [1/s2]
    pace : like x
        How quick observer and law are, 1 in short waves: in long ones they slow down with the sea. [1]
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
    surge_swing: Arithmetic = 0.0
    sway_swing: Arithmetic = 0.0
    yaw_swing: Arithmetic = 0.0
    wave_frequency: Arithmetic = 1.0
    wave_power: Arithmetic = 0.0
    pace: Arithmetic = 1.0


class ObserverConstants(NamedTuple):
    """Constants that the observer computes once from its parameters.

    Parameters
    ----------
    filters : EvenTable
        Wave models and gains over the frequency of the waves. [as `wave_filter.WaveFilter` says]
    inverse_mass : tuple of four floats or (...) arrays
        Elements 11, 22, 26, 66 of the inverse of the mass matrix. [1/kg, 1/kg, 1/(kg.m), 1/(kg.m2)]
    """

    filters: EvenTable
    inverse_mass: tuple


@kept(8)
def design(ship: DpShip, parameters: ObserverParameters) -> ObserverConstants:
    """Gains, wave models and inverse mass matrix for a ship.

    Parameters
    ----------
    ship : DpShip
        The ship; fields may be arrays of one shape.
    parameters : ObserverParameters
        Measurements, waves and disturbances.

    Returns
    -------
    ObserverConstants
        What `step` needs.

    Notes
    -----
    In waves longer than `full_frequency` all frequencies of the filter shrink with that of the waves: the intensities
    of the disturbances go with its third and fifth power, as their units do. The expected motion in waves grows with
    the square of their period, as that of waves of one steepness.
    """
    # Tables over the wave frequency, because the filter follows the sea.
    p = parameters
    frequencies = np.linspace(p.wave_frequency_min, p.wave_frequency_max, FREQUENCIES)

    def noise_at(frequency):
        pace = minimum(1.0, frequency / p.full_frequency)
        # Scaling with the pace p: motion with p⁻², disturbance with p³, bias drift with p⁵, as
        # their units.
        horizontal = AxisNoise(
            p.position_period,
            p.position_delay,
            p.position_noise,
            p.velocity_noise,
            p.wave_motion / pace**2,
            p.velocity_disturbance * pace**3,
            p.bias_drift * pace**5,
        )
        yaw = AxisNoise(
            p.heading_period,
            p.heading_delay,
            p.heading_noise,
            p.rate_noise,
            p.wave_yaw / pace**2,
            p.rate_disturbance * pace**3,
            p.bias_drift_yaw * pace**5,
        )
        return horizontal, yaw

    # Inverse of the coupled sway-yaw block [M22 M26; M26 M66] in closed form.
    determinant = ship.mass_sway * ship.mass_yaw - ship.mass_sway_yaw * ship.mass_sway_yaw
    inverse = (
        1.0 / ship.mass_surge,
        ship.mass_yaw / determinant,
        -ship.mass_sway_yaw / determinant,
        ship.mass_sway / determinant,
    )
    return ObserverConstants(
        filter_table(frequencies, p.wave_damping, p.sample_period, noise_at), inverse
    )


def at_rest(measured: Motion, *, parameters: ObserverParameters) -> StateEstimate:
    """Estimate at the start: measured position, no velocity, no bias, no waves.

    Parameters
    ----------
    measured : Motion
        First measurement.
    parameters : ObserverParameters
        Of which the wave frequency is used here.

    Returns
    -------
    StateEstimate
        The estimate.
    """
    zero = 0.0 * measured.x
    still = StateEstimate(measured.x, measured.y, measured.psi, *(zero,) * 15)
    assumed = zero + parameters.wave_frequency
    frequency, power, pace = _paced(assumed, assumed * assumed, parameters)
    return still._replace(wave_frequency=frequency, wave_power=power, pace=pace)


def step(
    estimate: StateEstimate,
    measurement: Measurement,
    load: Load,
    *,
    ship: DpShip,
    parameters: ObserverParameters,
    design: ObserverConstants,
) -> StateEstimate:
    """Estimate one sample later: predicted with the known load, corrected with the measurement at its end.

    Parameters
    ----------
    estimate : StateEstimate
        Estimate at the start.
    measurement : Measurement
        Measurement at the end.
    load : tuple of three
        Known load over the sample, thrusters and wind, body frame. [N, N, N.m]
    ship : DpShip
        The ship.
    parameters : ObserverParameters
        Periods and ages of the measurements, and limits of the wave frequency.
    design : ObserverConstants
        Made of the same ship and parameters by `design`.

    Returns
    -------
    StateEstimate
        Estimate at the end.
    """
    # Kalman filter: gains at the present wave frequency, prediction over the sample, correction.
    filters = filter_at(estimate.wave_frequency, design.filters)
    acceleration = _acceleration(estimate, load, ship=ship, inverse_mass=design.inverse_mass)
    predicted = _predict(estimate, acceleration, dt=parameters.sample_period, wave=filters.wave)
    innovations = _innovations(predicted, acceleration, measurement, parameters, filters)
    corrected = _correct(predicted, innovations, ship=ship, filters=filters)
    # Wave motion in surge, sway and yaw a sample later, integrated from its rates with forgetting.
    keep = 1.0 - parameters.sample_period * FORGETTING
    swings = (
        keep * corrected.surge_swing + parameters.sample_period * corrected.u_wave,
        keep * corrected.sway_swing + parameters.sample_period * corrected.v_wave,
        keep * corrected.yaw_swing + parameters.sample_period * corrected.r_wave,
    )
    # The frequency follows the corrected wave motion; the pace of observer and law follows the
    # frequency.
    frequency, power, pace = _paced(*_wave_frequency(corrected, swings, parameters), parameters)
    surge, sway, yaw = swings
    return corrected._replace(
        surge_swing=surge,
        sway_swing=sway,
        yaw_swing=yaw,
        wave_frequency=frequency,
        wave_power=power,
        pace=pace,
    )


def pace(wave_frequency: Arithmetic, full_frequency: float) -> Arithmetic:
    """Pace of observer and law: below 1 in long waves, where they slow down with the sea.

    Parameters
    ----------
    wave_frequency : float or (...) array or tensor
        Middle frequency of the wave motion. [rad/s]
    full_frequency : float
        Wave frequency below which they slow down. [rad/s]

    Returns
    -------
    like wave_frequency
        1 in short waves. [1]

    References
    ----------
    Definition.
    """
    return minimum(1.0, wave_frequency / full_frequency)


def _acceleration(e, load, *, ship, inverse_mass):
    """Acceleration of the low-frequency ship in body axes."""
    c = cos(e.psi)
    s = sin(e.psi)
    # ν̇ = M⁻¹ (τ - D ν + Rᵀ b). The bias b is kept in north-east, since current and waves are.
    X = load[0] - ship.damping_surge * e.u + c * e.bias_north + s * e.bias_east
    Y = load[1] - ship.damping_sway * e.v - s * e.bias_north + c * e.bias_east
    N = load[2] - ship.damping_yaw * e.r + e.bias_N
    i11, i22, i26, i66 = inverse_mass
    # r × velocity: the body axes turn, while position and bias stay north-east.
    return i11 * X + e.r * e.v, i22 * Y + i26 * N - e.r * e.u, i26 * Y + i66 * N


def _predict(e, acceleration, *, dt, wave):
    """Estimate after a sample without measurement: acceleration held, exact wave model."""
    c = cos(e.psi)
    s = sin(e.psi)
    u_dot, v_dot, r_dot = acceleration
    # Displacement u t + a t² / 2 in body axes, turned into north-east.
    surge = dt * (e.u + 0.5 * dt * u_dot)
    sway = dt * (e.v + 0.5 * dt * v_dot)
    # Wave model p'' + 2 ζ ω p' + ω² p = 0, the same for each axis.
    w11, w12, w21, w22 = wave
    return e._replace(
        x=e.x + c * surge - s * sway,
        y=e.y + s * surge + c * sway,
        psi=e.psi + dt * (e.r + 0.5 * dt * r_dot),
        u=e.u + dt * u_dot,
        v=e.v + dt * v_dot,
        r=e.r + dt * r_dot,
        surge_wave=w11 * e.surge_wave + w12 * e.u_wave,
        sway_wave=w11 * e.sway_wave + w12 * e.v_wave,
        yaw_wave=w11 * e.yaw_wave + w12 * e.r_wave,
        u_wave=w21 * e.surge_wave + w22 * e.u_wave,
        v_wave=w21 * e.sway_wave + w22 * e.v_wave,
        r_wave=w21 * e.yaw_wave + w22 * e.r_wave,
    )


def _innovations(e, acceleration, measurement, parameters, filters):
    """Measurement minus the estimate at its time, run backwards; 0 where nothing is new."""
    measured, position, heading = measurement
    u_dot, v_dot, r_dot = acceleration
    c = cos(e.psi)
    s = sin(e.psi)
    # The measurement is old: run the estimate back by its age, s(t - d) = s - u d + a d² / 2.
    age = parameters.position_delay
    (b11, b12, b21, b22) = filters.horizontal_age
    dx = measured.x - e.x
    dy = measured.y - e.y
    # The wave motion goes back with its own model, by the transition over -d.
    surge_wave = b11 * e.surge_wave + b12 * e.u_wave
    u_wave = b21 * e.surge_wave + b22 * e.u_wave
    sway_wave = b11 * e.sway_wave + b12 * e.v_wave
    v_wave = b21 * e.sway_wave + b22 * e.v_wave
    # Innovations of position and velocity in body axes, where the gains apply at any heading.
    surge = c * dx + s * dy + age * (e.u - 0.5 * age * u_dot) - surge_wave
    sway = c * dy - s * dx + age * (e.v - 0.5 * age * v_dot) - sway_wave
    u = measured.u - e.u + age * u_dot - u_wave
    v = measured.v - e.v + age * v_dot - v_wave
    # Heading and yaw rate have their own age.
    age = parameters.heading_delay
    (b11, b12, b21, b22) = filters.yaw_age
    yaw_wave = b11 * e.yaw_wave + b12 * e.r_wave
    r_wave = b21 * e.yaw_wave + b22 * e.r_wave
    yaw = wrap(measured.psi - e.psi + age * (e.r - 0.5 * age * r_dot) - yaw_wave)
    r = measured.r - e.r + age * r_dot - r_wave
    return position * surge, position * sway, heading * yaw, position * u, position * v, heading * r


def _correct(e, innovations, *, ship, filters):
    """Estimate corrected by the innovations; biases are accelerations times mass."""
    surge, sway, yaw, du, dv, dr = innovations
    c = cos(e.psi)
    s = sin(e.psi)
    g = filters.horizontal
    k = filters.yaw
    # Each innovation corrects all five states of its axis: wave, wave rate, position, velocity,
    # bias.
    move_surge = g.position_position * surge + g.position_velocity * du
    move_sway = g.position_position * sway + g.position_velocity * dv
    bias_u = g.bias_position * surge + g.bias_velocity * du
    bias_v = g.bias_position * sway + g.bias_velocity * dv
    bias_r = k.bias_position * yaw + k.bias_velocity * dr
    # The gains give a bias acceleration; times the mass matrix it is a load, turned into
    # north-east.
    X = ship.mass_surge * bias_u
    Y = ship.mass_sway * bias_v + ship.mass_sway_yaw * bias_r
    return e._replace(
        x=e.x + c * move_surge - s * move_sway,
        y=e.y + s * move_surge + c * move_sway,
        psi=e.psi + k.position_position * yaw + k.position_velocity * dr,
        u=e.u + g.velocity_position * surge + g.velocity_velocity * du,
        v=e.v + g.velocity_position * sway + g.velocity_velocity * dv,
        r=e.r + k.velocity_position * yaw + k.velocity_velocity * dr,
        bias_north=e.bias_north + c * X - s * Y,
        bias_east=e.bias_east + s * X + c * Y,
        bias_N=e.bias_N + ship.mass_sway_yaw * bias_v + ship.mass_yaw * bias_r,
        surge_wave=e.surge_wave + g.wave_position * surge + g.wave_velocity * du,
        sway_wave=e.sway_wave + g.wave_position * sway + g.wave_velocity * dv,
        yaw_wave=e.yaw_wave + k.wave_position * yaw + k.wave_velocity * dr,
        u_wave=e.u_wave + g.rate_position * surge + g.rate_velocity * du,
        v_wave=e.v_wave + g.rate_position * sway + g.rate_velocity * dv,
        r_wave=e.r_wave + k.rate_position * yaw + k.rate_velocity * dr,
    )


def _wave_frequency(e, swings, parameters):
    """Wave frequency and power one sample later: towards the peak of the estimated wave spectrum.

    The frequency is the root of the mean square of the swings' rates over that of the swings, somewhat above the peak.
    In calm water it returns to its default. Each axis counts by its motion over the assumed one; what is far above the
    mean of the last minutes, as the motion after a failure is, hardly counts.
    """
    p = parameters
    w = e.wave_frequency
    surge, sway, turn = swings
    # Rate of the swing: its integrator forgets, so d(swing)/dt = wave rate - forgetting × swing.
    du = e.u_wave - FORGETTING * surge
    dv = e.v_wave - FORGETTING * sway
    dr = e.r_wave - FORGETTING * turn
    # Weight each axis by its assumed motion, so that metres and radians can be added.
    horizontal = 1.0 / p.wave_motion**2
    yaw = 1.0 / p.wave_yaw**2
    rate = horizontal * (du * du + dv * dv) + yaw * dr * dr
    # For a sinusoid rate² = ω² motion². The difference of both drives ω up or down.
    expected = (w / p.wave_peak_ratio) ** 2 * (
        horizontal * (surge * surge + sway * sway) + yaw * turn * turn
    )
    share = p.sample_period / p.wave_time
    size = 0.5 * (rate + expected)
    # Weight of an outlier: motion far above the mean of the last minutes hardly counts.
    level = e.wave_power + CALM
    excess = size / (OUTLIER * level)
    rise = 0.5 * w * (rate - expected) / (1.0 + excess**4) + (p.wave_frequency - w) * CALM
    # In calm water the second term of `rise` dominates and returns ω to its default.
    frequency = clip(w + share * rise / level, p.wave_frequency_min, p.wave_frequency_max)
    return frequency, e.wave_power + share * (minimum(size, OUTLIER * level) - e.wave_power)


def _paced(frequency, power, parameters):
    """Wave frequency and power, with the pace of observer and law."""
    return frequency, power, pace(frequency, parameters.full_frequency)
