"""The scene of a diagnosis: the measured ship and her simulations side by side, and the force that is missing."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.diagnose.validation.missing_force import MissingForce
from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.report.diagnosis.force_figures import averaged, stretches
from shipcosim.report.run.scene import Run, make_run
from shipcosim.report.theme.views import FigurePage
from shipcosim.ssp import System

SIGNALS = {
    "north": ("x", "m"),
    "east": ("y", "m"),
    "heading": ("psi", "deg"),
    "surge": ("u", "m/s"),
    "sway": ("v", "m/s"),
    "yaw_rate": ("r", "deg/s"),
}
"""Signal of the scene's vessel and its unit, by role of the log."""
COLOURS = ("ink", "orange", "blue")
"""Colours of the measured ship and of her simulations, as in the figures below the scene."""
MOST_ARROWS = 200
"""Means of the missing force over the log: between them it is interpolated. Assumed."""


@dataclass(frozen=True, kw_only=True)
class ScenePage(FigurePage):
    """A page with figures on which the measured ship and her simulations sail again.

    Attributes
    ----------
    scene : tuple of Run
        Empty where there are no tracks.
    """

    scene: tuple[Run, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        drawn = {"figures": self.data, "scene": self.scene, "events": ()}
        object.__setattr__(self, "data", drawn | {"bars": "Force on the measured ship"})


def make_scene(
    tracks: Tracks | None, force: MissingForce | None, system: System | None
) -> tuple[Run, ...]:
    """The log and its simulations as runs of one scene.

    Parameters
    ----------
    tracks : Tracks or None
        Measured and simulated motion; None: there is no scene.
    force : MissingForce or None
        What else pushed the ship: drawn as an arrow from her middle.
    system : System or None
        Whose ship gives the size.

    Returns
    -------
    tuple of Run
        The measured one first; empty where the log has no position and heading.
    """
    if tracks is None:
        return ()
    size = _size(system)
    seen = {role: tracks.measured[role].values for role in SIGNALS}
    time = tracks.measured["time"].values
    runs = [_run("measured", time, seen, size, force)]
    # Predictions one after the other: at its end each jumps to where the next one starts.
    for name, prediction in tracks.predicted.items():
        starts = prediction["start_time"].values[:, None] + prediction["time"].values
        joined = {role: prediction[role].values.ravel() for role in SIGNALS}
        runs.append(_run(name, starts.ravel(), joined, size, None))
    shown = zip(runs, COLOURS, strict=False)
    return tuple(replace(run, colour=colour) for run, colour in shown if run is not None)


def _size(system: System | None) -> dict[str, float]:
    """Length and breadth of the ship, as start values of the scene's vessel. [m]"""
    for component in system.components.values() if system else ():
        sizes = {name: component.start.get(name) for name in ("length", "breadth")}
        size = {
            f"vessel.{name}": value for name, value in sizes.items() if isinstance(value, float)
        }
        if len(size) == len(sizes):
            return size
    return {}


def _run(
    label: str,
    time: NDArray,
    motion: Mapping[str, NDArray],
    size: dict[str, float],
    force: MissingForce | None,
) -> Run | None:
    """One ship of the scene, as the scene of a run makes it from a table of signals."""
    signals = {
        f"vessel.{signal}": ("time", motion[role], {"units": unit})
        for role, (signal, unit) in SIGNALS.items()
    }
    # The force of a single row is mostly noise: means over stretches, drawn like a thruster amidships.
    starts = dict(size)
    if force is not None:
        middle, edges = stretches(force.plain["time"].values, MOST_ARROWS)
        forward, starboard = (
            np.interp(time, middle, averaged(force.plain[way], edges)) for way in ("surge", "sway")
        )
        parts = {"tau_X": forward, "tau_Y": starboard, "thrust": np.hypot(forward, starboard)}
        signals |= {
            f"missing.{name}": ("time", values, {"units": "kN"}) for name, values in parts.items()
        }
        starts |= {"missing.x": 0.0, "missing.y": 0.0}
    attributes = {"start_values": json.dumps(starts)}
    return make_run(Dataset(signals, {"time": time}, attributes), label=label)
