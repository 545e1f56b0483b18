"""FMU of a force of constant direction over the earth."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.environment.earth_fixed_loads import (
    EarthForceParameters,
    OnsetParameters,
    earth_force,
    onset,
)


class EarthForce(Fmu):
    """Line or tether that pulls at one point of the ship in one direction over the earth."""

    psi = Input("rad", "heading, clockwise from north")

    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")

    force = Parameters(EarthForceParameters)
    begin = Parameters(OnsetParameters)

    def start(self):
        self._write(self.start_time)

    def step(self, t, h):
        self._write(t + h)

    def _write(self, t):
        force = self.force
        begin = self.begin
        share = onset(t, onset_time=begin.onset_time, ramp_time=begin.ramp_time)
        self.tau_X, self.tau_Y, self.tau_N = earth_force(
            self.psi, share * force.north, share * force.east, x=force.x, y=force.y
        )
