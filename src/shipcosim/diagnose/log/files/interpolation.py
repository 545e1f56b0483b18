"""Channels with times of their own at the times of another one."""

from __future__ import annotations

import numpy as np

_FAR = 3.0  # usual steps of a channel over which it is interpolated. Assumed.


def at_times(clock: np.ndarray, times: np.ndarray, values: np.ndarray, unit: str) -> np.ndarray:
    """Values at other times, angles the short way round; NaN outside of them and across holes.

    Parameters
    ----------
    clock : (m,) array
        The times that are wanted. [s]
    times, values : (n,) array
        Of a channel, times rising. [s, `unit`]
    unit : str
        Values in ``deg`` turn round the circle.

    Returns
    -------
    (m,) array
    """
    if len(times) < 2:
        return np.full(len(clock), np.nan)
    # Angles are interpolated unwrapped.
    turns = unit == "deg"
    there = np.interp(clock, times, np.unwrap(values, period=360.0) if turns else values)
    # Usual step of the channel; no value across a hole, or outside by more than half a step.
    after = np.clip(np.searchsorted(times, clock), 1, len(times) - 1)
    step = float(np.median(np.diff(times)))
    before = times[after - 1]
    is_far = (times[after] - before > _FAR * step) & (clock != before) & (clock != times[after])
    outside = (clock < times[0] - 0.5 * step) | (clock > times[-1] + 0.5 * step)
    # Wrap back, where the channel was not signed.
    back = np.mod(there, 360.0) if turns and values.min() >= 0.0 else there
    return np.where(is_far | outside, np.nan, back)
