"""FMU of the thrust allocator."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters, at_rest, design, step


class Allocator(Fmu):
    """Thrust allocation by generalised inverse: two azimuth thrusters at fixed angles and a tunnel thruster."""

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")
    port_available = Input("1", "port azimuth can be used", start=True)
    starboard_available = Input("1", "starboard azimuth can be used", start=True)
    tunnel_available = Input("1", "tunnel thruster can be used", start=True)

    port_thrust_cmd = Output("N", "commanded thrust of the port azimuth")
    port_azimuth_cmd = Output("rad", "commanded angle of the port azimuth, clockwise from the bow")
    starboard_thrust_cmd = Output("N", "commanded thrust of the starboard azimuth")
    starboard_azimuth_cmd = Output("rad", "commanded angle of the starboard azimuth, clockwise from the bow")
    tunnel_thrust_cmd = Output("N", "commanded thrust of the tunnel thruster, positive to starboard")
    tau_X = Output("N", "force forward that the commands give")
    tau_Y = Output("N", "force to starboard that the commands give")
    tau_N = Output("N.m", "yaw moment that the commands give")
    saturated = Output("1", "limits of thrust or missing units keep the commands from the requested load", start=False)

    model = Parameters(AllocationParameters)

    def start(self):
        self.design = design(self.model)
        self.port_azimuth_cmd = self.model.port_azimuth
        self.starboard_azimuth_cmd = self.model.starboard_azimuth
        self._show(at_rest((self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)))

    def step(self, t, h):
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        available = (self.port_available, self.starboard_available, self.tunnel_available)
        self._show(step(self.state, tau, available, h, parameters=self.model, design=self.design))

    def _show(self, state):
        self.state = state
        self.port_thrust_cmd, self.starboard_thrust_cmd, self.tunnel_thrust_cmd = state[:3]
        self.tau_X, self.tau_Y, self.tau_N, self.saturated = state[3:]
