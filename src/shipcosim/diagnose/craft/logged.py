"""A log as a craft is learned from it: the accelerations that it shows, and open-loop predictions along it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.errors import counts_of, sailed_steadily, starts_of
from shipcosim.diagnose.comparison.measured_force import MeasuredForce, measured_force_of
from shipcosim.diagnose.craft.numbers import CraftNumber, with_numbers
from shipcosim.diagnose.craft.thresholds import FEWEST_PARTS, MOST_PARTS, MOST_STARTS, PART
from shipcosim.diagnose.inference.predictions import predicted, replayable
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs, Record
from shipcosim.diagnose.ship.measured_motion import at_rows, readings, true_motion
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion

_DIFFERENCE = 1e-3  # of a number's coordinate, for slopes


@dataclass(frozen=True)
class CraftLog:
    """A log that a craft is learned from, in parts of which each is held out in turn.

    Attributes
    ----------
    record, model : Record and ShipModel
        As from `replayable`: the ship as her file has her.
    measured : MeasuredForce
    seen : Motion
        What the instruments show, smoothed, (n,) arrays.
    inputs : Inputs
        What drives her at each row.
    parts : (n,) int array
        Number of the part that a row is in.
    rows, counts : (s,) int array, list of int
        Where predictions start, each within one part; their horizons in rows.
    """

    record: Record
    model: ShipModel
    measured: MeasuredForce
    seen: Motion
    inputs: Inputs
    parts: np.ndarray
    rows: np.ndarray
    counts: list[int]

    @property
    def part_of_start(self) -> np.ndarray:
        """Part that each prediction is in."""
        return self.parts[self.rows]

    def trained_without(self, part: int) -> np.ndarray:
        """Rows that are learned from where a part is held out: none whose smoothing touches it."""
        held_out = self.parts == part
        near = np.convolve(held_out, np.ones(2 * self.measured.kernel.reach + 1), "same") > 0.5
        return self.measured.usable & ~near

    def left(self, model: ShipModel) -> np.ndarray:
        """Acceleration that a ship does not explain, smoothed, (..., 3, n) array."""
        # Modelled accelerations, smoothed with the measured ones' kernel.
        rates = motion_rates(self.measured.motion, self.inputs, model)
        explained = np.stack(np.broadcast_arrays(rates.u, rates.v, rates.r), axis=-2)
        return self.measured.rates - self.measured.kernel.smooth(explained)

    def slopes(
        self, numbers: Sequence[CraftNumber], at: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Unexplained acceleration at some coordinates of the numbers, (3, n), and what one of each explains, (p, 3, n)."""
        # Forward differences in every coordinate, all ships evaluated at once.
        tries = at + np.concatenate([np.zeros((1, at.size)), _DIFFERENCE * np.eye(at.size)])
        values = [
            number.value(column)[:, None] for number, column in zip(numbers, tries.T, strict=True)
        ]
        unexplained = self.left(with_numbers(self.model, numbers, values))
        return unexplained[0], (unexplained[0] - unexplained[1:]) / _DIFFERENCE

    def missed(self, numbers: Sequence[CraftNumber], values: np.ndarray) -> np.ndarray:
        """Errors of predictions, each with the values learned without its part.

        Parameters
        ----------
        numbers : sequence of p CraftNumber
        values : (p, k, s) array
            Of k crafts.

        Returns
        -------
        (k, 3, h, s) array
            North, east [m], heading [rad] after each horizon.
        """
        model = with_numbers(self.model, numbers, values)
        rows = self.rows
        # Predictions of all crafts from the same smoothed states.
        start = true_motion(at_rows(self.seen, rows), self.model)
        start = Motion(*(value + np.zeros((values.shape[1], 1)) for value in start))
        return self._off(readings(predicted(start, rows, self.record, model, self.counts), model))

    def missed_if_steady(self) -> np.ndarray:
        """Prediction errors, (1, 3, h, s) array, of a craft that keeps the velocity and the rate of turn of the start."""
        start = at_rows(self.seen, self.rows)
        time = self.record.step * np.array(self.counts)[:, None, None]
        return self._off(sailed_steadily(start, time))

    def _off(self, predicted: Motion) -> np.ndarray:
        """Predicted less seen place and heading after each horizon, (k, 3, h, s), of (h, k, s) arrays."""
        ends = (self.rows + np.array(self.counts)[:, None])[:, None]
        # Error of heading wrapped to half a turn, positions north and east.
        turned = np.angle(np.exp(1j * (predicted.psi - self.seen.psi[ends])))
        off = np.stack([predicted.x - self.seen.x[ends], predicted.y - self.seen.y[ends], turned])
        return np.moveaxis(off, 2, 0)

    def typical(self) -> dict[str, np.ndarray]:
        """Root mean squares of the velocities and of the commanded force, and of the wind where it is logged."""
        usable = self.measured.usable
        motion = self.measured.velocity[:, usable]
        commanded = commanded_by(self.record, self.measured, self.model)
        total = commanded.thrust[:, usable]
        # The larger of commanded and needed load: thrusters may be idle or too weak.
        needed = np.diag(self.model.mass_matrix)[:, None] * self.measured.rates[:, usable]
        loads = np.sqrt((np.maximum(np.abs(total), np.abs(needed)) ** 2).mean(1))
        typical = {"motion": np.sqrt((motion**2).mean(1)), "loads": loads}
        return (
            typical
            if commanded.wind is None
            else typical | {"wind": np.sqrt((commanded.wind**2).mean(1))}
        )


def craft_log(
    record: Record,
    model: ShipModel,
    horizons: Sequence[float],
    first_part: int = 0,
    *,
    whole: bool = False,
) -> CraftLog | None:
    """A log to learn a craft from; None where it is too short to hold parts of it out.

    Parameters
    ----------
    record : Record
    model : ShipModel
        As her file has her, with surrogates.
    horizons : sequence of float
        Of predictions, increasing. [s]
    first_part : int
        Number of its first part.
    whole : bool
        All of it is one part, as where there are other logs to learn from.
    """
    # Parts long enough for predictions within each; too few parts cannot be held out.
    measured = measured_force_of(record, model.length)
    seen = measured.smooth_motion
    counts = counts_of(horizons, record.step)
    size = record.time.size
    count = int(min(MOST_PARTS, size // (PART * counts[-1])))
    if whole:
        count = 1
    elif count < FEWEST_PARTS:
        return None
    parts = first_part + np.arange(size) * count // size
    # Predictions that stay within one part.
    rows = starts_of(record, measured, horizons[-1])
    rows = rows[parts[rows] == parts[rows + counts[-1]]]
    rows = rows[:: max(1, -(-rows.size // MOST_STARTS))]
    if np.unique(parts[rows]).size < count:
        return None
    # Without delay and with the wind over ground, what is logged in a row acts in that row.
    logged, neutral = replayable(record, model, seen)
    inputs = Inputs(record.time, logged.units, *(logged.wind or (None, None)))
    return CraftLog(logged, neutral, measured, seen, inputs, parts, rows, counts)
