"""FMU of the ship's sensors."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.ship import sensors
from shipcosim.models.ship.mast import MastParameters


class Sensors(Fmu):
    """Three position references, two compasses, a rate gyro and an anemometer: sampled, late, noisy, and failing."""

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
    apparent_wind_speed = Input("m/s", "wind speed relative to the ship at 10 m above her origin")
    apparent_wind_from = Input(
        "rad", "direction the apparent wind comes from, clockwise from the bow"
    )

    position_1_lost = Input("1", "position reference 1 drops out", start=False, optional=True)
    position_1_frozen = Input(
        "1", "position reference 1 repeats its last value", start=False, optional=True
    )
    position_1_north = Input("m", "offset of position reference 1 towards north", optional=True)
    position_1_east = Input("m", "offset of position reference 1 towards east", optional=True)
    position_1_north_rate = Input(
        "m/s", "drift of position reference 1 towards north, from when it is not 0", optional=True
    )
    position_1_east_rate = Input(
        "m/s", "drift of position reference 1 towards east, from when it is not 0", optional=True
    )
    position_2_lost = Input("1", "position reference 2 drops out", start=False, optional=True)
    position_2_frozen = Input(
        "1", "position reference 2 repeats its last value", start=False, optional=True
    )
    position_2_north = Input("m", "offset of position reference 2 towards north", optional=True)
    position_2_east = Input("m", "offset of position reference 2 towards east", optional=True)
    position_2_north_rate = Input(
        "m/s", "drift of position reference 2 towards north, from when it is not 0", optional=True
    )
    position_2_east_rate = Input(
        "m/s", "drift of position reference 2 towards east, from when it is not 0", optional=True
    )
    position_3_lost = Input("1", "position reference 3 drops out", start=False, optional=True)
    position_3_frozen = Input(
        "1", "position reference 3 repeats its last value", start=False, optional=True
    )
    position_3_north = Input("m", "offset of position reference 3 towards north", optional=True)
    position_3_east = Input("m", "offset of position reference 3 towards east", optional=True)
    position_3_north_rate = Input(
        "m/s", "drift of position reference 3 towards north, from when it is not 0", optional=True
    )
    position_3_east_rate = Input(
        "m/s", "drift of position reference 3 towards east, from when it is not 0", optional=True
    )
    compass_1_lost = Input("1", "compass 1 drops out", start=False, optional=True)
    compass_1_frozen = Input("1", "compass 1 repeats its last value", start=False, optional=True)
    compass_1_offset = Input("rad", "offset of compass 1", optional=True)
    compass_1_rate = Input(
        "rad/s", "rate at which compass 1 runs off, from when it is not 0", optional=True
    )
    compass_2_lost = Input("1", "compass 2 drops out", start=False, optional=True)
    compass_2_frozen = Input("1", "compass 2 repeats its last value", start=False, optional=True)
    compass_2_offset = Input("rad", "offset of compass 2", optional=True)
    compass_2_rate = Input(
        "rad/s", "rate at which compass 2 runs off, from when it is not 0", optional=True
    )
    wind_lost = Input("1", "the anemometer drops out", start=False, optional=True)
    wind_frozen = Input("1", "the anemometer sticks to its last value", start=False, optional=True)
    wind_scale = Input("1", "factor on the measured wind speed", start=1.0, optional=True)
    wind_offset = Input("rad", "offset of the measured wind direction", optional=True)

    x_1_meas = Output("m", "north position by reference 1")
    y_1_meas = Output("m", "east position by reference 1")
    u_1_meas = Output("m/s", "surge velocity over ground by reference 1")
    v_1_meas = Output("m/s", "sway velocity over ground by reference 1")
    position_1_valid = Output("1", "reference 1 says that it works", start=True)
    x_2_meas = Output("m", "north position by reference 2")
    y_2_meas = Output("m", "east position by reference 2")
    u_2_meas = Output("m/s", "surge velocity over ground by reference 2")
    v_2_meas = Output("m/s", "sway velocity over ground by reference 2")
    position_2_valid = Output("1", "reference 2 says that it works", start=True)
    x_3_meas = Output("m", "north position by reference 3")
    y_3_meas = Output("m", "east position by reference 3")
    u_3_meas = Output("m/s", "surge velocity over ground by reference 3")
    v_3_meas = Output("m/s", "sway velocity over ground by reference 3")
    position_3_valid = Output("1", "reference 3 says that it works", start=True)
    psi_1_meas = Output("rad", "heading by compass 1, clockwise from north")
    compass_1_valid = Output("1", "compass 1 says that it works", start=True)
    psi_2_meas = Output("rad", "heading by compass 2, clockwise from north")
    compass_2_valid = Output("1", "compass 2 says that it works", start=True)
    r_meas = Output("rad/s", "yaw rate by the rate gyro")
    wind_speed_meas = Output("m/s", "apparent wind speed at the mast, mean over some seconds")
    wind_from_meas = Output(
        "rad", "direction of the apparent wind at the mast, clockwise from the bow"
    )
    wind_valid = Output("1", "the anemometer says that it works", start=True)
    position_time_meas = Output("s", "time at which positions and velocities were sampled")
    heading_time_meas = Output("s", "time at which headings and yaw rate were sampled")
    wind_time_meas = Output("s", "time at which the wind was sampled")

    model = Parameters(sensors.SensorParameters)
    mast = Parameters(MastParameters)

    def start(self):
        failures = self._failures(self._references())
        self._show(
            sensors.start(
                self.start_time, self._truth(), failures, parameters=self.model, mast=self.mast
            )
        )

    def step(self, t, h):
        if self.state.taken < samples_due(t, self.model.period):
            failures = self._failures(self._references())
            self._show(
                sensors.step(
                    t, self.state, self._truth(), failures, parameters=self.model, mast=self.mast
                )
            )

    def _truth(self):
        return sensors.Truth(
            self.x + self.x_wave,
            self.y + self.y_wave,
            self.psi + self.psi_wave,
            self.u + self.u_wave,
            self.v + self.v_wave,
            self.r + self.r_wave,
            self.apparent_wind_speed,
            self.apparent_wind_from,
        )

    def _references(self):
        return (
            sensors.ReferenceFailure(
                self.position_1_lost,
                self.position_1_frozen,
                self.position_1_north,
                self.position_1_east,
                self.position_1_north_rate,
                self.position_1_east_rate,
            ),
            sensors.ReferenceFailure(
                self.position_2_lost,
                self.position_2_frozen,
                self.position_2_north,
                self.position_2_east,
                self.position_2_north_rate,
                self.position_2_east_rate,
            ),
            sensors.ReferenceFailure(
                self.position_3_lost,
                self.position_3_frozen,
                self.position_3_north,
                self.position_3_east,
                self.position_3_north_rate,
                self.position_3_east_rate,
            ),
        )

    def _failures(self, positions):
        compasses = (
            sensors.CompassFailure(
                self.compass_1_lost,
                self.compass_1_frozen,
                self.compass_1_offset,
                self.compass_1_rate,
            ),
            sensors.CompassFailure(
                self.compass_2_lost,
                self.compass_2_frozen,
                self.compass_2_offset,
                self.compass_2_rate,
            ),
        )
        wind = sensors.WindFailure(
            self.wind_lost, self.wind_frozen, self.wind_scale, self.wind_offset
        )
        return sensors.SensorFailures(positions, compasses, wind)

    def _show(self, state):
        self.state = state
        given = state.telegrams
        one, two, three = given.positions
        self.x_1_meas, self.y_1_meas, self.u_1_meas, self.v_1_meas = one[:4]
        self.x_2_meas, self.y_2_meas, self.u_2_meas, self.v_2_meas = two[:4]
        self.x_3_meas, self.y_3_meas, self.u_3_meas, self.v_3_meas = three[:4]
        self.position_1_valid = one.valid > 0.5
        self.position_2_valid = two.valid > 0.5
        self.position_3_valid = three.valid > 0.5
        one, two = given.compasses
        self.psi_1_meas = one.psi
        self.compass_1_valid = one.valid > 0.5
        self.psi_2_meas = two.psi
        self.compass_2_valid = two.valid > 0.5
        self.r_meas = given.r
        self.wind_speed_meas, self.wind_from_meas, self.wind_valid = (
            *given.wind[:2],
            given.wind.valid > 0.5,
        )
        self.position_time_meas, self.heading_time_meas, self.wind_time_meas = given[4:]
