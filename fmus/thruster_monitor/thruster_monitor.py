"""FMU of the monitor of thrusters and of the ship's place."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.allocation.monitor import MonitorParameters, alarms, at_rest, deviation, step
from shipcosim.models.core.sampling import samples_due


class ThrusterMonitor(Fmu):
    """Compares command and feedback of the thrusters, stops those that are faulty, and watches the ship's place."""

    port_thrust_cmd = Input("N", "commanded thrust of the port azimuth")
    port_thrust_feedback = Input("N", "reported thrust of the port azimuth")
    port_azimuth_cmd = Input("rad", "commanded angle of the port azimuth, clockwise from the bow")
    port_azimuth_feedback = Input(
        "rad", "reported angle of the port azimuth, clockwise from the bow"
    )
    port_available = Input("1", "port azimuth runs", start=True)
    starboard_thrust_cmd = Input("N", "commanded thrust of the starboard azimuth")
    starboard_thrust_feedback = Input("N", "reported thrust of the starboard azimuth")
    starboard_azimuth_cmd = Input(
        "rad", "commanded angle of the starboard azimuth, clockwise from the bow"
    )
    starboard_azimuth_feedback = Input(
        "rad", "reported angle of the starboard azimuth, clockwise from the bow"
    )
    starboard_available = Input("1", "starboard azimuth runs", start=True)
    tunnel_thrust_cmd = Input("N", "commanded thrust of the tunnel thruster")
    tunnel_thrust_feedback = Input("N", "reported thrust of the tunnel thruster")
    tunnel_available = Input("1", "tunnel thruster runs", start=True)
    position_error = Input("m", "distance of the estimated ship from the reference")
    heading_error = Input("rad", "estimated heading less the reference")
    tau_X_bias = Input(
        "N", "estimated force forward that neither thrust nor measured wind explains"
    )
    tau_Y_bias = Input(
        "N", "estimated force to starboard that neither thrust nor measured wind explains"
    )

    port_faulty = Output("1", "port azimuth does not do what is commanded; stays so", start=False)
    starboard_faulty = Output(
        "1", "starboard azimuth does not do what is commanded; stays so", start=False
    )
    tunnel_faulty = Output(
        "1", "tunnel thruster does not do what is commanded; stays so", start=False
    )
    port_deviation = Output(
        "1", "port azimuth's feedback less its command, over the tolerance: above 1 is beyond it"
    )
    starboard_deviation = Output("1", "the same of the starboard azimuth")
    tunnel_deviation = Output("1", "the same of the tunnel thruster")
    position_alarm = Output("1", "the ship has left her place", start=False)
    heading_alarm = Output("1", "the ship has left her heading", start=False)
    force_alarm = Output("1", "the unexplained force is larger than weather gives", start=False)

    monitor = Parameters(MonitorParameters)

    def start(self):
        self.looked = samples_due(self.start_time, self.monitor.monitor_period) - 1
        self._show(at_rest())

    def step(self, t, h):
        due = samples_due(t, self.monitor.monitor_period)
        if self.looked < due:
            since = (due - self.looked) * self.monitor.monitor_period
            self.looked = due
            self._look(since)

    def _look(self, h):
        available = (self.port_available, self.starboard_available, self.tunnel_available)
        errors = (self.position_error, self.heading_error)
        bias = (self.tau_X_bias, self.tau_Y_bias)
        self._show(
            step(
                self.state, self._deviations(), available, errors, bias, h, parameters=self.monitor
            )
        )

    def _deviations(self):
        limits = self.monitor
        azimuth = {
            "thrust_tolerance": limits.azimuth_thrust_tolerance,
            "azimuth_tolerance": limits.azimuth_tolerance,
        }
        self.port_deviation = deviation(
            (self.port_thrust_cmd, self.port_thrust_feedback),
            (self.port_azimuth_cmd, self.port_azimuth_feedback),
            **azimuth,
        )
        self.starboard_deviation = deviation(
            (self.starboard_thrust_cmd, self.starboard_thrust_feedback),
            (self.starboard_azimuth_cmd, self.starboard_azimuth_feedback),
            **azimuth,
        )
        self.tunnel_deviation = deviation(
            (self.tunnel_thrust_cmd, self.tunnel_thrust_feedback),
            thrust_tolerance=limits.tunnel_thrust_tolerance,
            azimuth_tolerance=limits.azimuth_tolerance,
        )
        return self.port_deviation, self.starboard_deviation, self.tunnel_deviation

    def _show(self, state):
        self.state = state
        found = alarms(state, parameters=self.monitor)
        self.port_faulty, self.starboard_faulty, self.tunnel_faulty = found[:3]
        self.position_alarm, self.heading_alarm, self.force_alarm = found[3:]
