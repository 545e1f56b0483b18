"""Ways to read the channels of thrusters: as logged, reversed, exchanged, and what each makes of the commands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from shipcosim.diagnose.comparison.axes import Axis
from shipcosim.diagnose.comparison.commanded import Commanded, commanded_by, late
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.thresholds import (
    CHANGE_COST,
    LAG_COST,
    LAGS,
    LEAST_LAG,
    LEAST_SUPPORT,
    MOST_CHANGES,
)
from shipcosim.diagnose.ship.inputs import Record, ThrusterSeries
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.surrogate_building import with_surrogates


@dataclass(frozen=True)
class LabelError:
    """One thing that is wrong with the labels: a thruster that runs the other way, or two that are exchanged.

    Attributes
    ----------
    thrusters : tuple of one or two str
    turns : bool
        Whether the log has directions of the two.
    """

    thrusters: tuple[str, ...]
    turns: bool = False

    def undo(self, units: ThrusterSeries) -> ThrusterSeries:
        """Inputs of the thrusters, corrected; fixed directions stay."""
        if len(self.thrusters) == 2:
            thruster, other = self.thrusters
            (first, ahead) = units[thruster]
            (second, lateral) = units[other]
            ahead, lateral = (lateral, ahead) if self.turns else (ahead, lateral)
            return units | {thruster: (second, ahead), other: (first, lateral)}
        (name,) = self.thrusters
        speed, direction = units[name]
        return units | {name: (-speed, direction)}


@dataclass(frozen=True)
class LabelHypothesis:
    """One way to read the thrusters' channels, and how well the commanded force then agrees with the measured force.

    Attributes
    ----------
    changes : tuple of LabelError
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
    units : dict of str to (n,) arrays
        What drives the thrusters, so read.
    """

    changes: tuple[LabelError, ...]
    support: float
    lag: float
    gained_by_lag: float
    lag_cost: float
    step: float
    commanded: Commanded
    ahead: dict[str, np.ndarray]
    units: ThrusterSeries

    @property
    def is_late(self) -> bool:
        """Whether the thrust clearly acts late, by enough rows to be resolved."""
        return self.lag >= LEAST_LAG * self.step and self.gained_by_lag > LEAST_SUPPORT

    @property
    def score(self) -> float:
        """Support less what the changes and the lag cost. [nats]"""
        return self.support - CHANGE_COST * len(self.changes) - self.lag_cost


def changes_of(record: Record, model: ShipModel) -> list[tuple[LabelError, ...]]:
    """What may be wrong with the labels: thrusters that run the other way, two of a make exchanged, several of these.

    Parameters
    ----------
    record : Record
    model : ShipModel

    Returns
    -------
    list of tuple of LabelError
        Exchanges before signs, one change before several.
    """
    # Of a command that never changes nothing tells the sign.
    names = [name for name in model.thrusters if np.ptp(record.units[name][0]) > 0.0]
    pairs = [
        pair for pair in combinations(names, 2) if model.make_of(pair[0]) == model.make_of(pair[1])
    ]
    # Single errors, then all sets of several of them.
    singles = [LabelError(pair, pair[0] in model.azimuths) for pair in pairs] + [
        LabelError((name,)) for name in names
    ]
    return [
        several for count in range(1, MOST_CHANGES + 1) for several in combinations(singles, count)
    ]


def reading(
    changes: tuple[LabelError, ...],
    record: Record,
    measured: MeasuredForce,
    axes: Sequence[Axis],
    model: ShipModel,
) -> LabelHypothesis:
    """One reading of the channels, with the lag that suits it best.

    Parameters
    ----------
    changes : tuple of LabelError
    record : Record
        As logged.
    measured : MeasuredForce
    axes : sequence of Axis
    model : ShipModel
        With surrogates of third-party FMUs.

    Returns
    -------
    LabelHypothesis
    """
    # Undo the assumed errors, then recompute the loads.
    units = record.units
    for change in changes:
        units = change.undo(units)
    commanded = driven(units, record, measured, model)
    ahead = ahead_of(units)
    # Thrust may act late: each delay has a cost, as a wrong sign can look like a delay.
    tries = []
    scale = froude_time(model.length)
    for lag in (0.0, *(k * scale for k in LAGS)):
        moved = late(commanded, lag / record.step)
        support = support_of(moved, ahead, axes)
        # Support beyond that without a delay.
        gained = support - tries[0].support if tries else 0.0
        cost = LAG_COST + lag / scale if lag else 0.0
        tries.append(
            LabelHypothesis(
                changes, support, float(lag), gained, cost, record.step, moved, ahead, units
            )
        )
    return max(tries, key=lambda attempt: attempt.score)


def ahead_of(units: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> dict[str, np.ndarray]:
    """By thruster, where it runs ahead, (n,) bool arrays, from the speed and direction that it is driven with."""
    return {name: speed >= 0.0 for name, (speed, _) in units.items()}


def driven(
    units: ThrusterSeries, record: Record, measured: MeasuredForce, model: ShipModel
) -> Commanded:
    """Loads of a model along a log, with thrusters driven under another label.

    Parameters
    ----------
    units : dict of str to (n,) arrays
        Speed and direction by thruster.
    record : Record
    measured : MeasuredForce
    model : ShipModel

    Returns
    -------
    Commanded
    """
    record = replace(record, units=units)
    if any(
        "rpm" in fmu.drives for fmu in model.third_party.values()
    ):  # one that gets its thrust is linear
        model = with_surrogates(model, record, measured.motion)
    return commanded_by(record, measured, model)


def support_of(commanded: Commanded, ahead: dict[str, np.ndarray], axes: Sequence[Axis]) -> float:
    """Log-likelihood that commanded loads gain over none, summed over the axes that they drive. [nats]"""
    total = 0.0
    for axis in axes:
        if axis.is_driven(commanded):
            total += axis.both_ways(*axis.by_way(commanded, ahead)).support
    return total
