"""Rows of a log: which are usable, how far apart they are, which lie in some segments; its arrays."""

from collections.abc import Sequence

import numpy as np
import xarray

from shipcosim.diagnose.finding import Segment
from shipcosim.diagnose.log.thresholds import UNEVEN


def usable_rows(time: np.ndarray) -> np.ndarray:
    """Rows in order of time, without those that have no time or one that was there already: (k,) indices."""
    rows = np.flatnonzero(np.isfinite(time))
    rows = rows[np.argsort(time[rows], kind="stable")]
    return rows[np.diff(time[rows], prepend=-np.inf) > 0.0]


def usual_step(time: np.ndarray) -> float:
    """Median step of increasing times, without the last digits of rounding. [s]"""
    return float(f"{np.median(np.diff(time)):.9g}")


def usual_distance(time: np.ndarray) -> float:
    """Distance of increasing times within which data is not missing: their step, or that of 95 % of uneven rows. [s]

    Times are uneven where they keep to no clock; a log of even times with lost rows is not.
    """
    # Times on a clock differ by whole steps; the deviation from these shows uneven sampling.
    step = usual_step(time)
    spans = np.diff(time)
    off = np.abs(spans / step - np.round(spans / step))
    return float(np.quantile(spans, 0.95)) if np.median(off) > UNEVEN else step


def inside(time: np.ndarray, segments: Sequence[Segment]) -> np.ndarray:
    """True for times in one of the segments, or for all without segments, (n,) array of bool."""
    if not segments:
        return np.ones(len(time), bool)
    return np.any([(time >= first) & (time <= last) for first, last in segments], axis=0)


def arrays_of(log: xarray.Dataset) -> dict[str, np.ndarray]:
    """A log as a dict of arrays by role, with its `time`."""
    return {"time": log["time"].values} | {str(name): log[name].values for name in log.data_vars}
