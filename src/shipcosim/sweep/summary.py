"""Summaries over runs that differ only in given factors, with confidence intervals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.sweep.plan import Plan
from shipcosim.sweep.study_model import Summary
from shipcosim.sweep.weather import NUMBERS

if TYPE_CHECKING:
    import pandas

CONFIDENCE = 0.95
SHARE = 0.9
"""Share of the runs of a case that have to hold, if a summary names none."""

RANGE = "_range"
"""Ending of the column that says the bounds of a value where not every case was run."""

Interval = tuple[float, float, float]
"""Value, lower and upper limit at CONFIDENCE; NaN where a limit cannot be given."""


def summarised(plan: Plan, runs: pandas.DataFrame) -> pandas.DataFrame:
    """Summaries of a study: a row for each combination of the remaining factors.

    Parameters
    ----------
    plan : Plan
    runs : DataFrame
        The table of runs; failed ones are left out, and counted in the columns `runs` and `failed`.

    Returns
    -------
    DataFrame
        Summaries over the same factors stand in the same rows; a factor that does not remain is empty.
    """
    import pandas

    factors = [factor.name for factor in plan.study.factor] + (
        ["sample"] if plan.samples is not None else []
    )
    # Summaries over the same factors share their rows.
    groups: dict[tuple[str, ...], list[Summary]] = {}
    for summary in plan.study.summary:
        gone = {*summary.over, summary.along}
        groups.setdefault(tuple(name for name in factors if name not in gone), []).append(summary)
    rows = [row for remaining, many in groups.items() for row in _rows(plan, runs, remaining, many)]
    return pandas.DataFrame(rows, columns=list(dict.fromkeys(name for row in rows for name in row)))


def by_levels(runs: Any, factors: Sequence[str]) -> Iterator[tuple[dict[str, Any], Any]]:
    """Levels of some factors, and the runs that have them."""
    grouped = runs.groupby(list(factors), sort=False, dropna=False) if factors else [((), runs)]
    for key, part in grouped:
        yield dict(zip(factors, key, strict=True)), part


def _rows(
    plan: Plan, runs: Any, remaining: tuple[str, ...], summaries: list[Summary]
) -> list[dict]:
    rows = []
    for row, part in by_levels(runs, remaining):
        # Failed runs are counted, but their values are not used.
        row |= {"runs": len(part), "failed": int((part["error"] != "").sum())}
        for summary in summaries:
            row |= _summary(plan, summary, part[part["error"] == ""])
        rows.append(row)
    return rows


def _summary(plan: Plan, summary: Summary, part: Any) -> Mapping[str, Any]:
    if summary.statistic == "last_held":
        return _last_held(plan, summary, part)
    values = part[summary.quantity].to_numpy(dtype=float)
    # "Never" is later than any time: infinite instead of missing, or an average would be too early.
    if any(measure.name == summary.quantity and measure.may_never_be for measure in plan.measures):
        values = np.where(np.isnan(values), np.inf, values)
    value, low, high = STATISTICS[summary.statistic](values[~np.isnan(values)], summary)
    limits = {f"{summary.name}_low": low, f"{summary.name}_high": high}
    return {summary.name: value} | (limits if summary.statistic in WITH_LIMITS else {})


def _last_held(plan: Plan, summary: Summary, part: Any) -> dict[str, Any]:
    """Label of the last case up to which all hold, and what the study tells of the cases that it left out."""
    factor = next(i for i, factor in enumerate(plan.study.factor) if factor.name == summary.along)
    label = summary.none
    # None where no case fails: only cases that were not run could.
    failing = None
    share = summary.share if summary.share is not None else SHARE
    # Levels come in increasing severity. Stop at the first in which too few runs hold.
    for level in plan.levels[factor]:
        held = part.loc[
            part[summary.along].astype(str) == str(level.label), summary.quantity
        ].to_numpy(dtype=float)
        held = held[~np.isnan(held)]  # of runs that end before what is judged
        if not len(held):
            break
        if held.mean() < share - 1e-12:
            failing = level.label
            break
        label = level.label
    is_condition = plan.study.factor[factor].conditions is not None
    return {summary.name: label, f"{summary.name}{RANGE}": range_of(label, failing, is_condition)}


def range_of(held: Any, failing: Any, is_condition: bool) -> str:
    """What is known where not every case is run: ``"4"``, ``">= 4"``, ``"1 to 3"``.

    Parameters
    ----------
    held, failing : label
        Last case that is held, and first that is not; None where there is none.
    is_condition : bool
        Whether they are DP capability numbers, of which there are none between neighbours and none above the highest.

    Examples
    --------
    >>> range_of(4, None, True), range_of(1, 4, True), range_of(3, 4, True), range_of(0, 1, True)
    ('>= 4', '1 to 3', '3', '0')
    >>> range_of("calm", "storm", False)
    'calm, not storm'
    """
    if not is_condition:
        return f">= {held}" if failing is None else f"{held}, not {failing}"
    if failing is None:
        return str(held) if held == NUMBERS[-1] else f">= {held}"
    highest = int(failing) - 1
    return str(held) if int(held or 0) == highest else f"{held} to {highest}"


def wilson(held: int, n: int) -> Interval:
    """Share of `n` that holds, with Wilson's interval.

    References
    ----------
    Wilson, Probable inference, the law of succession, and statistical inference, J. Am. Stat. Assoc. 22, 1927.

    Examples
    --------
    >>> [round(value, 3) for value in wilson(9, 10)]
    [0.9, 0.596, 0.982]
    """
    from scipy.stats import binomtest

    if n == 0:
        return np.nan, np.nan, np.nan
    low, high = binomtest(held, n).proportion_ci(CONFIDENCE, "wilson")
    return held / n, float(low), float(high)


def percentile(values: np.ndarray, percent: float) -> Interval:
    """Percentile of a sample, with the order statistics between which that of the population lies.

    Parameters
    ----------
    values : (n,) array
        What never happens is infinite, and so is a percentile that lies among such values.
    percent : float
        0 to 100.

    Returns
    -------
    Interval
        A limit is NaN where the sample is too small for it.

    References
    ----------
    David and Nagaraja, Order Statistics, 3rd ed., Wiley, 2003, ch. 7.1.

    Examples
    --------
    >>> percentile(np.arange(1.0, 101.0), 50.0)
    (50.5, 40.0, 61.0)
    >>> percentile(np.array([1.0, 2.0, np.inf]), 90.0)[0]
    inf
    """
    from scipy.stats import quantile_test

    if not len(values):
        return np.nan, np.nan, np.nan
    low, high = quantile_test(values, p=percent / 100.0).confidence_interval(CONFIDENCE)
    # Interpolation between a finite and an infinite value makes no sense: take the upper neighbour.
    after = np.sort(values)[int(np.ceil(percent / 100.0 * (len(values) - 1) - 1e-9))]
    value = np.percentile(values, percent) if np.isfinite(after) else after
    return float(value), float(low), float(high)


def mean(values: np.ndarray) -> Interval:
    """Mean of a sample, with Student's interval.

    Examples
    --------
    >>> [round(value, 2) for value in mean(np.array([1.0, 2.0, 3.0]))]
    [2.0, -0.48, 4.48]
    """
    from scipy.stats import t

    if len(values) < 2:
        return (float(values.mean()) if len(values) else np.nan), np.nan, np.nan
    # Mean ± t s / √n.
    half = t.ppf((1.0 + CONFIDENCE) / 2.0, len(values) - 1) * values.std(ddof=1) / sqrt(len(values))
    return float(values.mean()), float(values.mean() - half), float(values.mean() + half)


def _plain(reduce: Any, least: int = 1) -> Any:
    return lambda values, summary: (
        float(reduce(values)) if len(values) >= least else np.nan,
        np.nan,
        np.nan,
    )


WITH_LIMITS = ("percentile", "mean", "share")
STATISTICS: dict[str, Any] = {
    "percentile": lambda values, summary: percentile(values, summary.percentile),
    "mean": lambda values, summary: mean(values),
    "std": _plain(lambda values: values.std(ddof=1), 2),
    "maximum": _plain(np.max),
    "minimum": _plain(np.min),
    "share": lambda values, summary: wilson(int(values.sum()), len(values)),
}
"""Statistics of (values, summary)."""
