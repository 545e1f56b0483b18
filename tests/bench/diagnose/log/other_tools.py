"""Logs by the conventions of other tools, written from one simulated run, and how the reader opens each."""

from __future__ import annotations

import re
import tomllib
from datetime import UTC, datetime, timedelta
from functools import reduce
from pathlib import Path

import numpy as np

import shipcosim
from shipcosim.diagnose.log.channels import ChannelFile
from shipcosim.diagnose.log.degree_size import metres_per_degree
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError

LOGS = Path(__file__).parent / "other_tools.toml"
THRUSTERS = {"port": ("rpm", "azimuth"), "starboard": ("rpm", "azimuth"), "tunnel": ("rpm",)}
START = datetime(2022, 10, 27, 21, 57, 30, tzinfo=UTC)
LATITUDE, LONGITUDE = 63.4389, 10.3954
KNOT = 1852.0 / 3600.0
HOLDS = {
    "position": ("north", "east"),
    "velocity": ("surge", "sway"),
    "wind": ("wind_speed", "wind_from"),
    "true_wind": ("true_wind_speed", "true_wind_from"),
    "rpm": ("port_rpm", "starboard_rpm", "tunnel_rpm"),
    "azimuth": ("port_azimuth", "starboard_azimuth"),
}
TURNS = ("heading", "azimuth", "wind_from")
FINE = {"time": 2e-3, "north": 0.05, "east": 0.05}
"""By how much values may be off; 2e-3 of the largest else, and what a log says of its own digits."""
KEPT = 0.98  # quantile of the errors that counts, as some rows are interpolated


class _Comma(float):
    """A number that is written with a decimal comma."""

    def __format__(self, form):
        return super().__format__(form).replace(".", ",")


def motion():
    """Channels by role in the units of the roles, with noise: one row a second of the DP ship."""
    run = shipcosim.run("four_corner", until=700.0).table.isel(time=slice(100, 1300, 2))
    random = np.random.default_rng(7)

    def of(name, noise, size=1.0):
        values = run[name].values + (run[f"{name}_wave"].values if name[-1] in "xyiuvr" else 0.0)
        return size * values + random.normal(0.0, noise, len(values))

    turn = 180.0 / np.pi
    table = {"time": run["time"].values - run["time"].values[0]}
    table |= {"north": of("vessel.x", 0.05), "east": of("vessel.y", 0.05)}
    table |= {"surge": of("vessel.u", 0.005), "sway": of("vessel.v", 0.005)}
    table |= {
        "heading": of("vessel.psi", 0.03, turn) % 360.0,
        "yaw_rate": of("vessel.r", 0.01, turn),
    }
    table["wind_speed"] = of("vessel.apparent_wind_speed", 0.05)
    table["wind_from"] = of("vessel.apparent_wind_from", 0.3, turn) % 360.0
    # Wind over ground: the apparent one, and the ship's own velocity.
    apparent = table["wind_speed"] * np.exp(1j * np.radians(table["wind_from"]))
    wind = (apparent - table["surge"] - 1j * table["sway"]) * np.exp(
        1j * np.radians(table["heading"])
    )
    table |= {"true_wind_speed": np.abs(wind), "true_wind_from": np.degrees(np.angle(wind)) % 360.0}
    for side in ("port", "starboard", "tunnel"):
        table[f"{side}_rpm"] = run[f"{side}.rpm"].values + random.normal(0.0, 0.1, len(wind))
    for side in ("port", "starboard"):
        table[f"{side}_azimuth"] = turn * run[f"{side}.azimuth"].values + random.normal(
            0.0, 0.1, len(wind)
        )
    return table


def cells(table):
    """What templates of rows may name, one dict a row."""
    north, east = metres_per_degree(LATITUDE)
    velocity = (table["surge"] + 1j * table["sway"]) * np.exp(1j * np.radians(table["heading"]))
    columns = table | {
        "lat": LATITUDE + table["north"] / north,
        "lon": LONGITUDE + table["east"] / east,
        "sog": np.abs(velocity),
        "cog": np.degrees(np.angle(velocity)) % 360.0,
        "vn": velocity.real,
        "ve": velocity.imag,
        "psi": np.radians((table["heading"] + 180.0) % 360.0 - 180.0),
        "aside": (table["wind_from"] + 180.0) % 360.0 - 180.0,
    }
    columns |= {
        f"{name}_kn": columns[name] / KNOT for name in ("sog", "wind_speed", "true_wind_speed")
    }
    columns |= {"rot": 60.0 * table["yaw_rate"], "epoch": START.timestamp() + table["time"]}
    columns |= {"sog_kmh": 3.6 * columns["sog"], "cog_rad": np.radians(columns["cog"])}
    columns["yaw_rate_rad"] = np.radians(table["yaw_rate"])
    columns |= {"lat_min": 60.0 * columns["lat"], "lon_min": -60.0 * columns["lon"]}
    # Days since 1900 of spreadsheets, and of the year from 1.
    columns["days"] = columns["epoch"] / 86400.0 + 25569.0
    columns |= {"year_days": columns["days"] - 44561.0, "heading_rad": np.radians(table["heading"])}
    # What autopilots and receivers scale to whole numbers, and whole degrees with their minutes.
    for side, degrees in (("lat", LATITUDE), ("lon", LONGITUDE)):
        columns[f"{side}_whole"] = np.floor(columns[side])
        columns |= {f"{side}_rest": 60.0 * (columns[side] % 1.0)}
        columns[f"{side}_0"] = np.full(len(velocity), np.radians(degrees))
        columns[f"{side}_e7"] = np.round(1e7 * columns[side])
    columns |= {f"{name}_mm": 1e3 * columns[name] for name in ("vn", "ve", "sog")}
    columns |= {f"{name}_cm": 1e2 * columns[name] for name in ("vn", "ve")}
    columns |= {f"{name}_e5": 1e5 * columns[name] for name in ("heading", "cog")}
    columns |= {"heading_cd": 1e2 * table["heading"], "us": 1e6 * columns["epoch"]}
    columns |= {"boot": 1e3 * table["time"] + 52310.0, "tow": 1e3 * table["time"] + 424650000.0}
    for row, values in enumerate(zip(*columns.values(), strict=True)):
        numbers = dict(zip(columns, map(float, values), strict=True))
        yield numbers | {"row": row, "stamp": START + timedelta(seconds=numbers["time"])}


def written(log, rows, folder):
    """A log as a file in a folder."""
    lines = [sentence(line) for line in log.get("head", ())]
    # A long table may have all values of a channel below each other.
    parts = [[template] for template in log["rows"]] if log.get("by_channel") else [log["rows"]]
    for templates in parts:
        for row in rows:
            values = {
                k: _Comma(v) if isinstance(v, float) and log.get("comma") else v
                for k, v in row.items()
            }
            values["ms"] = round(1000 * row["epoch"])
            lines += [sentence(_filled(template, values)) for template in templates]
    lines += log.get("foot", ())
    path = folder / log.get("file", "log.csv")
    path.write_bytes("\n".join([*lines, ""]).encode(log.get("encoding", "utf-8")))
    return path


def _filled(template, values):
    """A template with its values; ``{lat:dm.4}`` is 6326.3340, and ``{lat:d.4}`` 63°26.3340'."""
    for name, kind, digits in re.findall(r"\{(lat|lon):(dm|d)\.(\d)\}", template):
        whole = int(values[name])
        minutes = format(
            type(values[name])(60.0 * (values[name] - whole)), f"0{int(digits) + 3}.{digits}f"
        )
        text = (
            f"{whole:0{2 + (name == 'lon')}d}{minutes}" if kind == "dm" else f"{whole}°{minutes}'"
        )
        template = template.replace(f"{{{name}:{kind}.{digits}}}", text)
    return template.format(**values)


def sentence(line):
    """``<...>`` of a line as a sentence of NMEA 0183, with its checksum."""
    return re.sub(
        r"<(\w{5},.*)>", lambda m: f"${m[1]}*{reduce(int.__xor__, m[1].encode()):02X}", line
    )


def outcome(log, path, table):
    """``"open"``, ``"asked"``, ``"refused"``, ``"wrong"`` or ``"wrong guess"``, and what was said."""
    roles = [role for group in log.get("holds", "").split() for role in HOLDS.get(group, (group,))]
    try:
        read = read_log(path, None, THRUSTERS)
        said = " / ".join(read.attrs["column_remarks"])
        if wrong := errors(read, table, log):
            return "wrong", f"{wrong} | {said}"
        if set(roles) <= set(read):
            return "open", ""
    except ShipcosimError as error:
        said = str(error)
    # What is asked may be confirmed: then all has to be right.
    try:
        proposal = propose(columns_of(path), THRUSTERS)
        read = read_log(
            path, ChannelFile(proposal.channels(guessed=True), proposal.form), THRUSTERS
        )
    except ShipcosimError:
        return "refused", said
    if wrong := errors(read, table, log):
        return "wrong guess", f"{wrong} | {said}"
    missing = [role for role in roles if role not in read]
    return ("refused" if missing else "asked"), f"{missing} {said}"


def errors(read, table, log):
    """Channels of a log that are not those of the motion."""
    read = read.sortby("time")
    time = read["time"].values - read["time"].values[0]
    wrong = [name for name in read.data_vars if name not in table]
    for role in ("time", *(role for role in table if role in read and role != "time")):
        values = time if role == "time" else read[role].values
        is_turn = role.endswith(TURNS)
        right = np.unwrap(table[role], period=360.0) if is_turn else table[role]
        off = values - np.interp(time, table["time"], right)
        off = (off + 180.0) % 360.0 - 180.0 if is_turn else off
        off = off[np.isfinite(off)]
        off = off - np.median(off) if role in HOLDS["position"] else off
        most = log.get("off", {}).get(role, FINE.get(role, 2e-3 * max(np.abs(right).max(), 0.5)))
        if not len(off) or np.quantile(np.abs(off), KEPT) > most:
            wrong.append(
                f"{role} off by {np.quantile(np.abs(off), KEPT) if len(off) else np.nan:.3g}"
            )
    return wrong


def logs():
    """Logs of the file, by name."""
    return tomllib.loads(LOGS.read_text(encoding="utf-8"))
