"""Stability margins of the DP loop of a run, from its start values alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from math import pi
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem
from shipcosim.models.control import margins as loops
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.study_model import Quantity, Study

if TYPE_CHECKING:
    from shipcosim.ssp import System

PARTS: tuple[Any, ...] = (DpShip, ObserverParameters, ControlParameters)
UNITS = {"phase": "rad", "gain": "1", "delay": "s"}
NONE = {"phase": 0.0, "gain": 1.0, "delay": 0.0}
"""Margins of a loop that is not stable."""


@dataclass(frozen=True)
class Margin:
    """Least margin of surge, sway and yaw.

    Parameters
    ----------
    kind : str
        ``"phase"``, ``"gain"`` or ``"delay"``.
    component : str
        The controller.
    wave_frequency : float
        That the wave filter has adapted to. [rad/s]
    values : mapping of str to float
        Its parameters in all runs, in the units of its variables.
    """

    kind: str
    component: str
    wave_frequency: float
    values: Mapping[str, float]

    def of(self, values: Mapping[str, Any]) -> float:
        """The margin of a run by its start values. [rad, 1 or s]"""
        # The run's own gains where it sets them, else those of all runs.
        of_run = tuple(
            float(values.get(f"{self.component}.{name}", value))
            for name, value in self.values.items()
        )
        return _least(tuple(self.values), of_run, self.wave_frequency)[self.kind]


def margin_of(quantity: Quantity, system: System) -> Margin:
    # The wave filter is tuned to the peak of the waves, ω = 2π / T_p.
    """Margin of a quantity, of a system that `complaint_of_margin` says nothing against."""
    component: Any = system.components[quantity.component]
    values = {name: float(component.start_value(name)) for name in _names()}
    return Margin(
        str(quantity.margin),
        quantity.component,
        2.0 * pi / float(quantity.peak_period or 0.0),
        values,
    )


def complaint_of_margin(study: Study, number: int, system: System) -> Problem | None:
    """Problem of the component of a margin."""
    name = study.quantity[number].component
    # A controller is recognised by its parameters, not by its name.
    having = [
        c.name
        for c in system.components.values()
        if all(parameter in c.variables for parameter in _names())
    ]
    if name in having:
        return None
    message = f"'{name}' is no DP controller: it lacks parameters of observer and control law."
    remedy = f"Those of {', '.join(having)} are there." if having else "The system has none."
    return problem_of(
        study,
        ("quantity", number, "component" if name != "controller" else "margin"),
        message,
        remedy,
    )


def _names() -> list[str]:
    return [field.name for part in PARTS for field in fields(part)]


@lru_cache(maxsize=64)
def _least(
    names: tuple[str, ...], values: tuple[float, ...], wave_frequency: float
) -> dict[str, float]:
    """Least margins over the axes; cached, since runs often differ only in seeds."""
    # Build the parameter groups that the analysis of the loop needs.
    given = dict(zip(names, values, strict=True))
    ship, noise, law = (
        part(**{field.name: given[field.name] for field in fields(part)}) for part in PARTS
    )
    # The loop linearised about rest: ship, observer and control law, without further delays.
    loop = loops.linear_loop(ship, noise, law, loops.Delays(), wave_frequency)
    if not loops.is_stable(loop):
        return NONE
    # Surge, sway and yaw each have margins; the least one counts.
    margins = [loops.margins(loop, axis) for axis in range(len(loops.AXES))]
    return {kind: min(getattr(margin, kind) for margin in margins) for kind in UNITS}
