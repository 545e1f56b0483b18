"""Tunnel thrusters: from a thrust command over drive, motor and shaft to the loads on the ship.

Limits, drive and motor are in `drive`; thrust and torque go with the squared speed of the motor.
"""

from dataclasses import dataclass

from shipcosim.models.core.maths import Arithmetic, exp, pi, sqrt, where
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.propulsion.drive import Thruster, at_rest, drive_step
from shipcosim.models.propulsion.failures import Failures
from shipcosim.models.propulsion.thruster import LOSS, REGENERATION, Loads

_TURN = 2.0 * pi
_ALMOST_NONE = 1e-12  # N, keeps the derivative of the square root finite


@dataclass(frozen=True, kw_only=True)
class TunnelParameters:
    """A tunnel thruster with its drive, speeds and torques on the motor's side."""

    x: float = required("m", "position forward", share=0.0014)
    thrust_coefficient: float = required(
        "N/rpm2", "thrust over squared motor speed", share=0.02, minimum=1e-9
    )
    torque_coefficient: float = required("N.m/rpm2", "torque over squared motor speed", minimum=0.0)
    speed_loss: float = quantity(
        0.0,
        "s2/m2",
        "thrust falls with exp(-speed_loss u_r^2) under way; (1/2.2)^2 is typical",
        "neutral",
        minimum=0.0,
    )
    thrust_min: float = required("N", "largest thrust to port, negative", maximum=0.0)
    thrust_max: float = required("N", "largest thrust to starboard", minimum=0.0)
    thrust_rate: float = required("N/s", "largest rate of the thrust command", minimum=0.0)
    rpm_max: float = required("rpm", "largest motor speed", minimum=1.0)
    torque_max: float = required("N.m", "largest motor torque", minimum=0.0)
    power_max: float = required("W", "largest motor power", minimum=0.0)
    inertia: float = required("kg.m2", "motor with what it drives", minimum=1e-6)
    friction: float = required("N.m.s/rad", "friction torque over motor speed", minimum=0.0)
    proportional_gain: float = required("N.m.s/rad", "k_p of the drive", minimum=0.0)
    integral_gain: float = required("N.m/rad", "k_i of the drive", minimum=0.0)
    regeneration: float = quantity(
        0.0, "1", REGENERATION, "neutral: diode rectifier", minimum=0.0, maximum=1.0
    )

    thrust_loss: float = quantity(
        0.0, "1", LOSS, "neutral; thrust_coefficient has the tolerance", maximum=1.0
    )
    rpm_offset: float = quantity(
        0.0, "rpm", "given motor speed of a replay minus the real one", "neutral", share=5.6e-4
    )


def tunnel_step(
    thruster: Thruster,
    thrust_cmd: Arithmetic,
    u_r: Arithmetic,
    failures: Failures,
    h: float,
    *,
    tunnel: TunnelParameters,
) -> Thruster:
    """State of a tunnel thruster one step later.

    Parameters
    ----------
    thruster : Thruster
        State at the start.
    thrust_cmd : like the state
        Commanded thrust, positive to starboard. [N]
    u_r : like the state
        Forward speed of the ship through the water. [m/s]
    failures : Failures
        What has failed; `SOUND` if nothing has.
    h : float
        Step. [s]
    tunnel : TunnelParameters
        The thruster.

    Returns
    -------
    Thruster
        State at the end.

    References
    ----------
    As `drive.drive_step`; quadratic thrust and torque curves: nominal model, tunnel thruster.
    """
    # Under way the jet is bent off, and thrust falls with exp(-c u²).
    loss = exp(-tunnel.speed_loss * u_r * u_r)
    # Coefficients per rpm² become those per (rev/s)²: 60².
    k_T = 3600.0 * tunnel.thrust_coefficient
    k_Q = 3600.0 * tunnel.torque_coefficient

    # Inverse of the quadratic thrust curve; the small number keeps the derivative finite at zero.
    def speed(thrust):
        n = sqrt((abs(thrust) + _ALMOST_NONE) / k_T)
        return where(thrust < 0.0, -n, n)

    def loads(n):
        square = n * abs(n)
        return loss * k_T * square, k_Q * square

    # The drive sees quadratic thrust and torque; the loss by speed acts on the thrust alone.
    return drive_step(
        thruster,
        thruster.azimuth,
        thrust_cmd,
        failures,
        h,
        tunnel,
        loads,
        speed,
        lambda n: k_Q * n * abs(n),
    )


def tunnel_replay(n: Arithmetic, *, tunnel: TunnelParameters) -> Thruster:
    """State of a tunnel thruster at a given motor speed, for replays.

    Parameters
    ----------
    n : float or (...) array or tensor
        Given motor speed; the real one differs by the offset of the thruster. [rev/s]
    tunnel : TunnelParameters
        The thruster.

    Returns
    -------
    Thruster
        With the real speed.

    References
    ----------
    As `tunnel_step`.
    """
    # The real speed is the logged one minus its offset.
    n = n - tunnel.rpm_offset / 60.0
    square = 3600.0 * n * abs(n)
    # The torque holds the motor at constant speed: load plus friction.
    torque = tunnel.torque_coefficient * square + tunnel.friction * _TURN * n
    thrust = tunnel.thrust_coefficient * square
    return at_rest(0.5 * pi + 0.0 * n)._replace(
        n=n, thrust_cmd=thrust, torque=torque, reported=thrust
    )


def tunnel_loads(thruster: Thruster, u_r: Arithmetic, *, tunnel: TunnelParameters) -> Loads:
    """Thrust of a tunnel thruster and its load on the ship.

    Parameters
    ----------
    thruster : Thruster
        State.
    u_r : like the state
        Forward speed of the ship through the water. [m/s]
    tunnel : TunnelParameters
        The thruster.

    Returns
    -------
    Loads
        Forces and load.

    References
    ----------
    As `tunnel_step`.
    """
    # T = c n |n|, with the losses; it acts across, at the tunnel's place.
    n = 60.0 * thruster.n
    kept = (1.0 - tunnel.thrust_loss) * exp(-tunnel.speed_loss * u_r * u_r)
    thrust = tunnel.thrust_coefficient * n * abs(n) * kept
    return Loads(thrust, 0.0 * n, 0.0 * n, thrust, tunnel.x * thrust)
