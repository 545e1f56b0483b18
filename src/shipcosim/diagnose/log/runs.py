"""A run as a log: the table that `shipcosim run` and `simulate` leave, with the roles that its signals have."""

import gzip
import hashlib
import json
from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import h5py
import numpy as np
import xarray

from shipcosim.diagnose.log.channels import Channel
from shipcosim.errors import error_at, reading
from shipcosim.models.core.kinematics import to_body
from shipcosim.series import make_table, read_columns
from shipcosim.ssp import AnyPath

LogSource = AnyPath | xarray.Dataset
"""A log: a file, the folder of a run, or a table."""

_LONGEST_HEADER = 1 << 20
"""Characters of a header that are read: a file with a longer first line is not the table of a run."""
_SHIP = {
    "north": ("x", "m"),
    "east": ("y", "m"),
    "heading": ("psi", "rad"),
    "surge": ("u", "m/s"),
    "sway": ("v", "m/s"),
    "yaw_rate": ("r", "rad/s"),
    "wind_speed": ("apparent_wind_speed", "m/s"),
    "wind_from": ("apparent_wind_from", "rad"),
}
"""Role: output of the ship and its unit."""
_MOST_NUMBERS = 5
"""Numbers that a remark names."""
_NEEDED = ("north", "east", "heading")


def run_as_log(
    log: LogSource,
    ship: str,
    thrusters: Collection[str],
    numbers: Mapping[str, Any] = MappingProxyType({}),
    thrust_signals: Mapping[str, str] = MappingProxyType({}),
) -> LogSource:
    """A log by roles of the table of a run; any other log as it is.

    What the instruments of a perfect ship would show: her position, heading and velocity with the waves that she
    follows, the wind that she feels, speed and direction of her thrusters. What sensors of the system add is left out.

    Parameters
    ----------
    log : path or xarray.Dataset
        Signals are ``component.connector``, inputs of the system are named alone.
    ship : str
        Name of the ship's component.
    thrusters : collection of str
        Names of those of her thrusters.
    numbers : mapping of str to float
        Of the ship, ``component.name``: the attribute ``run_remarks`` of the table names those that the run had
        otherwise.
    thrust_signals : mapping of str to str
        Signals that command the thrust of thrusters which follow that, by thruster.

    Returns
    -------
    path or xarray.Dataset
        Where `log` is the table of a run a table by roles, else `log`.

    Raises
    ------
    ShipcosimError
        If it is the table of a run without this ship.
    """
    if not isinstance(log, xarray.Dataset) and (Path(log) / "result.nc").is_file():
        log = Path(log) / "result.nc"
    # Signals and units of the table, from memory or from a file.
    if isinstance(log, xarray.Dataset):
        signals = {str(name): value.values for name, value in log.data_vars.items()}
        file = {}
        signals["time"] = log["time"].values
        units = {str(name): value.attrs.get("units", "") for name, value in log.data_vars.items()}
    elif not _names_components(Path(log)):
        return log
    else:
        columns = read_columns(log)
        signals, units = ({name: pair[i] for name, pair in columns.items()} for i in (0, 1))
        file = {"source": str(log), "sha256": hashlib.sha256(Path(log).read_bytes()).hexdigest()}
    channels = channels_of_run(signals, ship, thrusters, thrust_signals)
    if not channels:
        return log
    if missing := [role for role in _NEEDED if role not in channels]:
        there = sorted({name.rpartition(".")[0] for name in signals if "." in name})
        message = f"this is the table of a run, and it has no {', '.join(_SHIP[role][0] for role in missing)} of '{ship}'."
        remedy = f"Its components: {', '.join(there)}. {_name_system(log)}"
        raise error_at(file.get("source", "log"), message, remedy)
    if others := _thrusters_of_another_ship(signals, thrusters):
        message = (
            f"this is the table of a run of another ship: her thrusters are {', '.join(others)}."
        )
        remedy = f"Those of the system are {', '.join(thrusters)}. {_name_system(log)}"
        raise error_at(file.get("source", "log"), message, remedy)
    # Inputs of the system that are named as roles go before what its components show.
    inputs = {
        name: _channel(name, name)
        for name in signals
        if name.endswith(("_rpm", "_azimuth", "_thrust")) and "." not in name
    }
    named = {
        role: channel for role, channel in channels.items() if role in _SHIP or role not in signals
    }
    named |= inputs
    # Damaged cells make a column of texts.
    with reading(file.get("source", "log")):
        table = make_table(
            np.asarray(signals["time"], float),
            [_column(role, signal, signals, units) for role, signal in named.items()],
        )
    # Waves turn the ship, too: resolve the velocity along the heading that a compass shows.
    turned = signals.get(f"{ship}.psi_wave")
    if turned is not None and "surge" in table and "sway" in table:
        along = to_body(np.asarray(turned, float), table["surge"].values, table["sway"].values)
        for role, values in zip(("surge", "sway"), along, strict=True):
            table[role].values = values
    table.encoding |= file
    table.attrs["run_remarks"] = other_numbers(log, numbers)
    return table


def other_numbers(log: LogSource, numbers: Mapping[str, Any]) -> list[str]:
    """One sentence on start values that a run had and a ship has not; none where they agree or the table has none.

    Parameters
    ----------
    log : path or xarray.Dataset
        Table of a run; a .csv says nothing of it.
    numbers : mapping of str to float
        Of the ship, ``component.name``.
    """
    had = json.loads(_attribute(log, "start_values") or "{}")
    apart = [
        f"{path} {had[path]:g} (here {number:g})"
        for path, number in numbers.items()
        if isinstance(had.get(path), (int, float)) and not np.isclose(had[path], number, 1e-6, 0.0)
    ]
    if not apart:
        return []
    more = f" and {len(apart) - _MOST_NUMBERS} more" if len(apart) > _MOST_NUMBERS else ""
    shown = ", ".join(apart[:_MOST_NUMBERS])
    return [f"This run had other numbers than the system that it is compared with: {shown}{more}."]


def _name_system(log: LogSource) -> str:
    """What to do where a run is of another system than the one that it is compared with."""
    return f"Name the system that made it: --system {_attribute(log, 'system') or 'SSP'}."


def _attribute(log: LogSource, name: str) -> str:
    """An attribute of the table of a run; empty where it has none."""
    if isinstance(log, xarray.Dataset):
        return log.attrs.get(name, "")
    if Path(log).suffix != ".nc":
        return ""
    with reading(log), h5py.File(log) as file:
        return file.attrs.get(name, "")


def channels_of_run(
    signals: Collection[str],
    ship: str,
    thrusters: Collection[str],
    thrust_signals: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, Channel]:
    """Channels of the table of a run, by role; none where it is another table.

    Parameters
    ----------
    signals : collection of str
        Names of its columns.
    ship : str
        Name of the ship's component.
    thrusters : collection of str
        Names of those of her thrusters.
    thrust_signals : mapping of str to str
        As of `run_as_log`.
    """
    if not _is_run(signals):
        return {}
    named = {"time": "time"} | {role: f"{ship}.{output}" for role, (output, _) in _SHIP.items()}
    for name in thrusters:
        # A thruster whose force is commanded is driven by that, and not by the speed of a shaft.
        role = f"{name}_thrust"
        thrust = role if role in signals else thrust_signals.get(name, "")
        speed = {role: thrust} if thrust in signals else {f"{name}_rpm": f"{name}.rpm"}
        named |= speed | {f"{name}_azimuth": f"{name}.azimuth"}
    return {role: _channel(role, signal) for role, signal in named.items() if signal in signals}


def _thrusters_of_another_ship(signals: Collection[str], thrusters: Collection[str]) -> list[str]:
    """Components of a run that push the ship by a thrust, where the run lacks one of the system's and has others."""
    there = {name.rpartition(".")[0] for name in signals}
    if all(name in there for name in thrusters):
        return []
    pushing = [name for name in sorted(there) if {f"{name}.thrust", f"{name}.tau_X"} <= {*signals}]
    return pushing if any(name not in thrusters for name in pushing) else []


def _channel(role: str, signal: str) -> Channel:
    """Where a role comes from, with the unit that signals of a run have."""
    unit = _SHIP[role][1] if role in _SHIP else "rad" if role.endswith("_azimuth") else None
    return Channel(column=signal, unit=unit)


def _names_components(path: Path) -> bool:
    """Whether a file has columns with a dot in their names, of which nothing but the names is read."""
    try:
        return any("." in name for name in _names(path))
    except (
        Exception
    ):  # of a damaged file the libraries raise anything; reading it says what is wrong
        return False


def _names(path: Path) -> list[str]:
    """Names of the columns, without units; none of a file of another kind than runs leave."""
    if path.suffix == ".nc":
        with h5py.File(path) as table:
            return list(table)
    if path.suffix not in (".csv", ".gz"):
        return []
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", encoding="utf-8") as file:
        return [name.partition("[")[0] for name in file.readline(_LONGEST_HEADER).split(",")]


def _is_run(signals: Collection[str]) -> bool:
    """Whether most columns are signals of components, one of them a ship, and none is a position by its role."""
    dotted = sum("." in name for name in signals)
    ships = (name.removesuffix(".psi") for name in signals if name.endswith(".psi"))
    if not any(f"{ship}.x" in signals and f"{ship}.y" in signals for ship in ships):
        return False  # names of another tool, such as ROS
    return (
        "time" in signals
        and "north" not in signals
        and "latitude" not in signals
        and 2 * dotted > len(signals)
    )


def _column(role: str, channel: Channel, signals: Mapping, units: Mapping) -> tuple:
    """A role's values with what waves add, and their unit."""
    # The instruments measure the low-frequency motion plus the motion by waves.
    signal = channel.column
    values = np.asarray(signals[signal], float)
    if role in _SHIP and f"{signal}_wave" in signals:
        values = values + np.asarray(signals[f"{signal}_wave"], float)
    return role, values, units.get(signal) or channel.unit or "rpm", ""
