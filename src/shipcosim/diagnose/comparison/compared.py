"""The stage between the checks of a log and its identification: what is grossly wrong, and where to start."""

from dataclasses import dataclass, field, replace

import numpy as np
import xarray

from shipcosim.diagnose.checked_log import CheckedLog
from shipcosim.diagnose.comparison.axes import axes_of
from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.crude_fit import crude_model
from shipcosim.diagnose.comparison.crude_model import (
    CrudeModel,
    CrudeNumber,
    crude_numbers,
    spoken_for,
)
from shipcosim.diagnose.comparison.discrepancies import discrepancies_of, is_of_damping
from shipcosim.diagnose.comparison.errors import errors_of, errors_over_none
from shipcosim.diagnose.comparison.gains import AxisGain, CommonRatio, common_ratio, gains_of
from shipcosim.diagnose.comparison.label_hypotheses import LabelError
from shipcosim.diagnose.comparison.labels import Labels, read_labels
from shipcosim.diagnose.comparison.measured_force import felt_by
from shipcosim.diagnose.comparison.missing_loads import MissingLoad, missing_loads
from shipcosim.diagnose.comparison.thresholds import FEWEST_USABLE, GROSS, PLAIN, RESOLVED
from shipcosim.diagnose.finding import Discrepancy, Finding
from shipcosim.diagnose.hypotheses.catalogue import Cause
from shipcosim.diagnose.inference.problem import as_logged
from shipcosim.diagnose.log.mislabels import exchanged, finding_of, negative
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.stretches import in_stretches
from shipcosim.diagnose.ship.surrogate_building import with_surrogates


@dataclass(frozen=True)
class LogComparison:
    """Simulated against measured, and commanded against felt.

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
    crude : CrudeModel or None
        What may be said of thrust and damping over inertia.
    is_started_with : bool
        Whether the ship is started with it: it is beyond doubt, whatever the fits find.
    remarks : tuple of str
        What was not put into the ship, and why.
    obstacles : tuple of str
        Why no cause can be named from the log, whatever it shows, and what would do.
    missing : tuple of MissingLoad
        What the model lacks by axis, largest first; empty where the log has too few usable rows.
    """

    errors: dict[str, list[float]] = field(default_factory=dict)
    discrepancies: tuple[Discrepancy, ...] = ()
    gains: tuple[AxisGain, ...] = ()
    labels: Labels | None = None
    ratio: CommonRatio | None = None
    crude: CrudeModel | None = None
    is_started_with: bool = False
    remarks: tuple[str, ...] = ()
    obstacles: tuple[str, ...] = ()
    missing: tuple[MissingLoad, ...] = ()

    def told(self, verdict: str) -> tuple[Discrepancy, ...]:
        """Discrepancies for a verdict.

        Where nobody knows what is wrong the largest error is said in any case; where nothing is beyond noise and
        tolerances no error is.
        """
        if verdict == "consistent":
            errors = [one.discrepancy for one in self.missing]
            return tuple(one for one in self.discrepancies if one not in errors)
        if self.discrepancies or verdict != "unknown" or not self.missing:
            return self.discrepancies
        return (self.missing[0].discrepancy,)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is named of the physics beyond doubt: the ship is started with it."""
        return self.crude.findings if self.crude is not None and self.is_started_with else ()

    def given(self, model: ShipModel) -> ShipModel:
        """A ship as the system has her: without what was put into her beyond doubt."""
        return (
            self.crude.without(model) if self.crude is not None and self.is_started_with else model
        )

    def with_crude(self, model: ShipModel) -> ShipModel:
        """A ship with the crude model, beyond doubt or only where nothing else explains the log."""
        return model if self.crude is None or self.is_started_with else self.crude.on(model)

    def found_without(self) -> tuple[Finding, ...]:
        """What may be named where no cause of the catalogue explains the log."""
        return () if self.crude is None or self.is_started_with else self.crude.findings

    def spoken_for(self, cause: Cause, named: set[str], causes: dict[str, Cause]) -> bool:
        """Whether all that a cause could say is said, by a cause that is named or by a damping that differs."""
        axes = {one.axis for one in self.discrepancies if is_of_damping(one)}
        said = {
            one.cause
            for one in causes.values()
            if one.axis and (one.axis in axes or one.cause in named)
        }
        return spoken_for(cause, said, causes)


@dataclass(frozen=True)
class ComparedLog(CheckedLog):
    """A checked log held against the simulation; what is grossly wrong is put right, in the log and in the ship.

    Attributes
    ----------
    comparison : LogComparison
    """

    comparison: LogComparison


def compared(log: CheckedLog) -> ComparedLog:
    """A checked log held against the simulation: what is grossly wrong is put right before anything else.

    Sides and signs of thrusters that the motion contradicts are faults of the log; a common ratio of thrust to inertia
    that is far off is in the ship from here on.
    """
    length = log.ship.length
    log = replace(log, repaired=in_stretches(log.repaired, length))
    ship = as_logged(log.ship, log.repaired)
    record = record_of(log.repaired, ship)
    felt = felt_by(record, length)
    ship = with_surrogates(ship, record, first_motion(record, ship))
    errors = errors_of(record, felt, ship)
    # What to say where rows are too far apart for the ship's answers.
    step = float(np.diff(log.repaired["time"].values[:2])[0])
    most = RESOLVED * froude_time(ship.length)
    said = f"Rows {step:.3g} s apart do not show this ship's answers: no cause is named. {most:.2g} s would."
    too_slow = (said,) if step > most else ()
    unknown = _unknown_thrusters(log.repaired, ship)
    if too_slow or felt.usable.sum() < FEWEST_USABLE:
        return _stage(log, LogComparison(errors, (), obstacles=too_slow + unknown))
    commanded = commanded_by(record, felt, ship)
    axes = axes_of(felt, commanded, ship)
    over_none = errors_over_none(record, felt, errors)
    if unknown:
        missing = tuple(missing_loads(axes, commanded, felt, ship, over_none))
        large = tuple(one.discrepancy for one in missing if one.is_large)
        return _stage(log, LogComparison(errors, large, obstacles=unknown, missing=missing))
    labels = read_labels(record, felt, axes, ship)
    gains = gains_of(axes, labels.used.commanded, labels.used.ahead)
    ratio = common_ratio(gains)
    missing = missing_loads(axes, labels.used.commanded, felt, ship, over_none)
    told = tuple(discrepancies_of(labels, gains, ratio, missing))
    gross = ratio is not None and ratio.differs(GROSS)
    comparison = LogComparison(errors, told, tuple(gains), labels, ratio, missing=tuple(missing))
    found = _stage(log, comparison)
    if labels.is_sure and labels.best.changes:
        # The log with sides and signs of the thrusters put right.
        sure = float(1.0 - np.exp(-min(labels.margin, 4.6)))
        faults = [finding_of(_label(change, found.log), sure) for change in labels.best.changes]
        faults = (*found.faults, *faults)
        right = in_stretches(repaired(found.log, faults), found.ship.length)
        found = replace(found, faults=faults, repaired=right)
    return _started_with_crude_model(found) if gross else found


def _started_with_crude_model(log: ComparedLog) -> ComparedLog:
    """The ship with what is grossly wrong of her: thrust and damping together, or thrust alone."""
    known = with_crude(log.comparison, log.repaired, log.ship, log.causes)
    if known.crude is None:
        return replace(log, comparison=known)
    return replace(
        log, comparison=replace(known, is_started_with=True), ship=known.crude.on(log.ship)
    )


def with_crude(
    comparison: LogComparison, repaired: xarray.Dataset, ship: ShipModel, causes: dict[str, Cause]
) -> LogComparison:
    """The comparison with the crude model where it predicts better; else with the ratio alone, where that is plain."""
    length = ship.length
    logged = as_logged(ship, repaired)
    record = record_of(repaired, logged)
    felt = felt_by(record, length)
    logged = with_surrogates(logged, record, first_motion(record, logged))
    crude = crude_model(record, felt, logged, causes, comparison.errors["horizon_s"])
    if (
        crude is not None
        and crude.differs(PLAIN)
        and crude.errors is not None
        and crude.errors.is_better
    ):
        return replace(comparison, crude=crude)
    remarks = (
        () if crude is None or all(not one.axis for one in crude.numbers) else (_not_better(crude),)
    )
    alone = ratio_alone(comparison.ratio, ship, causes)
    return replace(
        comparison, crude=alone if alone and alone.differs(PLAIN) else None, remarks=remarks
    )


def _not_better(crude: CrudeModel) -> str:
    """Why a damping that differs is not put into the ship."""
    sizes = ", ".join(f"{one.axis} {one.estimate:.2f}" for one in crude.numbers if one.axis)
    return (
        f"The log as a whole asks for another damping ({sizes} of the model's, over inertia). Where rows are held out"
        " that predicts no better for sure, so it is not in the extended system."
    )


def ratio_alone(
    ratio: CommonRatio | None, ship: ShipModel, causes: dict[str, Cause]
) -> CrudeModel | None:
    """The crude model of a common ratio of thrust to inertia; None without a cause in the catalogue that says so."""
    thrust = next((one for one in crude_numbers(ship, causes) if not one.axis), None)
    if ratio is None or thrust is None:
        return None
    return CrudeModel((replace(thrust, estimate=ratio.ratio, std=ratio.std),))


def _unknown_thrusters(repaired: xarray.Dataset, ship: ShipModel) -> tuple[str, ...]:
    """What to say of thrusters that a log lacks."""
    found = []
    for name in ship.thrusters:
        lacking = [
            f"{name}_{kind}" for kind in ship.drives(name) if f"{name}_{kind}" not in repaired
        ]
        if lacking:
            found.append(
                f"No {' and '.join(lacking)} in the log: what '{name}' does to the ship is not known, and no cause is"
                " named. Log it; if it stood still, give a column of zeros."
            )
    return tuple(found)


def _stage(log: CheckedLog, comparison: LogComparison) -> ComparedLog:
    return ComparedLog(log.log, log.ship, log.causes, log.faults, log.repaired, comparison)


def _label(change: LabelError, log: xarray.Dataset):
    """What is wrong with the channels of a change."""
    if len(change.thrusters) == 1:
        return negative(_drives(change.thrusters[0], log)[0])
    one, other = (_drives(name, log) for name in change.thrusters)
    return exchanged(list(zip(one, other, strict=False)))


def _drives(name: str, log: xarray.Dataset) -> list[str]:
    """Channels of what drives a thruster, its speed or thrust first."""
    return [f"{name}_{kind}" for kind in ("rpm", "thrust", "azimuth") if f"{name}_{kind}" in log]


def ratio_finding(ratio: CommonRatio, causes: dict[str, Cause]) -> tuple[Finding, ...]:
    """The finding of a common ratio, by the cause that says so; none without one in the catalogue."""
    cause = next(
        (one for one in causes.values() if one.sought_in == "comparison" and not one.axis), None
    )
    if cause is None:
        return ()
    number = CrudeNumber(cause.cause, next(iter(cause.parameters)), "", (), ratio.ratio, ratio.std)
    return CrudeModel((number,)).findings
