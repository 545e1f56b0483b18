"""Parts common to all kinds of thrusters: their loads on the ship."""

from typing import Any, NamedTuple

from shipcosim.models.core.kinematics import load_at, velocity_at
from shipcosim.models.core.maths import Arithmetic, cos, maximum, sin, where

LOSS = "share of the thrust that is missing at the speed that the shaft has; torque and drive know nothing of it"
"""Description of the parameter `thrust_loss`."""
REGENERATION = "share of the motor's braking power that flows back into the grid; a brake resistor takes the rest"
"""Description of the parameter `regeneration`."""


class Loads(NamedTuple):
    """Loads of a thruster on the ship.

    Parameters
    ----------
    thrust, side_force : float or (...) array or tensor
        Force along the axis, and across it, 90 deg clockwise of the thrust. [N]
    tau_X, tau_Y, tau_N : like thrust
        Load about the origin. [N, N, N.m]
    """

    thrust: Arithmetic
    side_force: Arithmetic
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic


def loads_at_speed(
    thrust: Arithmetic, u_r: Arithmetic, v_r: Arithmetic, r: Arithmetic, thruster: Any
) -> Loads:
    """Loads of a thruster in a fixed direction, T max(0, 1 - speed_loss u_a sign(T)), u_a the speed along it.

    Parameters
    ----------
    thrust : float or (...) array or tensor
        At no speed. [N]
    u_r, v_r, r : like thrust
        Velocity of the ship through the water, yaw rate. [m/s, m/s, rad/s]
    thruster : FixedParameters or MapParameters
        The thruster. [units as its fields say]

    Returns
    -------
    Loads
        Forces and load.

    References
    ----------
    Assumed: a straight line.
    """
    p = thruster
    # Speed of the water along the thruster, at its place on the ship.
    c = cos(p.direction)
    s = sin(p.direction)
    u_a, v_a = velocity_at(p.x, p.y, u_r, v_r, r)
    along = c * u_a + s * v_a
    # Advance in the direction of thrust reduces it linearly, but never below zero.
    kept = maximum(1.0 - p.speed_loss * where(thrust < 0.0, -along, along), 0.0 * thrust)
    thrust = (1.0 - p.thrust_loss) * thrust * kept
    return Loads(thrust, 0.0 * thrust, *load_at(p.x, p.y, c * thrust, s * thrust))
