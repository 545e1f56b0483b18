"""What several logs of one ship have in common before any cause is sought: faults of the data, ratio, discrepancies."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray

from shipcosim.diagnose.comparison.gains import CommonRatio
from shipcosim.diagnose.comparison.labels import Labels
from shipcosim.diagnose.comparison.thresholds import COMMON_SPREAD
from shipcosim.diagnose.finding import Discrepancy, Finding, ParameterEstimate
from shipcosim.diagnose.log.mislabels import DRIVES, undone
from shipcosim.diagnose.log.rows import arrays_of
from shipcosim.diagnose.numerics import survival
from shipcosim.diagnose.reference.thresholds import APART, SAME_RATIO

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def common_faults(faults: Mapping[str, Sequence[Finding]]) -> list[Finding]:
    """Faults of the data that are the same, throughout, in half of the logs and two at least.

    Parameters
    ----------
    faults : mapping of str to sequence of Finding
        By name of the log.
    """
    # Group faults of the whole log that agree in cause,
    # channels and wording, whatever their numbers.
    by_key: dict[tuple, dict[str, Finding]] = {}
    for name, of_log in faults.items():
        for fault in of_log:
            if fault.kind == "data" and not fault.segments and not fault.alternatives:
                key = fault.cause, fault.component, fault.channels, _NUMBER.sub("#", fault.note)
                by_key.setdefault(key, {})[name] = fault
    return [
        _as_one(same) for same in by_key.values() if len(same) > 1 and 2 * len(same) >= len(faults)
    ]


def _as_one(same: Mapping[str, Finding]) -> Finding:
    """Findings by name of the log as one: parameters together, and as sure as the surest."""
    findings = list(same.values())
    return replace(
        findings[0],
        probability=max(finding.probability for finding in findings),
        parameters=together([finding.parameters for finding in findings]),
        logs=tuple(same),
    )


def together(parameters: Sequence[Mapping[str, ParameterEstimate]]) -> dict[str, ParameterEstimate]:
    """Estimates of several logs as one: means weighted by information, deviations at least what the logs differ by."""
    estimates = {}
    for name, first in parameters[0].items():
        # Mean weighted by inverse variances.
        values = np.array([parameter[name].estimate for parameter in parameters])
        stds = np.array([parameter[name].std for parameter in parameters])
        mean, std, _ = _weighted(values, np.maximum(stds, 1e-12))
        estimates[name] = ParameterEstimate(mean, std, first.unit)
    return estimates


def _weighted(values: np.ndarray, stds: np.ndarray) -> tuple[float, float, float]:
    """Mean weighted by information, its standard deviation widened to what the values differ by, and χ²."""
    # Inverse-variance weights, and chi-square of the deviations from the mean.
    weights = stds**-2.0
    mean = float(weights @ values / weights.sum())
    squares = float(weights @ (values - mean) ** 2)
    # Birge ratio: widen the standard deviation if the values differ by more than their errors.
    wider = max(squares / max(values.size - 1, 1), 1.0)
    return mean, float(np.sqrt(wider / weights.sum())), squares


def is_of_thrusters(fault: Finding) -> bool:
    """Whether a fault is one of the labels of what drives the thrusters."""
    return bool(fault.channels) and all(role.endswith(DRIVES) for role in fault.channels)


def leans_to(labels: Labels | None, fault: Finding) -> bool:
    """Whether a log without this label fault has weak evidence for it, or none at all."""
    # A log that does not show the fault may still have these thrusters among its likeliest labels.
    if labels is None:
        return True
    wanted = {role.rpartition("_")[0] for role in fault.channels}
    readings = (labels.best, *labels.rivals)
    return any(
        wanted in [set(change.thrusters) for change in reading.changes] for reading in readings
    )


def with_right_labels(log: xarray.Dataset, faults: Sequence[Finding]) -> xarray.Dataset:
    """A log as read, with faults of labels that hold throughout corrected.

    Parameters
    ----------
    log : xarray.Dataset
    faults : sequence of Finding
        Those of labels, with their `mislabel`.
    """
    # Correct one fault after the other, each on the result of the one before.
    columns = arrays_of(log)
    for fault in faults:
        columns = undone(columns, fault.mislabel, ())
    changed = log.copy()
    for role in {role for fault in faults for role in fault.channels}:
        changed[role] = log[role].copy(data=columns[role])
    changed.encoding |= log.encoding
    return changed


@dataclass(frozen=True)
class RatioOfLogs:
    """Thrust over inertia by several logs.

    Attributes
    ----------
    each : dict of str to CommonRatio
        By name of the log; those that tell it.
    common : CommonRatio or None
        Of all; None where they contradict each other, or none tells it.
    """

    each: dict[str, CommonRatio]
    common: CommonRatio | None

    @property
    def apart(self) -> tuple[str, ...]:
        """Logs that are far from all others, in their own standard deviations."""
        return tuple(name for name in self.each if len(self.each) > 2 and self._is_apart(name))

    def _is_apart(self, name: str) -> bool:
        # Ratio of all other logs, which must not contain the log itself.
        others = self.without(name)
        ratio = self.each[name]
        if others is None:
            return False
        # Difference of the logarithms in units of its standard deviation.
        return abs(np.log(ratio.ratio / others.ratio)) > APART * np.hypot(
            ratio.std / ratio.ratio, others.std / others.ratio
        )

    def without(self, name: str) -> CommonRatio | None:
        """The ratio by the other logs."""
        return ratio_of_logs(
            {other: ratio for other, ratio in self.each.items() if other != name}
        ).common

    @property
    def contradiction(self) -> str:
        """Sentence that the logs contradict each other; empty if they do not."""
        if self.common is not None or not self.each:
            return ""
        sizes = ", ".join(
            f"{name} {ratio.ratio:.2f} ± {ratio.std:.2f}" for name, ratio in self.each.items()
        )
        return f"Thrust over inertia differs from log to log by more than their errors, so none is common: {sizes}."


def ratio_of_logs(each: Mapping[str, CommonRatio]) -> RatioOfLogs:
    """One ratio of thrust to inertia for all logs, unless they differ by more than their errors.

    Parameters
    ----------
    each : mapping of str to CommonRatio
        By name of the log.
    """
    if not each:
        return RatioOfLogs({}, None)
    # Mean of the logarithms, as a ratio has relative errors.
    logs = np.log([ratio.ratio for ratio in each.values()])
    mean, std, squares = _weighted(
        logs, np.array([ratio.std / ratio.ratio for ratio in each.values()])
    )
    # Chi-square test that all logs have one ratio.
    chance = survival(float(squares), logs.size - 1) if logs.size > 1 else 1.0
    axes = tuple(dict.fromkeys(axis for ratio in each.values() for axis in ratio.axes))
    # Errors of the hull's form are common to all logs and do not average out.
    std = float(
        max(std, COMMON_SPREAD / np.sqrt(max(len(axes), 1)))
    )  # forms of a hull differ alike in all logs
    ratio = float(np.exp(mean))
    common = CommonRatio(ratio, ratio * std, axes) if chance > SAME_RATIO else None
    return RatioOfLogs(dict(each), common)


def common_discrepancies(each: Mapping[str, Sequence[Discrepancy]]) -> list[Discrepancy]:
    """Discrepancies of half of the logs and two at least: signs first, then by the share of the error they explain.

    Parameters
    ----------
    each : mapping of str to sequence of Discrepancy
        By name of the log.

    Returns
    -------
    list of Discrepancy
        In words with the range of their sizes; the share is the mean over all logs.
    """
    # Group discrepancies that agree in place, axis, unit and wording.
    by_key: dict[tuple, dict[str, Discrepancy]] = {}
    for name, of_log in each.items():
        for discrepancy in of_log:
            key = (
                discrepancy.component,
                discrepancy.axis,
                discrepancy.unit,
                _NUMBER.sub("#", discrepancy.what),
            )
            by_key.setdefault(key, {})[name] = discrepancy
    common = [
        replace(_ranging(list(same.values()), len(each)), logs=tuple(same))
        for same in by_key.values()
        if len(same) > 1 and 2 * len(same) >= len(each)
    ]
    return sorted(common, key=lambda shared: (shared.estimate > 0.0, -shared.share))


def _ranging(same: Sequence[Discrepancy], logs: int) -> Discrepancy:
    """Discrepancies of several logs as one, the numbers in its words from smallest to largest."""
    # Numbers in the wording become ranges over the logs.
    numbers = list(zip(*(_NUMBER.findall(discrepancy.what) for discrepancy in same), strict=True))
    ranges = iter([_range(texts) for texts in numbers])
    what = _NUMBER.sub(lambda _: next(ranges), same[0].what)
    # Weighted mean if all sizes have a standard deviation,
    # else the plain one; a log without it has a share of 0.
    values = np.array([discrepancy.estimate for discrepancy in same])
    stds = np.array([discrepancy.std for discrepancy in same])
    mean = float(values.mean())
    std = 0.0
    if (stds > 0.0).all():
        mean, std, _ = _weighted(values, stds)
    share = sum(discrepancy.share for discrepancy in same) / logs
    return replace(same[0], what=what, estimate=mean, std=std, share=share)


def _range(texts: Sequence[str]) -> str:
    low = min(texts, key=float)
    high = max(texts, key=float)
    return low if low == high else f"{low} to {high}"
