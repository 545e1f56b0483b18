"""FMU that predicts the ship by dead reckoning, with her DP in the loop as long as it has thrust."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import KineticPredictor
from shipcosim.interfaces.predictor import HORIZONS, NO_GOAL, Prediction, thrust_is_lost
from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.core.maths import choose
from shipcosim.models.prediction import controlled


class DpPredictor(KineticPredictor):
    """Position and heading in 10, 30 and 60 s: what DP will make of her, or the drift once all thrust is lost."""

    reference = Parameters(ReferenceParameters)
    law = Parameters(ControlParameters)
    units = Parameters(pseudo_inverse.AllocationParameters)
    observer = Parameters(controlled.ObserverAhead)

    def start(self):
        self.design = pseudo_inverse.design(self.units)
        super().start()

    def predict(self, state, known):
        motions = choose(
            (self.x_goal == NO_GOAL) | thrust_is_lost(known),
            lambda: self.reckoned(state, known),
            lambda: self._held(state, known),
        )
        return Prediction(motions, self.regions.positions, self.regions.headings)

    def _held(self, state, known):
        loop = controlled.ControlLoop(
            self.reference, self.ship, self.law, self.units, self.design, self.observer
        )
        ahead = {"horizons": HORIZONS, "longest_step": self.longest_step}
        return controlled.predict(known, state, **ahead, hull=self.hull, wind=self.wind, loop=loop)
