"""FMU that predicts where a ship that is steered by hand will be, as she comes into a harbour."""

from pathlib import Path

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import docking, helm
from shipcosim.models.prediction.docking_laws import VARIANTS, Model, law_of
from shipcosim.models.prediction.regions import RegionParameters, own_errors
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters

WEIGHTS = Path(__file__).with_name("weights")
HORIZONS = (10, 20, 30)  # s, as the outputs are named


class DockingPredictor(Fmu):
    """Position and heading in 10, 20 and 30 s, from what is measured aboard and how the thrusters are commanded now."""

    x_meas = Input("m", "measured north position")
    y_meas = Input("m", "measured east position")
    psi_meas = Input("rad", "measured heading, clockwise from north")
    u_meas = Input("m/s", "measured surge velocity over ground")
    v_meas = Input("m/s", "measured sway velocity over ground")
    r_meas = Input("rad/s", "measured yaw rate")
    wind_speed_meas = Input("m/s", "measured apparent wind speed at the mast")
    wind_from_meas = Input(
        "rad", "measured direction of the apparent wind at the mast, clockwise from the bow"
    )
    port_thrust_cmd = Input("N", "commanded thrust of the port azimuth")
    port_azimuth_cmd = Input(
        "rad", "commanded direction of the port azimuth, clockwise from the bow"
    )
    port_rpm = Input("rpm", "shaft speed of the port azimuth")
    port_azimuth = Input("rad", "direction of the port azimuth, clockwise from the bow")
    starboard_thrust_cmd = Input("N", "commanded thrust of the starboard azimuth")
    starboard_azimuth_cmd = Input(
        "rad", "commanded direction of the starboard azimuth, clockwise from the bow"
    )
    starboard_rpm = Input("rpm", "shaft speed of the starboard azimuth")
    starboard_azimuth = Input("rad", "direction of the starboard azimuth, clockwise from the bow")
    tunnel_thrust_cmd = Input("N", "commanded thrust of the tunnel, positive to starboard")
    tunnel_rpm = Input("rpm", "motor speed of the tunnel")

    predicted_at = Output(
        "s", "time at which the prediction was made, from which its seconds count"
    )
    x_10 = Output("m", "north position in 10 s")
    y_10 = Output("m", "east position in 10 s")
    psi_10 = Output("rad", "heading in 10 s")
    position_region_10 = Output(
        "m", "radius about the place in 10 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_10 = Output(
        "rad", "half-width about the heading in 10 s that has the true one in 90 %, or 0"
    )
    x_20 = Output("m", "north position in 20 s")
    y_20 = Output("m", "east position in 20 s")
    psi_20 = Output("rad", "heading in 20 s")
    position_region_20 = Output(
        "m", "radius about the place in 20 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_20 = Output(
        "rad", "half-width about the heading in 20 s that has the true one in 90 %, or 0"
    )
    x_30 = Output("m", "north position in 30 s")
    y_30 = Output("m", "east position in 30 s")
    psi_30 = Output("rad", "heading in 30 s")
    position_region_30 = Output(
        "m", "radius about the place in 30 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_30 = Output(
        "rad", "half-width about the heading in 30 s that has the true one in 90 %, or 0"
    )
    learned = Output(
        "1", "share of the learned correction in the prediction; 0 is the equations of motion alone"
    )

    mast = Parameters(MastParameters)
    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    helm = Parameters(helm.HelmParameters)
    variant = Parameter("ours", "1", "what predicts: kinetic, paper-iii or ours", origin="choice")

    def start(self):
        if self.variant not in VARIANTS:
            raise ValueError(
                f"variant '{self.variant}': there is none. There are {', '.join(VARIANTS)}."
            )
        file = "paper-iii" if self.variant == "paper-iii" else "ours"
        self.law = law_of(self.variant, read_arrays(WEIGHTS / f"{file}.npz"))
        self.model = Model(self.hull, self.wind, self.helm)
        self.made, self.state = (
            samples_due(self.start_time, 1.0),
            self.law.begin(self._aboard(), self.model),
        )
        self.errors = (0.0, 0.0)
        self.awaited = []
        self._predict(self.start_time)

    def step(self, t, h):
        due = samples_due(t, 1.0)
        if self.made < due:
            self.made = due
            self.state = self.law.follow(self.state, self._aboard(), self.model)
            self._predict(t)

    def _aboard(self):
        known = {name: getattr(self, name) for name in helm.KNOWN}
        return helm.aboard_of(known, self.mast)

    def _predict(self, t):
        places, self.learned, self.state = self.law.predict(self.state, self.model)
        self.predicted_at = t
        ten, twenty, thirty = (tuple(map(float, places[horizon - 1])) for horizon in HORIZONS)
        self.x_10, self.y_10, self.psi_10 = ten
        self.x_20, self.y_20, self.psi_20 = twenty
        self.x_30, self.y_30, self.psi_30 = thirty
        self._judge_itself(helm.moved_on(self.state.aboard.ship, self.helm.position_age), ten)

    def _judge_itself(self, ship, ten):
        """Regions, by how far she came from where she was foreseen ten seconds ago."""
        self.awaited.append(ten)
        if len(self.awaited) > HORIZONS[0]:
            foreseen = Motion._make((*self.awaited.pop(0), 0.0, 0.0, 0.0))
            self.errors = own_errors(self.errors, ship, foreseen, 1.0, regions=RegionParameters())
        positions, headings = docking.regions(self.law.widths, self.errors)
        self.position_region_10, self.position_region_20, self.position_region_30 = positions
        self.heading_region_10, self.heading_region_20, self.heading_region_30 = headings
