"""FMU that predicts the ship by dead reckoning."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment.wave_loads import drift_table, mean_drift
from shipcosim.models.environment.waves import components
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction.dead_reckoning import predict
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters

HORIZONS = (10.0, 30.0, 60.0)  # s, as the outputs are named


class Predictor(Fmu):
    """Position and heading in 10, 30 and 60 s, with thrust, wind, current and waves as they are now."""

    x_hat = Input("m", "north position")
    y_hat = Input("m", "east position")
    psi_hat = Input("rad", "heading, clockwise from north")
    u_hat = Input("m/s", "surge velocity over ground")
    v_hat = Input("m/s", "sway velocity over ground")
    r_hat = Input("rad/s", "yaw rate")
    tau_thrusters_X = Input("N", "force of all thrusters forward")
    tau_thrusters_Y = Input("N", "force of all thrusters to starboard")
    tau_thrusters_N = Input("N.m", "yaw moment of all thrusters")
    wind_north = Input("m/s", "velocity of the air towards north")
    wind_east = Input("m/s", "velocity of the air towards east")
    current_north = Input("m/s", "velocity of the water towards north")
    current_east = Input("m/s", "velocity of the water towards east")
    wave_height = Input("m", "significant wave height Hs")
    wave_period = Input("s", "peak period Tp of the waves", start=6.0)
    wave_from = Input("rad", "direction the waves come from, clockwise from north")
    wave_peak_enhancement = Input("1", "gamma of the JONSWAP spectrum", start=3.3)
    wave_seed = Input("1", "seed of the waves", start=1)

    x_10 = Output("m", "north position in 10 s")
    y_10 = Output("m", "east position in 10 s")
    psi_10 = Output("rad", "heading in 10 s")
    x_30 = Output("m", "north position in 30 s")
    y_30 = Output("m", "east position in 30 s")
    psi_30 = Output("rad", "heading in 30 s")
    x_60 = Output("m", "north position in 60 s")
    y_60 = Output("m", "east position in 60 s")
    psi_60 = Output("rad", "heading in 60 s")

    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    drift = Parameters(DriftParameters)
    prediction_period = Parameter(1.0, "s", "time between predictions", minimum=0.01)
    longest_step = Parameter(1.0, "s", "longest step of the integration", minimum=0.01)

    def start(self):
        self.made = samples_due(self.start_time, self.prediction_period)
        self._predict()

    def step(self, t, h):
        due = samples_due(t, self.prediction_period)
        if self.made < due:
            self.made = due
            self._predict()

    def _predict(self):
        sea = (self.wave_height, self.wave_period, self.wave_from, self.wave_peak_enhancement, self.wave_seed)
        at_10, at_30, at_60 = predict(
            Motion(self.x_hat, self.y_hat, self.psi_hat, self.u_hat, self.v_hat, self.r_hat),
            (self.tau_thrusters_X, self.tau_thrusters_Y, self.tau_thrusters_N),
            mean_drift(self.psi_hat, components(*sea), drift_table(self.drift.drift_table)),
            (self.wind_north, self.wind_east),
            (self.current_north, self.current_east),
            horizons=HORIZONS,
            longest_step=self.longest_step,
            hull=self.hull,
            wind=self.wind,
        )
        self.x_10, self.y_10, self.psi_10 = at_10[:3]
        self.x_30, self.y_30, self.psi_30 = at_30[:3]
        self.x_60, self.y_60, self.psi_60 = at_60[:3]
