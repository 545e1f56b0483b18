"""Measured logs: any table, by the roles of its columns, as one table in the units of the roles."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.angles import TURN, wrap_series
from shipcosim.diagnose.log.channels import Channel, read_channels
from shipcosim.diagnose.log.earth import metres_per_degree
from shipcosim.diagnose.log.roles import role_of
from shipcosim.diagnose.log.thresholds import LATEST
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.series import conversion, make_table, read_columns

if TYPE_CHECKING:
    import xarray

__all__ = ["read_log"]


def read_log(log: str | os.PathLike | xarray.Dataset, channels: str | os.PathLike | None = None) -> xarray.Dataset:
    """Read a measured log: every row of the file, in its order, in the units of the roles.

    Parameters
    ----------
    log : path or xarray.Dataset
        .csv, .csv.gz, .parquet or .nc; or such a table, over `time`, with the units of its columns as ``units``.
    channels : path, optional
        Channel file (see `read_channels`); without one the columns are named by roles.

    Returns
    -------
    xarray.Dataset
        Over `time` as it stands in the file. Latitude and longitude become `north` and `east` about the first fix,
        which is in the attributes `latitude_origin` and `longitude_origin` [deg]. Connectors keep the unit that is
        stated. The attribute `unused_columns` lists the columns that have no role; `source` and `sha256` of the
        encoding are name and fingerprint of a file.

    Raises
    ------
    ShipcosimError
        With all that is wrong: a column that is missing, not numeric or in a unit of something else, no time.
    """
    source, columns, file = _columns_of(log)
    mapping = read_channels(channels) if channels is not None else _by_header(source, columns)
    signals = _signals(source, columns, mapping)
    used = {channel.column for channel in mapping.values()}
    attributes = {"unused_columns": [name for name in columns if name and name not in used]}
    if "latitude" in signals:
        attributes |= _local_position(signals)
    time, _ = signals.pop("time")
    _check_time(source, time)
    table = make_table(time, [(n, v, unit, _meaning(n)) for n, (v, unit) in signals.items()], attributes)
    table.encoding |= file
    for name, channel in mapping.items():
        stated = channel.unit or columns[channel.column][1]
        if stated and name in table.variables:
            table[name].attrs["stated_unit"] = stated
    return table


def _columns_of(log):
    """Name of a log for messages, its columns as (values, unit) by name, and what says which file it is."""
    if isinstance(log, (str, os.PathLike)):
        columns = read_columns(log)
        return str(log), columns, {"source": str(log), "sha256": hashlib.sha256(Path(log).read_bytes()).hexdigest()}
    time = {"time": (np.asarray(log["time"].values, float), log["time"].attrs.get("units", ""))}
    rest = {str(name): (np.asarray(v.values), v.attrs.get("units", "")) for name, v in log.data_vars.items()}
    return "log", time | rest, {}


def _signals(source, columns, mapping):
    """Values and unit of each channel, by role or connector."""
    problems, signals = [], {}
    for name, channel in mapping.items():
        try:
            signals[name] = _signal(channel, name, columns)
        except ShipcosimError as error:
            problems += [Problem(f"{source}, {name}", p.found, p.remedy) for p in error.problems]
    if not problems and len(mapping) < 2:
        remedy = "Name them by roles, or say in a channel file which is what: --channels channels.toml."
        problems = [Problem(source, f"no column but time has a role: {_shown(columns)}.", remedy)]
    if problems:
        raise ShipcosimError(problems)
    return signals


def _check_time(source, time):
    if (beyond := np.abs(time) > LATEST).any() and np.isfinite(time[beyond]).any():
        row = int(np.flatnonzero(beyond)[0])
        found, remedy = f"is {time[row]:g} s in row {row + 2}.", f"Times are at most {LATEST:g} s, say since 1970."
        raise ShipcosimError(Problem(f"{source}, time", found, remedy))
    if len(np.unique(time[np.isfinite(time)])) < 2:
        raise ShipcosimError(Problem(f"{source}, time", "has fewer than two different times.", "A log has many rows."))


def _by_header(path, columns):
    """Channels of a file whose columns are named by roles. North and east go before latitude and longitude."""
    if "time" not in columns:
        remedy = "Say in a channel file which column is what: --channels channels.toml."
        raise ShipcosimError(Problem(str(path), f"has no column 'time', only {_shown(columns)}.", remedy))
    pairs = [("north", "east"), ("latitude", "longitude")]
    whole = [pair for pair in pairs if set(pair) <= set(columns)][:1]
    left_out = {name for pair in pairs if pair not in whole for name in pair}
    return {name: Channel(column=name) for name in columns if role_of(name) and name not in left_out}


def _shown(columns):
    return ", ".join(repr(name) for name in list(columns)[:8])


def _meaning(name):
    role = role_of(name)
    return role.meaning if role else f"connector {name}"


def _signal(channel, name, columns):
    """Values of a channel, and their unit."""
    if channel.column not in columns:
        found = f"there is no column '{channel.column}'."
        raise ShipcosimError(Problem("", found, suggestion(channel.column, columns)))
    values, stated = columns[channel.column]
    if values.dtype.kind != "f":
        row = next((i for i, value in enumerate(values) if value is not None and not _is_number(value)), 0)
        found = f"column '{channel.column}' holds '{values[row]}' in row {row + 2}, not only numbers."
        raise ShipcosimError(Problem("", found, "A missing value is an empty field or nan."))
    role = role_of(name)
    unit = channel.unit or stated or (role.unit if role else "")
    target = role.unit if role else unit
    factor, zero = conversion(unit, target)
    # -0.0 + 0.0 is 0.0, and the sign of a zero is all that is left of a rate in too large a unit
    return factor * (channel.sign * values + (channel.offset or -0.0)) + (zero or -0.0), target


def _is_number(text):
    try:
        return float(text) is not None
    except (TypeError, ValueError):
        return False


def _local_position(signals):
    """Turn latitude and longitude into north and east in a plane about the first fix; say where that is."""
    latitude, longitude = (np.radians(signals.pop(name)[0]) for name in ("latitude", "longitude"))
    fixed = np.flatnonzero(np.isfinite(latitude) & np.isfinite(longitude))
    first = fixed[0] if len(fixed) else 0
    meridian, parallel = metres_per_degree(np.degrees(latitude[first]))
    signals["north"] = meridian * np.degrees(latitude - latitude[first]), "m"
    signals["east"] = parallel * np.degrees(wrap_series(longitude - longitude[first], TURN)), "m"
    origin = np.degrees([latitude[first], longitude[first]])
    return {"latitude_origin": float(origin[0]), "longitude_origin": float(origin[1])}
