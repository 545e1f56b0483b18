"""Control law of dynamic positioning: nonlinear PID with feedforward of reference and wind.

The integral action is the observer's bias load, fed forward with opposite sign. The observer knows what was allocated,
so a request that the thrusters could not meet winds nothing up.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control.observer import DpShip, StateEstimate
from shipcosim.models.control.reference import ReferenceState
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic, clip, exp, hypot, maximum
from shipcosim.models.core.motion import Load, Vector
from shipcosim.models.core.parameters import required


@dataclass(frozen=True, kw_only=True)
class ControlParameters:
    """Poles and limits of the control law; its gains follow from the mass of the ship."""

    surge_frequency: float = required(
        "rad/s", "natural frequency of the loop in surge", minimum=0.0
    )
    sway_frequency: float = required("rad/s", "natural frequency of the loop in sway", minimum=0.0)
    yaw_frequency: float = required("rad/s", "natural frequency of the loop in yaw", minimum=0.0)
    damping_ratio: float = required("1", "relative damping of the loops", minimum=0.0)
    position_error_max: float = required(
        "m", "position error beyond which the restoring force grows no more", minimum=1e-3
    )
    heading_error_max: float = required(
        "rad", "heading error beyond which the restoring moment grows no more", minimum=1e-3
    )
    wind_filter_time: float = required(
        "s", "time constant of the filter of the wind's load", minimum=1e-3
    )
    force_filter_time: float = required(
        "s", "time constant of the filter of the requested force", minimum=1e-3
    )
    moment_filter_time: float = required(
        "s", "time constant of the filter of the requested yaw moment", minimum=1e-3
    )
    wind_share: float = required("1", "share of the wind's load that is fed forward", minimum=0.0)


class Desired(NamedTuple):
    """Desired motion: position, heading, and their rates and accelerations in north-east, as in `ReferenceState`.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position north and east, heading. [m, m, rad]
    x_dot, y_dot, r : like x
        Rates of x, y, psi. [m/s, m/s, rad/s]
    x_ddot, y_ddot, r_dot : like x
        Second derivatives of x, y, psi. [m/s2, m/s2, rad/s2]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    x_dot: Arithmetic
    y_dot: Arithmetic
    r: Arithmetic
    x_ddot: Arithmetic
    y_ddot: Arithmetic
    r_dot: Arithmetic


class ControlState(NamedTuple):
    """State of the controller.

    Parameters
    ----------
    wind_X, wind_Y, wind_N : float or (...) array or tensor
        Filtered wind load, body frame. [N, N, N.m]
    tau_X, tau_Y, tau_N : like wind_X
        Load requested last, body frame. [N, N, N.m]
    """

    wind_X: Arithmetic
    wind_Y: Arithmetic
    wind_N: Arithmetic
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic


def at_rest(wind_load: Load) -> ControlState:
    """State at the start: nothing requested, the wind load as measured.

    Parameters
    ----------
    wind_load : tuple of three floats or (...) arrays or tensors
        Load of the measured wind, body frame. [N, N, N.m]

    Returns
    -------
    ControlState
        The state.

    References
    ----------
    Definition.
    """
    zero = 0.0 * wind_load[0]
    return ControlState(*wind_load, zero, zero, zero)


def known_load(state: ControlState, allocated: Load) -> Load:
    """Load known to the observer: allocated thrust and filtered wind load.

    Parameters
    ----------
    state : ControlState
        State of the controller.
    allocated : tuple of three
        Load that the thrusters were told to give, body frame. [N, N, N.m]

    Returns
    -------
    tuple of three, like allocated
        Load in the body frame. [N, N, N.m]

    References
    ----------
    Definition.
    """
    return allocated[0] + state.wind_X, allocated[1] + state.wind_Y, allocated[2] + state.wind_N


def step(
    state: ControlState,
    estimate: StateEstimate,
    desired: Desired | ReferenceState,
    wind_load: Load,
    h: float,
    *,
    ship: DpShip,
    parameters: ControlParameters,
) -> ControlState:
    """State of the controller one sample later, with its requested load.

    Parameters
    ----------
    state : ControlState
        State at the last sample.
    estimate : StateEstimate
        Low-frequency ship.
    desired : Desired or ReferenceState
        Desired motion.
    wind_load : tuple of three
        Load of the measured wind, body frame. [N, N, N.m]
    h : float
        Time since the last sample. [s]
    ship : DpShip
        The ship.
    parameters : ControlParameters
        Poles and limits.

    Returns
    -------
    ControlState
        Its `tau_X`, `tau_Y`, `tau_N` is the requested load.

    Notes
    -----
    With the limited error e = Rᵀ(η_d - η) in body axes and ν_d = Rᵀ η̇_d,

        τ = M (Rᵀ η̈_d + a) + D ν_d - Rᵀ b - τ_wind,  a = 2 ζ ω (ν_d - ν) + ω² e.

    ω is the axis' frequency times the pace of the estimate.

    b is the estimated bias load: it takes the place of an integral. A low-pass filter of first order behind all that
    keeps steps of the estimate out of the commands.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 15.3.
    """
    psi = estimate.psi
    # Everything in body axes: desired velocity, and the loop's frequencies slowed with the sea.
    nu_d = (*to_body(psi, desired.x_dot, desired.y_dot), desired.r)
    p = parameters
    pace = estimate.pace
    frequencies = (pace * p.surge_frequency, pace * p.sway_frequency, pace * p.yaw_frequency)
    # Feedback as an acceleration, independent of the ship's size.
    correction = _correction(estimate, desired, nu_d, frequencies, parameters=parameters)
    wind = _filtered(state, wind_load, h, parameters=parameters)
    u_dot, v_dot = to_body(psi, desired.x_ddot, desired.y_ddot)
    # Feedforward of the desired acceleration; together times the mass matrix.
    X, Y, N = _load(
        u_dot + correction[0], v_dot + correction[1], desired.r_dot + correction[2], ship=ship
    )
    # The estimated bias acts as integral action, and the measured wind is met before it moves the
    # ship.
    b_X, b_Y = to_body(psi, estimate.bias_north, estimate.bias_east)
    share = parameters.wind_share
    wanted = (
        X + ship.damping_surge * nu_d[0] - b_X - share * wind[0],
        Y + ship.damping_sway * nu_d[1] - b_Y - share * wind[1],
        N + ship.damping_yaw * nu_d[2] - estimate.bias_N - share * wind[2],
    )
    return ControlState(*wind, *_smoothed(state, wanted, h, parameters=parameters))


def errors(estimate: StateEstimate, desired: Desired | ReferenceState) -> Vector:
    """Distance from the desired to the estimated position, and estimated less desired heading.

    Parameters
    ----------
    estimate : StateEstimate
        Low-frequency ship.
    desired : Desired or ReferenceState
        Desired motion.

    Returns
    -------
    tuple of two, like the estimate
        Distance, and heading error in [-π, π). [m, rad]

    References
    ----------
    Definition.
    """
    return hypot(estimate.x - desired.x, estimate.y - desired.y), wrap(estimate.psi - desired.psi)


def _correction(estimate, desired, nu_d, frequencies, *, parameters):
    """Proportional and derivative action as an acceleration, with limited errors."""
    p = parameters
    damping = 2.0 * parameters.damping_ratio
    in_surge, in_sway, in_yaw = frequencies
    # Far from the setpoint the restoring force stays constant: it is limited in size, not in
    # direction.
    surge, sway = to_body(estimate.psi, desired.x - estimate.x, desired.y - estimate.y)
    scale = p.position_error_max / maximum(hypot(surge, sway), p.position_error_max)
    yaw = clip(wrap(desired.psi - estimate.psi), -p.heading_error_max, p.heading_error_max)
    # a = 2 ζ ω (ν_d - ν) + ω² e: a damped oscillator of frequency ω.
    return (
        in_surge * (damping * (nu_d[0] - estimate.u) + in_surge * scale * surge),
        in_sway * (damping * (nu_d[1] - estimate.v) + in_sway * scale * sway),
        in_yaw * (damping * (nu_d[2] - estimate.r) + in_yaw * yaw),
    )


def _filtered(state, wind_load, h, *, parameters):
    """Filtered wind load one sample later."""
    keep = exp(-h / parameters.wind_filter_time)
    X, Y, N = wind_load
    return (
        X + keep * (state.wind_X - X),
        Y + keep * (state.wind_Y - Y),
        N + keep * (state.wind_N - N),
    )


def _smoothed(state, wanted, h, *, parameters):
    """Requested load after its low-pass filter, one sample later."""
    force = exp(-h / parameters.force_filter_time)
    moment = exp(-h / parameters.moment_filter_time)
    X, Y, N = wanted
    return (
        X + force * (state.tau_X - X),
        Y + force * (state.tau_Y - Y),
        N + moment * (state.tau_N - N),
    )


def _load(u_dot, v_dot, r_dot, *, ship):
    """Load for an acceleration, M ν̇."""
    return (
        ship.mass_surge * u_dot,
        ship.mass_sway * v_dot + ship.mass_sway_yaw * r_dot,
        ship.mass_sway_yaw * v_dot + ship.mass_yaw * r_dot,
    )
