"""FMU of somebody else's fixed propeller, for the tests of black boxes: names, units and law are not ours."""

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Screw(Fmu):
    """Fixed propeller behind a boat: quadratic thrust, weaker astern, less the faster it goes ahead."""

    shaft = Input("rad/s", "speed of the shaft")
    way = Input("m/s", "speed of the boat ahead through the water")
    swing = Input("rad/s", "rate of turning of the boat")
    push = Output("N", "force on the boat, ahead")
    twist = Output("N.m", "moment on the boat")
    gain = Parameter(6.0, "kg.m", "thrust over squared speed, in rev/s, where the boat lies still")
    astern = Parameter(0.7, "1", "thrust astern over that ahead")
    slip = Parameter(1.5, "m", "thrust is gone at this advance per turn")
    wake = Parameter(0.2, "1", "wake fraction")
    aside = Parameter(0.9, "m", "position to starboard")

    def start(self):
        n = self.shaft / 6.283185307179586
        speed = (1.0 - self.wake) * (self.way - self.aside * self.swing)
        self.push = self.gain * (
            (1.0 if n > 0.0 else self.astern) * n * abs(n) - abs(n) * speed / self.slip
        )
        self.twist = -self.aside * self.push

    def step(self, t, h):
        self.start()
