"""Measured logs: any table, by the roles of its columns, as one table in SI units and radians."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from shipcosim.diagnose.roles import ROLES, role_of
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.series import conversion, make_table, read_columns

if TYPE_CHECKING:
    import xarray

__all__ = ["Channel", "holds_roles", "read_channels", "read_log"]

EQUATORIAL_RADIUS, ECCENTRICITY_SQUARED = 6378137.0, 6.69437999014e-3  # [m, 1] WGS 84


class Channel(BaseModel):
    """Where a role comes from: value = sign * column + offset, both in `unit`, then turned into the role's unit."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    column: str = Field(min_length=1, description="name of the column, without its [unit]")
    unit: str | None = Field(None, description="unit of the column; default: the header's, else the role's")
    sign: Literal[1, -1] = 1
    offset: float = Field(0.0, description="added after the sign, in the unit of the column")


def read_channels(path: str | os.PathLike) -> dict[str, Channel]:
    """Read a channel file: TOML with one entry for each role or connector.

    ``surge = {column = "u", unit = "kn"}``, or ``surge = "u"`` where nothing else is to be said. A connector
    of a system is named in quotes, ``"vessel.u_r" = {column = "log", unit = "kn"}``.

    Raises
    ------
    ShipcosimError
        If the file cannot be read, names what is no role, or has no time.
    """
    path = Path(path)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ShipcosimError(Problem(str(path), f"cannot be read: {error}.")) from error
    channels, problems = {}, []
    for name, entry in content.items():
        where = f"{path}, {name}"
        if role_of(name) is None and not (isinstance(entry, str | dict) and "." in name):
            remedy = suggestion(name, [*ROLES, "NAME_rpm", "NAME_azimuth", "NAME_thrust"])
            problems.append(Problem(where, "is no role.", f'{remedy} A connector has a dot: "vessel.u_r".'))
            continue
        try:
            channels[name] = Channel.model_validate({"column": entry} if isinstance(entry, str) else entry)
        except ValidationError as error:
            problems += [_field_problem(where, detail) for detail in error.errors()]
    if "time" not in content:
        problems.append(Problem(str(path), "says no column for time.", 'It should have, say, time = {column = "t"}.'))
    if problems:
        raise ShipcosimError(problems)
    return channels


def holds_roles(path: str | os.PathLike) -> bool:
    """Whether a table has a column whose name is a role, so that it reads as a measured log."""
    return any(role_of(name) is not None for name in read_columns(path) if name != "time")


def read_log(path: str | os.PathLike, channels: str | os.PathLike | None = None) -> xarray.Dataset:
    """Read a measured log: every row of the file, in its order, as a table in SI units and radians.

    Parameters
    ----------
    path : path
        .csv, .csv.gz, .parquet or .nc.
    channels : path, optional
        Channel file; without one the columns are named by roles.

    Returns
    -------
    xarray.Dataset
        Variables named by roles (shaft speeds in rpm); latitude and longitude become `north` and `east` about the
        first fix, which is in the attributes `latitude_origin`, `longitude_origin`. [rad] The attribute
        `unused_columns` lists the columns that have no role.

    Raises
    ------
    ShipcosimError
        With all that is wrong: a column that is missing, not numeric or in a unit of something else, no time.
    """
    columns = read_columns(path)
    mapping = read_channels(channels) if channels is not None else _by_header(path, columns)
    problems, values, units = [], {}, {}
    for name, channel in mapping.items():
        try:
            values[name], units[name] = _values(channel, name, columns)
        except ShipcosimError as error:
            where = f"{path}, {name}"
            problems += [Problem(where, problem.found, problem.remedy) for problem in error.problems]
    problems += _together(path, mapping)
    if problems:
        raise ShipcosimError(problems)
    used = {channel.column for channel in mapping.values()}
    attributes = {"unused_columns": [name for name in columns if name not in used and name]}
    time = values.pop("time")
    if "latitude" in values:
        attributes |= _local_position(values, units)
    meanings = {name: getattr(role_of(name), "meaning", "") for name in values}
    return make_table(time, [(name, values[name], units[name], meanings[name]) for name in values], attributes)


def _by_header(path, columns):
    if "time" not in columns:
        shown = ", ".join(repr(name) for name in list(columns)[:8])
        remedy = "Say in a channel file which column is what: --channels channels.toml."
        raise ShipcosimError(Problem(str(path), f"has no column 'time', only {shown}.", remedy))
    return {name: Channel(column=name) for name in columns if role_of(name) is not None}


def _values(channel, name, columns):
    """Values of a channel and their unit."""
    if channel.column not in columns:
        raise ShipcosimError(
            Problem("", f"there is no column '{channel.column}'.", suggestion(channel.column, columns))
        )
    values, stated = columns[channel.column]
    if values.dtype.kind != "f":
        example = next((str(value) for value in values if value is not None), "")
        raise ShipcosimError(Problem("", f"column '{channel.column}' holds '{example}', not only numbers."))
    role = role_of(name)
    unit = channel.unit or stated or (role.unit if role else "")
    internal = role.internal if role else unit
    factor, zero = conversion(unit, internal)
    return factor * (channel.sign * values + channel.offset) + zero, internal


def _together(path, mapping):
    """Problems of the roles as a set."""
    problems = []
    for pair in (("north", "east"), ("latitude", "longitude")):
        for one, other in (pair, pair[::-1]):
            if one in mapping and other not in mapping:
                problems.append(Problem(str(path), f"has {one} without {other}.", "A position needs both."))
    if "north" in mapping and "latitude" in mapping:
        remedy = "Give either north and east or latitude and longitude."
        problems.append(Problem(str(path), "gives the position twice.", remedy))
    return problems


def _local_position(values, units):
    """Turn latitude and longitude into north and east in a plane about the first fix; say where that is."""
    latitude, longitude = values.pop("latitude"), values.pop("longitude")
    fixed = np.flatnonzero(np.isfinite(latitude) & np.isfinite(longitude))
    first = fixed[0] if len(fixed) else 0
    curvature = 1.0 - ECCENTRICITY_SQUARED * np.sin(latitude[first]) ** 2
    meridian = EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED) / curvature**1.5
    parallel = EQUATORIAL_RADIUS / np.sqrt(curvature) * np.cos(latitude[first])
    values["north"] = meridian * (latitude - latitude[first])
    values["east"] = parallel * (np.mod(longitude - longitude[first] + np.pi, 2 * np.pi) - np.pi)
    units |= {"north": "m", "east": "m"}
    return {"latitude_origin": float(latitude[first]), "longitude_origin": float(longitude[first])}


def _field_problem(where, detail):
    path = ".".join(str(part) for part in detail["loc"])
    return Problem(
        f"{where}.{path}" if path else where, f"{detail['msg']}.", "A channel has column, unit, sign, offset."
    )
