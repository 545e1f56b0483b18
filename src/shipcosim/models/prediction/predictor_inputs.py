"""Inputs of all predictors: a ship's knowledge of herself and of the weather.

A predictor is a state and two functions: `step` takes the state and a `Known` to the next sample, `predict` gives the
motion to come from both. Dead reckoning has its state in `surroundings`, and `predict` in `dead_reckoning`.
"""

from typing import Any, NamedTuple

from shipcosim.models.control.pid import Desired
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic, cos, sin
from shipcosim.models.core.motion import Load, Motion, Triple, Vector


class Known(NamedTuple):
    """Inputs of a predictor at one time: the DP system's knowledge of ship and weather.

    Parameters
    ----------
    ship : Motion
        The low-frequency ship as the observer of the DP controller estimates her.
    bias : tuple of three floats or (...) arrays or tensors
        Load in body axes that neither allocated thrust nor measured wind explains, as the same observer estimates it.
        [N, N, N.m]
    thrusters : like bias
        Commanded load of the thrusters in body axes. [N, N, N.m]
    wind_speed, wind_from : float or (...) array or tensor
        Measured apparent wind at 10 m above the ship: speed, and direction it comes from, clockwise from the bow.
        [m/s, rad]
    wind_believed : like wind_speed
        1 where the DP controller believes that wind, 0 where it does not: then its load is part of the bias. [1]
    desired : Desired, optional
        Desired motion of the DP controller now; None where it is unknown.
    goal : tuple of three, like wind_speed, optional
        Where its reference model goes to: position and heading. [m, m, rad]
    wave_frequency : like wind_speed, optional
        Of the motion in waves, as the DP controller estimates it. [rad/s]
    """

    ship: Motion
    bias: Load
    thrusters: Load
    wind_speed: Arithmetic
    wind_from: Arithmetic
    wind_believed: Arithmetic = 1.0
    desired: Desired | None = None
    goal: Triple | None = None
    wave_frequency: Arithmetic | None = None


def air_velocity(known: Any) -> Vector:
    """Velocity of the air over ground: the measured apparent wind, and the ship's own velocity.

    Parameters
    ----------
    known : Known or helm.Aboard
        Ship and apparent wind; floats, (...) arrays or tensors. [as its fields]

    Returns
    -------
    tuple of two, like known
        North and east. [m/s]

    References
    ----------
    Definition; the inverse of `wind_loads.apparent_wind`.
    """
    # Invert the apparent wind: air = ship - wind from its direction, turned into north-east.
    ship = known.ship
    speed = known.wind_speed
    return to_ned(
        ship.psi, ship.u - speed * cos(known.wind_from), ship.v - speed * sin(known.wind_from)
    )
