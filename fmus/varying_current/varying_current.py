"""FMU of a current that turns or grows."""

from shipcosim.fmi import Fmu, Output, Parameters
from shipcosim.models.environment.current import VaryingCurrentParameters, varying_current


class VaryingCurrent(Fmu):
    """Current between two: speed and direction are each linear in time."""

    current_speed = Output("m/s", "speed of the current")
    current_to = Output("rad", "direction the current flows to, clockwise from north")

    ends = Parameters(VaryingCurrentParameters)

    def start(self):
        if not self.ends.time_end > self.ends.time_start:
            raise ValueError(
                f"time_end {self.ends.time_end:g} s is not after time_start {self.ends.time_start:g} s"
            )
        self._write(self.start_time)

    def step(self, t, h):
        self._write(t + h)

    def _write(self, t):
        e = self.ends
        ends = e.north_start, e.east_start, e.north_end, e.east_end
        self.current_speed, self.current_to = varying_current(
            t, *ends, time_start=e.time_start, time_end=e.time_end
        )
