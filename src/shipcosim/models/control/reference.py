"""Reference model: from setpoints to desired position, velocity and acceleration that a ship can follow.

Each axis is a critically damped filter of third order, integrated exactly, behind a limit of the setpoint's speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, exp, hypot, maximum, minimum, where
from shipcosim.models.core.motion import Triple
from shipcosim.models.core.parameters import quantity, required


@dataclass(frozen=True, kw_only=True)
class ReferenceParameters:
    """Speed with which the reference follows its setpoint."""

    position_frequency: float = required(
        "rad/s", "natural frequency of the position reference", minimum=1e-4
    )
    heading_frequency: float = required(
        "rad/s", "natural frequency of the heading reference", minimum=1e-4
    )
    speed_max: float = quantity(
        0.0,
        "m/s",
        "largest speed of the reference over ground; 0: not limited",
        "choice",
        minimum=0.0,
    )
    yaw_rate_max: float = quantity(
        0.0, "rad/s", "largest yaw rate of the reference; 0: not limited", "choice", minimum=0.0
    )


class ReferenceState(NamedTuple):
    """State of the reference model: desired position and heading with rates, and the input of its filter.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Desired position north and east, heading (not wrapped). [m, m, rad]
    x_dot, y_dot, r : like x
        Rates of x, y, psi. [m/s, m/s, rad/s]
    x_ddot, y_ddot, r_dot : like x
        Second derivatives of x, y, psi. [m/s2, m/s2, rad/s2]
    x_in, y_in, psi_in : like x
        Setpoint behind its speed limit, the input of the filter. [m, m, rad]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    x_dot: Arithmetic = 0.0
    y_dot: Arithmetic = 0.0
    r: Arithmetic = 0.0
    x_ddot: Arithmetic = 0.0
    y_ddot: Arithmetic = 0.0
    r_dot: Arithmetic = 0.0
    x_in: Arithmetic = 0.0
    y_in: Arithmetic = 0.0
    psi_in: Arithmetic = 0.0


def at_rest(x: Arithmetic, y: Arithmetic, psi: Arithmetic) -> ReferenceState:
    """Reference at rest at a position and heading.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position north and east, heading. [m, m, rad]

    Returns
    -------
    ReferenceState
        The state.

    References
    ----------
    Definition.
    """
    zero = 0.0 * x
    return ReferenceState(x, y, psi, zero, zero, zero, zero, zero, zero, x, y, psi)


def resumed(motion: Sequence[Arithmetic], *, parameters: ReferenceParameters) -> ReferenceState:
    """State of a reference of which only the motion is known, as a controller passes it on.

    Parameters
    ----------
    motion : sequence of nine floats, (...) arrays or tensors
        The first nine fields of `ReferenceState`. [m, m, rad, m/s, m/s, rad/s, m/s2, m/s2, rad/s2]
    parameters : ReferenceParameters
        Natural frequencies.

    Returns
    -------
    ReferenceState
        The state.

    Notes
    -----
    The input of the filter is taken to move on evenly: it is ahead by 3/w of the rate and 3/w² of the second
    derivative. Only behind a limit of speed does it matter; without one the next step takes the setpoint.

    References
    ----------
    (d/dt + w)³ e = 0 without its third derivative.
    """
    of_position = parameters.position_frequency
    of_heading = parameters.heading_frequency
    axes = zip(
        motion[:3], motion[3:6], motion[6:], (of_position, of_position, of_heading), strict=True
    )
    return ReferenceState(
        *motion, *(x + 3.0 / w * (rate + second / w) for x, rate, second, w in axes)
    )


def step(
    state: ReferenceState,
    setpoint: Triple,
    h: float,
    *,
    parameters: ReferenceParameters,
) -> ReferenceState:
    """Reference one step later.

    Parameters
    ----------
    state : ReferenceState
        Reference at the start of the step.
    setpoint : tuple of three floats or (...) arrays or tensors
        Position and heading to go to, held over the step; headings go the shorter way. [m, m, rad]
    h : float
        Step. [s]
    parameters : ReferenceParameters
        Natural frequencies and speed limits.

    Returns
    -------
    ReferenceState
        Reference at the end of the step.

    Notes
    -----
    The limited setpoint moves at no more than `speed_max`. The filter's impulse response is positive with area one, so
    its output is no faster than its input and never overshoots.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, section 12.1.
    """
    # Move the setpoint at no more than the speed limit; headings go the shorter way.
    x_set, y_set, psi_set = setpoint
    dx = x_set - state.x_in
    dy = y_set - state.y_in
    dpsi = wrap(psi_set - state.psi_in)
    # North and east are limited together, so that the path to the setpoint is straight.
    part = _share(hypot(dx, dy), h * parameters.speed_max)
    x_in = state.x_in + part * dx
    y_in = state.y_in + part * dy
    psi_in = state.psi_in + _share(maximum(dpsi, -dpsi), h * parameters.yaw_rate_max) * dpsi
    # The filter works on the deviation from the limited setpoint, exactly over the step.
    w = parameters.position_frequency
    x, x_dot, x_ddot = critically_damped(h, state.x - x_in, state.x_dot, state.x_ddot, frequency=w)
    y, y_dot, y_ddot = critically_damped(h, state.y - y_in, state.y_dot, state.y_ddot, frequency=w)
    w = parameters.heading_frequency
    psi, r, r_dot = critically_damped(h, state.psi - psi_in, state.r, state.r_dot, frequency=w)
    return ReferenceState(
        x + x_in, y + y_in, psi + psi_in, x_dot, y_dot, r, x_ddot, y_ddot, r_dot, x_in, y_in, psi_in
    )


def critically_damped(
    h: float, e: Arithmetic, v: Arithmetic, a: Arithmetic, *, frequency: Arithmetic
) -> Triple:
    """Exact solution of (d/dt + w)³ e = 0 after time `h`.

    Parameters
    ----------
    h : float
        Time. [s]
    e, v, a : float or (...) array or tensor
        Deviation, its rate and its second derivative at the start. [any unit, that unit/s, that unit/s2]
    frequency : float or like e
        w, all three poles are at -w. [rad/s]

    Returns
    -------
    tuple of three, like e
        Deviation, rate and second derivative at the end. [as e, v, a]

    Notes
    -----
    With the system matrix A, N = A + w I is nilpotent, so exp(A h) = exp(-w h) (I + h N + h²/2 N²).

    References
    ----------
    Definition; solved in closed form here.
    """
    w = frequency
    # exp(A h) = exp(-w h) (I + h N + h² N² / 2), with N = A + w I: N³ = 0 for a triple pole.
    decay = exp(-w * h)
    q = 0.5 * h * h * (w * w * e + 2.0 * w * v + a)
    return (
        decay * (e + h * (w * e + v) + q),
        decay * (v + h * (w * v + a) - w * q),
        decay * (a - h * w * (w * w * e + 3.0 * w * v + 2.0 * a) + w * w * q),
    )


def _share(distance, reach):
    """Share of a distance covered if at most `reach` is; all of it if reach is 0 (no limit)."""
    return where(reach > 0.0, minimum(1.0, reach / maximum(distance, 1e-12)), 1.0)
