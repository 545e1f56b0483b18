"""Sides and signs of thrusters: which labels of their channels make what is commanded agree with what is felt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.diagnose.comparison.causality import causal_support
from shipcosim.diagnose.comparison.commanded import commanded_by, late
from shipcosim.diagnose.comparison.thresholds import (
    CHANGE_COST,
    LAG_COST,
    LAGS,
    LEAST_GAIN,
    LEAST_LAG,
    LEAST_SUPPORT,
    MOST_CHANGES,
    OPPOSITE,
    PLAINLY_WRONG,
    RIVAL,
    SURELY_CAUSED,
    SURELY_WRONG,
    TOLD,
)
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.surrogate import with_surrogates

if TYPE_CHECKING:
    from shipcosim.diagnose.comparison.axes import Axis
    from shipcosim.diagnose.comparison.commanded import Commanded
    from shipcosim.diagnose.comparison.felt import Felt
    from shipcosim.diagnose.ship.inputs import Record
    from shipcosim.diagnose.ship.model import ShipModel

__all__ = ["Change", "Labels", "Reading", "read_labels"]


@dataclass(frozen=True)
class Change:
    """One thing that is wrong with the labels: a thruster that runs the other way, or two that are exchanged.

    Attributes
    ----------
    thrusters : tuple of one or two str
    turns : bool
        Whether the log has directions of the two.
    """

    thrusters: tuple[str, ...]
    turns: bool = False

    def undo(self, units: dict[str, tuple[np.ndarray, np.ndarray]]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """What drives the thrusters, put right; the direction of one that does not turn stays."""
        if len(self.thrusters) == 2:
            one, other = self.thrusters
            (first, ahead), (second, beside) = units[one], units[other]
            ahead, beside = (beside, ahead) if self.turns else (ahead, beside)
            return units | {one: (second, ahead), other: (first, beside)}
        (name,) = self.thrusters
        speed, direction = units[name]
        return units | {name: (-speed, direction)}


@dataclass(frozen=True)
class Reading:
    """One way to read the thrusters' channels, and how well what is commanded then agrees with what is felt.

    Attributes
    ----------
    changes : tuple of Change
        None is as logged.
    support : float
        Log-likelihood that the commanded loads gain, summed over the axes. [nats]
    lag : float
        By how much they act late. [s]
    gained_by_lag : float
        Part of the support that there is only with this lag. [nats]
    lag_cost : float
        What the lag costs: the longer, the less likely; half a period of a manoeuvre late looks like a wrong sign.
        [nats]
    step : float
        Time from row to row. [s]
    commanded : Commanded
        With that lag.
    ahead : dict of str to (n,) bool array
        By thruster: where it runs ahead.
    """

    changes: tuple[Change, ...]
    support: float
    lag: float
    gained_by_lag: float
    lag_cost: float
    step: float
    commanded: Commanded
    ahead: dict[str, np.ndarray]

    @property
    def is_late(self) -> bool:
        """Whether the thrust surely acts late, by rows that can be told apart."""
        return self.lag >= LEAST_LAG * self.step and self.gained_by_lag > LEAST_SUPPORT

    @property
    def score(self) -> float:
        """Support less what the changes and the lag cost. [nats]"""
        return self.support - CHANGE_COST * len(self.changes) - self.lag_cost


@dataclass(frozen=True)
class Labels:
    """What the labels of the thrusters' channels are.

    Attributes
    ----------
    logged : Reading
        As logged.
    best : Reading
    rivals : tuple of Reading
        Other readings that cannot be told from the best.
    explained : float
        Largest share of the felt force that the best reading explains on an axis where it differs from the logged one.
    foresight : float
        Log-likelihood by which commands read so tell the next velocities better than as logged. [nats]
    is_contradicted : bool
        Whether the thrusters as logged surely do the opposite of what they are commanded, on an axis of which they and
        the water explain most.
    """

    logged: Reading
    best: Reading
    rivals: tuple[Reading, ...]
    explained: float = 0.0
    foresight: float = 0.0
    is_contradicted: bool = False

    @property
    def is_wrong(self) -> bool:
        """Whether the labels are wrong beyond doubt, in one way or another."""
        better = self.best.score > self.logged.score + SURELY_WRONG and self.logged not in self.rivals
        plain = self.is_contradicted or self.best.score > self.logged.score + PLAINLY_WRONG
        least = SURELY_CAUSED if self.explained <= TOLD else 0.0 if plain else RIVAL
        return better and self.foresight > least

    @property
    def is_sure(self) -> bool:
        """Whether it is known how they are wrong."""
        return self.is_wrong and not self.rivals

    @property
    def used(self) -> Reading:
        """The best reading where it is sure, else as logged."""
        return self.best if self.is_sure else self.logged


def read_labels(record: Record, felt: Felt, axes: Sequence[Axis], model: ShipModel) -> Labels:
    """The readings of the thrusters' channels.

    Other readings than the logged one are only tried where that is in doubt: where on some axis the thrusters together
    do not surely what they are commanded, or one of them does surely the opposite.

    Parameters
    ----------
    record : Record
    felt : Felt
    axes : sequence of Axis
    model : ShipModel
        With surrogates of third-party FMUs.

    Returns
    -------
    Labels
    """

    def read(*changes):
        return _reading(changes, record, felt, axes, model)

    logged = read()
    if all(_does_as_told(axis, logged.commanded) for axis in axes):
        return Labels(logged, logged, ())
    singles = _single_changes(record, model)
    found = [logged, *(read(one) for one in singles), *(read(*several) for several in _together(singles))]
    found.sort(key=lambda one: -one.score)
    rivals = tuple(one for one in found[1:] if one.score > found[0].score - RIVAL)
    readings = [one.commanded for one in (found[0], logged)]
    best, first = causal_support(felt, readings, froude_time(model.parts["hull"].length))
    explained = _explained(found[0], logged, axes)
    return Labels(logged, found[0], rivals, explained, float(best - first), _is_contradicted(found[0], logged, axes))


def _is_contradicted(best: Reading, logged: Reading, axes: Sequence[Axis]) -> bool:
    """Whether on an axis where a reading differs from the logged one that has surely the wrong sign."""
    for axis in axes:
        total = axis.total(logged.commanded)
        if axis.is_driven(logged.commanded) and np.abs(axis.total(best.commanded) - total).max() > 0.1 * axis.size:
            fit = axis.compared(total[None])
            if fit.gains[0] < -OPPOSITE * fit.std[0] and fit.support > LEAST_SUPPORT and fit.share > TOLD:
                return True
    return False


def _explained(best: Reading, logged: Reading, axes: Sequence[Axis]) -> float:
    """Largest share of the felt force that a reading explains on an axis where it differs from the logged one."""
    shares = [0.0]
    for axis in axes:
        differs = np.abs(axis.total(best.commanded) - axis.total(logged.commanded)).max() > 0.1 * axis.size
        if differs and axis.is_driven(best.commanded):
            shares.append(axis.explained(_each(axis, best.commanded)).share)
    return max(shares)


def _does_as_told(axis: Axis, commanded: Commanded) -> bool:
    """Whether the thrusters together surely do on an axis what they are commanded, and none the opposite."""
    if not axis.is_driven(commanded):
        return True
    each = _each(axis, commanded)
    together, apart = axis.compared(each.sum(0)[None]), axis.compared(each)
    opposite = bool(np.any(apart.gains < -OPPOSITE * np.maximum(apart.std, 1e-9)))
    return not opposite and together.gains[0] > max(OPPOSITE * together.std[0], LEAST_GAIN)


def _each(axis: Axis, commanded: Commanded) -> np.ndarray:
    """What each thruster that acts on an axis is commanded, (k, n) array."""
    return np.stack([axis.smoothed(load) for load in commanded.thrusters.values() if np.any(load[axis.number])])


def _single_changes(record: Record, model: ShipModel) -> list[Change]:
    """Each thruster that runs run the other way, and each two of a make exchanged."""
    names = [name for name in model.thrusters if np.any(record.units[name][0])]
    pairs = [pair for pair in combinations(names, 2) if _make(model, pair[0]) == _make(model, pair[1])]
    return [Change(pair, pair[0] in model.azimuths) for pair in pairs] + [Change((name,)) for name in names]


def _make(model: ShipModel, name: str) -> object:
    """What kind of thruster it is."""
    third_party = model.third_party.get(name)
    return third_party.component.fmu.model_name if third_party else type(model.parts[name])


def _together(singles: Sequence[Change]) -> list[tuple[Change, ...]]:
    """Several changes at once, exchanges before signs."""
    return [both for count in range(2, MOST_CHANGES + 1) for both in combinations(singles, count)]


def _reading(changes, record, felt, axes, model):
    """One reading, with the lag that suits it best."""
    units = record.units
    for change in changes:
        units = change.undo(units)
    record = replace(record, units=units)
    if any("rpm" in one.drives for one in model.third_party.values()):  # one that is told its thrust is linear
        model = with_surrogates(model, record, felt.motion)
    commanded = commanded_by(record, felt, model)
    ahead = {name: speed >= 0.0 for name, (speed, _) in units.items()}
    tries = []
    scale = froude_time(model.parts["hull"].length)
    for lag in (0.0, *(k * scale for k in LAGS)):
        moved = late(commanded, lag / record.step)
        support = support_of(moved, ahead, axes)
        gained = support - tries[0].support if tries else 0.0
        cost = LAG_COST + lag / scale if lag else 0.0
        tries.append(Reading(tuple(changes), support, float(lag), gained, cost, record.step, moved, ahead))
    return max(tries, key=lambda one: one.score)


def support_of(commanded: Commanded, ahead: dict[str, np.ndarray], axes: Sequence[Axis]) -> float:
    """Log-likelihood that commanded loads gain over none, summed over the axes that they drive. [nats]"""
    total = 0.0
    for axis in axes:
        if axis.is_driven(commanded):
            ways = [
                sum((axis.smoothed(load * (ahead[name] == way)) for name, load in commanded.thrusters.items()), 0.0)
                for way in (True, False)
            ]
            total += axis.both_ways(*map(np.asarray, ways)).support
    return total
