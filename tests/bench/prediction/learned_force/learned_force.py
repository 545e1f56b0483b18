"""FMU of what a predictor has learned, as a force on the ship: a simulated ship that has it leaves a log."""

from pathlib import Path

import numpy as np

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.prediction import own_model, paper_iv
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

WEIGHTS = Path(__file__).with_name("weights") / "learned.npz"


class LearnedForce(Fmu):
    """Residual load of our drift predictor, or of the networks of paper IV."""

    u = Input("m/s", "velocity forward over ground")
    v = Input("m/s", "velocity to starboard over ground")
    r = Input("rad/s", "yaw rate")
    u_r = Input("m/s", "velocity forward through the water")
    v_r = Input("m/s", "velocity to starboard through the water")
    wind_X = Input("N", "wind load, forward")
    wind_Y = Input("N", "wind load, to starboard")
    wind_N = Input("N.m", "wind load, yaw")
    port_X = Input("N", "port azimuth, forward")
    port_Y = Input("N", "port azimuth, to starboard")
    port_N = Input("N.m", "port azimuth, yaw")
    starboard_X = Input("N", "starboard azimuth, forward")
    starboard_Y = Input("N", "starboard azimuth, to starboard")
    starboard_N = Input("N.m", "starboard azimuth, yaw")
    tunnel_Y = Input("N", "tunnel thruster, to starboard")
    tunnel_N = Input("N.m", "tunnel thruster, yaw")

    tau_X = Output("N", "force forward")
    tau_Y = Output("N", "force to starboard")
    tau_N = Output("N.m", "yaw moment")

    hull = Parameters(HullParameters)

    def start(self):
        self.learned = read_arrays(WEIGHTS)
        self.residual, self.due = (0.0, 0.0, 0.0), self.start_time
        given = [accelerations(0.0, 0.0, 0.0, *one, hull=self.hull) for one in np.eye(3).tolist()]
        self.mobility = np.array(given).T  # acceleration of a ship at rest by each load of 1
        self._write(self.start_time)

    def step(self, t, h):
        self._write(t + h)

    def _write(self, t):
        if "coefficients" in self.learned:
            load = self._own_record()
        else:
            if t >= self.due - 1e-9:
                self.residual, self.due = self._paper_iv(), self.due + paper_iv.PERIOD
            load = np.linalg.solve(self.mobility, self.residual)
        self.tau_X, self.tau_Y, self.tau_N = map(float, load)

    def _own_record(self):
        stern = self.port_X + self.starboard_X, self.port_Y + self.starboard_Y
        wind, thrust = (
            (self.wind_X, self.wind_Y, self.wind_N),
            own_model.Thrust(self.tunnel_Y, *stern),
        )
        coefficients = tuple(self.learned["coefficients"].tolist())
        wash = own_model.wash_of(thrust)
        damping = own_model.damping_error(
            coefficients, self.u_r, self.v_r, self.r, wash, hull=self.hull
        )
        supply = own_model.wind_and_thrust_error(coefficients, wind, thrust, hull=self.hull)
        return [a + b for a, b in zip(damping, supply, strict=True)]

    def _paper_iv(self):
        X = self.port_X + self.starboard_X + self.wind_X
        Y = self.port_Y + self.starboard_Y + self.tunnel_Y + self.wind_Y
        N = self.port_N + self.starboard_N + self.tunnel_N + self.wind_N
        dot = accelerations(self.u, self.v, self.r, X, Y, N, hull=self.hull)
        inputs = np.array([[self.u, self.v, self.r, *dot, *self.residual]])
        return tuple(
            paper_iv.outputs(paper_iv.ensemble_of(self.learned), inputs).mean(axis=0)[0].tolist()
        )
