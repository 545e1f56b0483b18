"""What logs taught of a craft: her numbers in words, and what they gain on parts that were held out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from shipcosim.diagnose.comparison.gains import is_beyond
from shipcosim.diagnose.comparison.thresholds import PLAIN, SURE_OF_RATIO
from shipcosim.diagnose.craft.numbers import CraftNumber, thrust_of, with_numbers
from shipcosim.diagnose.craft.thresholds import NOT_WORSE
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.ship.model import ShipModel

_ONLY_RATIO = "Thrust and inertia cannot be told apart: only their ratio is known."


@dataclass(frozen=True)
class LearnedNumber:
    """A number of a craft as learned.

    Attributes
    ----------
    number : CraftNumber
    value, std : float
        The standard deviation by leaving out each part of the logs in turn.
    gain : float
        Error on held-out parts with the file's number instead, over that with this one.
    """

    number: CraftNumber
    value: float
    std: float
    gain: float = 1.0

    def as_json(self) -> dict[str, Any]:
        """Its entry in diagnosis.json."""
        number = self.number
        return {
            "name": number.name,
            "numbers": list(number.paths),
            "is_factor": number.is_factor,
            "unit": number.unit,
            "given": number.given,
            "estimate": self.value,
            "std": self.std,
            "error_without": self.gain,
        }

    def __str__(self) -> str:
        number = self.number
        unit = (
            " of the file's"
            if number.is_factor
            else f" {number.unit}, by the file {number.given:.3g}"
        )
        larger = 100.0 * (self.gain - 1.0)
        gain = f"; without it the error is {larger:.0f} % larger" if larger >= 1.0 else ""
        return f"{number.name} {self.value:.3g} ± {self.std:.2g}{unit}{gain}"


@dataclass(frozen=True)
class HeldOutErrors:
    """Errors of predictions over a craft's own horizon, on parts of logs that were not learned from.

    Attributes
    ----------
    horizon : float
        [s]
    before, after : float
        Root mean square position error with the given ship, and with the learned one. [m]
    before_deg, after_deg : float
        The same of the heading. [deg]
    ratio_ci95 : tuple of two floats
        95 % interval of after over before, in position, by a bootstrap over the parts.
    current_ci95 : tuple of two floats
        The same over the error of the given ship in a steady current, learned from the same rows.
    steady, steady_deg : float
        Errors of a craft that keeps the velocity and the rate of turn of each start. [m, deg]
    steady_ci95 : tuple of two floats
        The interval of after over that, in position.
    """

    horizon: float
    before: float
    after: float
    before_deg: float
    after_deg: float
    ratio_ci95: tuple[float, ...]
    current_ci95: tuple[float, ...]
    steady: float
    steady_deg: float
    steady_ci95: tuple[float, ...]

    @property
    def is_better(self) -> bool:
        """Whether the learned craft predicts positions better beyond doubt, in a current too; headings no worse."""
        is_nearer = max(self.ratio_ci95[1], self.current_ci95[1]) < 1.0
        return is_nearer and self.after_deg < NOT_WORSE * self.before_deg

    @property
    def beats_steady(self) -> bool:
        """Whether she predicts positions better, beyond doubt, than one that keeps her velocity; headings no worse."""
        return self.steady_ci95[1] < 1.0 and self.after_deg < NOT_WORSE * self.steady_deg

    def as_gain(self) -> dict[str, Any]:
        """The entry ``gain`` of diagnosis.json; what is only known beside a fit of fine causes is None."""
        unknown = ("bias_observer_m", "noise_floor_m", "share_of_explainable", "ci95")
        return {
            "horizon_s": float(f"{self.horizon:.4g}"),
            "before_m": self.before,
            "after_m": self.after,
            "error_ratio": self.after / self.before,
            "error_ratio_ci95": list(self.ratio_ci95),
        } | dict.fromkeys(unknown)


@dataclass(frozen=True)
class LearnedCraft:
    """A craft as logs taught her.

    Attributes
    ----------
    numbers : tuple of LearnedNumber
    before, after : dict of str to float
        Numbers of the ship that differ, by the file and as learned.
    std : dict of str to float
        Of those as learned.
    errors : HeldOutErrors or None
        None of a ratio of thrust to inertia alone, which the comparison of forces tells.
    logs : int
        How many she was learned from.
    each_without : tuple of LearnedCraft
        Of several logs: the same numbers as learned without each of them.
    """

    numbers: tuple[LearnedNumber, ...]
    before: dict[str, float]
    after: dict[str, float]
    std: dict[str, float]
    errors: HeldOutErrors | None = None
    logs: int = 1
    each_without: tuple[LearnedCraft, ...] = ()

    def on(self, model: ShipModel) -> ShipModel:
        """The ship with these numbers; their standard deviations are the new tolerances."""
        # The uncertainty of learning adds to the tolerances that the numbers have already.
        stds = {
            path: float(np.hypot(model.tolerances.get(path, 0.0), std))
            for path, std in self.std.items()
        }
        return model.with_values(self.after).with_tolerances(stds)

    def without(self, model: ShipModel) -> ShipModel:
        """A ship with these numbers as her file has her."""
        return model.with_values(self.before)

    @property
    def thrust(self) -> LearnedNumber | None:
        """Thrust over inertia, where it is learned and differs from the file's for sure."""
        thrust = next((number for number in self.numbers if number.number.name == "thrust"), None)
        if thrust is None or not is_beyond(thrust.value, thrust.std, PLAIN, SURE_OF_RATIO):
            return None
        return thrust

    def as_json(self) -> dict[str, Any]:
        """The entry ``craft`` of diagnosis.json."""
        errors = asdict(self.errors) if self.errors else None
        return {
            "numbers": [number.as_json() for number in self.numbers],
            "logs": self.logs,
            "held_out": errors,
        }


def learned_craft(
    model: ShipModel,
    numbers: Sequence[LearnedNumber],
    errors: HeldOutErrors | None = None,
    logs: int = 1,
) -> LearnedCraft:
    """A craft with some numbers learned.

    Parameters
    ----------
    model : ShipModel
        As her file has her.
    numbers : sequence of LearnedNumber
    errors : HeldOutErrors, optional
    logs : int
    """
    paths = dict.fromkeys(
        path for learned_number in numbers for path in learned_number.number.paths
    )
    values = [learned_number.value for learned_number in numbers]

    def numbers_at(values: Sequence[float]) -> dict[str, float]:
        ship = with_numbers(model, [learned_number.number for learned_number in numbers], values)
        return {path: float(ship.get(path)) for path in paths}

    after = numbers_at(values)
    # Delta method: move each learned number by its standard deviation, and add the squares of what
    # that moves.
    squares = dict.fromkeys(paths, 0.0)
    for i, number in enumerate(numbers):
        moved = numbers_at([*values[:i], number.value + number.std, *values[i + 1 :]])
        squares = {
            path: square + (moved[path] - after[path]) ** 2 for path, square in squares.items()
        }
    before = {path: float(model.get(path)) for path in paths}
    std = {path: float(np.sqrt(square)) for path, square in squares.items()}
    return LearnedCraft(tuple(numbers), before, after, std, errors, logs)


def ratio_alone(model: ShipModel, ratio: float, std: float) -> LearnedCraft | None:
    """A craft of which only the ratio of thrust to inertia is known; None where no thruster has a number for it."""
    thrust = thrust_of(model)
    return learned_craft(model, [LearnedNumber(thrust, ratio, std)]) if thrust else None


def ratio_findings(ratio: float, std: float, causes: Mapping[str, Cause]) -> tuple[Finding, ...]:
    """Thrust over inertia as a finding; none if the catalogue lacks the cause."""
    cause = next(
        (definition for definition in causes.values() if definition.sought_in == "comparison"), None
    )
    if cause is None:
        return ()
    parameters = {next(iter(cause.parameters)): ParameterEstimate(ratio, std, "1")}
    return (Finding(cause.cause, None, "physics", 0.95, parameters, note=_ONLY_RATIO),)
