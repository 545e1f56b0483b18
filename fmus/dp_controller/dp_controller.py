"""FMU of the DP controller: observer and control law."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.control import observer
from shipcosim.models.control import pid as control
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads


class DpController(Fmu):
    """Observer with wave filter, and nonlinear PID with feedforward of reference and wind."""

    x_meas = Input("m", "measured north position")
    y_meas = Input("m", "measured east position")
    psi_meas = Input("rad", "measured heading, clockwise from north")
    u_meas = Input("m/s", "measured surge velocity over ground")
    v_meas = Input("m/s", "measured sway velocity over ground")
    r_meas = Input("rad/s", "measured yaw rate")
    wind_speed_meas = Input("m/s", "measured apparent wind speed")
    wind_from_meas = Input("rad", "measured direction of the apparent wind, clockwise from the bow")
    x_d = Input("m", "desired north position")
    y_d = Input("m", "desired east position")
    psi_d = Input("rad", "desired heading, clockwise from north")
    x_d_dot = Input("m/s", "desired velocity north")
    y_d_dot = Input("m/s", "desired velocity east")
    r_d = Input("rad/s", "desired yaw rate")
    x_d_ddot = Input("m/s2", "desired acceleration north")
    y_d_ddot = Input("m/s2", "desired acceleration east")
    r_d_dot = Input("rad/s2", "desired yaw acceleration")
    tau_X_allocated = Input("N", "force forward that the allocator's commands give")
    tau_Y_allocated = Input("N", "force to starboard that the allocator's commands give")
    tau_N_allocated = Input("N.m", "yaw moment that the allocator's commands give")

    tau_X_cmd = Output("N", "requested force forward")
    tau_Y_cmd = Output("N", "requested force to starboard")
    tau_N_cmd = Output("N.m", "requested yaw moment")
    x_hat = Output("m", "estimated north position of the low-frequency ship")
    y_hat = Output("m", "estimated east position of the low-frequency ship")
    psi_hat = Output("rad", "estimated heading of the low-frequency ship, clockwise from north")
    u_hat = Output("m/s", "estimated surge velocity over ground")
    v_hat = Output("m/s", "estimated sway velocity over ground")
    r_hat = Output("rad/s", "estimated yaw rate")
    tau_X_bias = Output("N", "estimated force forward that neither thrust nor measured wind explains")
    tau_Y_bias = Output("N", "estimated force to starboard that neither thrust nor measured wind explains")
    tau_N_bias = Output("N.m", "estimated yaw moment that neither thrust nor measured wind explains")
    position_error = Output("m", "distance of the estimated ship from the reference")
    heading_error = Output("rad", "estimated heading less the reference")

    ship = Parameters(observer.DpShip)
    noise = Parameters(observer.ObserverParameters)
    law = Parameters(control.ControlParameters)
    wind = Parameters(WindParameters)

    def start(self):
        self.design = observer.design(self.ship, self.noise)
        self.taken = samples_due(self.start_time, self.noise.sample_period) - 1
        self._show(observer.at_rest(self._measured()), control.at_rest(self._wind_load()))

    def step(self, t, h):
        due = samples_due(t, self.noise.sample_period)
        while self.taken < due:
            self._sample()
            self.taken += 1

    def _sample(self):
        allocated = (self.tau_X_allocated, self.tau_Y_allocated, self.tau_N_allocated)
        estimate = observer.step(
            self.estimate,
            observer.Measurement(self._measured()),
            control.known_load(self.state, allocated),
            ship=self.ship,
            parameters=self.noise,
            design=self.design,
        )
        state = control.step(
            self.state,
            estimate,
            self._desired(),
            allocated,
            self._wind_load(),
            self.noise.sample_period,
            ship=self.ship,
            parameters=self.law,
        )
        self._show(estimate, state)

    def _measured(self):
        return Motion(self.x_meas, self.y_meas, self.psi_meas, self.u_meas, self.v_meas, self.r_meas)

    def _desired(self):
        return control.Desired(
            self.x_d,
            self.y_d,
            self.psi_d,
            self.x_d_dot,
            self.y_d_dot,
            self.r_d,
            self.x_d_ddot,
            self.y_d_ddot,
            self.r_d_dot,
        )

    def _wind_load(self):
        return wind_loads(self.wind_speed_meas, self.wind_from_meas, wind=self.wind)

    def _show(self, estimate, state):
        self.estimate, self.state = estimate, state
        self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd = state.tau_X, state.tau_Y, state.tau_N
        self.x_hat, self.y_hat, self.psi_hat = estimate.x, estimate.y, wrap(estimate.psi)
        self.u_hat, self.v_hat, self.r_hat = estimate.u, estimate.v, estimate.r
        self.tau_X_bias, self.tau_Y_bias = to_body(estimate.psi, estimate.bias_north, estimate.bias_east)
        self.tau_N_bias = estimate.bias_N
        self.position_error, self.heading_error = control.errors(estimate, self._desired())
