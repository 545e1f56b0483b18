"""FMU of a thruster by a measured map."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.propulsion.mapped import (
    MapParameters,
    commanded,
    mapped_command,
    mapped_loads,
    mapped_step,
    mapped_thrust,
    within_map,
)


class MappedThruster(Fmu):
    """Thruster whose thrust over its command was measured, with a lag and a loss under way."""

    thrust_cmd = Input("N", "commanded thrust, positive in the thruster's direction")
    command_in = Input("1", "command of a replay, in the unit of the map", optional=True)
    u_r = Input("m/s", "ship's velocity forward through the water")
    v_r = Input("m/s", "ship's velocity to starboard through the water")
    r = Input("rad/s", "ship's yaw rate")
    failed = Input("1", "without power: no thrust is wanted", start=False, optional=True)

    thrust = Output("N", "delivered thrust, positive in the thruster's direction")
    command = Output("1", "command in the unit of the map, within its rate")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    available = Output("1", "has not failed", start=True)

    replay = Parameter(False, "1", "the thrust follows command_in through the map, not thrust_cmd")
    thruster = Parameters(MapParameters)

    def start(self):
        self.command = (
            self.command_in if self.replay else mapped_command(0.0, thruster=self.thruster)
        )
        self.at_no_speed = (
            mapped_thrust(self.command, thruster=self.thruster) if self.replay else 0.0
        )
        self._push()

    def step(self, t, h):
        wanted = self._wanted()
        asked = (
            self.command_in
            if self.replay and not self.failed
            else mapped_command(wanted, thruster=self.thruster)
        )
        self.command = commanded(self.command, asked, h, thruster=self.thruster)
        if self.thruster.command_rate > 0.0:
            wanted = mapped_thrust(self.command, thruster=self.thruster)
        self.at_no_speed = mapped_step(self.at_no_speed, wanted, h, thruster=self.thruster)
        self._push()

    def _wanted(self):
        """Thrust that is wanted at no speed, whatever the rate."""
        if self.failed:
            return 0.0
        if self.replay:
            return mapped_thrust(self.command_in, thruster=self.thruster)
        return within_map(self.thrust_cmd, thruster=self.thruster)

    def _push(self):
        loads = mapped_loads(self.at_no_speed, self.u_r, self.v_r, self.r, thruster=self.thruster)
        self.thrust, _, self.tau_X, self.tau_Y, self.tau_N = loads
        self.available = not self.failed
