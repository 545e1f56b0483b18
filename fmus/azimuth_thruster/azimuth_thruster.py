"""FMU of an azimuth thruster with its drive."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.maths import where
from shipcosim.models.propulsion.azimuth import (
    AzimuthParameters,
    azimuth_loads,
    azimuth_replay,
    azimuth_step,
)
from shipcosim.models.propulsion.drive import at_rest, powers
from shipcosim.models.propulsion.failures import PLENTY, Failures


class AzimuthThruster(Fmu):
    """Azimuth thruster: drive, motor, ducted propeller in four quadrants, side force."""

    thrust_cmd = Input("N", "commanded thrust")
    azimuth_cmd = Input("rad", "commanded direction of positive thrust, clockwise from the bow")
    u_r = Input("m/s", "ship's velocity forward through the water")
    v_r = Input("m/s", "ship's velocity to starboard through the water")
    r = Input("rad/s", "ship's yaw rate")
    failed = Input(
        "1", "without power: no motor torque, direction kept", start=False, optional=True
    )
    stop = Input("1", "emergency stop: as failed, by command", start=False, optional=True)
    full_thrust = Input(
        "1",
        "failure: the drive gives its largest thrust ahead, whatever is commanded",
        start=False,
        optional=True,
    )
    rpm_frozen = Input(
        "1", "failure: the drive keeps its last set point of thrust", start=False, optional=True
    )
    azimuth_frozen = Input("1", "failure: the unit keeps its direction", start=False, optional=True)
    rpm_reversed = Input(
        "1", "failure: the measured shaft speed has the wrong sign", start=False, optional=True
    )
    azimuth_reversed = Input(
        "1", "failure: the measured direction has the wrong sign", start=False, optional=True
    )
    rate_share = Input(
        "1",
        "share that is left of the largest rates of thrust and turning",
        start=1.0,
        optional=True,
    )
    power_limit = Input(
        "W", "power that the switchboard grants the motor", start=PLENTY, optional=True
    )
    rpm_in = Input("rpm", "shaft speed of a replay", optional=True)
    azimuth_in = Input(
        "rad", "direction of positive thrust of a replay, clockwise from the bow", optional=True
    )
    neighbour_azimuth = Input(
        "rad",
        "direction of positive thrust of the unit whose slipstream can meet this one",
        optional=True,
    )
    neighbour_rpm = Input("rpm", "shaft speed of that unit", optional=True)
    thrust_share = Input(
        "1",
        "share of the thrust that the slipstreams of other units leave",
        start=1.0,
        optional=True,
    )

    thrust = Output("N", "delivered thrust along the axis")
    side_force = Output("N", "force across the axis, 90 deg clockwise of the thrust")
    azimuth = Output("rad", "direction of positive thrust as given, clockwise from the bow")
    rpm = Output("rpm", "shaft speed, negative astern")
    torque = Output("N.m", "torque of the motor")
    power = Output("W", "power drawn from the grid, negative where it flows back")
    brake_power = Output("W", "braking power of the motor that the brake resistor turns into heat")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    thrust_feedback = Output("N", "thrust that the drive reports, from the measured shaft speed")
    azimuth_feedback = Output("rad", "direction that the steering reports")
    saturated = Output("1", "at a limit of thrust, its rate, or the motor", start=False)
    available = Output("1", "has neither failed nor been stopped", start=True)

    replay = Parameter(
        False,
        "1",
        "shaft speed and direction follow rpm_in and azimuth_in; nothing else acts on them",
    )
    azimuth_start = Parameter(
        0.0, "rad", "direction of positive thrust at the start, clockwise from the bow"
    )
    unit = Parameters(AzimuthParameters)

    def start(self):
        self.state = self._replayed() if self.replay else at_rest(wrap(self.azimuth_start))
        self._write()

    def step(self, t, h):
        if self.replay:
            self.state = self._replayed()
        else:
            command = (self.thrust_cmd, self.azimuth_cmd)
            water = (self.u_r, self.v_r, self.r)
            self.state = azimuth_step(
                self.state, *command, *water, self._failures(), h, unit=self.unit
            )
        reported = (
            self.state.reported
        )  # the propeller's thrust; of a reversed shaft speed with the wrong sign
        self._write(reported if self.replay else where(self.rpm_reversed, -reported, reported))

    def _replayed(self):
        water = self.u_r, self.v_r, self.r
        return azimuth_replay(self.rpm_in / 60.0, wrap(self.azimuth_in), *water, unit=self.unit)

    def _failures(self):
        return Failures(
            self.failed | self.stop,
            self.full_thrust,
            self.rpm_frozen,
            self.azimuth_frozen,
            self.rpm_reversed,
            self.azimuth_reversed,
            self.rate_share,
            self.power_limit,
        )

    def _write(self, propeller_thrust=None):
        state = self.state
        flow = (self.u_r, self.v_r, self.r)
        neighbour = (self.neighbour_azimuth, self.neighbour_rpm)
        known = {"propeller_thrust": propeller_thrust, "thrust_share": self.thrust_share}
        loads = azimuth_loads(state, *flow, *neighbour, unit=self.unit, **known)
        self.thrust, self.side_force, self.tau_X, self.tau_Y, self.tau_N = loads
        self.azimuth = state.azimuth
        self.rpm = 60.0 * state.n
        self.torque = state.torque
        self.power, self.brake_power = powers(state, self.unit)
        self.thrust_feedback = state.reported
        self.azimuth_feedback = where(self.azimuth_reversed, -state.azimuth, state.azimuth)
        self.saturated = state.saturated
        self.available = not (self.failed | self.stop)
