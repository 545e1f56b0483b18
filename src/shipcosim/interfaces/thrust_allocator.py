"""What all allocators share: the request, the load of the commands, and a step of their law."""

from math import pi
from time import perf_counter
from types import ModuleType
from typing import Any, ClassVar

from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.interfaces.geometry import check_geometry
from shipcosim.models.allocation.units import slack, thruster_power, unit_effect, used_shares
from shipcosim.models.core.motion import Load


class LoadRequest(Fmu):
    """Inputs of an allocator: the requested load."""

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")


class ThrustAllocator(LoadRequest):
    """Outputs and step of every allocator.

    A derived class declares the variables of its units, and says by `AVAILABLE`, `THRUST_CMD` and `AZIMUTH_CMD` which
    of them belongs to which unit. ``turns`` tells whether the law turns units; those in `FIXED` it does not turn.
    """

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

    measure_solve_time = Parameter(
        False,
        "1",
        "measure the time of the law; off, so that runs repeat to the last digit",
        origin="choice",
    )

    AVAILABLE: ClassVar[tuple[str, ...]]
    THRUST_CMD: ClassVar[tuple[str, ...]]
    AZIMUTH_CMD: ClassVar[tuple[str, ...]]
    FIXED: ClassVar[tuple[int, ...]] = ()
    law: ClassVar[ModuleType]
    turns: ClassVar[bool]
    model: Any
    power: Any

    def start(self) -> None:
        self._check()
        self.design = self.designed()
        self.least = tuple(self.model.of_units("thrust_min"))
        self.most = tuple(self.model.of_units("thrust_max"))
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        self._show(self.at_rest(tau))

    def at_rest(self, tau: Load) -> Any:
        """State at the start."""
        return self.law.at_rest(tau, parameters=self.model)

    def designed(self) -> Any:
        """What the law computes once; an FMU that was trained reads its weights here."""
        return self.law.design(self.model)

    def step(self, t: float, h: float) -> None:
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        available, limits = self._usable()
        start = perf_counter() if self.measure_solve_time else 0.0
        state = self.law.step(
            self.state, tau, available, h, parameters=self.model, design=self.design, **limits
        )
        self.solve_time = perf_counter() - start if self.measure_solve_time else 0.0
        self._show(state)

    def _usable(self) -> tuple[tuple, dict[str, Any]]:
        """Whether each unit can be used, and limits by power, as the law takes them."""
        return tuple(getattr(self, name) for name in self.AVAILABLE), {}

    def _check(self):
        """Refuse units that cannot give the three loads: as they can turn, or at their fixed angles."""
        names = ("x", "y", "azimuth", "thrust_min", "thrust_max")
        units = zip(*(self.model.of_units(name) for name in names), strict=True)
        effect = []
        limits = []
        for unit, (x, y, azimuth, least, most) in enumerate(units):
            turns = self.turns and unit not in self.FIXED
            for direction in (0.0, 0.5 * pi) if turns else (azimuth,):
                effect.append(unit_effect(x, y, direction))
                limits.append(max(most, -least))
        check_geometry(effect, limits)

    def _show(self, state):
        self.state = state
        for name, thrust in zip(self.THRUST_CMD, state.thrusts, strict=True):
            setattr(self, name, thrust)
        # A unit that nothing can turn has no command of its angle.
        for name, azimuth in zip(self.AZIMUTH_CMD, state.azimuths, strict=False):
            setattr(self, name, azimuth)
        self.tau_X = state.tau_X
        self.tau_Y = state.tau_Y
        self.tau_N = state.tau_N
        self.saturated = state.saturated
        tau = self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd
        self.slack_X, self.slack_Y, self.slack_N = slack(
            tau, (state.tau_X, state.tau_Y, state.tau_N)
        )
        self.used = used_shares(state.thrusts, self.least, self.most)
        self.thruster_power = thruster_power(self.used, self.power.largest)
