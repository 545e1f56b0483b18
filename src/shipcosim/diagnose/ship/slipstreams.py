"""Thrust that the slipstreams of azimuth thrusters take from one another, where a system has an FMU for it."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.propulsion.interaction import (
    InteractionParameters,
    Pair,
    pairs,
    thrust_shares,
)


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

    @cached_property
    def pairs_behind(self) -> dict[int, tuple[Pair, ...]]:
        """By number of a unit the pairs in which it lies behind; made once, since a share is asked in every row."""
        unit_pairs = pairs(self.parameters)
        return {
            number: tuple(pair for pair in unit_pairs if pair.behind == number)
            for number in self.numbers.values()
        }

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
        behind = self.pairs_behind[number]
        scale = self.parameters.loss_scale
        return thrust_shares(tuple(azimuths), washes, unit_pairs=behind, loss_scale=scale)[number]
