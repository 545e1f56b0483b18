"""Parts common to all kinds of thrusters: their loads on the ship."""

from typing import NamedTuple

from shipcosim.models.core.maths import Arithmetic

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
