"""The crude model of a ship: thrust and damping over inertia as factors on the model's, where they predict better."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.comparison.gains import is_beyond
from shipcosim.diagnose.comparison.thresholds import SURE_OF_RATIO
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import with_thrust

_ONLY_RATIO = "Thrust and inertia cannot be told apart: only their ratio is known."
_ONLY_DAMPING = "Damping and inertia cannot be told apart: only their ratio is known."


@dataclass(frozen=True)
class CrudeNumber:
    """One factor of a crude model: all thrust, or the damping of one axis, over inertia and over the model's.

    Attributes
    ----------
    cause, parameter : str
        In the catalogue.
    axis : str
        ``"surge"``, ``"sway"`` or ``"yaw"`` of a damping; empty of the thrust.
    paths : tuple of str
        Numbers of the ship that take it.
    estimate, std : float
    """

    cause: str
    parameter: str
    axis: str
    paths: tuple[str, ...]
    estimate: float = 1.0
    std: float = 0.0

    def differs(self, least: float) -> bool:
        """Whether it differs from 1 by a factor of more than `least` for sure."""
        return is_beyond(self.estimate, self.std, least, SURE_OF_RATIO)

    def values(self, model: ShipModel, factor: Any) -> dict[str, Any]:
        """Numbers of the ship with a factor, a float or an array, on what the model has."""
        if not self.axis:
            return {path: 1.0 - factor * (1.0 - model.get(path)) for path in self.paths}
        return {path: factor * model.get(path) for path in self.paths}

    def on(self, model: ShipModel) -> ShipModel:
        """The ship with this number, known as well as its standard deviation says."""
        if not self.axis:
            return with_thrust(model, self.estimate, self.std)
        known = {
            p: float(np.hypot(model.tolerances.get(p, 0.0), self.std * abs(model.get(p))))
            for p in self.paths
        }
        return replace(
            model.with_values(self.values(model, self.estimate)),
            tolerances=model.tolerances | known,
        )


@dataclass(frozen=True)
class HeldOutErrors:
    """Errors of predictions over a craft's own horizon, on rows that the crude model was not fitted on.

    Attributes
    ----------
    horizon : float
        [s]
    before, after : float
        Root mean square position error with the given model, and with the crude one. [m]
    over_before : tuple of two floats
        95 % interval of the crude model's error over the given one's, by a bootstrap over blocks of the log.
    over_current : tuple of two floats
        The same over that of the given model with a steady current, fitted on the same rows.
    """

    horizon: float
    before: float
    after: float
    over_before: tuple[float, float]
    over_current: tuple[float, float]

    @property
    def is_better(self) -> bool:
        """Whether the crude model predicts better than the given one beyond doubt, in still water and in a current."""
        return self.over_before[1] < 1.0 and self.over_current[1] < 1.0

    def as_gain(self) -> dict[str, Any]:
        """The entry ``gain`` of diagnosis.json; what is only known beside a fit of fine causes is None."""
        unknown = dict.fromkeys(
            ("bias_observer_m", "noise_floor_m", "share_of_explainable", "ci95")
        )
        known = {
            "horizon_s": float(f"{self.horizon:.4g}"),
            "before_m": self.before,
            "after_m": self.after,
        }
        of_errors = {
            "error_ratio": self.after / self.before,
            "error_ratio_ci95": list(self.over_before),
        }
        return known | unknown | of_errors


@dataclass(frozen=True)
class CrudeModel:
    """Factors on the model's thrust and damping, over inertia.

    Attributes
    ----------
    numbers : tuple of CrudeNumber
        Those that differ from 1; the thrust first.
    errors : HeldOutErrors or None
        None of a ratio of thrust to inertia alone, which the comparison of forces tells.
    """

    numbers: tuple[CrudeNumber, ...]
    errors: HeldOutErrors | None = None

    def differs(self, least: float) -> bool:
        """Whether one of the numbers differs from 1 by a factor of more than `least` for sure."""
        return any(one.differs(least) for one in self.numbers)

    def on(self, model: ShipModel) -> ShipModel:
        """The ship with these numbers, known as well as their standard deviations say."""
        for one in self.numbers:
            model = one.on(model)
        return model

    def without(self, model: ShipModel) -> ShipModel:
        """A ship with these numbers as she was without them."""
        for one in self.numbers:
            model = replace(one, estimate=1.0 / one.estimate, std=0.0).on(model)
        return model

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The numbers as findings of the physics."""
        return tuple(
            Finding(
                one.cause,
                None,
                "physics",
                0.95,
                {one.parameter: ParameterEstimate(one.estimate, one.std, "1")},
                note=_ONLY_DAMPING if one.axis else _ONLY_RATIO,
            )
            for one in self.numbers
        )


def crude_numbers(model: ShipModel, causes: Mapping[str, Cause]) -> list[CrudeNumber]:
    """What a crude model of a ship can consist of, by the causes of a catalogue that are sought in the comparison.

    Parameters
    ----------
    model : ShipModel
    causes : mapping of str to Cause

    Returns
    -------
    list of CrudeNumber
        All 1; the thrust first. Without those that the ship has no number for.
    """
    found = []
    for cause in sorted(
        (one for one in causes.values() if one.sought_in == "comparison"), key=lambda one: one.axis
    ):
        for name, parameter in cause.parameters.items():
            paths = [path for pattern in parameter.of for path in _paths(pattern, model)]
            paths = [
                path
                for path in paths
                if model.has(path) and (not cause.axis or model.get(path) != 0.0)
            ]
            if paths:
                found.append(CrudeNumber(cause.cause, name, cause.axis, tuple(paths)))
    return found


def _paths(pattern: str, model: ShipModel) -> list[str]:
    if "{thrusters}" in pattern:
        return [pattern.replace("{thrusters}", name) for name in model.thrusters]
    return [pattern.replace("vessel.", f"{model.vessel}.", 1)]


def spoken_for(cause: Cause, said: set[str], causes: Mapping[str, Cause]) -> bool:
    """Whether all numbers of a cause are those of causes that are said.

    Parameters
    ----------
    cause : Cause
    said : set of str
        Names of causes.
    causes : mapping of str to Cause
    """
    own = {number for one in cause.parameters.values() for number in one.of}
    known = [causes[name] for name in said if name in causes and causes[name].axis]
    numbers = {
        number for one in known for parameter in one.parameters.values() for number in parameter.of
    }
    return own <= numbers.union(*(one.replaces for one in known))
