"""Learning a craft: which numbers her logs teach, by what they gain on parts that were held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.craft.fit import Normal, fitted
from shipcosim.diagnose.craft.learned import (
    HeldOutErrors,
    LearnedCraft,
    LearnedNumber,
    learned_craft,
)
from shipcosim.diagnose.craft.logged import CraftLog
from shipcosim.diagnose.craft.numbers import CraftNumber, current_numbers, numbers_of, with_numbers
from shipcosim.diagnose.craft.thresholds import DRIVING, LEAST_GAIN, MOST_NUMBERS, SURE
from shipcosim.diagnose.inference.thresholds import DRAWS
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.ship.hull import hull_loads


@dataclass(frozen=True)
class _HeldOut:
    """Mean squares of prediction errors by part, of several crafts: (k, c, parts) array, and predictions in each."""

    squares: np.ndarray
    counts: np.ndarray

    def gain(self, craft: int, other: int) -> tuple[float, float]:
        """Natural logarithm by which the error of one craft is above another's, and its standard error."""
        # Logarithm of the error, mean over position and heading and horizons: without each part, and of all parts.
        sums = self.squares * self.counts
        total = sums.sum(-1, keepdims=True)
        squares = np.concatenate([total - sums, total], axis=-1)
        without = 0.5 * np.log(np.maximum(squares, 1e-18)).mean(1)
        # Jackknife: the error without each part, of both crafts; the variance of their difference.
        each = without[craft] - without[other]
        return float(each[-1]), float(_jackknife(each[:-1]))


def _jackknife(without: np.ndarray) -> np.ndarray:
    """Standard deviation by the jackknife: from the values without each part, along the first axis."""
    parts = len(without)
    return np.sqrt((parts - 1) / parts * ((without - without.mean(0)) ** 2).sum(0))


def learn(logs: Sequence[CraftLog]) -> LearnedCraft | None:
    """Learn a craft from logs; None if no ship can have the best-fitting numbers.

    Numbers that the file has are free from the start. One by one those are added that lower the error most on parts
    that were held out, then those given back to the file without which the error is no larger.
    """
    model = logs[0].model
    # Typical motions and loads of what every log has.
    each = [log.typical() for log in logs]
    typical = {
        name: np.sqrt(np.mean([np.square(rms[name]) for rms in each], axis=0))
        for name in each[0]
        if all(name in rms for rms in each)
    }
    # Forward selection: add the number that lowers the held-out error most, until none does so
    # surely.
    numbers = numbers_of(model, typical)
    free = [i for i, number in enumerate(numbers) if number.is_of_file]
    near = None
    while True:
        normal = fitted(logs, numbers, free, near)
        near = normal.solved(free)[-1]
        # Sets with one more number.
        tries = [free, *[[*free, i] for i in range(len(numbers)) if i not in free]]
        held_out = _held_out(logs, normal, tries)
        best = _best(held_out, tries, normal, logs)
        if best is None or len(free) >= MOST_NUMBERS:
            break
        free = best
    # Backward elimination of numbers that do not help.
    free = _without_idle(logs, normal, free)
    normal = fitted(logs, numbers, free, near)
    return None if _drives(logs, normal, free) else _stated(logs, normal, free)


def _held_out(logs: Sequence[CraftLog], normal: Normal, tries: Sequence[Sequence[int]]) -> _HeldOut:
    """Errors on parts that were held out, of the craft with each set of numbers."""
    values = normal.values(np.stack([normal.solved(free) for free in tries]))
    return _errors(logs, normal.numbers, values)


def _errors(
    logs: Sequence[CraftLog], numbers: Sequence[CraftNumber], values: np.ndarray
) -> _HeldOut:
    """Errors by part with the values without each, (k, parts + 1, p) array."""
    # Each prediction uses the numbers fitted without its own part (cross-validation).
    return _by_part(
        logs,
        [log.missed(numbers, np.moveaxis(values[:, log.part_of_start], -1, 0)) for log in logs],
    )


def _by_part(logs: Sequence[CraftLog], missed: Sequence[np.ndarray]) -> _HeldOut:
    """Errors by part, of what each log's predictions miss at the two longest horizons."""
    squares, counts = [], []
    for log, off in zip(logs, missed, strict=True):
        part = log.part_of_start
        off = off[:, :, -2:]
        position = (off[:, :2] ** 2).sum(1)
        each = np.concatenate([position, off[:, 2] ** 2], axis=1)
        for number in np.unique(part):
            squares.append(each[..., part == number].mean(-1))
            counts.append((part == number).sum())
    # Each part counts as much as it has predictions, at most as much as a usual one.
    weights = np.minimum(np.array(counts, float), np.median(counts))
    return _HeldOut(np.stack(squares, axis=-1), weights)


def _best(held_out: _HeldOut, tries, normal: Normal, logs) -> list[int] | None:
    """The set with the further number that lowers the error most; None if none lowers it clearly."""
    # Largest gain first; it must exceed its standard error, and the result must be a possible ship.
    gains = [held_out.gain(0, k) for k in range(1, len(tries))]
    order = sorted(range(len(gains)), key=lambda k: -gains[k][0])
    for k in order:
        gain, std = gains[k]
        if gain < LEAST_GAIN:
            return None
        if gain > SURE * std and not _drives(logs, normal, tries[k + 1]):
            return tries[k + 1]
    return None


def _drives(logs: Sequence[CraftLog], normal: Normal, free: Sequence[int]) -> bool:
    """Whether the numbers are impossible: the water would drive the ship, or her mass matrix is not positive."""
    # A positive definite mass matrix, and a hull that takes energy rather than gives it.
    values = normal.values(normal.solved(free)[-1])
    model = with_numbers(logs[0].model, normal.numbers, values)
    mass = model.mass_matrix
    if np.linalg.eigvalsh(0.5 * (mass + mass.T)).min() <= 0.0:
        return True
    return _driving_share(logs, model) > max(DRIVING, _driving_share(logs, logs[0].model))


def _driving_share(logs: Sequence[CraftLog], model: ShipModel) -> float:
    """Energy that the water gives a ship over what it takes, at the speeds of logs and at twice as much."""
    given = 0.0
    taken = 1e-12
    # Power of the hull loads along the logged motion, and at twice its speed.
    for log in logs:
        for factor in (1.0, 2.0):
            u, v, r = (factor * series[log.measured.usable] for series in log.seen[3:])
            X, Y, N = hull_loads(u, v, r, hull=model.parts["hull"])
            power = X * u + Y * v + N * r
            given += float(np.maximum(power, 0.0).sum())
            taken += float(np.maximum(-power, 0.0).sum())
    return given / taken


def _without_idle(logs: Sequence[CraftLog], normal: Normal, free: list[int]) -> list[int]:
    """A set without numbers that gain nothing on parts that were held out: they are the file's."""
    # Drop the number whose absence costs least while that lowers the error.
    while len(free) > 1:
        tries = [free, *([i for i in free if i != left_out] for left_out in free)]
        held_out = _held_out(logs, normal, tries)
        losses = [held_out.gain(k, 0)[0] for k in range(1, len(tries))]
        least = int(np.argmin(losses))
        if losses[least] > 0.0:
            return free
        free = tries[least + 1]
    return free


def _stated(logs: Sequence[CraftLog], normal: Normal, free: list[int]) -> LearnedCraft:
    """The learned numbers, with the gain of each and of all on held-out parts."""
    numbers = [normal.numbers[i] for i in free]
    # The learned set, the set without each number, and the file's ship.
    tries = [free, *([i for i in free if i != left_out] for left_out in free), []]
    values = normal.values(np.stack([normal.solved(attempt) for attempt in tries]))
    each = values[0]
    held_out = _errors(logs, normal.numbers, values)
    # Her rival: the file's ship in a steady current, learned alike.
    current = current_numbers()
    rival = fitted(logs, current, range(len(current)))
    in_current = rival.values(rival.solved(range(len(current)))[None])
    by_current = _errors(logs, current, in_current)
    steady = _by_part(logs, [log.missed_if_steady() for log in logs])
    # Jackknife standard deviation of each number.
    spread = _jackknife(each[:-1])
    gains = [float(np.exp(held_out.gain(k, 0)[0])) for k in range(1, len(tries) - 1)]

    def craft(values: np.ndarray) -> LearnedCraft:
        learned = [
            LearnedNumber(number, float(values[i]), float(spread[i]), gain)
            for number, i, gain in zip(numbers, free, gains, strict=True)
            if values[i] != number.given
        ]
        return learned_craft(
            logs[0].model, learned, _of_all(held_out, (by_current, steady), logs), len(logs)
        )

    if len(logs) == 1:
        return craft(each[-1])
    return replace(craft(each[-1]), each_without=tuple(map(craft, each[:-1])))


def _of_all(
    held_out: _HeldOut, rivals: Sequence[_HeldOut], logs: Sequence[CraftLog]
) -> HeldOutErrors:
    """Errors on held-out parts: of the learned craft, the first; of the given ship, the last; and of two rivals."""
    # Bootstrap over the parts: multinomial counts are draws with repetition.
    weights = held_out.counts
    draws = np.random.default_rng(1).multinomial(
        weights.size, np.full(weights.size, 1.0 / weights.size), size=DRAWS
    )
    # Position and heading at the longest horizon: errors, and ratios of errors over the draws.
    squares = np.concatenate([held_out.squares[[0, -1]], *(rival.squares for rival in rivals)])
    sums = squares[:, [1, 3]] * weights
    errors = np.sqrt(sums.sum(-1) / weights.sum())
    drawn = np.sqrt(np.maximum(sums[:, 0] @ draws.T, 1e-30))
    over = [
        tuple(map(float, np.quantile(drawn[0] / rival_error, (0.025, 0.975))))
        for rival_error in drawn[1:]
    ]
    after, before, _, steady = ((float(place), float(np.degrees(turn))) for place, turn in errors)
    horizon = logs[0].counts[-1] * logs[0].record.step
    return HeldOutErrors(
        horizon, before[0], after[0], before[1], after[1], over[0], over[1], *steady, over[2]
    )
