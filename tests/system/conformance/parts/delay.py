"""FMU whose output follows its input one step later: y = u of the step before, first `first`."""

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Delay(Fmu):
    """Gives what it got one step before."""

    u = Input("m", "what comes in")
    y = Output("m", "what came in before")
    first = Parameter(0.0, "m", "output until the first step is done")

    def start(self):
        self.y = self.first
        self.kept = self.u

    def step(self, t, h):
        self.y, self.kept = self.kept, self.u
