"""FMU of a tunnel thruster with its drive."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.maths import pi
from shipcosim.models.propulsion.drive import at_rest, powers
from shipcosim.models.propulsion.failures import PLENTY, Failures
from shipcosim.models.propulsion.tunnel import (
    TunnelParameters,
    tunnel_loads,
    tunnel_replay,
    tunnel_step,
)


class TunnelThruster(Fmu):
    """Tunnel thruster: drive, motor, propeller, loss of thrust under way."""

    thrust_cmd = Input("N", "commanded thrust, positive to starboard")
    u_r = Input("m/s", "ship's velocity forward through the water")
    failed = Input("1", "without power: no motor torque", start=False, optional=True)
    stop = Input("1", "emergency stop: as failed, by command", start=False, optional=True)
    full_thrust = Input(
        "1",
        "failure: the drive gives its largest thrust to starboard, whatever is commanded",
        start=False,
        optional=True,
    )
    rpm_frozen = Input(
        "1", "failure: the drive keeps its last set point of thrust", start=False, optional=True
    )
    rpm_reversed = Input(
        "1", "failure: the measured motor speed has the wrong sign", start=False, optional=True
    )
    rate_share = Input(
        "1", "share that is left of the largest rate of thrust", start=1.0, optional=True
    )
    power_limit = Input(
        "W", "power that the switchboard grants the motor", start=PLENTY, optional=True
    )
    rpm_in = Input("rpm", "motor speed of a replay", optional=True)

    thrust = Output("N", "delivered thrust, positive to starboard")
    rpm = Output("rpm", "motor speed, positive pushes to starboard")
    torque = Output("N.m", "torque of the motor")
    power = Output("W", "power drawn from the grid, negative where it flows back")
    brake_power = Output("W", "braking power of the motor that the brake resistor turns into heat")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    thrust_feedback = Output("N", "thrust that the drive reports, from the measured motor speed")
    saturated = Output("1", "at a limit of thrust, its rate, or the motor", start=False)
    available = Output("1", "has neither failed nor been stopped", start=True)

    replay = Parameter(False, "1", "motor speed follows rpm_in; nothing else acts on it")
    tunnel = Parameters(TunnelParameters)

    def start(self):
        self.state = self._replayed() if self.replay else at_rest(0.5 * pi)
        self._write()

    def step(self, t, h):
        if self.replay:
            self.state = self._replayed()
        else:
            command = self.thrust_cmd, self.u_r, self._failures()
            self.state = tunnel_step(self.state, *command, h, tunnel=self.tunnel)
        self._write()

    def _replayed(self):
        return tunnel_replay(self.rpm_in / 60.0, tunnel=self.tunnel)

    def _failures(self):
        return Failures(
            self.failed | self.stop,
            self.full_thrust,
            self.rpm_frozen,
            rpm_reversed=self.rpm_reversed,
            rate_share=self.rate_share,
            power_limit=self.power_limit,
        )

    def _write(self):
        state = self.state
        loads = tunnel_loads(state, self.u_r, tunnel=self.tunnel)
        self.thrust, _, self.tau_X, self.tau_Y, self.tau_N = loads
        self.rpm = 60.0 * state.n
        self.torque = state.torque
        self.power, self.brake_power = powers(state, self.tunnel)
        self.thrust_feedback = state.reported
        self.saturated = state.saturated
        self.available = not (self.failed | self.stop)
