"""Interface of the ships: hull, wind and waves under the loads of whatever is connected."""

from shipcosim.angles import wrap
from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import acts
from shipcosim.models.core.sampling import tidy_time
from shipcosim.models.environment.wave_loads import drift_table
from shipcosim.models.environment.wave_motion import wave_response
from shipcosim.models.environment.waves import components
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters, at_present, carried, step


class Ship(Fmu):
    """Variables and motion of every ship in surge, sway and yaw, so that one can take another's place.

    A ship of another form than the hull's law implements, where it differs:

    - ``settle()``: what else it must know at the start,
    - ``wind_load()``: the load of the apparent wind,
    - ``form_load()``: what the loads on its hull differ by from those of the law, held over a step,
    - ``remember(h)``: what else changes over a step, called before the ship moves.
    """

    tau_X_1 = Input("N", "force forward, of a thruster, a line, anything")
    tau_Y_1 = Input("N", "force to starboard, as tau_X_1")
    tau_N_1 = Input("N.m", "yaw moment, as tau_X_1")
    tau_X_2 = Input("N", "force forward, second load", optional=True)
    tau_Y_2 = Input("N", "force to starboard, second load", optional=True)
    tau_N_2 = Input("N.m", "yaw moment, second load", optional=True)
    tau_X_3 = Input("N", "force forward, third load", optional=True)
    tau_Y_3 = Input("N", "force to starboard, third load", optional=True)
    tau_N_3 = Input("N.m", "yaw moment, third load", optional=True)
    tau_X_4 = Input("N", "force forward, fourth load", optional=True)
    tau_Y_4 = Input("N", "force to starboard, fourth load", optional=True)
    tau_N_4 = Input("N.m", "yaw moment, fourth load", optional=True)
    tau_X_5 = Input("N", "force forward, fifth load", optional=True)
    tau_Y_5 = Input("N", "force to starboard, fifth load", optional=True)
    tau_N_5 = Input("N.m", "yaw moment, fifth load", optional=True)
    tau_X_6 = Input("N", "force forward, sixth load", optional=True)
    tau_Y_6 = Input("N", "force to starboard, sixth load", optional=True)
    tau_N_6 = Input("N.m", "yaw moment, sixth load", optional=True)
    wind_north = Input("m/s", "velocity of the air towards north")
    wind_east = Input("m/s", "velocity of the air towards east")
    current_north = Input("m/s", "velocity of the water towards north")
    current_east = Input("m/s", "velocity of the water towards east")
    wave_height = Input("m", "significant wave height Hs", minimum=0.0)
    wave_period = Input("s", "peak period Tp of the waves", start=6.0)
    wave_from = Input("rad", "direction the waves come from, clockwise from north")
    wave_peak_enhancement = Input("1", "gamma of the JONSWAP spectrum", start=3.3)
    wave_seed = Input("1", "seed of the waves", start=1)

    x = Output("m", "position north, low-frequency")
    y = Output("m", "position east, low-frequency")
    psi = Output("rad", "heading, clockwise from north, low-frequency")
    u = Output("m/s", "velocity forward over ground, low-frequency")
    v = Output("m/s", "velocity to starboard over ground, low-frequency")
    r = Output("rad/s", "yaw rate, low-frequency")
    u_r = Output("m/s", "velocity forward through the water")
    v_r = Output("m/s", "velocity to starboard through the water")
    u_dot = Output("m/s2", "rate of u")
    v_dot = Output("m/s2", "rate of v")
    r_dot = Output("rad/s2", "rate of r")
    x_wave = Output("m", "first-order motion north")
    y_wave = Output("m", "first-order motion east")
    psi_wave = Output("rad", "first-order yaw")
    u_wave = Output("m/s", "rate of the first-order motion, forward")
    v_wave = Output("m/s", "rate of the first-order motion, to starboard")
    r_wave = Output("rad/s", "rate of the first-order yaw")
    apparent_wind_speed = Output("m/s", "wind speed relative to the ship")
    apparent_wind_from = Output(
        "rad", "direction the apparent wind comes from, clockwise from the bow"
    )
    tau_thrusters_X = Output("N", "sum of the connected loads, forward")
    tau_thrusters_Y = Output("N", "sum of the connected loads, to starboard")
    tau_thrusters_N = Output("N.m", "sum of the connected loads, yaw")
    tau_wind_X = Output("N", "wind load forward")
    tau_wind_Y = Output("N", "wind load to starboard")
    tau_wind_N = Output("N.m", "wind load, yaw")
    tau_drift_X = Output("N", "wave drift load forward")
    tau_drift_Y = Output("N", "wave drift load to starboard")
    tau_drift_N = Output("N.m", "wave drift load, yaw")
    tau_hull_X = Output("N", "load of the water on the moving hull, forward")
    tau_hull_Y = Output("N", "load of the water on the moving hull, to starboard")
    tau_hull_N = Output("N.m", "load of the water on the moving hull, yaw")

    x_start = Parameter(0.0, "m", "position north at the start")
    y_start = Parameter(0.0, "m", "position east at the start")
    psi_start = Parameter(0.0, "rad", "heading at the start")
    u_start = Parameter(0.0, "m/s", "velocity forward over ground at the start")
    v_start = Parameter(0.0, "m/s", "velocity to starboard over ground at the start")
    r_start = Parameter(0.0, "rad/s", "yaw rate at the start")
    hull = Parameters(HullParameters)
    wind = Parameters(WindParameters)
    drift = Parameters(DriftParameters)

    def settle(self) -> None:
        """Nothing else is known at the start."""

    def wind_load(self) -> Load:
        """Load of the wind by the table alone. [N, N, N.m]"""
        return wind_loads(self.apparent_wind_speed, self.apparent_wind_from, wind=self.wind)

    def form_load(self) -> Load:
        """No load beside those of the hull's law. [N, N, N.m]"""
        return 0.0, 0.0, 0.0

    def remember(self, h: float) -> None:
        """Nothing else changes over a step."""

    def start(self) -> None:
        self.state = Motion(
            self.x_start,
            self.y_start,
            wrap(self.psi_start),
            self.u_start,
            self.v_start,
            self.r_start,
        )
        self.water = self.current_north, self.current_east
        self.settle()
        self._meet_waves(self.start_time)
        self._add_connected()
        self._write()

    def step(self, t: float, h: float) -> None:
        north, east = self.water
        self.water = self.current_north, self.current_east
        if acts(self.hull.current_acceleration):
            change = self.current_north - north, self.current_east - east
            self.state = carried(self.state, *change, hull=self.hull)
        self._add_connected()
        tau = self._with_form(self._loads())
        self.remember(h)
        self.state = step(
            self.state, *tau, self.current_north, self.current_east, h, hull=self.hull
        )
        self._meet_waves(tidy_time(t + h))
        self._write()

    def _loads(self):
        """Sum of all loads from outside, at the present state."""
        ship = self.state
        self.apparent_wind_speed, self.apparent_wind_from = apparent_wind(
            ship.psi, ship.u, ship.v, self.wind_north, self.wind_east
        )
        self.tau_wind_X, self.tau_wind_Y, self.tau_wind_N = self.wind_load()
        return (
            self.tau_thrusters_X + self.tau_wind_X + self.tau_drift_X,
            self.tau_thrusters_Y + self.tau_wind_Y + self.tau_drift_Y,
            self.tau_thrusters_N + self.tau_wind_N + self.tau_drift_N,
        )

    def _with_form(self, tau):
        X, Y, N = self.form_load()
        return tau[0] + X, tau[1] + Y, tau[2] + N

    def _add_connected(self):
        """Sum of the connected loads."""
        X = self.tau_X_1 + self.tau_X_2 + self.tau_X_3 + self.tau_X_4 + self.tau_X_5 + self.tau_X_6
        Y = self.tau_Y_1 + self.tau_Y_2 + self.tau_Y_3 + self.tau_Y_4 + self.tau_Y_5 + self.tau_Y_6
        N = self.tau_N_1 + self.tau_N_2 + self.tau_N_3 + self.tau_N_4 + self.tau_N_5 + self.tau_N_6
        self.tau_thrusters_X = X
        self.tau_thrusters_Y = Y
        self.tau_thrusters_N = N

    def _meet_waves(self, t):
        ship = self.state
        hull = self.hull
        load, motion = wave_response(
            t,
            *ship[:5],
            components(
                self.wave_height,
                self.wave_period,
                self.wave_from,
                self.wave_peak_enhancement,
                self.wave_seed,
            ),
            drift_table(self.drift.drift_table),
            length=hull.length,
            breadth=hull.breadth,
            draught=hull.draught,
        )
        self.tau_drift_X, self.tau_drift_Y, self.tau_drift_N = load
        self.x_wave, self.y_wave, self.psi_wave, self.u_wave, self.v_wave, self.r_wave = motion

    def _write(self):
        tau = self._with_form(self._loads())
        self.x, self.y, self.psi, self.u, self.v, self.r = ship = self.state
        water, rates, loads = at_present(
            ship, *tau, self.current_north, self.current_east, hull=self.hull
        )
        self.u_r, self.v_r = water
        self.u_dot, self.v_dot, self.r_dot = rates
        self.tau_hull_X, self.tau_hull_Y, self.tau_hull_N = self._with_form(loads)
