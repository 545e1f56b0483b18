"""Neural allocation of up to six units of any ship; the law is that of `neural_law`.

The network is trained for a ship: number, places, limits and power of her units. `specific_power` and `turning_time` of
the parameters, which the optimal allocator weighs, have no effect here.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from shipcosim.models.allocation import neural_law
from shipcosim.models.allocation.fixed_angles import UNITS
from shipcosim.models.allocation.neural import Units
from shipcosim.models.allocation.neural_law import NeuralLaw, Remembered, resting
from shipcosim.models.allocation.optimal_units import OptimalUnitsParameters
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity
from shipcosim.models.propulsion.interaction import InteractionParameters, pair_table


def _diameter(number):
    about = f"propeller diameter of unit {number}, where the law is to know its slipstream; 0: it does not"
    return quantity(0.0, "m", about, "neutral", minimum=0.0)


@dataclass(frozen=True, kw_only=True)
class NeuralUnitsParameters(OptimalUnitsParameters):
    """Places, limits, turning and slipstreams of the units."""

    diameter_1: float = _diameter(1)
    diameter_2: float = _diameter(2)
    diameter_3: float = _diameter(3)
    diameter_4: float = _diameter(4)
    diameter_5: float = _diameter(5)
    diameter_6: float = _diameter(6)


def units_of(
    parameters: NeuralUnitsParameters, full_power: tuple = (1.0,) * UNITS
) -> tuple[Units, tuple]:
    """The units in vectors, without those that have no thrust.

    Parameters
    ----------
    parameters : NeuralUnitsParameters
        The units.
    full_power : tuple of six floats
        Powers at their limits of thrust, which only training needs. [W]

    Returns
    -------
    Units
        The units that there are. [as its fields say]
    tuple of int
        Their places among the six. [1]

    References
    ----------
    Definition.
    """
    # Units with thrust; the others do not exist.
    p = parameters
    numbers = tuple(k for k, most in enumerate(p.of_units("thrust_max")) if most > 0.0)
    names = "x y azimuth thrust_min thrust_max thrust_rate azimuth_rate azimuth_first azimuth_last thrust_least".split()
    x, y, azimuth, low, high, rate, turn, first, last, least = (
        _chosen(p, name, numbers) for name in names
    )
    # An empty interval of angles means no limit.
    free = last <= first
    first = np.where(free, -inf, first)
    last = np.where(free, inf, last)
    # A unit that turns runs with its least thrust or more; the others reverse.
    least = np.where(turn > 0.0, np.minimum(least, high), low)
    bearing = tandem = None
    # Slipstreams only where a diameter is given.
    if _chosen(p, "diameter", numbers).any():
        names = [f"{name}_{k}" for name in ("x", "y", "diameter") for k in range(1, UNITS + 1)]
        bearing, tandem = pair_table(
            InteractionParameters(**{name: getattr(p, name) for name in names}), numbers
        )
    power = np.array(full_power, float)[list(numbers)]
    return Units(
        x, y, azimuth, turn, first, last, least, high, rate, power, p.yaw_lever, bearing, tandem
    ), numbers


def _chosen(parameters, name, numbers):
    """A parameter of some units."""
    return np.array(parameters.of_units(name))[list(numbers)]


def design(parameters: NeuralUnitsParameters, arrays: dict) -> NeuralLaw:
    """What the law needs of the parameters and of a trained network.

    Parameters
    ----------
    parameters : NeuralUnitsParameters
        The units.
    arrays : dict of str to array
        Weights. [1]

    Returns
    -------
    NeuralLaw
        The units that there are.

    References
    ----------
    Definition.
    """
    units, numbers = units_of(parameters)
    least = tuple(_chosen(parameters, "thrust_min", numbers).tolist())
    return neural_law.designed(units, numbers, arrays, least, parameters.yaw_lever)


def at_rest(tau: Load, *, parameters: NeuralUnitsParameters) -> Remembered:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : NeuralUnitsParameters
        Units and their angles at the start.

    Returns
    -------
    Remembered
        The state.

    References
    ----------
    Definition.
    """
    return resting(tau, tuple(parameters.of_units("azimuth")))


def step(
    state: Remembered,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: NeuralUnitsParameters,
    design: NeuralLaw,
) -> Remembered:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Remembered
        State at the last commands.
    tau : tuple of three floats or (...) arrays
        Requested load, body frame. [N, N, N.m]
    available : tuple of six bools or (...) arrays of bool
        Whether the units can be used. [1]
    h : float
        Time since the last commands. [s]
    parameters : NeuralUnitsParameters
        Units and limits.
    design : NeuralLaw
        Made of the same parameters by `design`.

    Returns
    -------
    Remembered
        Commands and the load they give.

    References
    ----------
    As `neural_law.step`.
    """
    return neural_law.step(state, tau, available, h, design=design)
