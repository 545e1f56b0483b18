"""FMU of the ship's sensors."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.ship.sensors import SensorParameters, Truth, start, step


class Sensors(Fmu):
    """Position, heading, velocity and wind as measured: sampled, with drift, noise and bias."""

    x = Input("m", "north position of the low-frequency ship")
    y = Input("m", "east position of the low-frequency ship")
    psi = Input("rad", "heading of the low-frequency ship, clockwise from north")
    u = Input("m/s", "surge velocity over ground")
    v = Input("m/s", "sway velocity over ground")
    r = Input("rad/s", "yaw rate")
    x_wave = Input("m", "first-order wave motion towards north")
    y_wave = Input("m", "first-order wave motion towards east")
    psi_wave = Input("rad", "first-order wave motion in yaw")
    u_wave = Input("m/s", "rate of the first-order motion forward")
    v_wave = Input("m/s", "rate of the first-order motion to starboard")
    r_wave = Input("rad/s", "rate of the first-order motion in yaw")
    apparent_wind_speed = Input("m/s", "wind speed relative to the ship")
    apparent_wind_from = Input("rad", "direction the apparent wind comes from, clockwise from the bow")

    x_meas = Output("m", "measured north position")
    y_meas = Output("m", "measured east position")
    psi_meas = Output("rad", "measured heading, clockwise from north")
    u_meas = Output("m/s", "measured surge velocity over ground")
    v_meas = Output("m/s", "measured sway velocity over ground")
    r_meas = Output("rad/s", "measured yaw rate")
    wind_speed_meas = Output("m/s", "measured apparent wind speed, mean over some seconds")
    wind_from_meas = Output("rad", "measured direction of the apparent wind, clockwise from the bow")

    model = Parameters(SensorParameters)

    def start(self):
        self._show(start(self.start_time, self._truth(), parameters=self.model))

    def step(self, t, h):
        self._show(step(t, self.state, self._truth(), parameters=self.model))

    def _truth(self):
        return Truth(
            self.x + self.x_wave,
            self.y + self.y_wave,
            self.psi + self.psi_wave,
            self.u + self.u_wave,
            self.v + self.v_wave,
            self.r + self.r_wave,
            self.apparent_wind_speed,
            self.apparent_wind_from,
        )

    def _show(self, state):
        self.state = state
        self.x_meas, self.y_meas, self.psi_meas, self.u_meas, self.v_meas, self.r_meas = state.measured[:6]
        self.wind_speed_meas, self.wind_from_meas = state.measured[6:]
