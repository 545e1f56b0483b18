"""FMU of the DP controller: voting on the sensors, observer and control law."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.control import observer, voting
from shipcosim.models.control import pid as control
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import choose, number
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.mast import MastParameters
from shipcosim.models.ship.sensor_messages import Fix, Heading, Telegrams, Wind


class DpController(Fmu):
    """Voting on sensors, observer with wave filter, and nonlinear PID with feedforward of reference and wind."""

    x_1_meas = Input("m", "north position by reference 1")
    y_1_meas = Input("m", "east position by reference 1")
    u_1_meas = Input("m/s", "surge velocity over ground by reference 1")
    v_1_meas = Input("m/s", "sway velocity over ground by reference 1")
    position_1_valid = Input("1", "reference 1 says that it works", start=True)
    x_2_meas = Input("m", "north position by reference 2")
    y_2_meas = Input("m", "east position by reference 2")
    u_2_meas = Input("m/s", "surge velocity over ground by reference 2")
    v_2_meas = Input("m/s", "sway velocity over ground by reference 2")
    position_2_valid = Input("1", "reference 2 says that it works", start=True)
    x_3_meas = Input("m", "north position by reference 3")
    y_3_meas = Input("m", "east position by reference 3")
    u_3_meas = Input("m/s", "surge velocity over ground by reference 3")
    v_3_meas = Input("m/s", "sway velocity over ground by reference 3")
    position_3_valid = Input("1", "reference 3 says that it works", start=True)
    psi_1_meas = Input("rad", "heading by compass 1, clockwise from north")
    compass_1_valid = Input("1", "compass 1 says that it works", start=True)
    psi_2_meas = Input("rad", "heading by compass 2, clockwise from north")
    compass_2_valid = Input("1", "compass 2 says that it works", start=True)
    r_meas = Input("rad/s", "yaw rate by the rate gyro")
    wind_speed_meas = Input("m/s", "apparent wind speed at the mast")
    wind_from_meas = Input(
        "rad", "direction of the apparent wind at the mast, clockwise from the bow"
    )
    wind_valid = Input("1", "the anemometer says that it works", start=True)
    position_time_meas = Input("s", "time at which positions and velocities were sampled")
    heading_time_meas = Input("s", "time at which headings and yaw rate were sampled")
    wind_time_meas = Input("s", "time at which the wind was sampled")
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
    tau_X_bias = Output(
        "N", "estimated force forward that neither thrust nor measured wind explains"
    )
    tau_Y_bias = Output(
        "N", "estimated force to starboard that neither thrust nor measured wind explains"
    )
    tau_N_bias = Output(
        "N.m", "estimated yaw moment that neither thrust nor measured wind explains"
    )
    wave_frequency_hat = Output("rad/s", "frequency that the wave filter has adapted to")
    position_error = Output("m", "distance of the estimated ship from the reference")
    heading_error = Output("rad", "estimated heading less the reference")
    dead_reckoning_time = Output("s", "time since the last trusted position; 0 while there is one")
    positions_used = Output("1", "position references in use", start=3)
    compasses_used = Output("1", "compasses in use", start=2)
    position_1_rejected = Output(
        "1", "reference 1 says that it works and is not believed", start=False
    )
    position_2_rejected = Output(
        "1", "reference 2 says that it works and is not believed", start=False
    )
    position_3_rejected = Output(
        "1", "reference 3 says that it works and is not believed", start=False
    )
    compass_1_rejected = Output(
        "1", "compass 1 says that it works and is not believed", start=False
    )
    compass_2_rejected = Output(
        "1", "compass 2 says that it works and is not believed", start=False
    )
    wind_rejected = Output(
        "1", "the anemometer is lost or not believed: the wind is not fed forward", start=False
    )

    ship = Parameters(observer.DpShip)
    noise = Parameters(observer.ObserverParameters)
    law = Parameters(control.ControlParameters)
    wind = Parameters(WindParameters)
    mast = Parameters(MastParameters)
    limits = Parameters(voting.VotingParameters)

    def start(self):
        self.design = observer.design(self.ship, self.noise)
        self.taken = samples_due(self.start_time, self.noise.sample_period) - 1
        given = self._telegrams(self._fixes())
        self.voting = voting.start(self.start_time, given, mast=self.mast, wind=self.wind)
        estimate = observer.at_rest(voting.measurement(self.voting).motion, parameters=self.noise)
        self._show(estimate, control.at_rest(self.voting.wind.load))
        self._say(self.start_time)

    def step(self, t, h):
        due = samples_due(t, self.noise.sample_period)
        self.repeat(lambda: self.taken < due, self._sample)

    def _sample(self):
        t = self.taken * self.noise.sample_period
        self.taken += 1
        allocated = (self.tau_X_allocated, self.tau_Y_allocated, self.tau_N_allocated)
        period = self.noise.sample_period
        fixes = choose(
            self.position_time_meas > self.voting.position_time,
            self._fixes,
            lambda: self.voting.positions.fixes,
        )
        self.voting, estimate = voting.step(
            t,
            self.voting,
            self._telegrams(fixes),
            self.estimate,
            parameters=self.limits,
            mast=self.mast,
            wind=self.wind,
        )
        estimate = observer.step(
            estimate,
            voting.measurement(self.voting),
            control.known_load(self.state, allocated),
            ship=self.ship,
            parameters=self.noise,
            design=self.design,
        )
        state = control.step(
            self.state,
            estimate,
            self._desired(),
            self.voting.wind.load,
            period,
            ship=self.ship,
            parameters=self.law,
        )
        self._show(estimate, state)
        self._say(t)

    def _fixes(self):
        return (
            Fix(
                self.x_1_meas,
                self.y_1_meas,
                self.u_1_meas,
                self.v_1_meas,
                number(self.position_1_valid),
            ),
            Fix(
                self.x_2_meas,
                self.y_2_meas,
                self.u_2_meas,
                self.v_2_meas,
                number(self.position_2_valid),
            ),
            Fix(
                self.x_3_meas,
                self.y_3_meas,
                self.u_3_meas,
                self.v_3_meas,
                number(self.position_3_valid),
            ),
        )

    def _telegrams(self, fixes):
        return Telegrams(
            fixes,
            (
                Heading(self.psi_1_meas, number(self.compass_1_valid)),
                Heading(self.psi_2_meas, number(self.compass_2_valid)),
            ),
            self.r_meas,
            Wind(self.wind_speed_meas, self.wind_from_meas, number(self.wind_valid)),
            self.position_time_meas,
            self.heading_time_meas,
            self.wind_time_meas,
        )

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

    def _show(self, estimate, state):
        self.estimate = estimate
        self.state = state
        self.tau_X_cmd = state.tau_X
        self.tau_Y_cmd = state.tau_Y
        self.tau_N_cmd = state.tau_N
        self.x_hat = estimate.x
        self.y_hat = estimate.y
        self.psi_hat = wrap(estimate.psi)
        self.u_hat = estimate.u
        self.v_hat = estimate.v
        self.r_hat = estimate.r
        self.tau_X_bias, self.tau_Y_bias = to_body(
            estimate.psi, estimate.bias_north, estimate.bias_east
        )
        self.tau_N_bias = estimate.bias_N
        self.wave_frequency_hat = estimate.wave_frequency
        self.position_error, self.heading_error = control.errors(estimate, self._desired())

    def _say(self, t):
        """Outputs on which sensors are believed."""
        positions = self.voting.positions
        compasses = self.voting.compasses
        self.dead_reckoning_time = voting.dead_reckoning_time(
            t, self.voting, parameters=self.limits
        )
        (one, two) = compasses.used
        (first, second) = compasses.headings
        self.compasses_used = round(one + two)
        self.compass_1_rejected = first.valid > one
        self.compass_2_rejected = second.valid > two
        if self.voting.position_new:
            self.positions_used = round(sum(positions.used))
            self.position_1_rejected, self.position_2_rejected, self.position_3_rejected = (
                fix.valid > used for fix, used in zip(positions.fixes, positions.used, strict=True)
            )
        self.wind_rejected = self.voting.wind.wind.valid < 0.5
