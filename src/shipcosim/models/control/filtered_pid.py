"""PID of dynamic positioning behind a low-pass filter, one for each degree of freedom, without a model of the ship.

The wave filter needs to know neither ship nor sea, and pays with phase lag; the integral holds mean loads. Nothing
tells the integral that thrusters are at their limits.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control.pid import Desired
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic, exp
from shipcosim.models.core.motion import Triple
from shipcosim.models.core.parameters import required


@dataclass(frozen=True, kw_only=True)
class FilteredPidParameters:
    """Gains of the PID in surge, sway and yaw, and the low-pass filter before it."""

    surge_gain: float = required("N/m", "K_p in surge", share=0.05, minimum=0.0)
    sway_gain: float = required("N/m", "K_p in sway", share=0.05, minimum=0.0)
    yaw_gain: float = required("N.m/rad", "K_p in yaw", share=0.05, minimum=0.0)
    surge_integral_time: float = required("s", "T_i in surge", share=0.05, minimum=1e-3)
    sway_integral_time: float = required("s", "T_i in sway", share=0.05, minimum=1e-3)
    yaw_integral_time: float = required("s", "T_i in yaw", share=0.05, minimum=1e-3)
    surge_derivative_time: float = required("s", "T_d in surge", share=0.05, minimum=0.0)
    sway_derivative_time: float = required("s", "T_d in sway", share=0.05, minimum=0.0)
    yaw_derivative_time: float = required("s", "T_d in yaw", share=0.05, minimum=0.0)
    filter_frequency: float = required(
        "rad/s", "frequency of both poles of the low-pass filter", share=0.05, minimum=1e-3
    )


class FilteredPidState(NamedTuple):
    """State of the controller.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Filtered position north and east and heading (not wrapped). [m, m, rad]
    x_dot, y_dot, psi_dot : like x
        Their rates. [m/s, m/s, rad/s]
    surge, sway, yaw : like x
        Integrals of the errors in body axes. [m.s, m.s, rad.s]
    tau_X, tau_Y, tau_N : like x
        Requested load, body frame. [N, N, N.m]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    x_dot: Arithmetic
    y_dot: Arithmetic
    psi_dot: Arithmetic
    surge: Arithmetic
    sway: Arithmetic
    yaw: Arithmetic
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic


def at_rest(x: Arithmetic, y: Arithmetic, psi: Arithmetic) -> FilteredPidState:
    """State at the start: the filter at the measured position, nothing requested.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Measured position north and east, heading. [m, m, rad]

    Returns
    -------
    FilteredPidState
        The state.

    References
    ----------
    Definition.
    """
    zero = 0.0 * x
    return FilteredPidState(x, y, psi, *(zero,) * 9)


def errors(state: FilteredPidState, desired: Desired) -> Triple:
    """Desired minus filtered position and heading, in body axes.

    Parameters
    ----------
    state : FilteredPidState
        State of the controller.
    desired : Desired
        Desired motion.

    Returns
    -------
    tuple of three, like the state
        Errors in surge, sway, yaw; the last in [-π, π). [m, m, rad]

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper I, eq. (1).
    """
    surge, sway = to_body(state.psi, desired.x - state.x, desired.y - state.y)
    return surge, sway, wrap(desired.psi - state.psi)


def step(
    state: FilteredPidState,
    measured: Triple,
    desired: Desired,
    h: float,
    *,
    parameters: FilteredPidParameters,
) -> FilteredPidState:
    """State of the controller `h` later, with the load that it requests.

    Parameters
    ----------
    state : FilteredPidState
        State of the controller.
    measured : tuple of three floats or (...) arrays or tensors
        Position north and east, heading, waves included. [m, m, rad]
    desired : Desired
        Desired motion; accelerations are not used.
    h : float
        Step. [s]
    parameters : FilteredPidParameters
        Gains and filter.

    Returns
    -------
    FilteredPidState
        Its `tau_X`, `tau_Y`, `tau_N` is the requested load.

    Notes
    -----
    Of each axis, with the error e in body axes,

        τ = K_p (e + 1/T_i ∫e dt + T_d ė).

    Position and heading come from a low-pass filter of two equal poles ω²/(s + ω)², integrated exactly, whose state is
    the rate as well; ė is taken of the error with the ship's axes held.

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper I, eq. (1),
    (2). Order and frequency of the filter and the gains are not printed.
    """
    p = parameters
    frequency = parameters.filter_frequency
    # Filter the deviation from the new measurement, which is constant over the step: the solution
    # is exact.
    x, x_dot = _filtered(state.x - measured[0], state.x_dot, frequency, h)
    y, y_dot = _filtered(state.y - measured[1], state.y_dot, frequency, h)
    psi, psi_dot = _filtered(wrap(state.psi - measured[2]), state.psi_dot, frequency, h)
    # The heading is not wrapped: add the turn along the shorter arc.
    heading = state.psi - wrap(state.psi - measured[2]) + psi
    held = state._replace(
        x=measured[0] + x, y=measured[1] + y, psi=heading, x_dot=x_dot, y_dot=y_dot, psi_dot=psi_dot
    )
    surge, sway, yaw = errors(held, desired)
    # Rate of the error, desired minus filtered, with the ship's axes held.
    u, v = to_body(heading, desired.x_dot - x_dot, desired.y_dot - y_dot)
    r = desired.r - psi_dot
    # Rectangular rule; the step is short against the integral times.
    sums = state.surge + h * surge, state.sway + h * sway, state.yaw + h * yaw
    return held._replace(
        surge=sums[0],
        sway=sums[1],
        yaw=sums[2],
        tau_X=p.surge_gain
        * (surge + sums[0] / p.surge_integral_time + p.surge_derivative_time * u),
        tau_Y=p.sway_gain * (sway + sums[1] / p.sway_integral_time + p.sway_derivative_time * v),
        tau_N=p.yaw_gain * (yaw + sums[2] / p.yaw_integral_time + p.yaw_derivative_time * r),
    )


def _filtered(ahead, rate, frequency, h):
    """Deviation of the filter from its constant input, and its rate, one step later."""
    # Two equal poles: e(t) = (e0 + (e0' + ω e0) t) exp(-ω t).
    slope = rate + frequency * ahead
    left = exp(0.0 * ahead - frequency * h)
    return (ahead + slope * h) * left, (rate - frequency * slope * h) * left
