"""FMU of wind, current and waves."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.core.sampling import tidy_time
from shipcosim.models.environment import waves
from shipcosim.models.environment.weather import (
    EnvironmentParameters,
    EnvironmentState,
    air_velocity,
    step,
    water_velocity,
)


class Environment(Fmu):
    """Wind with gusts, current and waves; the means follow their setpoints at set rates."""

    wind_speed = Input("m/s", "setpoint of the mean wind speed at 10 m", minimum=0.0, optional=True)
    wind_from = Input(
        "rad", "setpoint of the direction the wind comes from, clockwise from north", optional=True
    )
    current_speed = Input("m/s", "setpoint of the current's speed", minimum=0.0, optional=True)
    current_to = Input(
        "rad", "setpoint of the direction the current flows to, clockwise from north", optional=True
    )

    wind_north = Output("m/s", "velocity of the air towards north, gusts included")
    wind_east = Output("m/s", "velocity of the air towards east, gusts included")
    wind_speed_mean = Output("m/s", "mean wind speed at 10 m")
    wind_from_mean = Output("rad", "direction the mean wind comes from, clockwise from north")
    current_north = Output("m/s", "velocity of the water towards north")
    current_east = Output("m/s", "velocity of the water towards east")
    wave_height = Output("m", "significant wave height Hs")
    wave_period = Output("s", "peak period Tp of the waves", start=6.0)
    wave_from = Output("rad", "direction the waves come from, clockwise from north")
    wave_peak_enhancement = Output("1", "gamma of the JONSWAP spectrum", start=3.3)
    wave_seed = Output("1", "seed of the waves", start=1)
    elevation = Output("m", "elevation of the sea at the origin, positive upwards")

    model = Parameters(EnvironmentParameters)

    def start(self):
        self.means = EnvironmentState(
            self.wind_speed, wrap(self.wind_from), self.current_speed, wrap(self.current_to)
        )
        self.wave_height = self.model.significant_wave_height
        self.wave_period = self.model.peak_period
        self.wave_from = self.model.waves_from
        self.wave_seed = self.model.seed
        self.wave_peak_enhancement = self.model.peak_enhancement
        self._write(self.start_time)

    def step(self, t, h):
        setpoints = self.wind_speed, self.wind_from, self.current_speed, self.current_to
        self.means = step(h, self.means, *setpoints, parameters=self.model)
        self._write(tidy_time(t + h))

    def _write(self, t):
        model = self.model
        means = self.means
        self.wind_north, self.wind_east = air_velocity(
            t, means, gust_scale=model.gust_scale, seed=model.seed
        )
        self.current_north, self.current_east = water_velocity(means)
        self.wind_speed_mean = means.wind_speed
        self.wind_from_mean = means.wind_from
        sea = (
            self.wave_height,
            self.wave_period,
            self.wave_from,
            self.wave_peak_enhancement,
            self.wave_seed,
        )
        self.elevation = waves.elevation(t, 0.0, 0.0, waves.components(*sea))
