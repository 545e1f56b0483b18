"""FMU of a thruster by a measured map."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.propulsion.mapped import MapParameters, mapped_loads, mapped_step, mapped_thrust, within_map


class MappedThruster(Fmu):
    """Thruster whose thrust over its command was measured, with a lag and a loss under way."""

    thrust_cmd = Input("N", "commanded thrust, positive in the thruster's direction")
    command_in = Input("1", "command of a replay, in the unit of the map")
    u_r = Input("m/s", "ship's velocity forward through the water")
    v_r = Input("m/s", "ship's velocity to starboard through the water")
    r = Input("rad/s", "ship's yaw rate")
    failed = Input("1", "without power: no thrust is wanted", start=False)

    thrust = Output("N", "delivered thrust, positive in the thruster's direction")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    available = Output("1", "has not failed", start=True)

    replay = Parameter(False, "1", "the thrust follows command_in through the map, not thrust_cmd")
    thruster = Parameters(MapParameters)

    def start(self):
        self.at_no_speed = self._wanted() if self.replay else 0.0
        self._push()

    def step(self, t, h):
        self.at_no_speed = mapped_step(self.at_no_speed, self._wanted(), h, thruster=self.thruster)
        self._push()

    def _wanted(self):
        if self.failed:
            return 0.0
        if self.replay:
            return mapped_thrust(self.command_in, thruster=self.thruster)
        return within_map(self.thrust_cmd, thruster=self.thruster)

    def _push(self):
        loads = mapped_loads(self.at_no_speed, self.u_r, self.v_r, self.r, thruster=self.thruster)
        self.thrust, _, self.tau_X, self.tau_Y, self.tau_N = loads
        self.available = not self.failed
