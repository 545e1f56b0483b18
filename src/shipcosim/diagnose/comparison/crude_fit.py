"""Fit of a crude model to open-loop predictions over a craft's own time, and its errors on blocks that are held out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.comparison.axes import axes_of
from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.crude_model import (
    CrudeModel,
    CrudeNumber,
    HeldOutErrors,
    crude_numbers,
)
from shipcosim.diagnose.comparison.errors import starts_of
from shipcosim.diagnose.comparison.gains import CommonRatio, common_ratio, gains_of
from shipcosim.diagnose.comparison.label_hypotheses import ahead_of
from shipcosim.diagnose.comparison.measured_force import Felt
from shipcosim.diagnose.comparison.thresholds import (
    COMMON_SPREAD,
    CRUDE_BLOCK,
    CRUDE_FOLDS,
    CRUDE_ROUNDS,
    CRUDE_SETTLED,
    CRUDE_STARTS,
    DAMPING_SPREAD,
    FEWEST_BLOCKS,
    FEWEST_USABLE,
    HUBER,
    LARGEST_STEP,
    NOT_ZERO,
    ROUND_MODEL,
    TYPICAL_CURRENT,
)
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.inference.predictions import predicted, replayable
from shipcosim.diagnose.inference.thresholds import DRAWS
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import readings, true_motion
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion

_STEP = 1e-3  # of a logarithm, for derivatives
_DAMPED = np.array([0.0, 0.3, 3.0, 30.0])  # shares of the diagonal that steps are damped by
_BOUND = np.log(20.0)


@dataclass(frozen=True)
class _Task:
    """Fits that are made side by side, each on some of the predictions.

    Attributes
    ----------
    used : (f, s) bool array
    mean, std : (f, p) arrays
        What is taken to be known of the logarithms.
    """

    used: np.ndarray
    mean: np.ndarray
    std: np.ndarray

    def of_numbers(self, free: np.ndarray) -> _Task:
        """Of some of the numbers."""
        return replace(self, mean=self.mean[:, free], std=self.std[:, free])


@dataclass(frozen=True)
class _Current:
    """A steady current in one direction, in the place of a crude number: what water that goes would do instead."""

    path: str
    axis: str = "water"

    def values(self, model: ShipModel, factor: np.ndarray) -> dict[str, np.ndarray]:
        """Numbers of the ship with the current that goes with a factor."""
        return {self.path: model.get(self.path) + TYPICAL_CURRENT * np.log(factor)}


@dataclass(frozen=True)
class _Predictions:
    """Open-loop predictions from rows of a log.

    Attributes
    ----------
    record, model : Record and ShipModel
        As from `replayable`; `original` as it was before.
    seen, start : Motion
        What the instruments show, smoothed, (n,) arrays; the state at each row.
    rows : (s,) array
    counts : list of int
        Horizons in rows.
    numbers : sequence of CrudeNumber
    weights : (3, h, 1) array
        Over the root mean square errors of the given model: north, east, heading.
    """

    record: Record
    model: ShipModel
    original: ShipModel
    seen: Motion
    rows: np.ndarray
    counts: list[int]
    numbers: Sequence[CrudeNumber | _Current]
    weights: np.ndarray

    def missed(self, logs: np.ndarray) -> np.ndarray:
        """Errors with some factors, (k, p) array of logarithms: (k, 3, h, s) array, north [m], east [m], heading."""
        values = {}
        for one, factor in zip(self.numbers, np.exp(logs).T, strict=True):
            values |= one.values(self.model, factor[:, None])
        model = self.model.with_values(values)
        rows = self.rows
        start = true_motion(Motion(*(value[rows] for value in self.seen)), self.original)
        start = Motion(*(value + np.zeros((len(logs), 1)) for value in start))
        found = readings(predicted(start, rows, self.record, model, self.counts), model)
        ends = (rows + np.array(self.counts)[:, None])[:, None]
        off = (
            found.x - self.seen.x[ends],
            found.y - self.seen.y[ends],
            found.psi - self.seen.psi[ends],
        )
        return np.moveaxis(np.stack([*off[:2], np.angle(np.exp(1j * off[2]))]), 2, 0)

    def of_numbers(self, which: np.ndarray) -> _Predictions:
        """Those with some of the numbers."""
        return replace(
            self, numbers=[one for one, is_in in zip(self.numbers, which, strict=True) if is_in]
        )

    @property
    def share(self) -> float:
        """What each start counts: those of less than a horizon apart are of one."""
        apart = np.minimum(np.diff(self.rows), self.counts[-1]).sum() if self.rows.size > 1 else 0.0
        return (float(apart) / self.counts[-1] + 1.0) / self.rows.size

    @property
    def block(self) -> np.ndarray:
        """Number of the block that each start is in."""
        return self.rows // max(round(CRUDE_BLOCK * self.counts[-1]), 1)


def crude_model(
    record: Record,
    felt: Felt,
    model: ShipModel,
    causes: Mapping[str, Cause],
    horizons: Sequence[float],
) -> CrudeModel | None:
    """The crude model of a log: what differs from the given one for sure, and how well it predicts blocks held out.

    Parameters
    ----------
    record : Record
    felt : Felt
        Of the log.
    model : ShipModel
        As given, with surrogates.
    causes : mapping of str to Cause
    horizons : sequence of float
        Of the predictions, increasing; the longer ones are left out where the log has too few blocks of them. [s]

    Returns
    -------
    CrudeModel or None
        None where the forces felt do not tell thrust over inertia, so that nobody knows what balances the damping;
        where nothing differs for sure; or where the log is too short. Whether it predicts better its errors say.
    """
    ratio = _ratio_on(record, felt, model)
    numbers = crude_numbers(model, causes)
    if ratio is None or not numbers:
        return None
    every = _predictions(record, felt, model, numbers, horizons)
    while np.unique(every.block).size < FEWEST_BLOCKS:
        horizons = horizons[:-1]
        if not horizons:
            return None
        every = _predictions(record, felt, model, numbers, horizons)

    free, logs, std = _differing(every, ratio)
    if not free.any():
        return None
    train, touched = _folds(every)
    task = _task(
        every, train, [_ratio_on(record, felt, model, ~rows) for rows in touched]
    ).of_numbers(free)
    others, _ = _fitted(
        every.of_numbers(free), task, np.repeat(logs[None], len(train), axis=0), CRUDE_ROUNDS // 2
    )
    current = replace(
        every, numbers=[_Current(f"water.current_{way}") for way in ("north", "east")]
    )
    drifting, _ = _fitted(
        current, _task(current, train, [None] * len(train)), rounds=CRUDE_ROUNDS // 2
    )
    errors = _held_out(every.of_numbers(free), others, current, drifting)
    found = [one for one, is_free in zip(numbers, free, strict=True) if is_free]
    return CrudeModel(tuple(map(_sized, found, logs, std)), errors)


def _differing(
    every: _Predictions, ratio: CommonRatio
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which numbers differ from the given model for sure; logarithms and standard deviations of these."""
    free = np.ones(len(every.numbers), bool)
    logs = None
    task = _task(every, np.ones((1, every.rows.size), bool), [ratio])
    while True:
        logs, std = _fitted(every.of_numbers(free), task.of_numbers(free), logs)
        sure = np.abs(logs[0]) > NOT_ZERO * std[0]
        free[np.flatnonzero(free)[~sure]] = False
        if sure.all() or not free.any():
            return free, logs[0], std[0]
        logs = logs[:, sure]


def _sized(number: CrudeNumber, log: float, std: float) -> CrudeNumber:
    """A number with its size."""
    size = float(np.exp(log))
    spread = DAMPING_SPREAD if number.axis else COMMON_SPREAD
    return replace(number, estimate=size, std=float(size * np.hypot(std, spread)))


def _predictions(record, felt, model, numbers, horizons):
    """Predictions from all over a log, with the weights by the errors of the given model."""
    counts = [max(1, round(horizon / record.step)) for horizon in horizons]
    rows = starts_of(record, felt, horizons[-1])
    rows = rows[:: max(1, -(-rows.size // CRUDE_STARTS))]
    seen = Motion(*(felt.kernel.smooth(value) for value in felt.motion))
    logged, neutral = replayable(record, model, seen)
    found = _Predictions(
        logged, neutral, model, seen, rows, counts, numbers, np.ones((3, len(counts), 1))
    )
    squares = (found.missed(np.zeros((1, len(numbers))))[0] ** 2).mean(-1, keepdims=True)
    squares[:2] = squares[:2].mean(0)
    return replace(found, weights=1.0 / np.sqrt(squares + 1e-18))


def _ratio_on(record, felt, model, rows=None):
    """Thrust over inertia by the forces felt, on some rows if given; None where they do not tell it."""
    usable = felt.usable if rows is None else felt.usable & rows
    if usable.sum() < FEWEST_USABLE:
        return None
    felt = replace(felt, usable=usable)
    commanded = commanded_by(record, felt, model)
    return common_ratio(
        gains_of(axes_of(felt, commanded, model), commanded, ahead_of(record.units))
    )


def _task(predictions, used, ratios):
    """Fits round the model, and of the thrust round what the forces felt tell, where they do."""
    mean = np.zeros((len(used), len(predictions.numbers)))
    std = np.full(mean.shape, ROUND_MODEL)
    for i in (i for i, one in enumerate(predictions.numbers) if not one.axis):
        for j, ratio in enumerate(ratios):
            if ratio is not None:
                mean[j, i], std[j, i] = np.log(ratio.ratio), ratio.std / ratio.ratio
    return _Task(used, mean, std)


def _fitted(
    predictions: _Predictions,
    task: _Task,
    start: np.ndarray | None = None,
    rounds: int = CRUDE_ROUNDS,
) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of the factors that predict best, and their standard deviations, (f, p) arrays.

    Levenberg's and Marquardt's steps, several of which are tried at once.
    """
    logs = task.mean.copy() if start is None else start
    every = np.arange(len(logs))
    for _ in range(rounds):
        off, normal, each = _linearised(predictions, task, logs)
        diagonal = normal * np.eye(logs.shape[1])
        steps = np.stack(
            [
                np.linalg.solve(normal + by * diagonal, each.sum(2)[..., None])[..., 0]
                for by in _DAMPED
            ]
        )
        tries = np.clip(logs - np.clip(steps, -LARGEST_STEP, LARGEST_STEP), -_BOUND, _BOUND)
        costs = np.stack(
            [
                _cost(predictions, task, *one)
                for one in zip(_missed(predictions, tries), tries, strict=True)
            ]
        )
        best = costs.argmin(0)
        better = costs[best, every] < _cost(predictions, task, off, logs)
        new = np.where(better[:, None], tries[best, every], logs)
        moved = np.abs(new - logs).max()
        logs = new
        if moved < CRUDE_SETTLED:
            break
    return logs, _deviations(predictions, task, logs)


def _missed(predictions, logs):
    """Errors with (..., p) arrays of logarithms: (..., 3, h, s) array."""
    found = predictions.missed(logs.reshape(-1, logs.shape[-1]))
    return found.reshape(*logs.shape[:-1], *found.shape[1:])


def _deviations(predictions, task, logs):
    """Standard deviations: the larger of those by what is left and of those by what blocks of the log say apart."""
    off, normal, each = _linearised(predictions, task, logs)
    inverse = np.linalg.inv(normal)
    left = (_loss(off * predictions.weights) * task.used[:, None, None]).mean(
        (1, 2, 3)
    ) / task.used.mean(1)
    number = np.unique(predictions.block, return_inverse=True)[1]
    blocks = int(number.max()) + 1
    sums = each[..., :-1] @ np.eye(blocks)[number]
    spread = sums @ sums.swapaxes(1, 2) * blocks / max(blocks - logs.shape[1], 1)
    by_blocks = inverse @ (spread + task.std[:, None] ** -2.0 * np.eye(logs.shape[1])) @ inverse
    squares = [
        np.diagonal(one, axis1=1, axis2=2)
        for one in (inverse * np.minimum(left, 1.0)[:, None, None], by_blocks)
    ]
    return np.sqrt(np.maximum(*squares))


def _linearised(predictions, task, logs):
    """Errors, the normal matrices, and the gradients by start with the prior's last, (f, p, s + 1) array."""
    found = _missed(
        predictions, np.concatenate([logs[None], logs + _STEP * np.eye(logs.shape[1])[:, None]])
    )
    off = found[0]
    slope = (found[1:] - found[0]) / _STEP
    size = np.maximum(np.abs(off * predictions.weights), 1e-12)
    heavy = (
        np.minimum(1.0, HUBER / size)
        * predictions.weights**2
        * predictions.share
        * task.used[:, None, None]
    )
    prior = task.std**-2.0
    normal = np.einsum("ifabc,jfabc,fabc->fij", slope, slope, heavy) + prior[:, None] * np.eye(
        logs.shape[1]
    )
    each = np.einsum("ifabc,fabc->fic", slope, off * heavy)
    return off, normal, np.concatenate([each, ((logs - task.mean) * prior)[..., None]], axis=2)


def _loss(off):
    """Huber's loss, twice."""
    size = np.abs(off)
    return np.where(size < HUBER, size**2, HUBER * (2.0 * size - HUBER))


def _cost(predictions, task, off, logs):
    """What is minimised, (f,) array."""
    of_log = (_loss(off * predictions.weights) * task.used[:, None, None]).sum(
        (1, 2, 3)
    ) * predictions.share
    return of_log + (((logs - task.mean) / task.std) ** 2).sum(1)


def _folds(predictions: _Predictions) -> tuple[np.ndarray, np.ndarray]:
    """Parts to hold out: predictions that touch no row of those held out, (f, s) array; rows that these do, (f, n)."""
    reach = predictions.counts[-1]
    rows = predictions.rows
    fold = np.unique(predictions.block, return_inverse=True)[1] % CRUDE_FOLDS
    touched = np.zeros((CRUDE_FOLDS, predictions.seen.x.size), bool)
    for number, row in zip(fold, rows, strict=True):
        touched[number, row : row + reach + 1] = True
    sums = np.pad(np.cumsum(touched, axis=1), ((0, 0), (1, 0)))
    return sums[:, rows + reach + 1] == sums[:, rows], touched


def _held_out(
    predictions: _Predictions, logs: np.ndarray, rival: _Predictions, others: np.ndarray
) -> HeldOutErrors:
    """Errors of each part of the log, by what was fitted without it, (f, p) arrays, of the crude model and a rival."""
    given = predictions.missed(np.zeros((1, logs.shape[1])))[0]
    # Squared distance after the longest horizon.
    squares = [
        (one[:2, -1] ** 2).sum(0)
        for one in (given, _each_by_its_fold(predictions, logs), _each_by_its_fold(rival, others))
    ]
    number = np.unique(predictions.block, return_inverse=True)[1]
    blocks = number.max() + 1
    sums = np.stack([np.bincount(number, one, blocks) for one in squares])
    draws = np.random.default_rng(1).multinomial(blocks, np.full(blocks, 1.0 / blocks), size=DRAWS)
    first, crude, instead = np.sqrt(np.maximum(sums @ draws.T, 1e-30))
    before, after = (float(np.sqrt(one.mean())) for one in squares[:2])
    horizon = predictions.counts[-1] * predictions.record.step
    return HeldOutErrors(
        horizon, before, after, _interval(crude / first), _interval(crude / instead)
    )


def _each_by_its_fold(predictions, logs):
    """Errors of each prediction by what was fitted without it, (3, h, s) array."""
    fold = np.unique(predictions.block, return_inverse=True)[1] % CRUDE_FOLDS
    return np.moveaxis(predictions.missed(logs), -1, 1)[fold, np.arange(fold.size)].transpose(
        1, 2, 0
    )


def _interval(ratios):
    low, high = map(float, np.quantile(ratios, (0.025, 0.975)))
    return low, high
