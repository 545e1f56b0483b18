"""FMU of a plain DP controller: low-pass filter and PID."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.control.filtered_pid import FilteredPidParameters, at_rest, errors, step
from shipcosim.models.control.pid import Desired
from shipcosim.models.core.maths import hypot


class PidController(Fmu):
    """PID in surge, sway and yaw behind a low-pass filter; it knows no ship, no wind and no limits of thrusters."""

    x_meas = Input("m", "measured north position")
    y_meas = Input("m", "measured east position")
    psi_meas = Input("rad", "measured heading, clockwise from north")
    x_d = Input("m", "desired north position")
    y_d = Input("m", "desired east position")
    psi_d = Input("rad", "desired heading, clockwise from north")
    x_d_dot = Input("m/s", "desired velocity north")
    y_d_dot = Input("m/s", "desired velocity east")
    r_d = Input("rad/s", "desired yaw rate")

    tau_X_cmd = Output("N", "requested force forward")
    tau_Y_cmd = Output("N", "requested force to starboard")
    tau_N_cmd = Output("N.m", "requested yaw moment")
    x_hat = Output("m", "filtered north position")
    y_hat = Output("m", "filtered east position")
    psi_hat = Output("rad", "filtered heading, clockwise from north")
    position_error = Output("m", "distance of the filtered position from the reference")
    heading_error = Output("rad", "filtered heading less the reference")

    law = Parameters(FilteredPidParameters)

    def start(self):
        self._show(at_rest(self.x_meas, self.y_meas, self.psi_meas))

    def step(self, t, h):
        measured = self.x_meas, self.y_meas, self.psi_meas
        self._show(step(self.state, measured, self._desired(), h, parameters=self.law))

    def _desired(self):
        return Desired(
            self.x_d, self.y_d, self.psi_d, self.x_d_dot, self.y_d_dot, self.r_d, 0.0, 0.0, 0.0
        )

    def _show(self, state):
        self.state = state
        self.tau_X_cmd = state.tau_X
        self.tau_Y_cmd = state.tau_Y
        self.tau_N_cmd = state.tau_N
        self.x_hat = state.x
        self.y_hat = state.y
        self.psi_hat = wrap(state.psi)
        surge, sway, yaw = errors(state, self._desired())
        self.position_error = hypot(surge, sway)
        self.heading_error = -yaw
