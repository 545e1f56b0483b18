"""Monitoring of thrusters and position: command against feedback, estimate against reference.

A unit whose feedback stays beyond a tolerance of its command is faulty, and is stopped: the fault
is latched. Wrong feedback, or thrust lost behind the shaft, shows in the ship's motion: she leaves
her position, or the observer estimates an unknown force that is too large for the weather.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, hypot, maximum, pi, where
from shipcosim.models.core.motion import Triple, Vector
from shipcosim.models.core.parameters import quantity

_DEG = pi / 180.0


@dataclass(frozen=True, kw_only=True)
class MonitorParameters:
    """Tolerances and times of the alarms, for a ship with two azimuth thrusters and a tunnel thruster."""

    azimuth_thrust_tolerance: float = quantity(
        3e3,
        "N",
        "difference of commanded and reported thrust of an azimuth that is no fault",
        "assumed: 5 % of 60 kN",
    )
    tunnel_thrust_tolerance: float = quantity(
        1.5e3,
        "N",
        "difference of commanded and reported thrust of the tunnel that is no fault",
        "assumed: 7 % of 21.6 kN",
    )
    azimuth_tolerance: float = quantity(
        10.0 * _DEG,
        "rad",
        "difference of commanded and reported direction that is no fault",
        "assumed",
    )
    fault_delay: float = quantity(
        6.0,
        "s",
        "time beyond a tolerance after which the unit is faulty",
        "assumed; turning by 45 deg takes 4.5 s",
    )
    position_limit: float = quantity(
        5.0, "m", "distance from the reference that is no alarm", "assumed, usual"
    )
    heading_limit: float = quantity(
        10.0 * _DEG, "rad", "heading off the reference that is no alarm", "assumed"
    )
    force_limit: float = quantity(
        40e3,
        "N",
        "unexplained force that is no alarm",
        "assumed: above 25 kN, the most in the scenarios' weather",
    )
    alarm_delay: float = quantity(
        2.0, "s", "time beyond a limit after which there is an alarm", "assumed"
    )
    monitor_period: float = quantity(
        0.2,
        "s",
        "time between two looks at commands and feedback",
        "assumed: short beside the delays",
        minimum=1e-3,
    )


class MonitorState(NamedTuple):
    """Times for which tolerances and limits have been exceeded; those of units stay once they reach the delay.

    Parameters
    ----------
    port, starboard, tunnel : float or (...) array or tensor
        For how long the unit's feedback has been beyond tolerance. [s]
    position, heading, force : like port
        For how long the ship has been beyond her limits. [s]
    """

    port: Arithmetic
    starboard: Arithmetic
    tunnel: Arithmetic
    position: Arithmetic
    heading: Arithmetic
    force: Arithmetic


class Alarms(NamedTuple):
    """Alarms of the monitor.

    Parameters
    ----------
    port, starboard, tunnel : bool or (...) array or tensor of bool
        Whether the unit is faulty; latched. [1]
    position, heading, force : like port
        Whether the ship is beyond her limits. [1]
    """

    port: Arithmetic
    starboard: Arithmetic
    tunnel: Arithmetic
    position: Arithmetic
    heading: Arithmetic
    force: Arithmetic


def at_rest(like: Arithmetic = 0.0) -> MonitorState:
    """State at the start: nothing is beyond a limit.

    Parameters
    ----------
    like : float or (...) array or tensor
        Gives shape and type only. [any unit]

    Returns
    -------
    MonitorState
        The state.

    References
    ----------
    Definition.
    """
    return MonitorState(*(0.0 * like,) * 6)


def deviation(
    thrusts: Vector,
    azimuths: Vector = (0.0, 0.0),
    *,
    thrust_tolerance: float,
    azimuth_tolerance: float,
) -> Arithmetic:
    """Deviation of feedback from command over its tolerance; above 1 it is exceeded.

    Parameters
    ----------
    thrusts : tuple of two floats or (...) arrays or tensors
        Commanded and reported thrust. [N, N]
    azimuths : tuple of two, like thrusts
        Commanded and reported direction; none of a unit that does not turn. [rad, rad]
    thrust_tolerance, azimuth_tolerance : float
        Tolerances. [N, rad]

    Returns
    -------
    like thrusts
        The larger of both ratios. [1]

    References
    ----------
    Definition.

    Examples
    --------
    >>> deviation((10e3, 8.5e3), (0.0, 0.1), thrust_tolerance=3e3, azimuth_tolerance=0.05)
    2.0
    """
    # Thrust and direction have tolerances of their own; the direction differs the short way round.
    of_thrust = abs(thrusts[0] - thrusts[1]) / thrust_tolerance
    return maximum(of_thrust, abs(wrap(azimuths[0] - azimuths[1])) / azimuth_tolerance)


def step(
    state: MonitorState,
    deviations: Triple,
    available: tuple,
    errors: Vector,
    bias: Vector,
    h: float,
    *,
    parameters: MonitorParameters,
) -> MonitorState:
    """State of the monitor `h` later.

    Parameters
    ----------
    state : MonitorState
        State at the start.
    deviations : tuple of three floats or (...) arrays or tensors
        `deviation` of port, starboard and tunnel. [1]
    available : tuple of three bools or (...) arrays or tensors of bool
        Whether the units run; one that does not is not watched. [1]
    errors : tuple of two, like deviations
        Distance from the reference, and heading off it. [m, rad]
    bias : tuple of two, like deviations
        Estimated force forward and to starboard that neither thrust nor measured wind explains. [N, N]
    h : float
        Time since the last step. [s]
    parameters : MonitorParameters
        Tolerances and times.

    Returns
    -------
    MonitorState
        State at the end.

    References
    ----------
    Alarms on the difference of command and feedback, on position, heading and the force of the observer: common
    practice of DP systems; tolerances and times are assumed.
    """
    p = parameters
    # Count the time beyond a tolerance; once the delay is
    # reached, the time stays: the fault is latched.
    units = [
        where((off > 1.0) & on, time + h, where(time >= p.fault_delay, time, 0.0))
        for time, off, on in zip(state[:3], deviations, available, strict=True)
    ]
    # Limits of the ship: position, heading and the force that the observer cannot explain.
    beyond = (
        errors[0] > p.position_limit,
        abs(errors[1]) > p.heading_limit,
        hypot(*bias) > p.force_limit,
    )
    # These alarms are not latched: the time returns to zero.
    ship = [where(over, time + h, 0.0) for time, over in zip(state[3:], beyond, strict=True)]
    return MonitorState(*units, *ship)


def alarms(state: MonitorState, *, parameters: MonitorParameters) -> Alarms:
    """Alarms in a state of the monitor.

    Parameters
    ----------
    state : MonitorState
        The state.
    parameters : MonitorParameters
        Tolerances and times.

    Returns
    -------
    Alarms
        Faulty units, and the alarms.

    References
    ----------
    As `step`.
    """
    faulty = (time >= parameters.fault_delay for time in state[:3])
    return Alarms(*faulty, *(time >= parameters.alarm_delay for time in state[3:]))
