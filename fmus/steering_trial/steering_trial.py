"""FMU of steering trials."""

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.control.steering_trial import SteeringTrialParameters, TrialState, step


class SteeringTrial(Fmu):
    """Steers a turning circle or a zig-zag, and reads off what a trial is judged by."""

    x = Input("m", "ship's position north")
    y = Input("m", "ship's position east")
    psi = Input("rad", "ship's heading, clockwise from north")

    rpm = Output("rpm", "speed of the shafts")
    azimuth = Output(
        "rad", "angle of rudders and azimuths, positive turns the ship to port: the helm's opposite"
    )
    turned = Output("rad", "change of heading since the first order, clockwise")
    advance_90 = Output("m", "way along the first heading until she has turned by 90 deg")
    transfer_90 = Output("m", "way across it, to the side of the turn, until then")
    tactical_diameter = Output("m", "way across until she has turned by 180 deg")
    overshoot_1 = Output(
        "rad", "turn beyond the check angle after the helm was first put over; of a zig-zag"
    )
    overshoot_2 = Output("rad", "the same after the second time")

    trial = Parameters(SteeringTrialParameters)
    shaft_rpm = Parameter(100.0, "rpm", "speed of the shafts, held")

    def start(self):
        self._show(TrialState(self.x, self.y, self.psi, self.psi))

    def step(self, t, h):
        motion = self.x, self.y, self.psi
        self._show(step(self.state, t, motion, h, parameters=self.trial))

    def _show(self, state):
        self.state = state
        self.rpm = self.shaft_rpm
        self.azimuth = -state.helm
        self.turned = state.turned
        self.advance_90 = state.advance
        self.transfer_90 = state.transfer
        self.tactical_diameter = state.tactical_diameter
        self.overshoot_1 = state.overshoot_1
        self.overshoot_2 = state.overshoot_2
