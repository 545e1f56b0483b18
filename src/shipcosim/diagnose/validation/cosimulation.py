"""The predictions of a gain as co-simulations: the system itself, from what was known at the start of each segment."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np
import xarray

from shipcosim.cosim import replay
from shipcosim.diagnose.inference.predictions import missing, predicted
from shipcosim.diagnose.ship.inputs import CHANNELS
from shipcosim.diagnose.ship.measured_motion import at_rows, readings
from shipcosim.diagnose.ship.third_party_fmu import DRIVES, drives_of
from shipcosim.diagnose.validation.gain import Comparison, Predictor
from shipcosim.diagnose.validation.split import HORIZONS, in_rows
from shipcosim.diagnose.validation.thresholds import INPUT_DELAY, MOST, STEP, WEATHER_RATE
from shipcosim.errors import error_at
from shipcosim.models.core.motion import Motion
from shipcosim.options import CountProgress
from shipcosim.series import make_table
from shipcosim.ssp import System

_CALM = {
    "gust_scale": 0.0,
    "significant_wave_height": 0.0,
    "wind_speed_rate": WEATHER_RATE,
    "wind_turn_rate": WEATHER_RATE,
}


@dataclass(frozen=True)
class Replayed:
    """A system that replays logs.

    Attributes
    ----------
    system : System
    signals : dict of str to str, optional
        By role, what it shows as the log does, as `Extension.signals`; without them its ship is looked at through the
        instruments of the ship model.
    """

    system: System
    signals: Mapping[str, str] | None = None


def simulated(
    comparison: Comparison,
    plain: Replayed,
    extended: Replayed | None,
    *,
    most: int = MOST,
    progress: CountProgress | None = None,
) -> xarray.Dataset:
    """Errors of a comparison, those of the plain and the extended model by co-simulation, on some of its segments.

    Parameters
    ----------
    comparison : Comparison
    plain, extended : Replayed
        The system, and the one extended by the causes of ``comparison.fit``. The second is not run where no cause was
        fitted.
    most : int
        Segments, evenly spread.
    progress : callable, optional
        Called with (segments done, segments in all).

    Returns
    -------
    xarray.Dataset
        As ``comparison.errors``; besides ``difference`` [m] by model ``plain`` and ``extended``, horizon and segment:
        how far the co-simulation is from the same prediction in array form.
    """
    # Evenly spread segments; a co-simulation of all would take too long.
    count = min(most, comparison.rows.size)
    some = np.linspace(0, comparison.rows.size - 1, count).round().astype(int)
    rows = comparison.rows[some]
    errors = comparison.errors.isel(segment=some).copy(deep=True)
    replays = {"plain": plain}
    done = 0
    apart = np.zeros((2, len(HORIZONS), count))
    if comparison.fit.hypotheses and extended is not None:
        replays["extended"] = extended
    for number, (model, system_replayed) in enumerate(replays.items()):
        predictor = comparison.predictors[model]
        each = (
            None
            if progress is None
            else lambda n, _, done=done: progress(done + n, count * len(replays))
        )
        predictions = replayed(system_replayed, predictor, rows, progress=each)
        done += count
        # Errors at the end of each horizon, against the same reference as those in array form.
        horizons = in_rows(predictor.record)
        ends = rows + np.array(horizons)[:, None]
        for channel, values in missing(predictions, comparison.seen, ends).items():
            errors[channel].loc[{"model": model}] = values
            if "extended" not in replays:
                errors[channel].loc[{"model": "extended"}] = values
        # How far co-simulation and array form differ: a check of the array form.
        array = in_array_form(predictor, rows)
        apart[number:] = np.hypot(predictions.x - array.x, predictions.y - array.y)
    errors["difference"] = (("replayed", "horizon", "segment"), apart, {"units": "m"})
    return errors.assign_coords(replayed=["plain", "extended"])


def in_array_form(predictor: Predictor, rows: np.ndarray) -> Motion:
    """What a model predicts the log to show after the horizons, (horizons, s) arrays."""
    motion = at_rows(predictor.motion, rows)
    predictions = predicted(
        motion, rows, predictor.record, predictor.model, in_rows(predictor.record)
    )
    return readings(predictions, predictor.model)


def replayed(
    system_replayed: Replayed,
    predictor: Predictor,
    rows: np.ndarray,
    *,
    step_size: float = STEP,
    progress: CountProgress | None = None,
) -> Motion:
    """Predictions of a log after the horizons, by a system that is run from some rows.

    Parameters
    ----------
    system_replayed : Replayed
    predictor : Predictor
        The same model in array form: gives start values and the table.
    rows : (s,) array of int
        Where the runs start.
    step_size : float
        [s]
    progress : callable, optional
        Called with (segments done, segments in all).

    Returns
    -------
    Motion
        (horizons, s) arrays.

    Raises
    ------
    ShipcosimError
        If the system has no inputs for what the log says of its thrusters.
    """
    record = predictor.record
    # Instruments show the ship late by the navigation lag: the replay starts that much earlier.
    lag = predictor.original.parts["instruments"].navigation_lag
    late = lag if system_replayed.signals else 0.0
    at_starts = replace(predictor, motion=at_rows(predictor.motion, rows))
    time, channels = sailed_from(
        system_replayed,
        at_starts,
        record.time[rows],
        HORIZONS[-1] + late,
        lag,
        step_size=step_size,
        progress=progress,
    )
    # Horizons count from the start as shown, so the delay is added.
    ends = late + record.step * np.array(in_rows(record))
    motion = Motion(*(np.array([_at(series, time, end) for end in ends]) for series in channels))
    return motion if system_replayed.signals else readings(motion, predictor.model)


def sailed_from(
    system_replayed: Replayed,
    start: Predictor,
    times: np.ndarray,
    seconds: float,
    lag: float,
    *,
    step_size: float = STEP,
    progress: CountProgress | None = None,
) -> tuple[np.ndarray, list[np.ndarray]]:
    """What a system shows, run from some states of its ship with what drove her in a log.

    Parameters
    ----------
    system_replayed : Replayed
    start : Predictor
        Gives the table, and the ship's motion where each run starts, (s,) arrays.
    times : (s,) array
        Where the runs start in the log. [s]
    seconds : float
        How long they last, rounded up to whole steps. [s]
    lag : float
        By how much the log's times are late. [s]
    step_size : float
        [s]
    progress : callable, optional
        Called with (runs done, runs in all).

    Returns
    -------
    (k,) array, list of six (s, k) arrays
        Times since the start [s], and position, heading without jumps, and velocity. [SI]
    """
    ship = start.model.vessel
    table, states = driving_table(system_replayed.system, start, step_size, lag)
    states |= {f"{ship}.{name}_start": value for name, value in start.motion._asdict().items()}
    signals = [f"{ship}.{name}" for name in Motion._fields]
    if system_replayed.signals:
        signals = [system_replayed.signals[role] for role in CHANNELS]
    replay_table = replay(
        system_replayed.system,
        table,
        (times - lag).tolist(),
        step_size * ceil(seconds / step_size - 1e-6),
        states=states,
        step_size=step_size,
        signals=signals,
        progress=progress,
    )
    channels = [replay_table[name].values for name in signals]
    channels[2] = np.unwrap(channels[2], axis=1)
    return replay_table["time"].values, channels


def _at(series, time, end):
    """Rows of (segments, times) at one time, linear between."""
    after = min(max(int(np.searchsorted(time, end)), 1), time.size - 1)
    share = (end - time[after - 1]) / (time[after] - time[after - 1])
    return (1.0 - share) * series[:, after - 1] + share * series[:, after]


def driving_table(
    system: System, predictor: Predictor, step_size: float, lag: float = 0.0
) -> tuple[xarray.Dataset, dict[str, Any]]:
    """What drives a ship in a log as a table for the inputs of a system, and what must hold besides for a replay.

    An input acts on the ship a step and a half after its row, so the table is that much early.

    Parameters
    ----------
    system : System
    predictor : Predictor
    step_size : float
        [s]
    lag : float
        By how much the log's times are late. [s]

    Returns
    -------
    tuple of xarray.Dataset and dict of str to value

    Raises
    ------
    ShipcosimError
        With every variable of a thruster that no input feeds, although the log changes it.
    """
    record = predictor.record
    model = predictor.model
    columns = []
    states = {}
    unfed = []
    # Each thruster: a series for every input that the system feeds, a constant where it never
    # changes.
    for name, (speed, direction) in record.units.items():
        states |= {} if name in model.third_party else {f"{name}.replay": True}
        series = {
            kind: (values, DRIVES[kind]) for kind, values in drives_of(speed, direction).items()
        }
        for variable, kind in _driven(model, name):
            values, unit = series[kind]
            fed = _input(system, name, variable)
            if fed:
                columns.append((fed, values, unit, ""))
            elif np.ptp(values) == 0.0 and not any(
                c.target == (name, variable) for c in system.connections
            ):
                states[f"{name}.{variable}"] = values[0]
            else:
                unfed.append(f"{name}.{variable}")
    if unfed:
        message = f"no input of the system feeds {', '.join(unfed)}, which the log has."
        raise error_at(system.name, message, "Connect an input of the system to each.")
    weather, calm = _weather(system, model.vessel, record)
    columns = columns + weather
    last = record.time[-1] + record.step
    # Times of the table, early by the delays of measurements and inputs.
    time = np.append(record.time, last) - lag - INPUT_DELAY * step_size
    table = make_table(
        time, [(name, np.append(values, values[-1]), *more) for name, values, *more in columns]
    )
    for column in table.data_vars.values():
        column.attrs["interpolation"] = "linear"
    return table, states | calm


def _driven(model, name):
    """Variables of a thruster that the log drives, and by what."""
    if name not in model.third_party:
        return [(f"{kind}_in", kind) for kind in model.drives(name)]
    return [
        (link.variable, link.quantity)
        for link in model.third_party[name].links
        if link.quantity in model.drives(name)
    ]


def _input(system, component, variable):
    """Input of the system that feeds a variable, or None."""
    feeding = (c.source for c in system.connections if c.target == (component, variable))
    return next((name for owner, name in feeding if owner is None), None)


def _weather(system, ship, record):
    """Columns of the wind, and values that leave it as logged."""
    # A wind component with gusts and waves is calmed; the logged wind replaces them.
    sources = [c.source for c in system.connections if c.target == (ship, "wind_north")]
    if not sources or sources[0][0] is None:
        return _straight(system, ship, record), {}
    air = sources[0][0]
    variables = system.components[air].variables
    values = {f"{air}.{name}": value for name, value in _CALM.items() if name in variables}
    names = [_input(system, air, name) for name in ("wind_speed", "wind_from")]
    if record.wind is None or None in names:
        return [], values | ({names[0]: 0.0} if names[0] else {f"{air}.wind_speed": 0.0})
    return [(names[0], record.wind[0], "m/s", ""), (names[1], record.wind[1], "rad", "")], values


def _straight(system, ship, record):
    """Columns of the wind for inputs of the system that feed it to the ship."""
    names = [_input(system, ship, f"wind_{axis}") for axis in ("north", "east")]
    if record.wind is None or None in names:
        return []
    speed, direction = record.wind
    values = -speed * np.cos(direction), -speed * np.sin(direction)
    return [(name, value, "m/s", "") for name, value in zip(names, values, strict=True)]
