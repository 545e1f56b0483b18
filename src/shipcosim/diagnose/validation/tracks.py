"""A log again as simulated: open-loop predictions one after another, each from the measured state, beside the log."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray

from shipcosim.angles import wrap_series
from shipcosim.diagnose.explanation.verdict import JudgedLog
from shipcosim.diagnose.inference.predictions import predicted, replayable
from shipcosim.diagnose.log.roles import ROLES
from shipcosim.diagnose.ship.inputs import CHANNELS, Record, first_motion
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.ship.measured_motion import at_rows, readings, true_motion
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import way_of
from shipcosim.diagnose.ship.third_party_fmu import number_of
from shipcosim.diagnose.ship.time_scales import response_times
from shipcosim.diagnose.validation.cosimulation import Replayed, sailed_from
from shipcosim.diagnose.validation.gain import Predictor
from shipcosim.diagnose.validation.thresholds import (
    LEAST_SHARE,
    LONGEST_HORIZON,
    MOST_ROWS,
    SHORTEST_HORIZON,
    SMOOTHED_SHARE,
    STEP,
    TIME_CONSTANTS,
)
from shipcosim.errors import ShipcosimError, error_at
from shipcosim.models.core.motion import Motion
from shipcosim.options import CountProgress

_TO_LOG = (1.0, 1.0, 180.0 / np.pi, 1.0, 1.0, 180.0 / np.pi)


@dataclass(frozen=True)
class Tracks:
    """A log, and its simulations.

    Attributes
    ----------
    horizon : float
        Length of each prediction. [s]
    measured : xarray.Dataset
        Roles of the navigation over ``time``, heading unwrapped. [as the roles]
    predicted : dict of str to xarray.Dataset
        By simulation: the same over ``segment`` and ``time`` since the start of the segment, from ``start_time``.
    """

    horizon: float
    measured: xarray.Dataset
    predicted: dict[str, xarray.Dataset]


def tracks_of(log: JudgedLog, is_named: bool) -> Tracks | None:
    """Tracks of a judged log, before and, where something of the model is found wrong, after.

    Parameters
    ----------
    log : JudgedLog
    is_named : bool
        Whether the causes of its fit are named.

    Returns
    -------
    Tracks or None
        None where no stretch of the log is whole.
    """
    record = log.problem.record
    model = log.problem.model
    comparison = log.explained.identification.comparison
    models = {"before": comparison.given(model)}
    if is_named or comparison.craft is not None:
        after = model.with_values(log.fit.values) if is_named else model
        models["after"] = comparison.craft.on(after) if comparison.craft else after
    try:
        return tracks_by_models(record, models, fitting_horizon(record, model))
    except ShipcosimError:
        return None


def fitting_horizon(record: Record, model: ShipModel) -> float:
    """Length of predictions: some of the craft's slowest time constants, and a part of the log at most. [s]"""
    # As long as the ship needs to respond, within limits, and so that the log holds several
    # predictions.
    slowest = response_times(model, first_motion(record)).slowest
    wanted = np.clip(TIME_CONSTANTS * slowest, SHORTEST_HORIZON, LONGEST_HORIZON)
    return float(min(wanted, LEAST_SHARE * (record.time[-1] - record.time[0])))


def tracks_by_models(record: Record, models: Mapping[str, ShipModel], horizon: float) -> Tracks:
    """Predictions of ship models in array form.

    Parameters
    ----------
    record : Record
    models : dict of str to ShipModel
        By name; with surrogates where they need them.
    horizon : float
        [s]
    """
    rows, count, by_model = *_segments(record, horizon), {}
    # Smoothed measurements give the start; inputs are those of the log without delay.
    seen = _seen(record, horizon)
    for name, model in models.items():
        driven, neutral = replayable(record, model, seen)
        start = true_motion(at_rows(seen, rows), model)
        ahead = readings(predicted(start, rows, driven, neutral, range(1, count + 1)), model)
        first = readings(start, model)
        # The start itself is the first row of each prediction.
        channels = [np.vstack([a[None], b]).T for a, b in zip(first, ahead, strict=True)]
        by_model[name] = _dataset(channels, record.step * np.arange(count + 1), record.time[rows])
    return Tracks(horizon, _measured(record), by_model)


def tracks_by_systems(
    record: Record,
    model: ShipModel,
    systems: Mapping[str, Replayed],
    horizon: float,
    progress: CountProgress | None = None,
    most: int | None = None,
) -> Tracks:
    """Predictions of systems, by co-simulation.

    Parameters
    ----------
    record : Record
    model : ShipModel
        Of the systems, all of which have its thrusters.
    systems : dict of str to Replayed
        By name; those with signals have instruments of their own.
    horizon : float
        [s]
    progress : callable, optional
        Called with (segments done, segments in all).
    most : int, optional
        Segments, evenly spread over the log; all if not given.

    Raises
    ------
    ShipcosimError
        If a system has no inputs for what the log says of its thrusters, or a run fails.
    """
    rows, _ = _segments(record, horizon)
    # At most this many segments, evenly spread.
    rows = (
        rows
        if most is None
        else rows[np.unique(np.linspace(0, rows.size - 1, most).round().astype(int))]
    )
    seen = _seen(record, horizon)
    predicted = {}
    total = rows.size * len(systems)
    for number, (name, replayed) in enumerate(systems.items()):
        each = (
            None
            if progress is None
            else lambda n, _, done=number: progress(done * rows.size + n, total)
        )
        predicted[name] = _cosimulated(record, seen, model, replayed, rows, horizon, each)
    return Tracks(horizon, _measured(record), predicted)


def _cosimulated(record, seen, model, replayed, rows, horizon, progress):
    """Predictions of one system from some rows of the motion that the log shows."""
    driven, neutral = replayable(record, model, seen)
    # The system's instruments have errors of their own: take them out of the start values.
    errors, lag = _instruments(replayed)
    showing = model.with_values({f"instruments.{key}": value for key, value in errors.items()})
    start = true_motion(at_rows(seen, rows), showing)
    # Long enough for the instruments' delay.
    starts = Predictor(driven, neutral, showing, start)
    time, channels = sailed_from(
        replayed, starts, record.time[rows], horizon + lag, lag, progress=progress
    )
    # Unwrapped headings may differ by full turns from the log's: shift them to its start.
    channels[2] += (
        2.0 * np.pi * np.round((seen.psi[rows] - channels[2][:, 0]) / (2.0 * np.pi))[:, None]
    )
    # Drop the time before the first delayed measurement.
    kept = slice(round(lag / STEP), None)
    return _dataset(
        [values[:, kept] for values in channels], time[kept] - time[kept][0], record.time[rows]
    )


def _instruments(replayed: Replayed) -> tuple[dict[str, float], float]:
    """Errors of the instruments of a system, and by how much they are late. [s]"""
    if not replayed.signals:
        return {}, 0.0
    part = replayed.system.components[replayed.signals["north"].rpartition(".")[0]]
    names = tuple(Instruments().errors)
    given = {name: number_of(part, name) for name in (*names, "lag") if name in part.variables}
    return given, given.pop("lag", 0.0)


def _segments(record: Record, horizon: float) -> tuple[np.ndarray, int]:
    """Rows at which predictions start, one after another where the log is whole, and how many rows each has."""
    # Walk along the log: a segment where all inputs are known, the next one behind it.
    count = int(horizon / record.step + 1e-6)
    if count < 1:
        message = f"a prediction of {horizon:g} s is shorter than a step of {record.step:g} s."
        raise error_at("replay", message, "Ask for longer predictions.")
    whole = np.isfinite(record.measured[:, :3]).sum(axis=-1) == 3
    rows = []
    row = 0
    while row + count + 1 < record.time.size:
        if whole[row] and record.usable[row : row + count].all():
            rows.append(row)
            row += count
        else:
            row += 1
    if not rows:
        message = f"no {horizon:g} s of the log have a position and heading, and everything that drives her throughout."
        raise error_at("replay", message, "Ask for shorter predictions, or for a longer log.")
    return np.array(rows), count


def _seen(record: Record, horizon: float) -> Motion:
    """The motion that the log shows, smoothed, to start predictions from."""
    smooth = min(4.0, SMOOTHED_SHARE * horizon)
    seen = first_motion(record, smooth)
    # Her places are kept to the way that her velocity goes.
    way = way_of(seen, record.step)
    besides = record.measured.copy()
    besides[:, :3] -= way
    off = first_motion(replace(record, measured=besides), smooth)
    return seen._replace(x=way[:, 0] + off.x, y=way[:, 1] + off.y, psi=way[:, 2] + off.psi)


def _measured(record: Record) -> xarray.Dataset:
    thin = slice(None, None, max(record.time.size // MOST_ROWS, 1))
    columns = {
        role: ("time", record.measured[thin, i] * scale, {"units": ROLES[role].unit})
        for i, (role, scale) in enumerate(zip(CHANNELS, _TO_LOG, strict=True))
    }
    return xarray.Dataset(columns, coords={"time": ("time", record.time[thin], {"units": "s"})})


def _dataset(channels: list[np.ndarray], time: np.ndarray, starts: np.ndarray) -> xarray.Dataset:
    """Channels, (segments, times) arrays in SI, with the units of the roles, and no more rows than can be drawn."""
    thin = slice(None, None, max(starts.size * time.size // MOST_ROWS, 1))
    columns = {
        role: (("segment", "time"), values[:, thin] * scale, {"units": ROLES[role].unit})
        for role, values, scale in zip(CHANNELS, channels, _TO_LOG, strict=True)
    }
    return xarray.Dataset(
        columns,
        coords={
            "time": ("time", time[thin], {"units": "s"}),
            "start_time": ("segment", starts, {"units": "s"}),
        },
    )


def errors_of(tracks: Tracks, shares: tuple[float, ...] = (1.0 / 6.0, 0.5, 1.0)) -> xarray.Dataset:
    """Root mean square errors against the log after parts of the horizon.

    Returns
    -------
    xarray.Dataset
        ``position`` [m], ``heading`` [deg], ``surge``, ``sway`` [m/s], ``yaw_rate`` [deg/s] over ``simulation`` and
        ``after`` [s]; NaN where the log has nothing.
    """
    names = list(tracks.predicted)
    # Times of the predictions that are nearest to the parts of the horizon.
    times = next(iter(tracks.predicted.values()))["time"].values
    after = [float(times[np.abs(times - share * tracks.horizon).argmin()]) for share in shares]
    errors = {
        name: np.full((len(names), len(after)), np.nan) for name in ("position", *CHANNELS[2:])
    }
    for i, name in enumerate(names):
        for j, end in enumerate(after):
            for channel, off in _misses(tracks, tracks.predicted[name], end).items():
                if np.isfinite(off).any():
                    errors[channel][i, j] = np.sqrt(np.nanmean(off**2))
    units = {"position": "m"} | {role: ROLES[role].unit for role in CHANNELS[2:]}
    return xarray.Dataset(
        {
            name: (("simulation", "after"), values, {"units": units[name]})
            for name, values in errors.items()
        },
        coords={"simulation": names, "after": ("after", after, {"units": "s"})},
    )


def misses_at_end(tracks: Tracks, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Position error of each prediction of one simulation after the whole horizon.

    Returns
    -------
    starts, errors : (s,) array
        When each starts [s], and its error, NaN where the log has nothing [m].
    """
    predicted = tracks.predicted[name]
    return predicted["start_time"].values, _misses(tracks, predicted, tracks.horizon)["position"]


def _misses(tracks: Tracks, predicted: xarray.Dataset, end: float) -> dict[str, np.ndarray]:
    """Errors of each prediction of one simulation after some time: distance of the positions, other channels."""
    there = predicted.sel(time=end, method="nearest")
    at = predicted["start_time"].values + float(there["time"])
    # A channel of the log at some times, linear between rows; NaN where one of them has no value.
    off = {
        role: there[role].values
        - np.interp(at, tracks.measured["time"].values, tracks.measured[role].values)
        for role in CHANNELS
    }
    off["heading"] = wrap_series(off["heading"])
    far = np.hypot(off.pop("north"), off.pop("east"))
    return {"position": far} | off
