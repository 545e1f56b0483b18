"""FMU of the interaction of up to six azimuth thrusters."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.core.parameters import UNITS
from shipcosim.models.propulsion.interaction import (
    InteractionParameters,
    pairs,
    thrust_shares,
)


class ThrusterInteraction(Fmu):
    """Share of its thrust that the slipstreams of the others leave to each of up to six units."""

    azimuth_1 = Input("rad", "direction of positive thrust of unit 1, clockwise from the bow")
    rpm_1 = Input("rpm", "its shaft speed, negative astern")
    azimuth_2 = Input("rad", "direction of positive thrust of unit 2, clockwise from the bow")
    rpm_2 = Input("rpm", "its shaft speed, negative astern")
    azimuth_3 = Input(
        "rad", "direction of positive thrust of unit 3, clockwise from the bow", optional=True
    )
    rpm_3 = Input("rpm", "its shaft speed, negative astern", optional=True)
    azimuth_4 = Input(
        "rad", "direction of positive thrust of unit 4, clockwise from the bow", optional=True
    )
    rpm_4 = Input("rpm", "its shaft speed, negative astern", optional=True)
    azimuth_5 = Input(
        "rad", "direction of positive thrust of unit 5, clockwise from the bow", optional=True
    )
    rpm_5 = Input("rpm", "its shaft speed, negative astern", optional=True)
    azimuth_6 = Input(
        "rad", "direction of positive thrust of unit 6, clockwise from the bow", optional=True
    )
    rpm_6 = Input("rpm", "its shaft speed, negative astern", optional=True)

    thrust_share_1 = Output("1", "share of its thrust that is left to unit 1", start=1.0)
    thrust_share_2 = Output("1", "share of its thrust that is left to unit 2", start=1.0)
    thrust_share_3 = Output("1", "share of its thrust that is left to unit 3", start=1.0)
    thrust_share_4 = Output("1", "share of its thrust that is left to unit 4", start=1.0)
    thrust_share_5 = Output("1", "share of its thrust that is left to unit 5", start=1.0)
    thrust_share_6 = Output("1", "share of its thrust that is left to unit 6", start=1.0)

    model = Parameters(InteractionParameters)

    def start(self):
        self.found = pairs(self.model)
        self.step(0.0, 0.0)

    def step(self, t, h):
        azimuths = (
            self.azimuth_1,
            self.azimuth_2,
            self.azimuth_3,
            self.azimuth_4,
            self.azimuth_5,
            self.azimuth_6,
        )
        speeds = self.rpm_1, self.rpm_2, self.rpm_3, self.rpm_4, self.rpm_5, self.rpm_6
        washes = tuple(
            rpm / 60.0 * d for rpm, d in zip(speeds, self.model.of_units("diameter"), strict=True)
        )
        shares = thrust_shares(
            azimuths, washes, unit_pairs=self.found, loss_scale=self.model.loss_scale
        )
        for number in range(UNITS):
            setattr(self, f"thrust_share_{number + 1}", shares[number])
