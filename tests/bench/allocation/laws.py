"""Every allocator behind one call: from a request and availability to thrusts and angles. One line a law in `LAWS`."""

import importlib.util
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from ships import equipped, parameters

from allocation import rivals
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters

ROOT = Path(__file__).resolve().parents[3]
UNITS = ("port", "starboard", "tunnel")


class Commands(NamedTuple):
    """Thrusts of port, starboard and tunnel [N], angles of port and starboard [rad], time that it took [s]."""

    thrusts: tuple[float, float, float]
    azimuths: tuple[float, float]
    seconds: float


class FmuLaw:
    """The class of an allocator FMU with the named interface, in this process.

    Parameters
    ----------
    name : str
        Of the FMU.
    settings : dict
        Parameters that differ from those of the ship.
    """

    def __init__(self, name: str, settings: dict[str, Any]):
        self.fmu = equipped(_fmu_class(name)(), "allocator")
        for parameter, value in {"measure_solve_time": True, **settings}.items():
            setattr(self.fmu, parameter, value)
        self.fmu.start()

    def step(self, tau, available, h: float) -> Commands:
        """Commands for a request [N, N, N.m]; `available` says whether port, starboard and tunnel can be used."""
        fmu = self.fmu
        fmu.tau_X_cmd, fmu.tau_Y_cmd, fmu.tau_N_cmd = tau
        fmu.port_available, fmu.starboard_available, fmu.tunnel_available = available
        fmu.step(0.0, h)
        seconds = fmu.solve_time
        thrusts = fmu.port_thrust_cmd, fmu.starboard_thrust_cmd, fmu.tunnel_thrust_cmd
        angles = fmu.port_azimuth_cmd, fmu.starboard_azimuth_cmd
        return Commands(thrusts, angles, seconds)


class RivalLaw:
    """Another project's allocator: a function from the request to the force of each unit, without memory of ours.

    Parameters
    ----------
    make : callable
        Gives the function, from the ship's allocation parameters.
    """

    def __init__(self, make: Callable):
        self.allocate = make(parameters(AllocationParameters))
        self.azimuths = (0.0, 0.0)

    def step(self, tau, available, h: float) -> Commands:
        """As of `FmuLaw`; a unit that cannot be used gives no thrust, and nobody takes over."""
        begun = time.perf_counter()
        forces = self.allocate(tau, h)
        seconds = time.perf_counter() - begun
        turned = [
            float(np.arctan2(y, x)) if np.hypot(x, y) > 1.0 else old
            for (x, y), old in zip(forces[:2], self.azimuths, strict=True)
        ]
        self.azimuths = turned[0], turned[1]
        thrusts = [float(np.hypot(x, y)) for x, y in forces[:2]] + [float(forces[2][1])]
        usable = [thrust if able else 0.0 for thrust, able in zip(thrusts, available, strict=True)]
        return Commands((usable[0], usable[1], usable[2]), self.azimuths, seconds)


LAWS: dict[str, Callable[[], FmuLaw | RivalLaw]] = {
    "allocator": lambda: FmuLaw("allocator", {}),
    "extended_allocator": lambda: FmuLaw("extended_allocator", {}),
    "optimal_allocator": lambda: FmuLaw("optimal_allocator", {}),
    "paper_v_allocator": lambda: FmuLaw("paper_v_allocator", {}),
    "paper_v_allocator, walks": lambda: FmuLaw("paper_v_allocator", {"variant": "paper-v-walks"}),
    "skadipy QP": lambda: RivalLaw(rivals.skadipy_quadratic_programme),
    "quta": lambda: RivalLaw(rivals.quta_with_sectors),
}
"""Name in the table: what makes the law, at rest."""
RIVALS = {"skadipy QP": "skadipy", "quta": "quta"}
"""Name in the table: the package that it needs."""


def there(name: str) -> bool:
    """Whether a law can be measured: rivals need their packages."""
    return name not in RIVALS or importlib.util.find_spec(RIVALS[name]) is not None


@cache
def _fmu_class(name):
    path = ROOT / "fmus" / name / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"fmu_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return next(
        c for c in vars(module).values() if isinstance(c, type) and c.__module__ == spec.name
    )
