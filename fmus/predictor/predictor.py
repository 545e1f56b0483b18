"""FMU that predicts the ship by dead reckoning, from what the ship knows."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction.dead_reckoning import predict
from shipcosim.models.prediction.known import Known
from shipcosim.models.prediction.surroundings import SurroundingsParameters, step, unknown
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters, wind_from_mast

HORIZONS = (10.0, 30.0, 60.0)  # s, as the outputs are named


class Predictor(Fmu):
    """Position and heading in 10, 30 and 60 s, with thrust, wind, current and remaining force as she knows them."""

    x_hat = Input("m", "estimated north position")
    y_hat = Input("m", "estimated east position")
    psi_hat = Input("rad", "estimated heading, clockwise from north")
    u_hat = Input("m/s", "estimated surge velocity over ground")
    v_hat = Input("m/s", "estimated sway velocity over ground")
    r_hat = Input("rad/s", "estimated yaw rate")
    tau_X_bias = Input("N", "estimated force forward that neither thrust nor measured wind explains")
    tau_Y_bias = Input("N", "estimated force to starboard that neither thrust nor measured wind explains")
    tau_N_bias = Input("N.m", "estimated yaw moment that neither thrust nor measured wind explains")
    tau_X_allocated = Input("N", "force forward that the allocator's commands give")
    tau_Y_allocated = Input("N", "force to starboard that the allocator's commands give")
    tau_N_allocated = Input("N.m", "yaw moment that the allocator's commands give")
    wind_speed_meas = Input("m/s", "measured apparent wind speed at the mast")
    wind_from_meas = Input("rad", "measured direction of the apparent wind at the mast, clockwise from the bow")
    wind_rejected = Input("1", "the anemometer is lost or not believed: the bias has the wind's load", start=False)

    x_10 = Output("m", "north position in 10 s")
    y_10 = Output("m", "east position in 10 s")
    psi_10 = Output("rad", "heading in 10 s")
    x_30 = Output("m", "north position in 30 s")
    y_30 = Output("m", "east position in 30 s")
    psi_30 = Output("rad", "heading in 30 s")
    x_60 = Output("m", "north position in 60 s")
    y_60 = Output("m", "east position in 60 s")
    psi_60 = Output("rad", "heading in 60 s")
    wind_north = Output("m/s", "mean velocity of the air towards north, as estimated")
    wind_east = Output("m/s", "mean velocity of the air towards east, as estimated")
    current_north = Output("m/s", "velocity of the water towards north, as estimated")
    current_east = Output("m/s", "velocity of the water towards east, as estimated")
    force_north = Output("N", "force towards north that current, wind and thrust do not explain")
    force_east = Output("N", "force towards east that current, wind and thrust do not explain")
    moment = Output("N.m", "yaw moment that current, wind and thrust do not explain")

    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    mast = Parameters(MastParameters)
    ship = Parameters(DpShip)
    assumed = Parameters(SurroundingsParameters)
    prediction_period = Parameter(1.0, "s", "time between predictions", minimum=0.01)
    longest_step = Parameter(2.0, "s", "longest step of the integration", minimum=0.01)

    def start(self):
        self.made = samples_due(self.start_time, self.prediction_period)
        known = self._known()
        self._show(known, unknown(known, parameters=self.assumed))

    def step(self, t, h):
        due = samples_due(t, self.prediction_period)
        if self.made < due:
            known, since = self._known(), (due - self.made) * self.prediction_period
            self.made = due
            self._show(
                known,
                step(
                    self.surroundings,
                    known,
                    since,
                    hull=self.hull,
                    wind=self.wind,
                    ship=self.ship,
                    parameters=self.assumed,
                ),
            )

    def _known(self):
        ship = Motion(self.x_hat, self.y_hat, self.psi_hat, self.u_hat, self.v_hat, self.r_hat)
        return Known(
            ship,
            (self.tau_X_bias, self.tau_Y_bias, self.tau_N_bias),
            (self.tau_X_allocated, self.tau_Y_allocated, self.tau_N_allocated),
            *wind_from_mast(self.wind_speed_meas, self.wind_from_meas, ship.u, ship.v, ship.r, mast=self.mast),
            1.0 - self.wind_rejected,
        )

    def _show(self, known, surroundings):
        at_10, at_30, at_60 = predict(
            known, surroundings, horizons=HORIZONS, longest_step=self.longest_step, hull=self.hull, wind=self.wind
        )
        self.x_10, self.y_10, self.psi_10 = at_10[:3]
        self.x_30, self.y_30, self.psi_30 = at_30[:3]
        self.x_60, self.y_60, self.psi_60 = at_60[:3]
        self.surroundings = surroundings
        self.wind_north, self.wind_east, self.current_north, self.current_east = surroundings[:4]
        self.force_north, self.force_east, self.moment = surroundings[4:7]
