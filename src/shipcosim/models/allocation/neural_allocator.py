"""Neural allocation of named and of numbered units, with the law of `neural_law`.

The network is trained for one ship: number, places, limits and power of her units. What only the
optimal allocator weighs has no effect here: `tunnel_price`, `specific_power` and `turning_time`.
"""

from dataclasses import dataclass
from math import atan, atan2, hypot, pi

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.allocation import neural_law
from shipcosim.models.allocation.neural import Units
from shipcosim.models.allocation.neural_law import NeuralLaw, Remembered, resting
from shipcosim.models.allocation.optimal import OptimalUnitsParameters, TurningParameters
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import UNITS, numbered_units, quantity
from shipcosim.models.propulsion.interaction import InteractionParameters, pair_table


@dataclass(frozen=True, kw_only=True)
class NeuralParameters(TurningParameters):
    """Two azimuth thrusters that turn and a tunnel thruster."""

    azimuth_diameter: float = quantity(
        0.0,
        "m",
        "propeller diameter of the azimuths, where the law is to know their slipstreams: then it keeps them out of the "
        "sectors of DNV-ST-0111 alone; 0: it does not",
        "neutral",
        minimum=0.0,
    )

    @property
    def by_unit(self) -> dict[str, tuple]:
        """As of `TurningParameters`, and the propeller diameters."""
        return super().by_unit | {"diameter": (self.azimuth_diameter, self.azimuth_diameter, 0.0)}

    @property
    def start_azimuths(self) -> tuple:
        """Directions at the start. [rad]"""
        return self.of_units("azimuth")

    @property
    def sectors(self) -> tuple:
        """Intervals of angles; with slipstreams only one azimuth's stream on the other is forbidden, DNV-ST-0111."""
        if self.azimuth_diameter <= 0.0:
            return super().sectors
        ahead = self.starboard_x - self.port_x
        aside = self.starboard_y - self.port_y
        half = pi - atan(0.1 + self.azimuth_diameter / hypot(ahead, aside))
        # Bearing from port to starboard, and back; each interval is centred away from the other unit.
        towards = atan2(aside, ahead)
        back = wrap(towards + pi)
        across = super().sectors[2]
        return (towards - half, towards + half), (back - half, back + half), across


def _fields(number):
    """Size of a unit."""
    size = f"propeller diameter of unit {number}, where the law is to know its slipstream; 0: it does not"
    return {"diameter": quantity(0.0, "m", size, "neutral", minimum=0.0)}


@dataclass(frozen=True, kw_only=True)
class NeuralUnitsParameters(numbered_units(_fields), OptimalUnitsParameters):
    """Places, limits, turning and slipstreams of the units."""


def units_of(
    parameters: NeuralParameters | NeuralUnitsParameters, full_power: tuple = (1.0,) * UNITS
) -> tuple[Units, tuple]:
    """The units in vectors, without those that have no thrust.

    Parameters
    ----------
    parameters : NeuralParameters or NeuralUnitsParameters
        The units.
    full_power : tuple of floats
        Powers at their limits of thrust, which only training needs. [W]

    Returns
    -------
    Units
        The units that there are. [as its fields say]
    tuple of int
        Their places among all units. [1]

    References
    ----------
    Definition.
    """
    # Units with thrust; the others do not exist.
    p = parameters
    numbers = tuple(k for k, most in enumerate(p.of_units("thrust_max")) if most > 0.0)
    chosen = list(numbers)
    names = (
        "x y azimuth thrust_min thrust_max thrust_rate azimuth_rate thrust_least diameter".split()
    )
    x, y, azimuth, low, high, rate, turn, least, diameter = (
        np.array(p.of_units(name))[chosen] for name in names
    )
    first, last = np.array(p.sectors)[chosen].T
    # A unit that turns runs with its least thrust or more; the others reverse.
    least = np.where(np.array(p.turning)[chosen], np.minimum(least, high), low)
    bearing = tandem = None
    # Slipstreams only where a diameter is given.
    if diameter.any():
        sizes = {
            f"{name}_{k}": value
            for name in ("x", "y", "diameter")
            for k, value in enumerate(p.of_units(name), 1)
        }
        bearing, tandem = pair_table(InteractionParameters(**sizes), numbers)
    power = np.array(full_power, float)[chosen]
    return Units(
        x, y, azimuth, turn, first, last, least, high, rate, power, p.yaw_lever, bearing, tandem
    ), numbers


def design(parameters: NeuralParameters | NeuralUnitsParameters, arrays: dict) -> NeuralLaw:
    """What the law needs of the parameters and of a trained network.

    Parameters
    ----------
    parameters : NeuralParameters or NeuralUnitsParameters
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
    thrust_min = parameters.of_units("thrust_min")
    least = tuple(thrust_min[k] for k in numbers)
    return neural_law.designed(units, numbers, arrays, least, parameters.lever_degraded)


def at_rest(tau: Load, *, parameters: NeuralParameters | NeuralUnitsParameters) -> Remembered:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : NeuralParameters or NeuralUnitsParameters
        Units and their angles at the start.

    Returns
    -------
    Remembered
        The state.

    References
    ----------
    Definition.
    """
    return resting(tau, parameters.start_azimuths)


step = neural_law.step
