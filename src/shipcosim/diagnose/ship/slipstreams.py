"""Thrust that the slipstreams of azimuth thrusters take from one another, where a system has an FMU for it."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.propulsion.interaction import InteractionParameters, pairs, thrust_shares
from shipcosim.ssp import System


@dataclass(frozen=True)
class Slipstreams:
    """The interaction of the thrusters of a system.

    Attributes
    ----------
    parameters : InteractionParameters
        Places and sizes of the units, by number.
    numbers : dict of str to int
        By thruster its number, from 0.
    """

    parameters: InteractionParameters
    numbers: dict[str, int]

    def share(self, name: str, units: Mapping[str, tuple[Arithmetic, Arithmetic]]) -> Arithmetic:
        """Share of its thrust that a thruster keeps, by speed [rev/s] and direction [rad] of all of them. [1]"""
        if name not in self.numbers:
            return 1.0
        # A number without a thruster of ours stands still: it hits nothing.
        diameters = self.parameters.of_units("diameter")
        speeds = [0.0] * len(diameters)
        azimuths = [0.0] * len(diameters)
        for other, number in self.numbers.items():
            speeds[number], azimuths[number] = units[other]
        washes = tuple(n * diameter for n, diameter in zip(speeds, diameters, strict=True))
        number = self.numbers[name]
        here = tuple(pair for pair in pairs(self.parameters) if pair.behind == number)
        scale = self.parameters.loss_scale
        return thrust_shares(tuple(azimuths), washes, unit_pairs=here, loss_scale=scale)[number]


def numbers_of(system: System, component: str, thrusters: Collection[str]) -> dict[str, int]:
    """By thruster that our FMU of interaction gives its share of thrust, its number there, from 0.

    Parameters
    ----------
    system : System
    component : str
        Name of that FMU's component.
    thrusters : collection of str
        Names of those that count.

    Returns
    -------
    dict of str to int
    """
    fed = {c.target[0]: c.source[1] for c in system.connections if c.source[0] == component}
    return {
        name: int(fed[name].removeprefix("thrust_share_")) - 1 for name in thrusters if name in fed
    }
