"""Drive, motor and shaft of a thruster: from a thrust command to shaft speed.

The drive limits the command and its rate, and turns it into motor torque by a PI law on shaft speeds. With g(T) the
shaft speed that gives T at bollard and Q_b(n) the torque there,

    Q_cmd = Q_b(n_d) + k_p 2π (n_d - n) + z,  n_d = g(T_cmd),  ż = k_i 2π (n_d - g(T)),

T the delivered thrust: its estimate is assumed to be exact. At bollard g(T) = n, an ordinary PI speed loop, as linear
through zero thrust as elsewhere; with inflow the integral brings the thrust, not the speed, to the command. Where the
limits of the motor cut the torque, z follows back at k_i/k_p (anti-windup). The speed limit lets the shaft approach
n_max at rate k_p/I.

The motor also brakes, within the same limits: when the shaft is to reverse, and when the inflow turns the propeller.
What it takes from the shaft then does not flow back into the grid, which a rectifier of diodes does not let through: a
brake resistor turns it into heat. The parameter `regeneration` is the share that does flow back.

References
----------
Smogeli, Control of Marine Propellers, NTNU, 2006; that the estimate of the thrust is exact is assumed, and so are a
brake resistor as strong as the motor, and a drive without losses.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from shipcosim.models.core.integrate import rk4_pair, substeps
from shipcosim.models.core.maths import Arithmetic, clip, maximum, minimum, pi, times, where
from shipcosim.models.core.motion import Vector
from shipcosim.models.propulsion.failures import Failures

_LONGEST_SUBSTEP = 0.05  # s; the fastest mode, shaft with drive at full thrust, is about 10 1/s
_TURN = 2.0 * pi
_SLOW = 0.1 / _TURN  # rev/s, slower the motor's power does not limit it
_THRUST_TOLERANCE = 1.0  # N, nearer than this the command counts as reached
_AT_ONCE = 1e9  # N/s, more than any rate


class Thruster(NamedTuple):
    """State of a thruster.

    Parameters
    ----------
    n : float or (...) array or tensor
        Shaft speed, of a tunnel thruster that of its motor. [rev/s]
    integral : like n
        Integral part z of the drive. [N.m]
    thrust_cmd : like n
        Command within its limits of size and rate. [N]
    azimuth : like n
        Direction of positive thrust, clockwise from the bow; π/2 for a tunnel. [rad]
    torque : like n
        Torque of the motor. [N.m]
    saturated : bool or (...) array or tensor of bool
        True at a limit of force, of its rate, or of the motor. [1]
    reported : like n
        Thrust that the drive reports: its estimate from the measured shaft speed. [N]
    """

    n: Arithmetic
    integral: Arithmetic
    thrust_cmd: Arithmetic
    azimuth: Arithmetic
    torque: Arithmetic
    saturated: Arithmetic
    reported: Arithmetic


def at_rest(azimuth: Arithmetic) -> Thruster:
    """State of a thruster whose shaft stands still.

    Parameters
    ----------
    azimuth : float or (...) array or tensor
        Direction of positive thrust. [rad]

    Returns
    -------
    Thruster
        The state.
    """
    zero = 0.0 * azimuth
    return Thruster(zero, zero, zero, azimuth, zero, False, zero)


def drive_step(
    thruster: Thruster,
    azimuth: Arithmetic,
    thrust_cmd: Arithmetic,
    failures: Failures,
    h: float,
    drive: Any,
    loads: Callable,
    speed: Callable,
    torque: Callable,
) -> Thruster:
    """State of drive, motor and shaft one step later.

    Parameters
    ----------
    thruster : Thruster
        State at the start.
    azimuth : like the state
        Direction of positive thrust at the end. [rad]
    thrust_cmd : like the state
        Commanded thrust. [N]
    failures : Failures
        What has failed. Without power command and integral are reset.
    h : float
        Step, divided into equal parts of at most 0.05 s. [s]
    drive : AzimuthParameters or TunnelParameters
        Limits, motor and gains. [as the fields say]
    loads : callable
        ``loads(n)`` gives thrust and torque of the propeller. [N, N.m]
    speed, torque : callable
        The bollard curves ``speed(thrust)`` and ``torque(n)``. [rev/s, N.m]

    Returns
    -------
    Thruster
        State at the end.
    """
    # Failures as factors: power on or off, sign of the measured shaft speed.
    running = where(failures.stopped, 0.0, 1.0)
    sign = where(failures.rpm_reversed, -1.0, 1.0)
    start = running * thruster.thrust_cmd
    wanted, rate = _set_point(thruster, thrust_cmd, failures, drive)
    change = clip(running * wanted - start, -rate * h, rate * h)
    # Gains per rad/s are used with shaft speeds in rev/s, hence 2π.
    gain = drive.proportional_gain * _TURN
    ratio = drive.integral_gain / drive.proportional_gain
    integral_gain = drive.integral_gain * _TURN
    friction = drive.friction * _TURN
    inertia = drive.inertia * _TURN
    motor = _motor(drive, gain, running, sign, failures.power_limit)

    # Set point within the step: the command moves linearly.
    def demand(share):
        n_d = speed(start + share * change)
        return n_d, torque(n_d) + gain * n_d

    # Shaft: I 2π ṅ = Q_motor - Q_propeller - friction; integral z as in the module's docstring.
    def rates(n, integral, n_d, forward):
        thrust, load = loads(n)
        torque_wanted, given = motor(n, integral, forward, load)
        n_dot = (given - load - friction * n) / inertia
        return n_dot, integral_gain * (n_d - speed(sign * thrust)) + ratio * (given - torque_wanted)

    # Sub-steps, because the shaft with its drive is faster than the step of an FMU.
    parts = substeps(h, _LONGEST_SUBSTEP)

    def turn(state):
        part, n, integral, before = state
        middle = demand((part + 0.5) / parts)
        after = demand((part + 1.0) / parts)
        return part + 1.0, *rk4_pair(rates, n, integral, h / parts, before, middle, after), after

    state = 0.0, thruster.n, running * thruster.integral, demand(0.0)
    _, n, integral, now = times(parts, turn, state)
    # Outputs at the end of the step; saturated means a limit of thrust, rate or motor was active.
    reached = start + change
    thrust, load = loads(n)
    wanted_torque, given = motor(n, integral, now[1], load)
    at_limit = ((abs(reached - thrust_cmd) > _THRUST_TOLERANCE) | (wanted_torque != given)) & (
        running > 0.0
    )
    return Thruster(n, running * integral, reached, azimuth, given, at_limit, sign * thrust)


def _set_point(thruster, thrust_cmd, failures, drive):
    """Target thrust of the drive, and the rate at which it moves there. [N, N/s]"""
    # A frozen drive keeps its set point; a drive that fails to full thrust goes there at once.
    wanted = where(
        failures.rpm_frozen,
        thruster.thrust_cmd,
        clip(thrust_cmd, drive.thrust_min, drive.thrust_max),
    )
    wanted = where(failures.full_thrust, drive.thrust_max, wanted)
    return wanted, where(failures.full_thrust, _AT_ONCE, failures.rate_share * drive.thrust_rate)


def powers(thruster: Thruster, drive: Any) -> Vector:
    """Power that a thruster draws from the grid, and what its brake resistor turns into heat.

    Their difference is the power of the motor on the shaft, 2π n Q.

    Parameters
    ----------
    thruster : Thruster
        State.
    drive : AzimuthParameters or TunnelParameters
        Whose `regeneration` counts. [as the fields say]

    Returns
    -------
    tuple of two, like the state
        From the grid, negative only where some flows back; in the resistor, never negative. [W, W]

    References
    ----------
    Balance of energy; that drive and motor have no losses is assumed.
    """
    # Shaft power 2π n Q: positive while driving, negative while braking.
    shaft = _TURN * thruster.n * thruster.torque
    driving = maximum(shaft, 0.0)
    braking = maximum(-shaft, 0.0)
    # Only the regenerated share of the braking power goes back into the grid.
    return driving - drive.regeneration * braking, (1.0 - drive.regeneration) * braking


def _motor(drive, gain, running, sign, power_limit):
    """Function that gives the torque asked for by the drive, and the torque of the motor.

    The motor keeps within its limits of torque, power and speed.
    """
    n_max = drive.rpm_max / 60.0
    torque_max = drive.torque_max
    power = minimum(drive.power_max, power_limit) / _TURN

    def motor(n, integral, forward, load):
        # PI law on shaft speed with feedforward of the bollard torque; the sensor may have the
        # wrong sign.
        torque_wanted = forward - gain * (sign * n) + integral
        # Power limit as a torque limit, Q ≤ P / (2π n); near rest only torque limits.
        most = minimum(torque_max, power / maximum(abs(n), _SLOW))
        # Speed limit: the net torque is at most k_p 2π (n_max - n), so the shaft approaches n_max
        # at the rate k_p/I.
        least = maximum(-most, load - gain * (n_max + n))
        most = minimum(most, load + gain * (n_max - n))
        return torque_wanted, running * clip(torque_wanted, least, most)

    return motor
