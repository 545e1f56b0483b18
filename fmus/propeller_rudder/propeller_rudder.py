"""FMU of a propeller with a rudder."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.propulsion.rudder import PropellerRudderParameters, propeller_rudder_loads


class PropellerRudder(Fmu):
    """Propeller and the rudder in its race, by the MMG standard method; speed and rudder as given, no drive."""

    rpm_in = Input("rpm", "speed of the shaft, negative astern")
    azimuth_in = Input(
        "rad", "rudder: direction into which it turns the race, positive turns the ship to port"
    )
    u_r = Input("m/s", "ship's velocity forward through the water")
    v_r = Input("m/s", "ship's velocity to starboard through the water")
    r = Input("rad/s", "ship's yaw rate")

    thrust = Output("N", "thrust of the propeller, less its deduction")
    rpm = Output("rpm", "speed of the shaft")
    azimuth = Output("rad", "rudder angle, positive turns the ship to port")
    side_force = Output("N", "side force of the rudder alone, to starboard")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")

    unit = Parameters(PropellerRudderParameters)

    def start(self):
        self._push()

    def step(self, t, h):
        self._push()

    def _push(self):
        loads = propeller_rudder_loads(
            self.rpm_in / 60.0, self.azimuth_in, self.u_r, self.v_r, self.r, unit=self.unit
        )
        self.thrust, self.side_force, self.tau_X, self.tau_Y, self.tau_N = loads
        self.rpm, self.azimuth = self.rpm_in, self.azimuth_in
