"""A repaired log as arrays in SI: what was measured of the ship, and what drove her, on an even grid of times."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.ship.time_scales import fastest_rate, response_times
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Motion

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.ship.model import ShipModel
    from shipcosim.diagnose.ship.third_party_fmu import ThirdPartyFmu

__all__ = ["CHANNELS", "Inputs", "Record", "averaged", "first_motion", "record_of"]

_SLOW_ENOUGH = 0.16  # s over the root of the ship's length in m: rows that are closer are averaged, 0.93 s for 33.9 m
_MANY_ROWS = 20_000  # of which more are averaged further: five and a half hours at 1 Hz
_LONGEST_ROW = 4  # times that long, and
_SHARE_OF_ANSWER = 0.25  # of the time of the ship's fastest answer
_SHORTEST = 18.0  # s over the root of the length in m: 105 s for 33.9 m, 20 s for 1.2 m
_FEWEST_ROWS = 60
_ONE_STEP = 0.2  # s over the root of the length in m: 1 s on a ship of 25 m
_RATE_OF_A_STEP = 1.0  # 1, of the fastest answer times the step: Runge-Kutta of fourth order diverges beyond 2.8
_MOST_STEPS = 64  # from row to row; a model or a log that asks for more is wrong
CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")
_TO_SI = (1.0, 1.0, np.pi / 180.0, 1.0, 1.0, np.pi / 180.0)


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


@dataclass(frozen=True)
class Record:
    """Measurements and inputs of one log, or of several of the same length with them on the first axis.

    Attributes
    ----------
    time : (n,) array
        Even. [s]
    measured : (..., n, 6) array
        `CHANNELS` in SI, heading unwrapped, NaN where there is none.
    units : dict of str to tuple of two (..., n) arrays
        Speed of each thruster, or thrust where that drives it, and direction, unwrapped. [rev/s or N, rad]
    wind : tuple of two (..., n) arrays, or None
        Speed, and direction unwrapped. [m/s, rad]
    known : (n,) bool array
        Whether everything that drives the ship is known over the step that follows.
    rate : float
        Of the fastest answer that the ship gives in the log. [1/s]
    """

    time: np.ndarray
    measured: np.ndarray
    units: dict[str, tuple[np.ndarray, np.ndarray]]
    wind: tuple[np.ndarray, np.ndarray] | None
    known: np.ndarray
    remarks: tuple[str, ...] = field(default=())
    rate: float = 0.0

    @property
    def step(self) -> float:
        """Time from row to row. [s]"""
        return float(self.time[1] - self.time[0])

    def substeps(self, model: ShipModel) -> int:
        """Number of integration steps from row to row; more than one for a small or stiff ship."""
        rows = self.step * max(1.0 / (_ONE_STEP * np.sqrt(model.parts["hull"].length)), self.rate / _RATE_OF_A_STEP)
        return 2 ** int(np.ceil(np.log2(min(max(rows, 1.0), _MOST_STEPS)) - 1e-9))

    def inputs(self, model: ShipModel, share: float = 0.0, steps: slice = slice(None)) -> Inputs:
        """Inputs of the ship model at each row but the last, or a share of a step after it; or in some of these steps.

        Late channels are taken that much later; where the navigation is late, all others are taken earlier.
        """
        lags = model.parts["instruments"]
        late = share * self.step - lags.navigation_lag
        behind, late_wind = self._places(late + lags.thruster_lag, steps), self._places(late + lags.wind_lag, steps)
        units = {name: (_between(pair[0], *behind), _between(pair[1], *behind)) for name, pair in self.units.items()}
        wind = (None, None) if self.wind is None else (_between(series, *late_wind) for series in self.wind)
        return Inputs(self.time[:-1][steps] + share * self.step, units, *wind)

    def _places(self, seconds: float, steps: slice) -> tuple[np.ndarray, np.ndarray]:
        """Rows that much later: the row before, and the share of the step after it."""
        rows = self.time.size
        at = np.clip(np.arange(rows - 1)[steps] + seconds / self.step, 0.0, rows - 1.0)
        low = np.minimum(at.astype(int), rows - 2)
        return low, at - low


def _between(series: np.ndarray, low: np.ndarray, share: np.ndarray) -> np.ndarray:
    """A series linear between rows."""
    return series[..., low] * (1.0 - share) + series[..., low + 1] * share


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
    missing = [role for role in ("north", "east", "heading") if role not in log]
    if missing:
        found, right = f"no channel {', '.join(missing)}.", "A diagnosis needs north, east and heading."
        raise ShipcosimError(Problem(str(log.attrs.get("source", "log")), found, right))
    measured = np.stack([_column(log, role, rows) * si for role, si in zip(CHANNELS, _TO_SI, strict=True)], axis=-1)
    measured[:, 2] = unwrap_series(measured[:, 2])
    remarks, known, units = [], np.ones(rows, bool), {}
    _check_third_party(log, model)
    for name in model.thrusters:
        units[name], whole = _unit(log, name, model, rows, remarks)
        known &= whole
    wind, whole = _wind(log, rows, remarks)
    known &= whole
    remarks += [_about_third_party(name, one) for name, one in model.third_party.items()]
    known[:-1] &= known[1:]
    record = Record(log["time"].values.astype(float), measured, units, wind, known, tuple(remarks))
    thinned = _thinned_for(model, record)
    _check_length(log, model, first_motion(thinned, model))
    return thinned


def _thinned_for(model: ShipModel, record: Record) -> Record:
    """The record at the rate that a ship's answer needs, and at less than that where it is very long."""
    slow = _SLOW_ENOUGH * np.sqrt(model.parts["hull"].length)
    rows = max(round(slow / record.step), 1)
    thinned = _thinned(record, rows, model)
    rate = fastest_rate(model, first_motion(thinned, model))
    longest = min(_LONGEST_ROW * slow, _SHARE_OF_ANSWER / max(rate, 1e-9))
    further = min(int(np.ceil(thinned.time.size / _MANY_ROWS)), int(longest / thinned.step + 1e-6))
    if further > 1:
        rows *= further
        thinned = _thinned(record, rows, model)
        rate = fastest_rate(model, first_motion(thinned, model))
    if rows == 1:
        return replace(record, rate=rate)
    why = "this long log" if further > 1 else "this ship's answer"
    remark = f"Rows {record.step:.3g} s apart are averaged over {thinned.step:.3g} s, which resolves {why}."
    return replace(thinned, rate=rate, remarks=(*record.remarks, remark))


def _check_length(log: xarray.Dataset, model: ShipModel, motion: Motion) -> None:
    """Raise ShipcosimError for a log that is too short for what its ship does, or has too few rows."""
    rows, span = log.sizes["time"], float(log["time"][-1] - log["time"][0])
    least = _SHORTEST * np.sqrt(model.parts["hull"].length)
    if span < least or rows < _FEWEST_ROWS:
        slowest = max((time for time in response_times(model, motion) if np.isfinite(time)), default=np.inf)
        answer = f"whose slowest answer takes {slowest:.2g} s" if slowest < 1e4 else "that hardly moves"
        found = f"{rows} rows over {span:.0f} s, of a ship {answer}."
        right = f"It takes {_FEWEST_ROWS} rows over {least:.0f} s at the least, better twenty times that."
        raise ShipcosimError(Problem(str(log.attrs.get("source", "log")), found, right))


def _thinned(record: Record, rows: int, model: ShipModel) -> Record:
    """The record with every so many rows averaged into one; of speeds, which push by their square, as that."""
    if rows == 1:
        return record

    def mean(series):
        whole = series[: len(series) // rows * rows].reshape(-1, rows, *series.shape[1:])
        count = np.isfinite(whole).sum(1)
        return np.where(count > 0, np.nansum(whole, axis=1) / np.maximum(count, 1), np.nan)

    def of_squares(series):
        push = mean(series * np.abs(series))
        return np.sign(push) * np.sqrt(np.abs(push))

    pushes = {name: mean if "thrust" in model.drives(name) else of_squares for name in record.units}
    units = {name: (pushes[name](drive), mean(direction)) for name, (drive, direction) in record.units.items()}
    wind = None if record.wind is None else (of_squares(record.wind[0]), mean(record.wind[1]))
    known = mean(record.known.astype(float)) == 1.0
    return Record(mean(record.time), mean(record.measured), units, wind, known, record.remarks)


def _column(log: xarray.Dataset, role: str, rows: int) -> np.ndarray:
    return log[role].values.astype(float) if role in log else np.full(rows, np.nan)


def _unit(log, name, model, rows, remarks):
    """Speed or thrust of a thruster and its direction, and where they are known."""
    speed, direction = _column(log, f"{name}_rpm", rows) / 60.0, _column(log, f"{name}_azimuth", rows) * np.pi / 180.0
    if "thrust" in model.drives(name):
        speed = _column(log, f"{name}_thrust", rows)
    elif f"{name}_rpm" not in log:
        if "rpm" in model.drives(name):
            remarks.append(f"No speed of '{name}' in the log: taken to stand still in simulations.")
        speed = np.zeros(rows)
    if name in model.azimuths and f"{name}_azimuth" not in log:
        remarks.append(f"No direction of '{name}' in the log: taken to point ahead in simulations.")
    if name not in model.azimuths or f"{name}_azimuth" not in log:
        direction = np.full(rows, model.fixed.get(name, 0.0))
    whole = np.isfinite(speed) & np.isfinite(direction)
    return (averaged(speed), averaged(unwrap_series(direction))), whole


def _check_third_party(log: xarray.Dataset, model: ShipModel) -> None:
    """Raise ShipcosimError where the log lacks what drives a third-party FMU: nobody knows its load then."""
    drives = [(name, f"{name}_{kind}") for name, one in model.third_party.items() for kind in one.drives]
    where, remedy = str(log.attrs.get("source", "log")), "Log it under this name, or name its column in a channel file."
    lacking = [
        Problem(where, f"no channel {role}, which drives '{name}'.", remedy) for name, role in drives if role not in log
    ]
    if lacking:
        raise ShipcosimError(lacking)


def _about_third_party(name: str, one: ThirdPartyFmu) -> str:
    """What the user should know of a third-party FMU."""
    idle = f" What the log does not tell keeps its start value: {', '.join(one.idle)}." if one.idle else ""
    text = f"'{name}' is a third-party FMU ({one.component.fmu.model_name}), known by its co-simulation along the log."
    return f"{text}{idle} No manoeuvre can be prescribed with it."


def _wind(log, rows, remarks):
    for speed, direction in (("wind_speed", "wind_from"), ("true_wind_speed", "true_wind_from")):
        if speed in log and direction in log:
            pair = _column(log, speed, rows), unwrap_series(_column(log, direction, rows) * np.pi / 180.0)
            whole = np.isfinite(pair[0]) & np.isfinite(pair[1])
            if whole.any():
                return (averaged(pair[0]), averaged(pair[1])), whole
    remarks.append("No wind in the log: forces of the wind, of waves, of a current and of a line cannot be told apart.")
    return None, np.ones(rows, bool)


def averaged(series: np.ndarray) -> np.ndarray:
    """The series without gaps, averaged over neighbouring rows.

    So the noise of a channel does not get less, and the log likelier, when the channel is taken half a row later.
    """
    filled = _filled(series)
    ends = np.concatenate([filled[:1], filled, filled[-1:]])
    return 0.25 * ends[:-2] + 0.5 * ends[1:-1] + 0.25 * ends[2:]


def _filled(series: np.ndarray) -> np.ndarray:
    """The series with linear interpolation where it has no value."""
    whole = np.isfinite(series)
    if not whole.any():
        return np.zeros_like(series)
    return np.interp(np.arange(series.size), np.flatnonzero(whole), series[whole])


def first_motion(record: Record, model: ShipModel, smooth: float = 4.0) -> Motion:
    """A motion near the measured one, to start from: smoothed measurements, rates from positions where not measured.

    Returns
    -------
    Motion
        Of (..., n) arrays.
    """
    from scipy.ndimage import gaussian_filter1d

    rows = np.arange(record.time.size)
    width = max(smooth / record.step, 1.0)
    flat = record.measured.reshape(-1, rows.size, 6)
    out = np.empty_like(flat)
    for one, into in zip(flat, out, strict=True):
        for channel in range(6):
            whole = np.isfinite(one[:, channel])
            series = np.interp(rows, rows[whole], one[whole, channel]) if whole.any() else None
            into[:, channel] = np.nan if series is None else gaussian_filter1d(series, width, mode="nearest")
    x, y, psi, u, v, r = np.moveaxis(out.reshape(record.measured.shape), -1, 0)
    if np.isnan(r).any():
        r = np.gradient(psi, record.step, axis=-1)
    if np.isnan(u).any() or np.isnan(v).any():
        north, east = np.gradient(x, record.step, axis=-1), np.gradient(y, record.step, axis=-1)
        u, v = np.cos(psi) * north + np.sin(psi) * east, np.cos(psi) * east - np.sin(psi) * north
    return Motion(x, y, psi, u, v, r)
