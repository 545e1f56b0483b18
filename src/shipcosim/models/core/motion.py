"""State of motion of a ship in the horizontal plane: η and ν of the three degrees of freedom surge, sway and yaw."""

from typing import NamedTuple

from shipcosim.models.core.maths import Arithmetic


class Motion(NamedTuple):
    """Position, heading and velocity over ground, η = (x, y, ψ) and ν = (u, v, r); also their rates or measurements.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position north and east, heading clockwise from north. [m, m, rad]
    u, v, r : like x
        Velocity over ground forward and to starboard, yaw rate. [m/s, m/s, rad/s]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    u: Arithmetic
    v: Arithmetic
    r: Arithmetic


Load = tuple[Arithmetic, Arithmetic, Arithmetic]
"""Load τ = (X, Y, N) on a ship in body axes: force forward, to starboard, and yaw moment. [N, N, N.m]"""
Vector = tuple[Arithmetic, Arithmetic]
"""Two numbers: north and east, or forward and to starboard. [any unit]"""
Triple = tuple[Arithmetic, Arithmetic, Arithmetic]
"""Three numbers: of surge, sway and yaw, or of three units. [any unit]"""
