"""FMU that integrates by Euler's rule: y' = u, y(0) = initial."""

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Integrator(Fmu):
    """Integrates its input."""

    u = Input("m", "rate, of a second")
    y = Output("m", "integral")
    initial = Parameter(1.0, "m", "value at the start")

    def start(self):
        self.y = self.initial

    def step(self, t, h):
        self.y += h * self.u
