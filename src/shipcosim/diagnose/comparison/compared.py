"""The stage between the checks of a log and its identification: what is grossly wrong, and where to start."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.diagnose.comparison.axes import axes_of
from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.discrepancies import discrepancies_of
from shipcosim.diagnose.comparison.errors import errors_of, errors_over_none
from shipcosim.diagnose.comparison.felt import felt_by
from shipcosim.diagnose.comparison.gains import common_ratio, gains_of
from shipcosim.diagnose.comparison.labels import read_labels
from shipcosim.diagnose.comparison.missing import missing_loads
from shipcosim.diagnose.comparison.thresholds import FEWEST_USABLE, GROSS, PLAIN, RESOLVED
from shipcosim.diagnose.inference.problem import as_logged
from shipcosim.diagnose.log.mislabels import exchanged, finding_of, negative
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.result import Discrepancy, Estimate, Finding
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.stretches import in_stretches
from shipcosim.diagnose.ship.surrogate import with_surrogates
from shipcosim.diagnose.ship.thrusters import with_thrust
from shipcosim.diagnose.stages import CheckedLog, ComparedLog

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.comparison.gains import AxisGain, CommonRatio
    from shipcosim.diagnose.comparison.labels import Change, Labels
    from shipcosim.diagnose.comparison.missing import MissingLoad
    from shipcosim.diagnose.hypotheses.catalogue import Cause
    from shipcosim.diagnose.ship.model import ShipModel

__all__ = ["LogComparison", "compared", "ratio_finding"]

_ONLY_RATIO = "Thrust and inertia cannot be told apart: only their ratio is known."


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
    findings : tuple of Finding
        Of the physics, beyond doubt: the ship is started with them.
    obstacles : tuple of str
        Why no cause can be named from the log, whatever it shows, and what would do.
    missing : tuple of MissingLoad
        What the model lacks by axis, largest first; empty where the log has too few usable rows.
    """

    errors: dict[str, list[float]]
    discrepancies: tuple[Discrepancy, ...]
    gains: tuple[AxisGain, ...] = ()
    labels: Labels | None = None
    ratio: CommonRatio | None = None
    findings: tuple[Finding, ...] = ()
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

    def given(self, model: ShipModel) -> ShipModel:
        """A ship as the system has her: without the ratio that was put into her beyond doubt."""
        if self.ratio is None or not self.findings:
            return model
        return with_thrust(model, 1.0 / self.ratio.ratio, 0.0)

    def with_ratio(self, model: ShipModel) -> ShipModel:
        """A ship with the ratio of thrust to inertia, beyond doubt or only where nothing else explains the log."""
        return model if self.ratio is None or self.findings else with_thrust(model, self.ratio.ratio, 0.0)

    def found_without(self, causes: dict[str, Cause]) -> tuple[Finding, ...]:
        """What may be named where no cause of the catalogue explains the log: a common ratio that is not gross."""
        if self.findings or self.ratio is None or not self.ratio.differs(PLAIN):
            return ()
        return ratio_finding(self.ratio, causes)


def compared(log: CheckedLog) -> ComparedLog:
    """A checked log held against the simulation: what is grossly wrong is put right before anything else.

    Sides and signs of thrusters that the motion contradicts are faults of the log; a common ratio of thrust to inertia
    that is far off is in the ship from here on.
    """
    length = log.ship.parts["hull"].length
    log = replace(log, repaired=in_stretches(log.repaired, length))
    ship = as_logged(log.ship, log.repaired)
    record = record_of(log.repaired, ship)
    felt = felt_by(record, length)
    ship = with_surrogates(ship, record, first_motion(record, ship))
    errors = errors_of(record, felt, ship)
    too_slow, unknown = _too_slow(log.repaired, ship), _unknown_thrusters(log.repaired, ship)
    if too_slow or felt.usable.sum() < FEWEST_USABLE:
        return _stage(log, LogComparison(errors, (), obstacles=too_slow + unknown))
    commanded = commanded_by(record, felt, ship)
    axes, over_none = axes_of(felt, commanded, ship), errors_over_none(record, felt, errors)
    if unknown:
        missing = tuple(missing_loads(axes, commanded, felt, ship, over_none))
        large = tuple(one.discrepancy for one in missing if one.is_large)
        return _stage(log, LogComparison(errors, large, obstacles=unknown, missing=missing))
    labels = read_labels(record, felt, axes, ship)
    gains = gains_of(axes, labels.used.commanded)
    ratio = common_ratio(gains)
    missing = missing_loads(axes, labels.used.commanded, felt, ship, over_none)
    told = tuple(discrepancies_of(labels, gains, ratio, missing))
    gross = ratio is not None and ratio.differs(GROSS)
    findings = ratio_finding(ratio, log.causes) if ratio is not None and gross else ()
    comparison = LogComparison(errors, told, tuple(gains), labels, ratio, findings, missing=tuple(missing))
    found = _stage(log, comparison)
    if labels.is_sure and labels.best.changes:
        found = _relabelled(found, labels)
    if ratio is not None and findings:
        found = replace(found, ship=with_thrust(found.ship, ratio.ratio, ratio.std))
    return found


def _too_slow(repaired: xarray.Dataset, ship: ShipModel) -> tuple[str, ...]:
    """What to say where rows are too far apart for the ship's answers."""
    step, most = float(np.diff(repaired["time"].values[:2])[0]), RESOLVED * froude_time(ship.parts["hull"].length)
    said = f"Rows {step:.3g} s apart do not show this ship's answers: no cause is named. {most:.2g} s would."
    return (said,) if step > most else ()


def _unknown_thrusters(repaired: xarray.Dataset, ship: ShipModel) -> tuple[str, ...]:
    """What to say of thrusters that a log lacks."""
    found = []
    for name in ship.thrusters:
        lacking = [f"{name}_{kind}" for kind in ship.drives(name) if f"{name}_{kind}" not in repaired]
        if lacking:
            found.append(
                f"No {' and '.join(lacking)} in the log: what '{name}' does to the ship is not known, and no cause is"
                " named. Log it; if it stood still, give a column of zeros."
            )
    return tuple(found)


def _stage(log: CheckedLog, comparison: LogComparison) -> ComparedLog:
    return ComparedLog(log.log, log.ship, log.causes, log.faults, log.repaired, comparison)


def _relabelled(log: ComparedLog, labels: Labels) -> ComparedLog:
    """The log with sides and signs of the thrusters put right."""
    sure = float(1.0 - np.exp(-min(labels.margin, 4.6)))
    faults = [finding_of(_label(change, log.log), sure) for change in labels.best.changes]
    faults = (*log.faults, *faults)
    right = in_stretches(repaired(log.log, faults), log.ship.parts["hull"].length)
    return replace(log, faults=faults, repaired=right)


def _label(change: Change, log: xarray.Dataset):
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
    cause = next((one for one in causes.values() if one.sought_in == "comparison"), None)
    if cause is None:
        return ()
    size = {name: Estimate(ratio.ratio, ratio.std, "1") for name in cause.parameters}
    return (Finding(cause.cause, None, "physics", 0.95, size, note=_ONLY_RATIO),)
