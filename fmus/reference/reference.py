"""FMU of the reference model."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.control.reference import ReferenceParameters, at_rest, step


class Reference(Fmu):
    """Third-order reference of position and heading, with velocities and accelerations."""

    x_set = Input("m", "north position to go to", optional=True)
    y_set = Input("m", "east position to go to", optional=True)
    psi_set = Input(
        "rad", "heading to go to, clockwise from north; taken the shortest way round", optional=True
    )

    x_d = Output("m", "desired north position")
    y_d = Output("m", "desired east position")
    psi_d = Output("rad", "desired heading, clockwise from north")
    x_d_dot = Output("m/s", "desired velocity north")
    y_d_dot = Output("m/s", "desired velocity east")
    r_d = Output("rad/s", "desired yaw rate")
    x_d_ddot = Output("m/s2", "desired acceleration north")
    y_d_ddot = Output("m/s2", "desired acceleration east")
    r_d_dot = Output("rad/s2", "desired yaw acceleration")
    x_goal = Output("m", "north position that the reference goes to")
    y_goal = Output("m", "east position that the reference goes to")
    psi_goal = Output("rad", "heading that the reference goes to, clockwise from north")

    model = Parameters(ReferenceParameters)
    x_start = Parameter(0.0, "m", "north position that the reference starts from, at rest")
    y_start = Parameter(0.0, "m", "east position that the reference starts from")
    psi_start = Parameter(
        0.0, "rad", "heading that the reference starts from, clockwise from north"
    )

    def start(self):
        self._show(at_rest(self.x_start, self.y_start, self.psi_start))

    def step(self, t, h):
        self._show(
            step(self.state, (self.x_set, self.y_set, self.psi_set), h, parameters=self.model)
        )

    def _show(self, state):
        self.state = state
        self.x_d = state.x
        self.y_d = state.y
        self.psi_d = wrap(state.psi)
        self.x_d_dot = state.x_dot
        self.y_d_dot = state.y_dot
        self.r_d = state.r
        self.x_d_ddot = state.x_ddot
        self.y_d_ddot = state.y_ddot
        self.r_d_dot = state.r_dot
        self.x_goal = self.x_set
        self.y_goal = self.y_set
        self.psi_goal = self.psi_set
