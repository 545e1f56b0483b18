"""Drive, motor and shaft of a thruster: from a thrust command to shaft speed.

The drive limits the command and its rate, and turns it into motor torque by a PI law on shaft speeds. With g(T) the
shaft speed that gives T at bollard and Q_b(n) the torque there,

    Q_cmd = Q_b(n_d) + k_p 2π (n_d - n) + z,  n_d = g(T_cmd),  ż = k_i 2π (n_d - g(T)),

T the delivered thrust: its estimate is assumed to be exact. At bollard g(T) = n, an ordinary PI speed loop, as linear
through zero thrust as elsewhere; with inflow the integral brings the thrust, not the speed, to what was asked. Where
the motor's limits cut the torque, z follows back at k_i/k_p. The speed limit lets the shaft near n_max at rate k_p/I.
"""

from typing import Any, NamedTuple

from .maths import clip, maximum, minimum, pi, rk4, substeps, where

_LONGEST_SUBSTEP = 0.05  # s; the fastest mode, shaft with drive at full thrust, is about 10 1/s
_TURN = 2.0 * pi
_THRUST_TOLERANCE = 1.0  # N, nearer than this the command counts as reached


class Thruster(NamedTuple):
    """State of a thruster.

    Parameters
    ----------
    n : float or (...) array or tensor
        Shaft speed, of a tunnel thruster its motor's. [rev/s]
    integral : like n
        Integral part z of the drive. [N.m]
    thrust_cmd : like n
        Command within its limits and rate. [N]
    azimuth : like n
        Direction of positive thrust, clockwise from the bow; π/2 for a tunnel. [rad]
    torque : like n
        Torque of the motor. [N.m]
    saturated : bool or array
        Running at a limit of force, of its rate, or of the motor.
    """

    n: Any
    integral: Any
    thrust_cmd: Any
    azimuth: Any
    torque: Any
    saturated: Any


def at_rest(azimuth):
    """A thruster that stands still.

    Parameters
    ----------
    azimuth : float or (...) array or tensor
        Direction of positive thrust. [rad]

    Returns
    -------
    Thruster
    """
    zero = 0.0 * azimuth
    return Thruster(zero, zero, zero, azimuth, zero, False)


def drive_step(thruster, thrust_cmd, failed, h, drive, loads, speed, torque):
    """Drive, motor and shaft a step later.

    Parameters
    ----------
    thruster : Thruster
        State at the start, its direction already that of the end.
    thrust_cmd : like the state
        Commanded thrust. [N]
    failed : bool or array
        Without power: no motor torque, the shaft runs free, command and integral are forgotten.
    h : float
        Step, divided into equal parts of at most 0.05 s. [s]
    drive : AzimuthParameters or TunnelParameters
        Limits, motor and gains.
    loads : callable
        ``loads(n)`` gives the propeller's thrust and torque. [N, N.m]
    speed, torque : callable
        The bollard curves ``speed(thrust)`` and ``torque(n)``. [rev/s, N.m]

    Returns
    -------
    Thruster
        State at the end.
    """
    running = where(failed, 0.0, 1.0)
    start = running * thruster.thrust_cmd
    wanted = running * clip(thrust_cmd, drive.thrust_min, drive.thrust_max)
    reached = start + clip(wanted - start, -drive.thrust_rate * h, drive.thrust_rate * h)
    slope = (reached - start) / h

    def rates(n, integral, command):
        n_d, (thrust, load) = speed(command), loads(n)
        asked, given = motor(n, integral, n_d, load)
        n_dot = (given - load - drive.friction * _TURN * n) / (_TURN * drive.inertia)
        follow = drive.integral_gain / drive.proportional_gain * (given - asked)
        return n_dot, drive.integral_gain * _TURN * (n_d - speed(thrust)) + follow, slope

    def motor(n, integral, n_d, load):
        asked = torque(n_d) + drive.proportional_gain * _TURN * (n_d - n) + integral
        return asked, where(failed, 0.0, _limited(asked, n, load, drive))

    state = thruster.n, running * thruster.integral, start
    parts = substeps(h, _LONGEST_SUBSTEP)
    for _ in range(parts):
        state = rk4(rates, state, h / parts)
    n, integral, _ = state
    asked, given = motor(n, integral, speed(reached), loads(n)[1])
    at_limit = ((abs(reached - thrust_cmd) > _THRUST_TOLERANCE) | (asked != given)) & (running > 0.0)
    return Thruster(n, running * integral, reached, thruster.azimuth, given, at_limit)


def _limited(torque, n, load, drive):
    """Torque within the motor's limits of torque, power and speed."""
    most = minimum(drive.torque_max, drive.power_max / maximum(_TURN * abs(n), 0.1))
    gain, n_max = drive.proportional_gain * _TURN, drive.rpm_max / 60.0
    return clip(torque, maximum(-most, load - gain * (n_max + n)), minimum(most, load + gain * (n_max - n)))
