"""Control law of dynamic positioning: nonlinear PID with feedforward of reference and wind, and anti-windup."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import clip, exp, hypot, maximum, where
from shipcosim.models.core.parameters import quantity


@dataclass(frozen=True)
class ControlParameters:
    """Where the poles are and what is limited. Gains follow from the ship's mass."""

    surge_frequency: float = quantity(
        0.10, "rad/s", "natural frequency of the loop in surge", "tuned on 20 seeds of the four corners", minimum=0.0
    )
    sway_frequency: float = quantity(
        0.10, "rad/s", "natural frequency of the loop in sway", "tuned on 20 seeds of the four corners", minimum=0.0
    )
    yaw_frequency: float = quantity(
        0.16, "rad/s", "natural frequency of the loop in yaw", "tuned on 20 seeds of the four corners", minimum=0.0
    )
    damping_ratio: float = quantity(
        1.0, "1", "relative damping of the loops", "tuned on 20 seeds of the four corners", minimum=0.0
    )
    integral_ratio: float = quantity(
        0.4,
        "1",
        "rate of the integral action over the loop's natural frequency",
        "tuned on 20 seeds of the four corners",
        minimum=0.0,
    )
    position_error_max: float = quantity(
        2.5,
        "m",
        "position error beyond which the restoring force grows no more",
        "tuned: the force stays within reach of two units, which else lose her after the third has failed",
        minimum=1e-3,
    )
    heading_error_max: float = quantity(
        20.0 * math.pi / 180.0,
        "rad",
        "heading error beyond which the restoring moment grows no more",
        "assumed",
        minimum=1e-3,
    )
    missed_force_max: float = quantity(
        2e3,
        "N",
        "missing force beyond which the integral grows no further that way",
        "assumed: more than the limit of the thrusters' rate makes them miss in normal work",
        minimum=0.0,
    )
    missed_moment_max: float = quantity(
        30e3, "N.m", "the same for the yaw moment", "assumed: missed_force_max at the thrusters", minimum=0.0
    )
    wind_time: float = quantity(
        1.0,
        "s",
        "time constant of the filter of the wind's load",
        "tuned on 20 seeds of the four corners",
        minimum=1e-3,
    )
    wind_share: float = quantity(1.0, "1", "share of the wind's load that is fed forward", "choice", minimum=0.0)


class Desired(NamedTuple):
    """Desired motion: position and heading, rates and accelerations in north-east, as a `ReferenceState` holds them."""

    x: float
    y: float
    psi: float
    x_dot: float
    y_dot: float
    r: float
    x_ddot: float
    y_ddot: float
    r_dot: float


class ControlState(NamedTuple):
    """Integral load (north, east, yaw), filtered wind load (body) and the load last asked for (body). [N, N, N.m]"""

    integral_north: float
    integral_east: float
    integral_N: float
    wind_X: float
    wind_Y: float
    wind_N: float
    tau_X: float
    tau_Y: float
    tau_N: float


def at_rest(wind_load):
    """State at the start: nothing integrated or asked for yet, the wind's load as measured. [N, N, N.m]"""
    zero = 0.0 * wind_load[0]
    return ControlState(zero, zero, zero, *wind_load, zero, zero, zero)


def known_load(state, allocated):
    """Load that the observer may count on: allocated thrust and filtered wind, body frame. [N, N, N.m]"""
    return allocated[0] + state.wind_X, allocated[1] + state.wind_Y, allocated[2] + state.wind_N


def step(state, estimate, desired, allocated, wind_load, h, *, ship, parameters):
    """Load to ask for, one sample later.

    Parameters
    ----------
    state : ControlState
    estimate : observer.Estimate
        Low-frequency ship.
    desired : Desired or reference.ReferenceState
        Desired motion.
    allocated : tuple of three
        What the thrusters were told to give of the last request, body frame. [N, N, N.m]
    wind_load : tuple of three
        Load of the measured wind, body frame. [N, N, N.m]
    h : float
        Time since the last sample. [s]
    ship : observer.DpShip
    parameters : ControlParameters

    Returns
    -------
    ControlState
        Its `tau_X`, `tau_Y`, `tau_N` is the load to ask for.

    Notes
    -----
    With the limited error e = Rᵀ(η_d - η) in body axes and ν_d = Rᵀ η̇_d,

        τ = M (Rᵀ η̈_d + a) + D ν_d + Rᵀ i - τ_wind,  a = 2 ζ ω (ν_d - ν) + ω² e.

    The integral i grows with κ ω M a, not with e alone: on a long way home, where e is limited, a is zero at a steady
    speed. It grows no further in a direction in which the last request was not given (thrusters at their limits).

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 15.3.
    """
    psi = estimate.psi
    nu_d = (*to_body(psi, desired.x_dot, desired.y_dot), desired.r)
    correction = _correction(estimate, desired, nu_d, parameters=parameters)
    integral = _integral(state, psi, correction, allocated, h, ship=ship, parameters=parameters)
    wind = _filtered(state, wind_load, h, parameters=parameters)
    u_dot, v_dot = to_body(psi, desired.x_ddot, desired.y_ddot)
    X, Y, N = _load(u_dot + correction[0], v_dot + correction[1], desired.r_dot + correction[2], ship=ship)
    i_X, i_Y = to_body(psi, integral[0], integral[1])
    share = parameters.wind_share
    return ControlState(
        *integral,
        *wind,
        X + ship.damping_surge * nu_d[0] + i_X - share * wind[0],
        Y + ship.damping_sway * nu_d[1] + i_Y - share * wind[1],
        N + ship.damping_yaw * nu_d[2] + integral[2] - share * wind[2],
    )


def errors(estimate, desired):
    """Distance and turn from the desired to the estimated ship. [m, rad]"""
    return hypot(estimate.x - desired.x, estimate.y - desired.y), wrap(estimate.psi - desired.psi)


def _correction(estimate, desired, nu_d, *, parameters):
    """Acceleration that takes the ship to the desired motion, for errors of position and heading up to their limits."""
    p, damping = parameters, 2.0 * parameters.damping_ratio
    surge, sway = to_body(estimate.psi, desired.x - estimate.x, desired.y - estimate.y)
    scale = p.position_error_max / maximum(hypot(surge, sway), p.position_error_max)
    yaw = clip(wrap(desired.psi - estimate.psi), -p.heading_error_max, p.heading_error_max)
    return (
        p.surge_frequency * (damping * (nu_d[0] - estimate.u) + p.surge_frequency * scale * surge),
        p.sway_frequency * (damping * (nu_d[1] - estimate.v) + p.sway_frequency * scale * sway),
        p.yaw_frequency * (damping * (nu_d[2] - estimate.r) + p.yaw_frequency * yaw),
    )


def _integral(state, psi, correction, allocated, h, *, ship, parameters):
    """Integral load a sample later."""
    p, k = parameters, parameters.integral_ratio
    X, Y, N = _load(
        k * p.surge_frequency * correction[0],
        k * p.sway_frequency * correction[1],
        k * p.yaw_frequency * correction[2],
        ship=ship,
    )
    north, east = to_ned(
        psi,
        _unless_missed(X, state.tau_X - allocated[0], p.missed_force_max),
        _unless_missed(Y, state.tau_Y - allocated[1], p.missed_force_max),
    )
    moment = _unless_missed(N, state.tau_N - allocated[2], p.missed_moment_max)
    return state.integral_north + h * north, state.integral_east + h * east, state.integral_N + h * moment


def _unless_missed(rate, missed, most):
    """Rate of an integral; 0 where it would ask for more of what is already missed by more than `most`."""
    return where(rate * missed > most * abs(rate), 0.0, rate)


def _filtered(state, wind_load, h, *, parameters):
    """Wind load behind its low-pass filter a sample later."""
    keep = exp(-h / parameters.wind_time)
    X, Y, N = wind_load
    return X + keep * (state.wind_X - X), Y + keep * (state.wind_Y - Y), N + keep * (state.wind_N - N)


def _load(u_dot, v_dot, r_dot, *, ship):
    """Load that gives the ship an acceleration."""
    return (
        ship.mass_surge * u_dot,
        ship.mass_sway * v_dot + ship.mass_sway_yaw * r_dot,
        ship.mass_sway_yaw * v_dot + ship.mass_yaw * r_dot,
    )
