"""FMU of a thrust allocator of up to six units at fixed directions."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.allocation.fixed_angles import FixedAngleParameters, at_rest, layout, step


class FixedAngleAllocator(Fmu):
    """Thrust allocation by generalised inverse: up to six units, each at a fixed direction."""

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")
    available_1 = Input("1", "unit 1 can be used", start=True)
    available_2 = Input("1", "unit 2 can be used", start=True)
    available_3 = Input("1", "unit 3 can be used", start=True)
    available_4 = Input("1", "unit 4 can be used", start=True)
    available_5 = Input("1", "unit 5 can be used", start=True)
    available_6 = Input("1", "unit 6 can be used", start=True)

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
    tau_X = Output("N", "force forward that the commands give")
    tau_Y = Output("N", "force to starboard that the commands give")
    tau_N = Output("N.m", "yaw moment that the commands give")
    saturated = Output("1", "limits of thrust or missing units keep the commands from the requested load", start=False)

    model = Parameters(FixedAngleParameters)

    def start(self):
        self.design, m = layout(self.model), self.model
        self.azimuth_cmd_1, self.azimuth_cmd_2, self.azimuth_cmd_3 = m.azimuth_1, m.azimuth_2, m.azimuth_3
        self.azimuth_cmd_4, self.azimuth_cmd_5, self.azimuth_cmd_6 = m.azimuth_4, m.azimuth_5, m.azimuth_6
        self._show(at_rest((self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)))

    def step(self, t, h):
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        first = self.available_1, self.available_2, self.available_3
        last = self.available_4, self.available_5, self.available_6
        self._show(step(self.state, tau, first + last, h, parameters=self.model, design=self.design))

    def _show(self, state):
        self.state = state
        self.thrust_cmd_1, self.thrust_cmd_2, self.thrust_cmd_3 = state.thrusts[:3]
        self.thrust_cmd_4, self.thrust_cmd_5, self.thrust_cmd_6 = state.thrusts[3:]
        self.tau_X, self.tau_Y, self.tau_N, self.saturated = state.tau_X, state.tau_Y, state.tau_N, state.saturated
