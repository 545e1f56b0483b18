"""FMU of a helmsman who docks a ship by hand."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.control import helmsman
from shipcosim.models.control.fairway import FairwayParameters
from shipcosim.models.core.motion import Motion


class Helmsman(Fmu):
    """Helmsman: brings a ship with two azimuths and a tunnel along a fairway to her berth."""

    x_meas = Input("m", "measured north position, from the berth")
    y_meas = Input("m", "measured east position, from the berth")
    psi_meas = Input("rad", "measured heading, clockwise from north")
    u_meas = Input("m/s", "measured surge velocity over ground")
    v_meas = Input("m/s", "measured sway velocity over ground")
    r_meas = Input("rad/s", "measured yaw rate")
    wind_speed_meas = Input("m/s", "measured apparent wind speed at the mast")
    wind_from_meas = Input(
        "rad", "measured direction of the apparent wind at the mast, clockwise from the bow"
    )

    port_thrust_cmd = Output("N", "lever of the port azimuth: commanded thrust")
    port_azimuth_cmd = Output(
        "rad", "commanded direction of the port azimuth, clockwise from the bow"
    )
    starboard_thrust_cmd = Output("N", "lever of the starboard azimuth: commanded thrust")
    starboard_azimuth_cmd = Output(
        "rad", "commanded direction of the starboard azimuth, clockwise from the bow"
    )
    tunnel_thrust_cmd = Output("N", "lever of the tunnel: commanded thrust, positive to starboard")
    stage = Output(
        "1", "0 under way, 1 closing in, 2 sideways to the quay, 3 lies at the berth", start=0
    )
    to_go = Output("m", "way left to the place off the berth")

    ship = Parameters(helmsman.ShipInHand)
    fairway = Parameters(FairwayParameters)
    manner = Parameters(helmsman.MannerParameters)

    def start(self):
        self.who = helmsman.Helmsman(self.ship, self.fairway, self.manner)
        self.mind = helmsman.begin(self.start_time)

    def step(self, t, h):
        ship = Motion(
            self.x_meas, self.y_meas, self.psi_meas, self.u_meas, self.v_meas, self.r_meas
        )
        seen = helmsman.Seen(ship, self.wind_speed_meas, self.wind_from_meas)
        self.mind = mind = helmsman.follow(t, self.mind, seen, helmsman=self.who)
        self.port_thrust_cmd, self.starboard_thrust_cmd, self.tunnel_thrust_cmd = mind.levers[:3]
        self.port_azimuth_cmd, self.starboard_azimuth_cmd = mind.levers[3:]
        self.stage = mind.stage
        self.to_go = mind.way.to_go
