"""Bands of expectations: the allowed range of a signal in its window, and whether it held."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.angles import wrap_series
from shipcosim.report.theme.numbers import finite
from shipcosim.report.theme.packing import LARGEST
from shipcosim.scenario import Expectation, Verdict
from shipcosim.scenario.judge import rows_of


@dataclass(frozen=True)
class Band:
    """Allowed values of a panel's quantity over a window.

    Parameters
    ----------
    time, lower, upper : list of float
        Corners, in the panel's unit. [s, -, -]
    passed : bool
        Whether the expectation holds.
    """

    time: list[float]
    lower: list[float]
    upper: list[float]
    passed: bool


def bands_of(
    shown: Dataset, signal: str, verdicts: Iterable[Verdict], minus: str | None = None
) -> list[Band]:
    """Bands of all expectations on a signal.

    Parameters
    ----------
    shown : xarray.Dataset
        The table in the page's units.
    signal : str
        Signal that the panel draws.
    verdicts : iterable of Verdict
        What was expected.
    minus : str, optional
        Signal that the panel subtracts: the band of an error.

    Returns
    -------
    list of Band
    """
    bands = []
    for verdict in verdicts:
        # An expectation whose window has no row is not drawn.
        rows = rows_of(shown, verdict.expect)
        if signal in verdict.expect.signal and len(rows):
            # Of the table only what the band is made of: cutting all of its signals takes long.
            targets = [target for target in verdict.expect.near or () if isinstance(target, str)]
            needed = shown[list({signal, *targets, *([minus] if minus else [])})]
            bands.append(_band_of(needed.isel(time=rows), signal, verdict, minus))
    return bands


def distance_bands(
    shown: Dataset, signals: list[str | None], verdicts: Iterable[Verdict]
) -> list[Band]:
    """Bands of the expectations that several signals together stay near a point."""
    bands = []
    for verdict in verdicts:
        time = shown["time"].values[rows_of(shown, verdict.expect)]
        # One limit on the distance from the point, from zero up to the radius.
        if verdict.expect.signal == signals and verdict.expect.near is not None and len(time):
            limit = np.full(len(time), verdict.expect.within)
            bands.append(_band(time, 0.0 * limit, limit, verdict.passed))
    return bands


def _band_of(part: Dataset, signal: str, verdict: Verdict, minus: str | None) -> Band:
    """Band over the rows of `part`."""
    # Limits in absolute terms, then relative to the
    # subtracted signal where the panel shows an error.
    drawn = part[signal].values
    lower, upper = _limits(part, signal, verdict.expect)
    if minus is not None:
        middle = part[minus].values
        lower = lower - middle
        upper = upper - middle
        drawn = drawn - middle
        # An error in heading is drawn the short way round: move the band by the same turns.
        if part[signal].attrs["units"] == "deg":
            turn = wrap_series(lower) - lower
            lower = lower + turn
            upper = upper + turn
    # An open side is drawn to a little beyond the curve: it has no limit of its own.
    least, most = (pick(finite(drawn), initial=0.0) for pick in (np.min, np.max))
    pad = 0.1 * (most - least)
    lower = np.where(np.isfinite(lower), lower, np.fmin(least, upper) - pad)
    upper = np.where(np.isfinite(upper), upper, np.fmax(most, lower) + pad)
    return _band(part["time"].values, lower, upper, verdict.passed)


def _limits(part: Dataset, signal: str, expect: Expectation) -> tuple[NDArray, NDArray]:
    """Least and largest allowed value in the page's unit, (m,) each; infinite on an open side."""
    values = part[signal].values
    unit = part[signal].attrs["units"]
    factor = part[signal].attrs["factor"]
    ones = np.ones(len(values))
    # Fixed limits: constant over the window, infinite where there is none.
    if expect.near is None:
        least = -np.inf if expect.at_least is None else expect.at_least * factor
        most = np.inf if expect.at_most is None else expect.at_most * factor
        return least * ones, most * ones
    # Limits around a target, which is a number or another signal.
    near = expect.near[expect.signal.index(signal)]
    middle = part[near].values if isinstance(near, str) else near * factor * ones
    # Move the target to the turn on which the heading is drawn.
    if unit == "deg":
        middle = middle + 360.0 * np.round((values - middle) / 360.0)
    return middle - expect.within * factor, middle + expect.within * factor


def _band(time: NDArray, lower: NDArray, upper: NDArray, passed: bool) -> Band:
    """Make a band; a constant one needs only its two ends."""
    if np.ptp(lower) == 0.0 and np.ptp(upper) == 0.0:
        time = time[[0, -1]]
        lower = lower[[0, -1]]
        upper = upper[[0, -1]]
    # Beyond LARGEST a page draws nothing, and rounding would overflow.
    below, above = (np.clip(edge, -LARGEST, LARGEST).round(6).tolist() for edge in (lower, upper))
    return Band(np.round(time, 6).tolist(), below, above, passed)
