"""FMU that multiplies: y = factor u + shift."""

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Gain(Fmu):
    """Multiplies."""

    u = Input("m", "what it multiplies")
    y = Output("m", "factor times u, plus shift")
    factor = Parameter(1.0, "1", "factor")
    shift = Parameter(0.0, "m", "what it adds")

    def start(self):
        self.y = self.factor * self.u + self.shift

    def step(self, t, h):
        self.start()
