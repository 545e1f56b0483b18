"""What predictors by the equations of motion share: wind, current and remaining force, and dead reckoning."""

from shipcosim.fmi import Output, Parameter, Parameters
from shipcosim.interfaces.predictor import HORIZONS, MotionPredictor
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import dead_reckoning, surroundings
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings, SurroundingsParameters
from shipcosim.models.ship.hull import HullParameters


class KineticPredictor(MotionPredictor):
    """A predictor whose state is `Surroundings`; an FMU of it declares ``predict(state, known)``."""

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

    def begin(self, known: Known) -> Surroundings:
        """Nothing but the wind is known at the start."""
        return surroundings.unknown(known, hull=self.hull, parameters=self.assumed)

    def follow(self, state: Surroundings, known: Known, since: float) -> Surroundings:
        """Surroundings as `surroundings.step` has them."""
        models = {"hull": self.hull, "wind": self.wind, "ship": self.ship}
        return surroundings.step(state, known, since, **models, parameters=self.assumed)

    def reckoned(self, state: Surroundings, known: Known) -> tuple[Motion, ...]:
        """Motion at the horizons with the thrust of now held."""
        ahead = {"horizons": HORIZONS, "longest_step": self.longest_step}
        return dead_reckoning.predict(known, state, **ahead, hull=self.hull, wind=self.wind)

    def show_state(self, state: Surroundings) -> None:
        """Write the estimated wind, current and remaining load."""
        self.wind_north, self.wind_east, self.current_north, self.current_east = state[:4]
        self.force_north, self.force_east, self.moment = state[4:7]
