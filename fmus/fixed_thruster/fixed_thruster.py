"""FMU of a plain fixed thruster."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.core.maths import pi, where
from shipcosim.models.propulsion.fixed import FixedParameters, fixed_loads, shaft_speed


class FixedThruster(Fmu):
    """Thruster that does not turn: a force as commanded, or quadratic in the speed of its shaft; no drive."""

    thrust_in = Input("N", "commanded force, positive in the thruster's direction", optional=True)
    rpm_in = Input("rpm", "speed of the shaft", optional=True)
    u_r = Input("m/s", "ship's velocity forward through the water")
    v_r = Input("m/s", "ship's velocity to starboard through the water")
    r = Input("rad/s", "ship's yaw rate")
    failed = Input("1", "without power: no thrust", start=False, optional=True)

    thrust = Output("N", "delivered thrust, positive in the thruster's direction")
    rpm = Output("rpm", "speed of the shaft that gives this thrust in still water")
    tau_X = Output("N", "force on the ship, forward")
    tau_Y = Output("N", "force on the ship, to starboard")
    tau_N = Output("N.m", "yaw moment on the ship")
    available = Output("1", "has not failed", start=True)

    thruster = Parameters(FixedParameters)

    def start(self):
        self._push()

    def step(self, t, h):
        self._push()

    def _push(self):
        force = where(self.failed, 0.0, self.thrust_in)
        speed = where(self.failed, 0.0, self.rpm_in) * pi / 30.0
        loads = fixed_loads(force, speed, self.u_r, self.v_r, self.r, thruster=self.thruster)
        self.rpm = shaft_speed(force, speed, thruster=self.thruster) * 30.0 / pi
        self.available = not self.failed
        self.thrust, _, self.tau_X, self.tau_Y, self.tau_N = loads
