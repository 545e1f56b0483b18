"""Interface of the allocators of up to six units, by their numbers, for any ship."""

from dataclasses import dataclass
from math import cos, pi, sin
from time import perf_counter
from types import ModuleType
from typing import Any, ClassVar

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.interfaces.geometry import check_geometry
from shipcosim.models.allocation.units import slack, thruster_power, used_shares
from shipcosim.models.core.parameters import quantity


def _full(number):
    about = f"power of unit {number} at its limit of thrust, for the estimate only; 0: not known, counts as none"
    return quantity(0.0, "W", about, "not known", minimum=0.0)


@dataclass(frozen=True, kw_only=True)
class FullPowers:
    """Power of the units at their limits of thrust."""

    full_power_1: float = _full(1)
    full_power_2: float = _full(2)
    full_power_3: float = _full(3)
    full_power_4: float = _full(4)
    full_power_5: float = _full(5)
    full_power_6: float = _full(6)

    @property
    def of_units(self):
        """Of all units, in their order. [W]"""
        first = self.full_power_1, self.full_power_2, self.full_power_3
        return (*first, self.full_power_4, self.full_power_5, self.full_power_6)


class NumberedAllocator(Fmu):
    """Variables of every allocator of up to six units. See docs/allocation.md.

    An FMU of a law declares two things: ``model = Parameters(...)``, with the fields of `FixedAngleParameters` and what
    the law needs beside, and ``law``, a module with three functions:

    - ``design(parameters)``: what is computed once,
    - ``at_rest(tau, *, parameters)``: the state at the start,
    - ``step(state, tau, available, h, *, parameters, design)``: the next state.

    The state has the fields of `models.allocation.units.Allocated`. ``turns = False`` where no law of the FMU turns a
    unit: its places and directions must then give all three loads.
    """

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")
    available_1 = Input("1", "unit 1 can be used", start=True)
    available_2 = Input("1", "unit 2 can be used", start=True)
    available_3 = Input("1", "unit 3 can be used", start=True)
    available_4 = Input("1", "unit 4 can be used", start=True)
    available_5 = Input("1", "unit 5 can be used", start=True)
    available_6 = Input("1", "unit 6 can be used", start=True)

    thrust_cmd_1 = Output("N", "commanded thrust of unit 1")
    azimuth_cmd_1 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_2 = Output("N", "commanded thrust of unit 2")
    azimuth_cmd_2 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_3 = Output("N", "commanded thrust of unit 3")
    azimuth_cmd_3 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_4 = Output("N", "commanded thrust of unit 4")
    azimuth_cmd_4 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_5 = Output("N", "commanded thrust of unit 5")
    azimuth_cmd_5 = Output("rad", "its direction, clockwise from the bow")
    thrust_cmd_6 = Output("N", "commanded thrust of unit 6")
    azimuth_cmd_6 = Output("rad", "its direction, clockwise from the bow")
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

    power = Parameters(FullPowers)
    measure_solve_time = Parameter(
        False,
        "1",
        "measure the time of the law; off, so that runs repeat to the last digit",
        origin="choice",
    )

    law: ClassVar[ModuleType]
    turns: ClassVar[bool] = True
    model: Any

    def start(self) -> None:
        self.design = self.designed()
        self._check()
        self.least, self.most = (
            tuple(self.model.of_units(name)) for name in ("thrust_min", "thrust_max")
        )
        self._show(
            self.law.at_rest(
                (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd), parameters=self.model
            )
        )

    def designed(self) -> Any:
        """What the law computes once; an FMU that was trained reads its weights here."""
        return self.law.design(self.model)

    def step(self, t: float, h: float) -> None:
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        first = self.available_1, self.available_2, self.available_3
        available = (*first, self.available_4, self.available_5, self.available_6)
        start = perf_counter() if self.measure_solve_time else 0.0
        state = self.law.step(
            self.state, tau, available, h, parameters=self.model, design=self.design
        )
        self.solve_time = perf_counter() - start if self.measure_solve_time else 0.0
        self._show(state)

    def _check(self):
        """Refuse units that cannot give the three loads: as they can turn, or at their fixed angles."""
        names = ("x", "y", "azimuth", "thrust_min", "thrust_max")
        effect = []
        limits = []
        for x, y, angle, least, most in zip(
            *(self.model.of_units(name) for name in names), strict=True
        ):
            for direction in (0.0, 0.5 * pi) if self.turns else (angle,):
                effect.append(
                    (cos(direction), sin(direction), x * sin(direction) - y * cos(direction))
                )
                limits.append(max(most, -least))
        check_geometry(effect, limits)

    def _show(self, state):
        self.state = state
        self.thrust_cmd_1, self.thrust_cmd_2, self.thrust_cmd_3 = state.thrusts[:3]
        self.thrust_cmd_4, self.thrust_cmd_5, self.thrust_cmd_6 = state.thrusts[3:]
        self.azimuth_cmd_1, self.azimuth_cmd_2, self.azimuth_cmd_3 = state.azimuths[:3]
        self.azimuth_cmd_4, self.azimuth_cmd_5, self.azimuth_cmd_6 = state.azimuths[3:]
        self.tau_X = state.tau_X
        self.tau_Y = state.tau_Y
        self.tau_N = state.tau_N
        self.saturated = state.saturated
        tau = self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd
        self.slack_X, self.slack_Y, self.slack_N = slack(
            tau, (state.tau_X, state.tau_Y, state.tau_N)
        )
        self.thruster_power = thruster_power(
            used_shares(state.thrusts, self.least, self.most), self.power.of_units
        )
