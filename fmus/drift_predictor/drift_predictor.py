"""FMU that predicts the drift of a ship, with what was learned over many ships and of her own record."""

import tomllib
from dataclasses import replace
from pathlib import Path

from shipcosim.angles import wrap
from shipcosim.fmi import Parameter, Parameters
from shipcosim.interfaces import MotionPredictor
from shipcosim.interfaces.predictor import HORIZONS, Prediction
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import drift_off, paper_iv
from shipcosim.models.prediction.regions import RegionParameters
from shipcosim.models.prediction.surroundings import SurroundingsParameters
from shipcosim.models.ship.hull import HullParameters

WEIGHTS = Path(__file__).with_name("weights")


class DriftPredictor(MotionPredictor):
    """Position and heading in 10, 30 and 60 s as learned from many ships and this one's record, or as in paper IV."""

    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    ship = Parameters(DpShip)
    assumed = Parameters(SurroundingsParameters)
    regions = Parameters(RegionParameters)
    longest_step = Parameter(
        2.0, "s", "longest step of the integration without what is learned", minimum=0.01
    )
    variant = Parameter(
        "ours",
        "1",
        "what predicts: the name of a file of weights, ours or paper-iv",
        origin="choice",
    )

    own_regions = Parameter(
        True,
        "1",
        "regions are those calibrated for the variant, and not those of the parameters",
        origin="choice",
    )

    def begin(self, known):
        files = {file.stem: file for file in WEIGHTS.glob("*.npz")}
        if self.variant not in files:
            raise ValueError(
                f"variant '{self.variant}': there is none. There are {', '.join(sorted(files))}."
            )
        if self.own_regions:
            widths = tomllib.loads((WEIGHTS / "regions.toml").read_text(encoding="utf-8"))
            self.regions = replace(self.regions, **widths[self.variant])
        arrays = read_arrays(files[self.variant])
        if self.variant == "paper-iv":
            if self.prediction_period != paper_iv.PERIOD:
                raise ValueError(
                    f"prediction_period = {self.prediction_period:g} s: networks of paper IV step by 1 s."
                )
            self.ensemble = paper_iv.ensemble_of(arrays)
            return paper_iv.begin(known)
        self.trained = drift_off.trained_of(arrays)
        return drift_off.begin(known, trained=self.trained, hull=self.hull, parameters=self.assumed)

    def follow(self, state, known, since):
        if self.variant == "paper-iv":
            return paper_iv.step(state, known, hull=self.hull, wind=self.wind)
        model = {
            "hull": self.hull,
            "wind": self.wind,
            "ship": self.ship,
            "parameters": self.assumed,
        }
        return drift_off.step(state, known, since, trained=self.trained, **model)

    def predict(self, state, known):
        if self.variant == "paper-iv":
            return Prediction(
                self._paper_iv(state, known), self.regions.positions, self.regions.headings, 1.0
            )
        motions, share = drift_off.predict(
            state,
            known,
            horizons=HORIZONS,
            longest_step=self.longest_step,
            trained=self.trained,
            hull=self.hull,
            wind=self.wind,
        )
        motions = tuple(Motion(*map(float, motion)) for motion in motions)
        return Prediction(motions, self.regions.positions, self.regions.headings, float(share))

    def _paper_iv(self, past, known):
        seconds = round(HORIZONS[-1])
        found = paper_iv.predict(
            past, known, self.ensemble, seconds=seconds, hull=self.hull, wind=self.wind
        )
        motions = (found[round(horizon) - 1] for horizon in HORIZONS)
        return tuple(
            Motion(*map(float, motion._replace(psi=wrap(motion.psi)))) for motion in motions
        )
