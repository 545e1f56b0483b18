"""FMU that predicts the ship by dead reckoning, from what the ship knows."""

from shipcosim.fmi import Output, Parameter, Parameters
from shipcosim.interfaces import MotionPredictor
from shipcosim.interfaces.predictor import HORIZONS, Prediction
from shipcosim.models.control.observer import DpShip
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import dead_reckoning, surroundings
from shipcosim.models.prediction.surroundings import SurroundingsParameters
from shipcosim.models.ship.hull import HullParameters


class Predictor(MotionPredictor):
    """Position and heading in 10, 30 and 60 s, with thrust, wind, current and remaining force as she knows them."""

    wind_north = Output("m/s", "mean velocity of the air towards north, as estimated")
    wind_east = Output("m/s", "mean velocity of the air towards east, as estimated")
    current_north = Output("m/s", "velocity of the water towards north, as estimated")
    current_east = Output("m/s", "velocity of the water towards east, as estimated")
    force_north = Output("N", "force towards north that current, wind and thrust do not explain")
    force_east = Output("N", "force towards east that current, wind and thrust do not explain")
    moment = Output("N.m", "yaw moment that current, wind and thrust do not explain")

    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    ship = Parameters(DpShip)
    assumed = Parameters(SurroundingsParameters)
    longest_step = Parameter(2.0, "s", "longest step of the integration", minimum=0.01)

    def begin(self, known):
        return surroundings.unknown(known, hull=self.hull, parameters=self.assumed)

    def follow(self, state, known, since):
        models = {"hull": self.hull, "wind": self.wind, "ship": self.ship}
        return surroundings.step(state, known, since, **models, parameters=self.assumed)

    def predict(self, state, known):
        self.wind_north, self.wind_east, self.current_north, self.current_east = state[:4]
        self.force_north, self.force_east, self.moment = state[4:7]
        motions = dead_reckoning.predict(
            known, state, horizons=HORIZONS, longest_step=self.longest_step, hull=self.hull, wind=self.wind
        )
        return Prediction(motions, self.regions.positions, self.regions.headings)
