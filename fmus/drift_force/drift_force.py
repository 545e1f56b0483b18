"""FMU of the mean drift load of waves."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.environment.earth_fixed_loads import (
    DriftForceParameters,
    OnsetParameters,
    drift_force,
    onset,
)


class DriftForce(Fmu):
    """Mean drift of waves that travel in one direction over the earth, given by its size on the beam."""

    psi = Input("rad", "heading, clockwise from north")

    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")

    drift = Parameters(DriftForceParameters)
    begin = Parameters(OnsetParameters)

    def start(self):
        self._write(self.start_time)

    def step(self, t, h):
        self._write(t + h)

    def _write(self, t):
        drift = self.drift
        begin = self.begin
        share = onset(t, onset_time=begin.onset_time, ramp_time=begin.ramp_time)
        law = {
            "surge_share": drift.surge_share,
            "sway_power": drift.sway_power,
            "yaw_arm": drift.yaw_arm,
        }
        self.tau_X, self.tau_Y, self.tau_N = drift_force(
            self.psi, share * drift.north, share * drift.east, **law
        )
