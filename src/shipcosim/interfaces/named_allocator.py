"""Interface of the allocators of two azimuth thrusters and a tunnel thruster, by their names."""

from typing import Any, ClassVar

from shipcosim.fmi import Input, Output, Parameters
from shipcosim.interfaces.thrust_allocator import LoadRequest, ThrustAllocator
from shipcosim.models.allocation.power import PowerParameters, granted_power, thrust_shares
from shipcosim.models.core.maths import choose, minimum, where
from shipcosim.models.core.motion import Load
from shipcosim.models.propulsion.failures import PLENTY


class NamedThrusters(LoadRequest):
    """Variables of two azimuths and a tunnel."""

    port_available = Input("1", "port azimuth can be used", start=True)
    starboard_available = Input("1", "starboard azimuth can be used", start=True)
    tunnel_available = Input("1", "tunnel thruster can be used", start=True)

    bus_a_power = Input(
        "W",
        "power that bus A has for thrusters; without any its units count as missing",
        start=PLENTY,
        optional=True,
    )
    bus_b_power = Input(
        "W",
        "power that bus B has for thrusters; without any its units count as missing",
        start=PLENTY,
        optional=True,
    )
    port_power = Input("W", "power that the port azimuth takes")
    starboard_power = Input("W", "power that the starboard azimuth takes")
    tunnel_power = Input("W", "power that the tunnel thruster takes")
    port_azimuth_feedback = Input(
        "rad", "angle of the port azimuth; a law that turns it starts from there"
    )
    starboard_azimuth_feedback = Input(
        "rad", "angle of the starboard azimuth; a law that turns it starts from there"
    )

    port_thrust_cmd = Output("N", "commanded thrust of the port azimuth")
    port_azimuth_cmd = Output("rad", "commanded angle of the port azimuth, clockwise from the bow")
    starboard_thrust_cmd = Output("N", "commanded thrust of the starboard azimuth")
    starboard_azimuth_cmd = Output(
        "rad", "commanded angle of the starboard azimuth, clockwise from the bow"
    )
    tunnel_thrust_cmd = Output(
        "N", "commanded thrust of the tunnel thruster, positive to starboard"
    )


class NamedAllocator(ThrustAllocator, NamedThrusters):
    """Variables of every allocator of two azimuths and a tunnel, and the power of two buses. See docs/allocation.md.

    An FMU of a law declares two things: ``model = Parameters(...)``, with the fields of `NamedUnits` and what the law
    needs beside, and ``law``, a module with three functions:

    - ``design(parameters)``: what is computed once,
    - ``at_rest(tau, *, parameters)``: the state at the start,
    - ``step(state, tau, available, h, *, parameters, design, shares)``: the next state. `shares` are the parts of their
      limits of thrust that power leaves to port, starboard and tunnel.

    The state has the fields of `models.allocation.units.Allocated`. With ``turns = True`` the first commands have the
    angles that the units have, so that the units can follow.
    """

    port_power_limit = Output("W", "power granted to the port azimuth", start=PLENTY)
    starboard_power_limit = Output("W", "power granted to the starboard azimuth", start=PLENTY)
    tunnel_power_limit = Output("W", "power granted to the tunnel thruster", start=PLENTY)
    bus_a_load = Output("W", "power that the thrusters of bus A take")
    bus_b_load = Output("W", "power that the thrusters of bus B take")

    power = Parameters(PowerParameters)

    AVAILABLE = ("port_available", "starboard_available", "tunnel_available")
    THRUST_CMD = ("port_thrust_cmd", "starboard_thrust_cmd", "tunnel_thrust_cmd")
    AZIMUTH_CMD = ("port_azimuth_cmd", "starboard_azimuth_cmd")
    FIXED = (2,)
    turns: ClassVar[bool] = False

    def _usable(self) -> tuple[tuple, dict[str, Any]]:
        """A unit that is available and has any power can be used, within the share that power leaves of its thrust."""
        buses = (self.bus_a_power, self.bus_b_power)

        def limited():
            granted = granted_power(self.used, buses, parameters=self.power)
            return granted, thrust_shares(granted, parameters=self.power)

        granted, shares = choose(
            minimum(*buses) < PLENTY, limited, lambda: ((PLENTY,) * 3, (1.0, 1.0, 1.0))
        )
        self.port_power_limit, self.starboard_power_limit, self.tunnel_power_limit = granted
        taken = zip(
            (self.port_power, self.starboard_power, self.tunnel_power),
            self.power.buses,
            strict=True,
        )
        self.bus_a_load = self.bus_b_load = 0.0
        for power, bus in taken:
            self.bus_a_load += where(bus < 0.5, power, 0.0)
            self.bus_b_load += where(bus < 0.5, 0.0, power)
        available, _ = super()._usable()
        live = tuple(on & (power > 0.0) for on, power in zip(available, granted, strict=True))
        return live, {"shares": shares}

    def at_rest(self, tau: Load) -> Any:
        """State at the start; a law that turns units starts from the angles that they have."""
        state = super().at_rest(tau)
        if not self.turns:
            return state
        angles = self.port_azimuth_feedback, self.starboard_azimuth_feedback
        return state._replace(azimuths=(*angles, *state.azimuths[2:]))
