"""The stage between the checks of a log and its identification: what is grossly wrong, and where to start."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray

from shipcosim.diagnose.checked_log import CheckedLog
from shipcosim.diagnose.comparison.axes import axes_of
from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.discrepancies import discrepancies_of
from shipcosim.diagnose.comparison.errors import errors_of, errors_over_none
from shipcosim.diagnose.comparison.gains import AxisGain, CommonRatio, common_ratio, gains_of
from shipcosim.diagnose.comparison.label_hypotheses import LabelError, reading
from shipcosim.diagnose.comparison.labels import Labels, read_labels
from shipcosim.diagnose.comparison.measured_force import measured_force_of
from shipcosim.diagnose.comparison.missing_loads import MissingLoad, missing_loads
from shipcosim.diagnose.comparison.thresholds import FEWEST_USABLE, GROSS, PLAIN, RESOLVED
from shipcosim.diagnose.craft.learn import learn
from shipcosim.diagnose.craft.learned import (
    HeldOutErrors,
    LearnedCraft,
    ratio_alone,
    ratio_findings,
)
from shipcosim.diagnose.craft.logged import craft_log
from shipcosim.diagnose.finding import Discrepancy, Finding
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.inference.problem import as_logged
from shipcosim.diagnose.log.mislabels import drive_channels, exchanged, finding_of, negative
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.stretches import in_stretches
from shipcosim.diagnose.ship.surrogate_building import with_surrogates
from shipcosim.diagnose.ship.thrusters import largest_loads

NOT_SHOWN = "The craft is not learned: her motion does not show what her thrusters did."
LEARNED = (
    "All numbers of the craft were assumed or learned from this log: no cause in her is sought."
)


@dataclass(frozen=True)
class LogComparison:
    """Simulated against measured, and commanded against measured force.

    Attributes
    ----------
    errors : dict
        Of the simulation, as from `errors_of`.
    discrepancies : tuple of Discrepancy
        Largest first.
    gains : tuple of AxisGain
        By axis that the thrusters drive; empty where the log has too few usable rows.
    labels : Labels or None
    ratio : CommonRatio or None
        Of thrust to inertia.
    craft : LearnedCraft or None
        What the log teaches of a craft that is not the file's.
    is_started_with : bool
        Whether the ship is started with it: it is beyond doubt, whatever the fits find.
    remarks : tuple of str
        What was not put into the ship, and why.
    obstacles : tuple of str
        Why no cause can be named from the log, whatever it shows, and what would do.
    missing : tuple of MissingLoad
        What the model lacks by axis, largest first; empty where the log has too few usable rows.
    is_assumed : bool
        Whether all numbers of the ship were guesses, so that only the craft is told.
    """

    errors: dict[str, list[float]] = field(default_factory=dict)
    discrepancies: tuple[Discrepancy, ...] = ()
    gains: tuple[AxisGain, ...] = ()
    labels: Labels | None = None
    ratio: CommonRatio | None = None
    craft: LearnedCraft | None = None
    is_started_with: bool = False
    remarks: tuple[str, ...] = ()
    obstacles: tuple[str, ...] = ()
    missing: tuple[MissingLoad, ...] = ()
    is_assumed: bool = False

    def for_verdict(self, verdict: str) -> tuple[Discrepancy, ...]:
        """Discrepancies for a verdict.

        Where nobody knows what is wrong the largest error is said in any case; where nothing is beyond noise and
        tolerances no error is.
        """
        if verdict == "consistent":
            errors = [load.discrepancy for load in self.missing]
            return tuple(
                discrepancy for discrepancy in self.discrepancies if discrepancy not in errors
            )
        if self.discrepancies or verdict != "unknown" or not self.missing:
            return self.discrepancies
        return (self.missing[0].discrepancy,)

    @property
    def started_craft(self) -> LearnedCraft | None:
        """The learned craft with which the fit starts; None if there is none."""
        return self.craft if self.is_started_with else None

    def findings(self, causes: Mapping[str, Cause]) -> tuple[Finding, ...]:
        """Thrust over inertia by the measured forces; if the log teaches the craft clearly, by the learned craft."""
        ratio = self.ratio
        if self.craft is None or ratio is None or not ratio.differs(PLAIN):
            return ()
        thrust = self.craft.thrust
        if thrust is not None:
            return ratio_findings(thrust.value, thrust.std, causes)
        return ratio_findings(ratio.ratio, ratio.std, causes)

    def given(self, model: ShipModel) -> ShipModel:
        """A ship as the system has her: without what was put into her beyond doubt."""
        return self.started_craft.without(model) if self.started_craft else model


@dataclass(frozen=True)
class ComparedLog(CheckedLog):
    """A checked log compared with the simulation; what is grossly wrong is corrected, in the log and in the ship.

    Attributes
    ----------
    comparison : LogComparison
    """

    comparison: LogComparison


def compared(log: CheckedLog, is_assumed: bool = False, keeps_labels: bool = False) -> ComparedLog:
    """A checked log compared with the simulation: what is grossly wrong is corrected before anything else.

    Sides and signs of thrusters that the motion contradicts are faults of the log, unless it `keeps_labels`; a common
    ratio of thrust to inertia that is far off is in the ship from here on. Where all numbers of the ship are guesses,
    she is learned instead.
    """
    log_compared = _compared(log, keeps_labels)
    if is_assumed:
        return _learned_alone(log_compared)
    # A ratio far off would bend every later fit: the ship starts with it.
    ratio = log_compared.comparison.ratio
    return _started_with_craft(log_compared) if ratio and ratio.differs(GROSS) else log_compared


def _compared(log: CheckedLog, keeps_labels: bool) -> ComparedLog:
    length = log.ship.length
    # A long log is reduced to stretches; the ship gets its kind of wind and surrogates of
    # third-party FMUs.
    log = replace(log, repaired=in_stretches(log.repaired, length))
    ship = as_logged(log.ship, log.repaired)
    record = record_of(log.repaired, ship)
    measured = measured_force_of(record, length)
    ship = with_surrogates(ship, record, first_motion(record))
    errors = errors_of(record, measured, ship)
    # What to say where rows are too far apart for the ship's answers.
    step = float(np.diff(log.repaired["time"].values[:2])[0])
    most = RESOLVED * froude_time(ship.length)
    message = f"Rows {step:.3g} s apart do not show this ship's answers: no cause is named. {most:.2g} s would."
    too_slow = (message,) if step > most else ()
    unlogged = _unlogged(log.repaired, ship)
    unknown = (_no_cause_without(unlogged),) if unlogged else ()
    # Rows that are too few, or too far apart, show no forces.
    if too_slow or measured.usable.sum() < FEWEST_USABLE:
        return _stage(log, LogComparison(errors, (), obstacles=too_slow + unknown))
    # Loads by the model, and regressions of measured force by axis.
    commanded = commanded_by(record, measured, ship)
    axes = axes_of(measured, commanded, ship)
    over_none = errors_over_none(record, measured, errors)
    # Unlogged thrusters make every cause uncertain; what is beyond their power is reported.
    if unlogged:
        power = largest_loads(ship, unlogged)
        missing = tuple(
            load
            for load in missing_loads(axes, commanded, measured, ship, over_none)
            if load.is_large and load.missing > power[load.axis]
        )
        large = tuple(load.discrepancy for load in missing)
        return _stage(log, LogComparison(errors, large, obstacles=unknown, missing=missing))
    # Labels first, as gains and ratio depend on them.
    if keeps_labels:
        logged = reading((), record, measured, axes, ship)
        labels = Labels(logged, logged, is_judged=False)
    else:
        labels = read_labels(record, measured, axes, ship)
    gains = gains_of(axes, labels.used.commanded, labels.used.ahead)
    ratio = common_ratio(gains)
    missing = missing_loads(axes, labels.used.commanded, measured, ship, over_none)
    discrepancies = tuple(discrepancies_of(labels, gains, ratio, missing))
    comparison = LogComparison(
        errors, discrepancies, tuple(gains), labels, ratio, missing=tuple(missing)
    )
    staged = _stage(log, comparison)
    if labels.is_sure and labels.best.changes:
        # The log with sides and signs of the thrusters corrected.
        sure = float(1.0 - np.exp(-min(labels.margin, 4.6)))
        faults = [finding_of(_label(change, staged.log), sure) for change in labels.best.changes]
        faults = (*staged.faults, *faults)
        right = in_stretches(repaired(staged.log, faults), staged.ship.length)
        staged = replace(staged, faults=faults, repaired=right)
    return staged


def _started_with_craft(log: ComparedLog) -> ComparedLog:
    """The ship as the log teaches her, or with the ratio of thrust to inertia alone."""
    comparison = with_learned_craft(log.comparison, log.repaired, log.ship)
    ratio = log.comparison.ratio
    craft = comparison.craft
    if craft is None and ratio is not None:
        craft = ratio_alone(log.ship, ratio.ratio, ratio.std)
    if craft is None:
        return log
    comparison = replace(comparison, craft=craft, is_started_with=True)
    return replace(log, comparison=comparison, ship=craft.on(log.ship))


def _learned_alone(log: ComparedLog) -> ComparedLog:
    """A log of a craft whose numbers were all guesses: she is learned from it, and no cause in her is sought."""
    comparison = log.comparison
    craft, obstacles = None, comparison.obstacles
    if not obstacles:
        craft, why = surely_taught([(log.repaired, log.comparison)], log.ship)
        obstacles = (why,)
    learned_only = LogComparison(
        comparison.errors,
        labels=comparison.labels,
        craft=craft,
        is_started_with=craft is not None,
        obstacles=obstacles,
        is_assumed=True,
    )
    return replace(log, comparison=learned_only, ship=craft.on(log.ship) if craft else log.ship)


def surely_taught(
    logs: Sequence[tuple[xarray.Dataset, LogComparison]], ship: ShipModel
) -> tuple[LearnedCraft | None, str]:
    """The craft learned from logs, if she clearly predicts better than a constant velocity; and remarks.

    Logs in which the motion does not show what the thrusters did teach none.

    Parameters
    ----------
    logs, ship
        As of `learned_from`; all numbers of the ship are guesses.
    """
    if not any(gain.is_known for _, comparison in logs for gain in comparison.gains):
        return None, NOT_SHOWN
    craft = _taught_by(logs, ship)
    errors = craft.errors if craft else None
    if errors is not None and errors.beats_steady:
        return craft, LEARNED
    return None, _not_learned(errors, len(logs))


def _not_learned(errors: HeldOutErrors | None, count: int) -> str:
    """Why logs do not teach a craft, and what would help."""
    remedy = (
        "Longer or more logs with turns and changes of speed help, and the right length of her."
    )
    what = "This log does" if count == 1 else "These logs do"
    if errors is None:
        return f"{what} not teach the craft: too short, or no ship moves like that. {remedy}"
    return (
        f"{what} not teach the craft. On parts that were held out her best numbers predict no better, for sure, than "
        f"a craft that keeps her velocity. After {errors.horizon:.3g} s they are {errors.after:.2g} m and "
        f"{errors.after_deg:.2g} deg off, she is {errors.steady:.2g} m and {errors.steady_deg:.2g} deg. {remedy}"
    )


def with_learned_craft(
    comparison: LogComparison, repaired: xarray.Dataset, ship: ShipModel
) -> LogComparison:
    """The comparison with the craft that a log teaches, where she predicts what was held out better than the file's."""
    craft = learned_from([(repaired, comparison)], ship)
    return comparison if craft is None else replace(comparison, craft=craft)


def learned_from(
    logs: Sequence[tuple[xarray.Dataset, LogComparison]], ship: ShipModel
) -> LearnedCraft | None:
    """The craft that logs teach, each held out in turn; of a single one parts of it.

    Parameters
    ----------
    logs : sequence of tuple of Dataset and LogComparison
        Repaired, and how the simulation compares.
    ship : ShipModel
        As her file has her.

    Returns
    -------
    LearnedCraft or None
        None where logs are too short, or she predicts no better than the file's for sure.
    """
    craft = _taught_by(logs, ship)
    return craft if craft and craft.errors and craft.errors.is_better else None


def _taught_by(
    logs: Sequence[tuple[xarray.Dataset, LogComparison]], ship: ShipModel
) -> LearnedCraft | None:
    """The craft learned from logs, for any quality of prediction; None if a log is too short."""
    # Common horizons for all logs: the median of what suits each.
    each = [comparison.errors["horizon_s"] for _, comparison in logs]
    horizons = [float(horizon) for horizon in np.median(each, axis=0)]
    parts = []
    for part, (log, _) in enumerate(logs):
        logged = as_logged(ship, log)
        record = record_of(log, logged)
        logged = with_surrogates(logged, record, first_motion(record))
        parts.append(craft_log(record, logged, horizons, part, whole=len(logs) > 1))
    usable = [part for part in parts if part is not None]
    return learn(usable) if len(usable) == len(logs) else None


def _unlogged(repaired: xarray.Dataset, ship: ShipModel) -> dict[str, list[str]]:
    """Channels of its thrusters that a log lacks, by thruster."""
    lacking = {
        name: [f"{name}_{kind}" for kind in ship.drives(name) if f"{name}_{kind}" not in repaired]
        for name in ship.thrusters
    }
    return {name: channels for name, channels in lacking.items() if channels}


def _no_cause_without(unlogged: Mapping[str, Sequence[str]]) -> str:
    """Why a log without channels of thrusters shows no cause."""
    channels = ", ".join(name for lacking in unlogged.values() for name in lacking)
    thrusters = " and ".join(f"'{name}'" for name in unlogged)
    return (
        f"No {channels} in the log. How {thrusters} pushed the ship is not known, so no cause is named. Log what is "
        "missing; of a thruster that stood still, give columns of zeros."
    )


def _stage(log: CheckedLog, comparison: LogComparison) -> ComparedLog:
    return ComparedLog(log.log, log.ship, log.causes, log.faults, log.repaired, comparison)


def _label(change: LabelError, log: xarray.Dataset):
    """What is wrong with the channels of a change."""
    if len(change.thrusters) == 1:
        return negative(drive_channels(change.thrusters[0], log)[0])
    channels, other = (drive_channels(name, log) for name in change.thrusters)
    return exchanged(list(zip(channels, other, strict=False)))
