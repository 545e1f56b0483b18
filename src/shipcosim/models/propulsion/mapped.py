"""Thrusters with a measured map: thrust over any command (per cent, pulse width), with a lag."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from shipcosim.models.core.interpolation import interp
from shipcosim.models.core.kinematics import load_at, moved, velocity_at
from shipcosim.models.core.maths import Arithmetic, clip, cos, exp, maximum, sin, where
from shipcosim.models.core.parameters import quantity, required, required_table
from shipcosim.models.core.tables import columns
from shipcosim.models.propulsion.thruster import LOSS, Loads


@dataclass(frozen=True, kw_only=True)
class MapParameters:
    """A thruster that does not turn, whose thrust at no speed was measured over its command."""

    x: float = required("m", "position forward", share=0.02)
    y: float = required("m", "position to starboard", share=0.02)
    direction: float = quantity(
        0.0, "rad", "direction of positive thrust, clockwise from the bow", "ahead"
    )
    thrust_table: str = required_table(
        ("command [1]", "thrust [N]"),
        "rows 'command thrust': thrust at no speed over the command in any unit, both increasing; constant beyond",
    )
    time_constant: float = quantity(
        0.0, "s", "time constant of the thrust", "neutral: at once", minimum=0.0
    )
    command_rate: float = quantity(
        0.0,
        "1/s",
        "quickest change of the command, in the unit of the map; 0: no limit",
        "neutral",
        minimum=0.0,
    )
    speed_loss: float = quantity(
        0.0,
        "s/m",
        "share of the thrust that each m/s of advance in its direction takes",
        "neutral",
        minimum=0.0,
    )
    thrust_loss: float = quantity(
        0.0, "1", LOSS, "neutral; 5 % of the map", tolerance=0.05, maximum=1.0
    )


def mapped_thrust(command: Arithmetic, *, thruster: MapParameters) -> Arithmetic:
    """Thrust at no speed that a command gives once the lag is over.

    Parameters
    ----------
    command : float or (...) array or tensor
        In the unit of the map. [1]
    thruster : MapParameters
        The thruster.

    Returns
    -------
    like command
        Thrust. [N]

    Raises
    ------
    ValueError
        The map is not one of two columns that both increase.

    References
    ----------
    Definition.
    """
    return interp(command, *_map(thruster.thrust_table))


def within_map(thrust: Arithmetic, *, thruster: MapParameters) -> Arithmetic:
    """The thrust within the map that is nearest to a wanted one.

    Parameters
    ----------
    thrust : float or (...) array or tensor
        Wanted. [N]
    thruster : MapParameters
        The thruster.

    Returns
    -------
    like thrust
        Thrust. [N]

    Raises
    ------
    ValueError
        The map is not one of two columns that both increase.

    References
    ----------
    Definition.
    """
    _, thrusts = _map(thruster.thrust_table)
    return clip(thrust, thrusts[0], thrusts[-1])


def mapped_command(thrust: Arithmetic, *, thruster: MapParameters) -> Arithmetic:
    """Command that gives a thrust at no speed once the lag is over.

    Parameters
    ----------
    thrust : float or (...) array or tensor
        At no speed; beyond the map the nearest that it has. [N]
    thruster : MapParameters
        The thruster.

    Returns
    -------
    like thrust
        In the unit of the map; where the thrust is the same over several commands, one of them. [1]

    Raises
    ------
    ValueError
        The map is not one of two columns that both increase.

    References
    ----------
    Definition.

    Examples
    --------
    >>> mapped_command(27.5, thruster=MapParameters(x=0.0, y=0.0, thrust_table="1500 0; 1900 55"))
    1700.0
    """
    commands, thrusts = _map(thruster.thrust_table)
    # The inverse map: both columns increase, so they can be swapped.
    return interp(thrust, thrusts, commands)


def commanded(
    command: Arithmetic, wanted: Arithmetic, h: float, *, thruster: MapParameters
) -> Arithmetic:
    """Command a step later, which changes no quicker than the thruster allows.

    Parameters
    ----------
    command, wanted : float or (...) array or tensor
        At the start; what is wanted over the step, in the unit of the map. [1, 1]
    h : float
        Step. [s]
    thruster : MapParameters
        The thruster.

    Returns
    -------
    like command
        In the unit of the map. [1]

    References
    ----------
    Definition.
    """
    if thruster.command_rate == 0.0:
        # A limit of zero means no limit.
        return wanted
    most = thruster.command_rate * h
    return moved(command, wanted, most)


def mapped_step(
    thrust: Arithmetic, wanted: Arithmetic, h: float, *, thruster: MapParameters
) -> Arithmetic:
    """Thrust at no speed a step later: a lag of first order, integrated exactly.

    Parameters
    ----------
    thrust, wanted : float or (...) array or tensor
        At the start; what is wanted over the step. [N, N]
    h : float
        Step. [s]
    thruster : MapParameters
        The thruster.

    Returns
    -------
    like thrust
        Thrust. [N]

    References
    ----------
    Definition.
    """
    if thruster.time_constant == 0.0:
        return wanted
    # Lag of first order, exact over the step: T + (T0 - T) e^(-h/τ).
    return wanted + (thrust - wanted) * exp(0.0 * thrust - h / thruster.time_constant)


def mapped_loads(
    thrust: Arithmetic, u_r: Arithmetic, v_r: Arithmetic, r: Arithmetic, *, thruster: Any
) -> Loads:
    """Load on the ship, T max(0, 1 - speed_loss u_a sign(T)) with the speed u_a of the water along the thruster.

    Parameters
    ----------
    thrust : float or (...) array or tensor
        At no speed. [N]
    u_r, v_r, r : like thrust
        Velocity of the ship through the water, yaw rate. [m/s, m/s, rad/s]
    thruster : MapParameters or fixed.FixedParameters
        Place, direction and losses. [as its fields]

    Returns
    -------
    Loads
        Forces and load.

    References
    ----------
    A straight line, assumed.

    Examples
    --------
    >>> boat = MapParameters(x=-0.4, y=0.3, thrust_table="1100 -28; 1500 0; 1900 55")
    >>> mapped_loads(mapped_thrust(1700.0, thruster=boat), 0.0, 0.0, 0.0, thruster=boat).tau_X
    27.5
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


@lru_cache(maxsize=16)
def _map(text):
    """Columns of the map; the thrust must not fall."""
    commands, thrusts = columns(text, 2)
    for number, (before, after) in enumerate(zip(thrusts, thrusts[1:], strict=False), 2):
        if after < before:
            raise ValueError(
                f"table, row {number}: {after:g} N after {before:g} N. The thrust must not fall."
            )
    return commands, thrusts
