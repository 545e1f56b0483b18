"""Interface of the allocators of two azimuth thrusters and a tunnel thruster, by their names."""

from math import cos, pi, sin
from time import perf_counter
from types import ModuleType
from typing import Any, ClassVar

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.interfaces.geometry import check_geometry
from shipcosim.models.allocation.power import PowerParameters, granted_power, thrust_shares
from shipcosim.models.allocation.units import slack, thruster_power, used_shares
from shipcosim.models.core.maths import where
from shipcosim.models.propulsion.failures import PLENTY


class NamedAllocator(Fmu):
    """Variables of every allocator of two azimuths and a tunnel, and the power of two buses. See docs/allocation.md.

    An FMU of a law declares two things: ``model = Parameters(...)``, with the fields of `NamedUnits` and what the law
    needs beside, and ``law``, a module with three functions:

    - ``design(parameters)``: what is computed once,
    - ``at_rest(tau, *, parameters)``: the state at the start,
    - ``step(state, tau, available, h, *, parameters, design, shares)``: the next state. `shares` are the parts of their
      limits of thrust that power leaves to port, starboard and tunnel.

    The state has the fields of `models.allocation.units.Allocated`. With ``turns = True`` the first commands have the
    angles that the units have, so that the units can follow.
    """

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")
    port_available = Input("1", "port azimuth can be used", start=True)
    starboard_available = Input("1", "starboard azimuth can be used", start=True)
    tunnel_available = Input("1", "tunnel thruster can be used", start=True)

    bus_a_power = Input(
        "W",
        "power that bus A has for thrusters; without any its units count as missing",
        start=PLENTY,
    )
    bus_b_power = Input(
        "W",
        "power that bus B has for thrusters; without any its units count as missing",
        start=PLENTY,
    )
    port_power = Input("W", "power that the port azimuth takes")
    starboard_power = Input("W", "power that the starboard azimuth takes")
    tunnel_power = Input("W", "power that the tunnel thruster takes")
    port_azimuth_feedback = Input(
        "rad", "angle of the port azimuth; a law that turns it starts from there"
    )
    starboard_azimuth_feedback = Input(
        "rad", "angle of the starboard azimuth; a law that turns it starts from there"
    )

    port_thrust_cmd = Output("N", "commanded thrust of the port azimuth")
    port_azimuth_cmd = Output("rad", "commanded angle of the port azimuth, clockwise from the bow")
    starboard_thrust_cmd = Output("N", "commanded thrust of the starboard azimuth")
    starboard_azimuth_cmd = Output(
        "rad", "commanded angle of the starboard azimuth, clockwise from the bow"
    )
    tunnel_thrust_cmd = Output(
        "N", "commanded thrust of the tunnel thruster, positive to starboard"
    )
    tau_X = Output("N", "force forward that the commands give")
    tau_Y = Output("N", "force to starboard that the commands give")
    tau_N = Output("N.m", "yaw moment that the commands give")
    slack_X = Output("N", "force forward that is requested and not given")
    slack_Y = Output("N", "force to starboard that is requested and not given")
    slack_N = Output("N.m", "yaw moment that is requested and not given")
    saturated = Output(
        "1",
        "limits of thrust or missing units keep the commands from the requested load",
        start=False,
    )
    thruster_power = Output(
        "W", "estimate of the power that the commands take: of each unit full power times share^1.5"
    )
    solve_time = Output(
        "s", "time that the law took by the clock, where measure_solve_time is true"
    )
    port_power_limit = Output("W", "power granted to the port azimuth", start=PLENTY)
    starboard_power_limit = Output("W", "power granted to the starboard azimuth", start=PLENTY)
    tunnel_power_limit = Output("W", "power granted to the tunnel thruster", start=PLENTY)
    bus_a_load = Output("W", "power that the thrusters of bus A take")
    bus_b_load = Output("W", "power that the thrusters of bus B take")

    power = Parameters(PowerParameters)
    measure_solve_time = Parameter(
        False,
        "1",
        "measure the time of the law; off, so that runs repeat to the last digit",
        origin="choice",
    )

    law: ClassVar[ModuleType]
    turns: ClassVar[bool] = False
    model: Any

    def start(self) -> None:
        self._check()
        self.design = self.designed()
        state = self.law.at_rest(
            (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd), parameters=self.model
        )
        if self.turns:
            angles = (
                self.port_azimuth_feedback,
                self.starboard_azimuth_feedback,
                *state.azimuths[2:],
            )
            state = state._replace(azimuths=angles)
        self._show(state)

    def designed(self) -> Any:
        """What the law computes once; an FMU that was trained reads its weights here."""
        return self.law.design(self.model)

    def step(self, t: float, h: float) -> None:
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        shares, live = self._powered()
        available = (
            self.port_available & live[0],
            self.starboard_available & live[1],
            self.tunnel_available & live[2],
        )
        start = perf_counter() if self.measure_solve_time else 0.0
        state = self.law.step(
            self.state, tau, available, h, parameters=self.model, design=self.design, shares=shares
        )
        self.solve_time = perf_counter() - start if self.measure_solve_time else 0.0
        self._show(state)

    def _check(self):
        """Refuse units that cannot give the three loads: as they can turn, or at their fixed angles."""
        m = self.model
        effect = [(0.0, 1.0, m.tunnel_x)]
        limits = [m.tunnel_thrust_max]
        for x, y, angle in (
            (m.port_x, m.port_y, m.port_azimuth),
            (m.starboard_x, m.starboard_y, m.starboard_azimuth),
        ):
            for direction in (0.0, 0.5 * pi) if self.turns else (angle,):
                effect.append(
                    (cos(direction), sin(direction), x * sin(direction) - y * cos(direction))
                )
                limits.append(max(m.azimuth_thrust_max, -m.azimuth_thrust_min))
        check_geometry(effect, limits)

    def _powered(self):
        """Shares of their thrust that power leaves to the units, and whether they have power at all."""
        buses = (self.bus_a_power, self.bus_b_power)
        shares = (1.0, 1.0, 1.0)
        granted = (PLENTY, PLENTY, PLENTY)
        if min(buses) < PLENTY:
            granted = granted_power(self.used, buses, parameters=self.power)
            shares = thrust_shares(granted, parameters=self.power)
        self.port_power_limit, self.starboard_power_limit, self.tunnel_power_limit = granted
        taken = zip(
            (self.port_power, self.starboard_power, self.tunnel_power),
            self.power.buses,
            strict=True,
        )
        self.bus_a_load = self.bus_b_load = 0.0
        for power, bus in taken:
            self.bus_a_load += where(bus < 0.5, power, 0.0)
            self.bus_b_load += where(bus < 0.5, 0.0, power)
        return shares, [power > 0.0 for power in granted]

    def _show(self, state):
        self.state = state
        m = self.model
        self.port_thrust_cmd, self.starboard_thrust_cmd, self.tunnel_thrust_cmd = state.thrusts
        self.port_azimuth_cmd, self.starboard_azimuth_cmd = state.azimuths[:2]
        self.tau_X = state.tau_X
        self.tau_Y = state.tau_Y
        self.tau_N = state.tau_N
        self.saturated = state.saturated
        tau = self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd
        self.slack_X, self.slack_Y, self.slack_N = slack(
            tau, (state.tau_X, state.tau_Y, state.tau_N)
        )
        least = (m.azimuth_thrust_min, m.azimuth_thrust_min, -m.tunnel_thrust_max)
        most = (m.azimuth_thrust_max, m.azimuth_thrust_max, m.tunnel_thrust_max)
        self.used = used_shares(state.thrusts, least, most)
        self.thruster_power = thruster_power(self.used, self.power.largest)
