"""FMU that predicts the ship by dead reckoning, from what the ship knows."""

from shipcosim.interfaces import KineticPredictor
from shipcosim.interfaces.predictor import Prediction


class Predictor(KineticPredictor):
    """Position and heading in 10, 30 and 60 s, with thrust, wind, current and remaining force as she knows them."""

    def predict(self, state, known):
        return Prediction(
            self.reckoned(state, known), self.regions.positions, self.regions.headings
        )
