"""Neural allocation of two azimuths and a tunnel thruster, with the law of `neural_law`.

The network is trained for one ship, with the power of her units. The parameters `tunnel_price` and
`turning_time` of the optimal allocator have no effect here.
"""

from dataclasses import dataclass
from math import atan, atan2, hypot, pi

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.allocation import neural_law
from shipcosim.models.allocation.neural import Units
from shipcosim.models.allocation.neural_law import NeuralLaw, Remembered, resting
from shipcosim.models.allocation.optimal import OptimalParameters
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity
from shipcosim.models.propulsion.interaction import InteractionParameters, pair_table


@dataclass(frozen=True, kw_only=True)
class NeuralParameters(OptimalParameters):
    """Two azimuth thrusters that turn and a tunnel thruster."""

    azimuth_diameter: float = quantity(
        0.0,
        "m",
        "propeller diameter of the azimuths, where the law is to know their slipstreams: then it keeps them out of the "
        "sectors of DNV-ST-0111 alone; 0: it does not",
        "neutral",
        minimum=0.0,
    )


def units_of(parameters: NeuralParameters, full_power: tuple = (1.0, 1.0, 1.0)) -> Units:
    """The units in vectors: port, starboard, tunnel.

    Parameters
    ----------
    parameters : NeuralParameters
        The units.
    full_power : tuple of three floats
        Powers at their limits of thrust, which only training needs. [W]

    Returns
    -------
    Units
        The units.

    References
    ----------
    Definition.
    """
    # Without a known slipstream the forbidden sectors of the parameters hold.
    p = parameters
    port = (p.port_x, p.port_y)
    starboard = (p.starboard_x, p.starboard_y)
    first = (p.port_azimuth_first, p.starboard_azimuth_first)
    last = (p.port_azimuth_last, p.starboard_azimuth_last)
    bearing = tandem = None
    # With slipstreams: forbid only the sector in which one azimuth blows on the other, DNV-ST-0111.
    if p.azimuth_diameter > 0.0:
        half = pi - atan(
            0.1 + p.azimuth_diameter / hypot(starboard[0] - port[0], starboard[1] - port[1])
        )
        # Bearing from port to starboard, and back; each
        # interval is centred away from the other unit.
        towards = atan2(starboard[1] - port[1], starboard[0] - port[0])
        back = wrap(towards + pi)
        first = (towards - half, back - half)
        last = (towards + half, back + half)
        # Bearings and shares kept in each slipstream.
        sizes = dict(diameter_1=p.azimuth_diameter, diameter_2=p.azimuth_diameter)
        places = dict(x_1=port[0], y_1=port[1], x_2=starboard[0], y_2=starboard[1])
        bearing, tandem = pair_table(InteractionParameters(**places, **sizes), (0, 1, 2))
    tunnel = p.tunnel_thrust_max
    least = p.azimuth_thrust_least
    return Units(
        x=np.array([p.port_x, p.starboard_x, p.tunnel_x]),
        y=np.array([p.port_y, p.starboard_y, 0.0]),
        azimuth=np.array([p.port_azimuth, p.starboard_azimuth, 0.5 * pi]),
        turn=np.array([p.azimuth_rate_max, p.azimuth_rate_max, 0.0]),
        first=np.array([*first, 0.0]),
        last=np.array([*last, 0.0]),
        least=np.array([least, least, -tunnel]),
        most=np.array([p.azimuth_thrust_max, p.azimuth_thrust_max, tunnel]),
        rate=np.array([p.thrust_rate_max] * 3),
        full_power=np.array(full_power, float),
        lever=p.yaw_lever,
        bearing=bearing,
        tandem=tandem,
    )


def design(parameters: NeuralParameters, arrays: dict) -> NeuralLaw:
    """What the law needs of the parameters and of a trained network.

    Parameters
    ----------
    parameters : NeuralParameters
        The units.
    arrays : dict of str to array
        Weights. [1]

    Returns
    -------
    NeuralLaw
        Port, starboard and tunnel.

    References
    ----------
    Definition.
    """
    p = parameters
    least = p.azimuth_thrust_min, p.azimuth_thrust_min, -p.tunnel_thrust_max
    return neural_law.designed(units_of(p), (0, 1, 2), arrays, least, p.yaw_lever_degraded)


def at_rest(tau: Load, *, parameters: NeuralParameters) -> Remembered:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : NeuralParameters
        Units and their angles at the start.

    Returns
    -------
    Remembered
        The state.

    References
    ----------
    Definition.
    """
    return resting(tau, (parameters.port_azimuth, parameters.starboard_azimuth, 0.5 * pi))


def step(
    state: Remembered,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: NeuralParameters,
    design: NeuralLaw,
    shares: tuple = (1.0, 1.0, 1.0),
) -> Remembered:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Remembered
        State at the last commands.
    tau : tuple of three floats or (...) arrays
        Requested load, body frame. [N, N, N.m]
    available : tuple of three bools or (...) arrays of bool
        Whether port, starboard and tunnel can be used. [1]
    h : float
        Time since the last commands. [s]
    parameters : NeuralParameters
        Units and limits.
    design : NeuralLaw
        Made of the same parameters by `design`.
    shares : tuple of three floats or (...) arrays
        Shares of their limits of thrust that power leaves to port, starboard and tunnel. [1]

    Returns
    -------
    Remembered
        Commands and the load they give.

    References
    ----------
    As `neural_law.step`.
    """
    return neural_law.step(state, tau, available, h, design=design, shares=shares)
