"""FMU of a mooring line, the example of docs/systems.md."""

from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.models.core.maths import cos, sin


class Line(Fmu):
    """Elastic line from the ship's stern to a fixed point; it pulls and never pushes."""

    x = Input("m", "position north of the ship")
    y = Input("m", "position east of the ship")
    psi = Input("rad", "heading of the ship")
    tension = Output("N", "pull in the line")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    anchor_north = Parameter(-117.0, "m", "fixed end, north")
    anchor_east = Parameter(0.0, "m", "fixed end, east")
    stern = Parameter(-17.0, "m", "where it is made fast on board, forward of the origin")
    length = Parameter(99.0, "m", "length without a load", minimum=1.0)
    stiffness = Parameter(5000.0, "N/m", "pull per stretch", minimum=0.0)

    def start(self):
        c, s = cos(self.psi), sin(self.psi)
        north = self.anchor_north - self.x - self.stern * c
        east = self.anchor_east - self.y - self.stern * s
        distance = max((north**2 + east**2) ** 0.5, 1e-9)
        self.tension = self.stiffness * max(distance - self.length, 0.0)
        pull_north, pull_east = self.tension * north / distance, self.tension * east / distance
        self.tau_X = c * pull_north + s * pull_east
        self.tau_Y = c * pull_east - s * pull_north
        self.tau_N = self.stern * self.tau_Y

    def step(self, t, h):
        self.start()
