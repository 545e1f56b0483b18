"""Interface of the allocators of up to six units, by their numbers, for any ship."""

from dataclasses import dataclass
from typing import ClassVar

from shipcosim.fmi import Input, Output, Parameters
from shipcosim.interfaces.thrust_allocator import LoadRequest, ThrustAllocator
from shipcosim.models.core.parameters import UNITS, numbered_units, quantity


def _fields(number):
    """Power of a unit."""
    about = f"power of unit {number} at its limit of thrust, for the estimate only; 0: not known, counts as none"
    return {"full_power": quantity(0.0, "W", about, "not known", minimum=0.0)}


@dataclass(frozen=True, kw_only=True)
class FullPowers(numbered_units(_fields)):
    """Power of the units at their limits of thrust."""

    @property
    def largest(self):
        """Full power of all units, in their order. [W]"""
        return self.of_units("full_power")


class NumberedRequest(LoadRequest):
    """Inputs: the requested load, and which of up to six units can be used."""

    available_1 = Input("1", "unit 1 can be used", start=True, optional=True)
    available_2 = Input("1", "unit 2 can be used", start=True, optional=True)
    available_3 = Input("1", "unit 3 can be used", start=True, optional=True)
    available_4 = Input("1", "unit 4 can be used", start=True, optional=True)
    available_5 = Input("1", "unit 5 can be used", start=True, optional=True)
    available_6 = Input("1", "unit 6 can be used", start=True, optional=True)

    AVAILABLE = tuple(f"available_{number}" for number in range(1, UNITS + 1))


class NumberedThrusters(NumberedRequest):
    """Variables of up to six units."""

    thrust_cmd_1 = Output("N", "commanded thrust of unit 1")
    azimuth_cmd_1 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_2 = Output("N", "commanded thrust of unit 2")
    azimuth_cmd_2 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_3 = Output("N", "commanded thrust of unit 3")
    azimuth_cmd_3 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_4 = Output("N", "commanded thrust of unit 4")
    azimuth_cmd_4 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_5 = Output("N", "commanded thrust of unit 5")
    azimuth_cmd_5 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_6 = Output("N", "commanded thrust of unit 6")
    azimuth_cmd_6 = Output("rad", "its direction, clockwise from the bow")


class NumberedAllocator(ThrustAllocator, NumberedThrusters):
    """Variables of every allocator of up to six units. See docs/allocation.md.

    An FMU of a law declares two things: ``model = Parameters(...)``, with the fields of `FixedAngleParameters` and what
    the law needs beside, and ``law``, a module with three functions:

    - ``design(parameters)``: what is computed once,
    - ``at_rest(tau, *, parameters)``: the state at the start,
    - ``step(state, tau, available, h, *, parameters, design)``: the next state.

    The state has the fields of `models.allocation.units.Allocated`. ``turns = False`` where no law of the FMU turns a
    unit: its places and directions must then give all three loads.
    """

    power = Parameters(FullPowers)

    THRUST_CMD = tuple(f"thrust_cmd_{number}" for number in range(1, UNITS + 1))
    AZIMUTH_CMD = tuple(f"azimuth_cmd_{number}" for number in range(1, UNITS + 1))
    turns: ClassVar[bool] = True
