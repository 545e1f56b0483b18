"""Remarks on a run: warnings, failures, values that are not finite, a ship that cannot hold."""

from collections.abc import Mapping

import numpy as np
from xarray import Dataset

from shipcosim.errors import shortened
from shipcosim.report.run.derived import ERRORS, FROM_EXPECTED, FROM_REFERENCE
from shipcosim.report.run.details import parsed
from shipcosim.report.run.roles import Roles
from shipcosim.report.theme.display import series_in

STRETCH = 60.0  # s over which a ship that cannot hold is recognised
AT_LIMIT = 0.5  # share of the stretch in which something must be at its limit
GROWTH = 2.0  # m by which the position error must grow over the stretch


def remarks(table: Dataset, shown: Dataset, roles: Roles) -> list[str]:
    """Sentences for what a reader must not overlook.

    Parameters
    ----------
    table : xarray.Dataset
        The run; its attribute `remarks` holds what the FMUs warned of.
    shown : xarray.Dataset
        Table in the page's units, with the derived signals.
    roles : Roles
        What the signals stand for.

    Returns
    -------
    list of str
    """
    # Expectations that a part of a run did not get to.
    missed = parsed(table.attrs.get("not_reached", "[]"))
    start, end = table["time"].values[[0, -1]] if missed else (0.0, 0.0)
    went = f"The run went from {start:g} to {end:g} s."
    not_reached = [f"Not reached: {claim}. {went}" for claim in missed]
    # FMU warnings and unreached expectations first, then what the signals show.
    sentences = [*parsed(table.attrs.get("remarks", "[]")), *not_reached, *_not_finite(shown)]
    # Components that fail at the same time share a sentence.
    failed = _first_times(shown, roles.flagged("failed"))
    sentences += [
        f"Failed from {time:g} s on: {', '.join(names)}." for time, names in failed.items()
    ]
    sentences += _alarms(shown, roles)
    return sentences + _rejected(shown, roles) + _reckoned(shown, roles) + _lost_hold(shown, roles)


_DERIVED = {*ERRORS.values(), FROM_REFERENCE, FROM_EXPECTED}


def _not_finite(shown: Dataset) -> list[str]:
    """The first signals that become non-finite, and how many follow."""
    # First time of each such signal; derived signals only repeat their inputs.
    begin: dict[str, float] = {
        name: float(shown["time"].values[~np.isfinite(v.values)][0])
        for name, v in series_in(shown).items()
        if name not in _DERIVED and not np.isfinite(v.values).all()
    }
    # The earliest three: the others usually follow from them.
    names = sorted(begin, key=begin.__getitem__)
    if not names:
        return []
    return [f"Not finite from {begin[names[0]]:g} s on: {shortened(names, 3)}."]


def _first_times(shown: Dataset, flags: Mapping[str, str]) -> dict[float, list[str]]:
    """Names of signals by the time at which they are first set; `flags` maps names to signals."""
    begin: dict[float, list[str]] = {}
    for name, signal in flags.items():
        is_set = shown[signal].values > 0.5 if signal in shown else np.zeros(0, bool)
        if is_set.any():
            begin.setdefault(shown["time"].values[np.argmax(is_set)], []).append(name)
    return begin


def _rejected(shown: Dataset, roles: Roles) -> list[str]:
    """Sensors that a controller rejected, and when first."""
    sentences = []
    for signal in roles.ending("_rejected"):
        # Only rejections that happened.
        flags = shown[signal].values > 0.5 if signal in shown else np.zeros(0, bool)
        if flags.any():
            first = shown["time"].values[np.argmax(flags)]
            share = 100.0 * flags.mean()
            component, _, sensor = signal.removesuffix("_rejected").rpartition(".")
            what = sensor.replace("_", " ")
            sentences.append(
                f"{component} rejects {what} from {first:g} s on, in {share:.0f} % of the run."
            )
    return sentences


def _reckoned(shown: Dataset, roles: Roles) -> list[str]:
    """Longest time without a trusted position, by controller."""
    sentences = []
    for component, signal in roles.flagged("dead_reckoning_time").items():
        # The signal counts the time since the last trusted position.
        times = shown[signal].values if signal in shown else np.zeros(1)
        if times.max() > 0.0:
            until = shown["time"].values[np.argmax(times)]
            sentences.append(
                f"{component} has no trusted position for up to {times.max():.0f} s, until {until:g} s."
            )
    return sentences


def _alarms(shown: Dataset, roles: Roles) -> list[str]:
    """Alarms and their times: signals that end in _alarm or _faulty."""
    begin = _first_times(shown, {signal: signal for signal in roles.ending("_alarm", "_faulty")})
    return [f"Alarm from {time:g} s on: {', '.join(begin[time])}." for time in sorted(begin)]


def _lost_hold(shown: Dataset, roles: Roles) -> list[str]:
    """Remark where thrust is at its limit and the error still grows: the ship cannot hold."""
    # Flags of everything at its limit, and the start of every stretch of STRETCH seconds.
    limits = {c: shown[s].values > 0.5 for c, s in roles.flagged("saturated").items() if s in shown}
    time = shown["time"].values
    starts = np.flatnonzero(time <= time[-1] - STRETCH)
    if not limits or FROM_REFERENCE not in shown or not len(starts):
        return []
    # Last row of each stretch.
    ends = np.searchsorted(time, time[starts] + STRETCH, side="right") - 1
    error = shown[FROM_REFERENCE].values
    # The ship loses her position if the error grows while a component is at its limit.
    shares = {}
    for component, flags in limits.items():
        # Cumulative count: the share of any stretch is then one difference.
        count = np.concatenate([[0.0], np.cumsum(flags)])
        shares[component] = (count[ends + 1] - count[starts]) / (ends + 1 - starts)
    lost = (error[ends] - error[starts] > GROWTH) & (
        np.max(list(shares.values()), axis=0) > AT_LIMIT
    )
    if not lost.any():
        return []
    # Report the first such stretch: which components, from when on, and how far.
    k = int(np.argmax(lost))
    limited = [component for component, share in shares.items() if share[k] > AT_LIMIT]
    drift = "She cannot hold" if error[-1] > GROWTH else "She is driven off for a while"
    begin = starts[k] + np.argmax(limits[limited[0]][starts[k] :])
    return [
        f"{drift}: from {time[begin]:g} s on the thrust is at its limit ({', '.join(limited)}). The position error "
        f"grows to {error[ends[k]]:.1f} m within a minute, and to {np.nanmax(error):.1f} m at most."
    ]
