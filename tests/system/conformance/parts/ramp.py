"""FMU that rises at a rate: y = bottom + rate t."""

from shipcosim.fmi import Fmu, Output, Parameter


class Ramp(Fmu):
    """Rises at a rate."""

    y = Output("m", "height")
    rate = Parameter(1.0, "m/s", "rate")
    bottom = Parameter(0.0, "m", "height at t = 0")

    def start(self):
        self.y = self.bottom + self.rate * self.start_time

    def step(self, t, h):
        self.y = self.bottom + self.rate * (t + h)
