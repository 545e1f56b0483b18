"""FMU of the instruments: measured motion with their errors and lag."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.ship.instruments import (
    InstrumentParameters,
    history_with,
    motion_at,
    readings,
)


class Instruments(Fmu):
    """Compass, antenna and speed log that are not as assumed, and late: what a log shows of a ship."""

    x = Input("m", "position north")
    y = Input("m", "position east")
    psi = Input("rad", "heading, clockwise from north")
    u = Input("m/s", "velocity forward over ground")
    v = Input("m/s", "velocity to starboard over ground")
    r = Input("rad/s", "yaw rate")

    x_meas = Output("m", "position north of the antenna")
    y_meas = Output("m", "position east of the antenna")
    psi_meas = Output("rad", "measured heading, clockwise from north")
    u_meas = Output("m/s", "velocity of the antenna over ground along the measured heading")
    v_meas = Output(
        "m/s", "velocity of the antenna over ground, 90 deg to starboard of the measured heading"
    )
    r_meas = Output("rad/s", "measured yaw rate")

    errors = Parameters(InstrumentParameters)

    def start(self):
        self.history = ((self.start_time, self._readings()),)
        self._write(self.start_time)

    def step(self, t, h):
        then = t + h - self.errors.lag
        self.history = history_with(self.history, t, self._readings(), then)
        self._write(then)

    def _readings(self):
        e = self.errors
        return readings(
            *(self.x, self.y, self.psi, self.u, self.v, self.r),
            heading_bias=e.heading_bias,
            lever_x=e.lever_x,
            lever_y=e.lever_y,
            velocity_scale=e.velocity_scale,
        )

    def _write(self, t):
        measured = motion_at(self.history, t)
        self.x_meas, self.y_meas, self.psi_meas, self.u_meas, self.v_meas, self.r_meas = measured
