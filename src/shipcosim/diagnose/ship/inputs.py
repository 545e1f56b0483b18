"""A repaired log as arrays in SI: what was measured of the ship, and what drove her, on an even grid of times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import xarray

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.numerics import between, gaussian_filter, places
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.stretches import rows_averaged, stretches_of
from shipcosim.diagnose.ship.third_party_fmu import ThirdPartyFmu
from shipcosim.diagnose.ship.time_scales import fastest_rate, response_times
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Motion

_SHORTEST = 18.0  # s over the root of the length in m: 105 s for 33.9 m, 20 s for 1.2 m
_FEWEST_ROWS = 60
_ONE_STEP = 0.2  # s over the root of the length in m: 1 s on a ship of 25 m
_RATE_OF_A_STEP = (
    1.0  # 1, of the fastest answer times the step: Runge-Kutta of fourth order diverges beyond 2.8
)
_MOST_STEPS = 64  # from row to row; a model or a log that asks for more is wrong
_LATE = (
    10.0  # s before and after a hole between stretches, within which a late channel is not known
)
CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")
_TO_SI = (1.0, 1.0, np.pi / 180.0, 1.0, 1.0, np.pi / 180.0)


ThrusterSeries = dict[str, tuple[np.ndarray, np.ndarray]]
"""By thruster its speed or thrust, and its direction, over the rows. [rev/s or N, rad]"""


class Inputs(NamedTuple):
    """Inputs of the ship model at some times, arrays of one shape.

    Attributes
    ----------
    time : array
        [s]
    units : dict of str to tuple of two arrays
        By thruster: speed, or thrust where that drives it, and direction as logged. [rev/s or N, rad]
    wind_speed, wind_from : array or None
        Wind at the mast, apparent or true as `ShipModel.wind_is_true` says. [m/s, rad]
    """

    time: Arithmetic
    units: dict[str, tuple[Arithmetic, Arithmetic]]
    wind_speed: Arithmetic | None
    wind_from: Arithmetic | None

    def at(self, rows: Any) -> Inputs:
        """Inputs at some of the rows, the last axis of the arrays."""
        units = part_of(self.units, (..., rows))
        wind = (
            None if series is None else series[..., rows]
            for series in (self.wind_speed, self.wind_from)
        )
        return Inputs(self.time[rows], units, *wind)


@dataclass(frozen=True)
class Record:
    """Measurements and inputs of one log, or of several of the same length with them on the first axis.

    Attributes
    ----------
    time : (n,) array
        Even, except for holes between the stretches of a long log. [s]
    measured : (..., n, 6) array
        `CHANNELS` in SI, heading unwrapped, NaN where there is none.
    units : dict of str to tuple of two (..., n) arrays
        Speed of each thruster, or thrust where that drives it, and direction, unwrapped. [rev/s or N, rad]
    wind : tuple of two (..., n) arrays, or None
        Speed, and direction unwrapped. [m/s, rad]
    usable : (n,) bool array
        Whether everything that drives the ship is known over the step that follows.
    rate : float
        Of the fastest answer that the ship gives in the log. [1/s]
    """

    time: np.ndarray
    measured: np.ndarray
    units: ThrusterSeries
    wind: tuple[np.ndarray, np.ndarray] | None
    usable: np.ndarray
    remarks: tuple[str, ...] = field(default=())
    rate: float = 0.0

    @property
    def step(self) -> float:
        """Time from row to row. [s]"""
        return float(self.time[1] - self.time[0])

    @cached_property
    def stretches(self) -> list[slice]:
        """Rows that follow each other; all of them but in a long log."""
        return stretches_of(self.time)

    @cached_property
    def is_last(self) -> np.ndarray:
        """Which rows are the last of a stretch, (n,) bool array."""
        flags = np.zeros(self.time.size, bool)
        flags[[rows.stop - 1 for rows in self.stretches]] = True
        return flags

    def part(self, rows: Any) -> Record:
        """Some rows, as an index of an array gives them."""
        wind = None if self.wind is None else tuple(series[rows] for series in self.wind)
        return replace(
            self,
            time=self.time[rows],
            measured=self.measured[rows],
            units=part_of(self.units, rows),
            wind=wind,
            usable=self.usable[rows],
        )

    def substeps(self, model: ShipModel) -> int:
        """Number of integration steps from row to row; more than one for a small or stiff ship."""
        # Steps short enough for the size of the ship and
        # for its fastest response, as a power of two.
        rows = self.step * max(
            1.0 / (_ONE_STEP * np.sqrt(model.length)), self.rate / _RATE_OF_A_STEP
        )
        return 2 ** int(np.ceil(np.log2(min(max(rows, 1.0), _MOST_STEPS)) - 1e-9))

    def inputs(self, model: ShipModel, share: float = 0.0, steps: slice = slice(None)) -> Inputs:
        """Inputs of the ship model at each row but the last, or a share of a step after it; or in some of these steps.

        Late channels are taken that much later; where the navigation is late, all others are taken earlier.
        """
        # Shift the inputs by the lags of their channels. A
        # late navigation means that the inputs act earlier.
        lags = model.parts["instruments"]
        late = share * self.step - lags.navigation_lag
        behind = self._places(late + lags.thruster_lag, steps)
        late_wind = self._places(late + lags.wind_lag, steps)
        units = {
            name: (between(pair[0], *behind), between(pair[1], *behind))
            for name, pair in self.units.items()
        }
        wind = (
            (None, None)
            if self.wind is None
            else (between(series, *late_wind) for series in self.wind)
        )
        return Inputs(self.time[:-1][steps] + share * self.step, units, *wind)

    def _places(self, seconds: float, steps: slice) -> tuple[np.ndarray, np.ndarray]:
        """Rows that much later: the row before, and the share of the step after it."""
        rows = self.time.size
        return places(np.arange(rows - 1)[steps] + seconds / self.step, rows)


def part_of(units: Mapping[str, tuple], rows: Any) -> dict[str, tuple]:
    """Some rows, or some of several logs, of each thruster's channels."""
    return {name: tuple(series[rows] for series in pair) for name, pair in units.items()}


def source_of(log: xarray.Dataset) -> str:
    """The file that a log is from, for messages."""
    return str(log.attrs.get("source", "log"))


def record_of(log: xarray.Dataset, model: ShipModel) -> Record:
    """Arrays of a repaired log.

    Parameters
    ----------
    log : xarray.Dataset
        Evenly spaced, roles in the contract's units, NaN where there is no data.
    model : ShipModel

    Returns
    -------
    Record
        Its `remarks` say what is missing.

    Raises
    ------
    ShipcosimError
        Too little to diagnose.
    """
    rows = log.sizes["time"]
    time = log["time"].values.astype(float)
    # One row has no step; of two or more `_check_length` says what this ship would need.
    if rows < 2:
        right = f"A diagnosis takes {_FEWEST_ROWS} rows at the least."
        raise error_at(source_of(log), f"{rows} rows.", right)
    missing = [role for role in ("north", "east", "heading") if role not in log]
    if missing:
        message = f"no channel {', '.join(missing)}."
        source = source_of(log)
        right = (
            "A diagnosis needs north, east and heading. "
            f"`shipcosim channels {source}` shows which columns may be them."
        )
        raise error_at(source, message, right)
    # Measurements in SI units, with the heading unwrapped.
    measured = np.stack(
        [_column(log, role, rows) * si for role, si in zip(CHANNELS, _TO_SI, strict=True)], axis=-1
    )
    measured[:, 2] = unwrap_series(measured[:, 2])
    _check_third_party(log, model)
    # Add the inputs, then average rows down to the rate that the ship needs.
    record = _driven(log, model, measured)
    remarks = [_about_third_party(name, fmu) for name, fmu in model.third_party.items()]
    record = replace(record, remarks=(*_about_stretches(time), *record.remarks, *remarks))
    thinned = _thinned_for(model, record)
    _check_length(log, model, first_motion(thinned))
    return thinned


def with_inputs_of(record: Record, log: xarray.Dataset, model: ShipModel) -> Record:
    """The record of a log with the same navigation, with thrusters and wind of this one.

    Parameters
    ----------
    record : Record
        As `record_of` gives it.
    log : xarray.Dataset
        Repaired, of the same rows.
    model : ShipModel

    Returns
    -------
    Record
        As `record_of` would give it, in a fraction of its time.
    """
    # Inputs alone, thinned like the record, so that the rows agree.
    driven = _driven(log, model, np.zeros((log.sizes["time"], 0)))
    driven = _thinned(driven, rows_averaged(model.length, driven.step), model)
    return replace(record, units=driven.units, wind=driven.wind, usable=driven.usable)


def _driven(log: xarray.Dataset, model: ShipModel, measured: np.ndarray) -> Record:
    """The record of every row of a log, with what was measured of the ship."""
    rows = log.sizes["time"]
    time = log["time"].values.astype(float)
    remarks = []
    units = {}
    # A step is known if all inputs are measured at both
    # of its ends, away from holes between stretches.
    usable = np.ones(rows, bool)
    for name in model.thrusters:
        units[name], whole = _unit(log, name, model, rows, remarks)
        usable &= whole
    wind, whole = _wind(log, rows, remarks)
    usable &= whole
    usable[:-1] &= usable[1:]
    usable &= ~_near_holes(time)
    return Record(time, measured, units, wind, usable, tuple(remarks))


def _near_holes(time: np.ndarray) -> np.ndarray:
    """Rows beside the holes between stretches, (n,) bool array."""
    # Rows at both sides of each hole, as far as a late channel reaches.
    inner = [rows.stop for rows in stretches_of(time)[:-1]]
    late = int(np.ceil(_LATE / (time[1] - time[0])))
    flags = np.zeros(time.size, bool)
    for row in inner:
        flags[max(row - late, 0) : row + late] = True
    return flags


def _about_stretches(time: np.ndarray) -> list[str]:
    """What of a long log is used."""
    parts = stretches_of(time)
    step = time[1] - time[0]
    if len(parts) == 1:
        return []
    used = time.size * step / 60.0
    span = (time[-1] - time[0]) / 3600.0
    what = f"{len(parts)} stretches, {used:.0f} min together, spread evenly over its rows"
    return [
        f"Of this log of {span:.1f} h {what}, are compared with the ship. All of it was checked for faults."
    ]


def _thinned_for(model: ShipModel, record: Record) -> Record:
    """The record at the rate that a ship's answer needs."""
    # At least two rows remain after averaging.
    rows = min(rows_averaged(model.length, record.step), record.time.size // 2)
    thinned = _thinned(record, rows, model)
    # The fastest response sets the integration step; it is estimated from the averaged motion.
    thinned = replace(thinned, rate=fastest_rate(model, first_motion(thinned)))
    if rows == 1:
        return thinned
    far = f"Rows {record.step:.3g} s apart are averaged over {thinned.step:.3g} s"
    return replace(thinned, remarks=(*record.remarks, f"{far}, which resolves this ship's answer."))


def _check_length(log: xarray.Dataset, model: ShipModel, motion: Motion) -> None:
    """Raise ShipcosimError for a log that is too short for what its ship does, or has too few rows."""
    rows = log.sizes["time"]
    span = float(log["time"][-1] - log["time"][0])
    # The response of ships scales with the root of
    # their length, and so does the shortest useful log.
    least = _SHORTEST * np.sqrt(model.length)
    if span < least or rows < _FEWEST_ROWS:
        # The slowest response is only for the message.
        slowest = max(
            (time for time in response_times(model, motion) if np.isfinite(time)), default=np.inf
        )
        answer = (
            f"whose slowest answer takes {slowest:.2g} s" if slowest < 1e4 else "that hardly moves"
        )
        message = f"{rows} rows over {span:.0f} s, of a ship {answer}."
        right = f"It takes {_FEWEST_ROWS} rows over {least:.0f} s at the least, better twenty times that."
        raise error_at(source_of(log), message, right)


def _thinned(record: Record, rows: int, model: ShipModel) -> Record:
    """The record with every so many rows averaged into one; of speeds, which push by their square, as that."""
    if rows == 1:
        return record
    # Whole groups of rows within each stretch; what is left at its end is dropped.
    used = np.concatenate(
        [
            np.arange(stretch.start, stretch.stop - (stretch.stop - stretch.start) % rows)
            for stretch in record.stretches
        ]
    )

    def mean(series):
        whole = series[used].reshape(used.size // rows, rows, *series.shape[1:])
        count = np.isfinite(whole).sum(1)
        return np.where(count > 0, np.nansum(whole, axis=1) / np.maximum(count, 1), np.nan)

    # Thrust and wind load go with the squared speed, so its
    # mean must be kept: the root of the mean signed square.
    def of_squares(series):
        push = mean(series * np.abs(series))
        return np.sign(push) * np.sqrt(np.abs(push))

    pushes = {name: mean if "thrust" in model.drives(name) else of_squares for name in record.units}
    units = {
        name: (pushes[name](drive), mean(direction))
        for name, (drive, direction) in record.units.items()
    }
    wind = None if record.wind is None else (of_squares(record.wind[0]), mean(record.wind[1]))
    # An averaged row is known only if all of its rows are.
    usable = mean(record.usable.astype(float)) == 1.0
    return Record(mean(record.time), mean(record.measured), units, wind, usable, record.remarks)


def _column(log: xarray.Dataset, role: str, rows: int) -> np.ndarray:
    return log[role].values.astype(float) if role in log else np.full(rows, np.nan)


def _unit(log, name, model, rows, remarks):
    """Speed or thrust of a thruster and its direction, and the rows in which they are known."""
    # The drive of a thruster is its speed in rev/s, or its thrust if this is logged instead.
    speed = _column(log, f"{name}_rpm", rows) / 60.0
    direction = _column(log, f"{name}_azimuth", rows) * np.pi / 180.0
    if "thrust" in model.drives(name):
        speed = _column(log, f"{name}_thrust", rows)
    elif f"{name}_rpm" not in log:
        if "rpm" in model.drives(name):
            remarks.append(f"No speed of '{name}' in the log: taken to stand still in simulations.")
        speed = np.zeros(rows)
    if name in model.azimuths and f"{name}_azimuth" not in log:
        remarks.append(f"No direction of '{name}' in the log: taken to point ahead in simulations.")
    # Without a logged direction a thruster points where the system fixes it, or ahead.
    if name not in model.azimuths or f"{name}_azimuth" not in log:
        direction = np.full(rows, model.fixed.get(name, 0.0))
    # Where both are measured; gaps are filled for the arrays only.
    whole = np.isfinite(speed) & np.isfinite(direction)
    return (averaged(speed), averaged(unwrap_series(direction))), whole


def _check_third_party(log: xarray.Dataset, model: ShipModel) -> None:
    """Raise ShipcosimError where the log lacks what drives a third-party FMU: nobody knows its load then."""
    drives = [
        (name, f"{name}_{kind}") for name, fmu in model.third_party.items() for kind in fmu.drives
    ]
    where = source_of(log)
    remedy = "Log it under this name, or name its column in a channel file."
    lacking = [
        Problem(where, f"no channel {role}, which drives '{name}'.", remedy)
        for name, role in drives
        if role not in log
    ]
    lacking += [
        Problem(
            str(name),
            f"{fmu.component.fmu.model_name} follows {', '.join(fmu.idle)}, which no log contains.",
            "A diagnosis knows what drives a thruster as rpm, azimuth or thrust: describe her by another kind.",
        )
        for name, fmu in model.third_party.items()
        if fmu.idle and not fmu.drives
    ]
    if lacking:
        raise ShipcosimError(lacking)


def _about_third_party(name: str, fmu: ThirdPartyFmu) -> str:
    """What the user should know of a third-party FMU."""
    idle = (
        f" Inputs that the log does not have keep their start values: {', '.join(fmu.idle)}."
        if fmu.idle
        else ""
    )
    text = f"'{name}' is a third-party FMU ({fmu.component.fmu.model_name}), known by its co-simulation along the log."
    return f"{text}{idle} No manoeuvre can be prescribed with it."


def _wind(log, rows, remarks):
    # Prefer the apparent wind to the true one.
    for speed, direction in (("wind_speed", "wind_from"), ("true_wind_speed", "true_wind_from")):
        if speed in log and direction in log:
            pair = (
                _column(log, speed, rows),
                unwrap_series(_column(log, direction, rows) * np.pi / 180.0),
            )
            whole = np.isfinite(pair[0]) & np.isfinite(pair[1])
            if whole.any():
                return (averaged(pair[0]), averaged(pair[1])), whole
    remarks.append(
        "No wind in the log: forces of the wind, of waves, of a current and of a line cannot be told apart."
    )
    return None, np.ones(rows, bool)


def averaged(series: np.ndarray) -> np.ndarray:
    """The series without gaps, averaged over neighbouring rows.

    So the noise of a channel does not get less, and the log likelier, when the channel is taken half a row later.
    """
    # Missing values are interpolated linearly.
    whole = np.isfinite(series)
    filled = np.zeros_like(series)
    if whole.any():
        filled = np.interp(np.arange(series.size), np.flatnonzero(whole), series[whole])
    # Weights 1/4, 1/2, 1/4: interpolation half a row later then changes the noise little.
    ends = np.concatenate([filled[:1], filled, filled[-1:]])
    return 0.25 * ends[:-2] + 0.5 * ends[1:-1] + 0.25 * ends[2:]


def first_motion(record: Record, smooth: float = 4.0) -> Motion:
    """A motion near the measured one, to start from: smoothed measurements, rates from positions where not measured.

    Returns
    -------
    Motion
        Of (..., n) arrays.
    """
    # Width of the Gaussian kernel in rows, at least one.
    rows = np.arange(record.time.size)
    width = max(smooth / record.step, 1.0)
    flat = record.measured.reshape(-1, rows.size, 6)
    out = np.empty_like(flat)
    # Interpolate over gaps, then smooth each stretch by itself.
    for table, into in zip(flat, out, strict=True):
        for channel in range(6):
            whole = np.isfinite(table[:, channel])
            into[:, channel] = (
                np.interp(rows, rows[whole], table[whole, channel]) if whole.any() else np.nan
            )
            for part in record.stretches if whole.any() else ():
                into[part, channel] = gaussian_filter(into[part, channel], width, ends="held")
    x, y, psi, u, v, r = np.moveaxis(out.reshape(record.measured.shape), -1, 0)
    # Velocities that were not measured come from positions and heading.
    if np.isnan(r).any():
        r = rate_of(psi, record)
    if np.isnan(u).any() or np.isnan(v).any():
        u, v = to_body(psi, rate_of(x, record), rate_of(y, record))
    return Motion(x, y, psi, u, v, r)


def rate_of(series: np.ndarray, record: Record) -> np.ndarray:
    """Rate of a series over the rows of a record, (..., n) arrays. [per s]"""
    return np.concatenate(
        [np.gradient(series[..., rows], record.step, axis=-1) for rows in record.stretches], axis=-1
    )
