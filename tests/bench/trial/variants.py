"""The same log told otherwise: what a table becomes, and what its answer must become.

Every function takes a table of a log as `truth` draws it (columns ``role [unit]``) and gives another; those named
`..._finding` take the parameters of a finding and give those that are then right.
"""

import numpy as np
import pandas as pd

TWINS = {"port": "starboard", "starboard": "port"}
ANGLES = ("heading", "wind_from", "port_azimuth", "starboard_azimuth")
MIRRORED = ("azimuth_offset", "heading_bias", "wind_direction")


def turned(log, angle):
    """The earth frame turned: every direction over ground is `angle` more. [deg]"""
    log, (cos, sin) = log.copy(), (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
    north, east = log["north [m]"], log["east [m]"]
    log["north [m]"], log["east [m]"] = cos * north - sin * east, sin * north + cos * east
    log["heading [deg]"] = (log["heading [deg]"] + angle) % 360.0
    return log


def turned_finding(cause, component, values, angle):
    """Vectors over ground turn, all else stays."""
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    values = dict(values)
    for end in ("", "_start", "_end"):
        north, east = values.get(f"north{end}"), values.get(f"east{end}")
        if north is not None:
            values[f"north{end}"], values[f"east{end}"] = (
                cos * north - sin * east,
                sin * north + cos * east,
            )
    return cause, component, values


def mirrored(log):
    """Port and starboard, east and west exchanged."""
    new = log.copy()
    for name in ("east [m]", "sway [m/s]", "yaw_rate [deg/s]", "tunnel_rpm [rpm]"):
        new[name] = -log[name]
    new["heading [deg]"] = -log["heading [deg]"] % 360.0
    new["wind_from [deg]"] = -log["wind_from [deg]"] % 360.0
    for side, twin in TWINS.items():
        new[f"{side}_rpm [rpm]"] = log[f"{twin}_rpm [rpm]"]
        new[f"{side}_azimuth [deg]"] = -log[f"{twin}_azimuth [deg]"]
    return new


def mirrored_finding(cause, component, values):
    """The other side's unit; what points to starboard changes its sign, and so do angles."""
    flips = cause in MIRRORED or (cause, component) == ("rpm_offset", "tunnel")
    sign = {
        name: -1.0 if flips or name in ("y", "east", "east_start", "east_end") else 1.0
        for name in values
    }
    return (
        cause,
        TWINS.get(component, component),
        {name: sign[name] * value for name, value in values.items()},
    )


def shifted(log, seconds):
    """Another origin of time. [s]"""
    return log.assign(**{"time [s]": log["time [s]"] + seconds})


def with_other_units(log):
    """Knots, radians, revolutions per second, kilometres and minutes, as the headers say."""
    factors = {
        "time [s]": ("time [min]", 1 / 60),
        "north [m]": ("north [km]", 1e-3),
        "east [m]": ("east [ft]", 1 / 0.3048),
        "surge [m/s]": ("surge [kn]", 3600 / 1852),
        "sway [m/s]": ("sway [kn]", 3600 / 1852),
        "wind_speed [m/s]": ("wind_speed [km/h]", 3.6),
        "yaw_rate [deg/s]": ("yaw_rate [rad/s]", np.pi / 180),
        **{f"{name} [deg]": (f"{name} [rad]", np.pi / 180) for name in ANGLES},
    }
    return pd.DataFrame(
        {new: factor * log[old] for old, (new, factor) in _all(log, factors).items()}
    )


def _all(log, factors):
    return {name: factors.get(name, (name, 1.0)) for name in log}


def with_channel_file(log, folder):
    """A logger's own names, signs and origins; writes the channel file that explains them.

    Returns
    -------
    DataFrame, path of the channel file
    """
    names = {name: f"ch{i:02d}" for i, name in enumerate(log)}
    table = log.rename(columns=names)
    heading, starboard = names["heading [deg]"], names["starboard_azimuth [deg]"]
    table[heading] = (table[heading] - 90.0) % 360.0
    table[starboard] = -table[starboard]
    table[names["surge [m/s]"]] *= 3600 / 1852
    lines = []
    for name, column in names.items():
        role, unit = name.rstrip("]").split(" [")
        more = {"heading": ", offset = 90", "starboard_azimuth": ", sign = -1"}.get(role, "")
        lines.append(
            f'{role} = {{column = "{column}", unit = "{"kn" if role == "surge" else unit}"{more}}}'
        )
    path = folder / "channels.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return table, path


def at_positions_on_earth(log, latitude=63.4, longitude=10.4):
    """Latitude and longitude instead of metres, on the WGS 84 ellipsoid."""
    radius, flat = 6378137.0, 0.00669437999014
    curve = 1.0 - flat * np.sin(np.radians(latitude)) ** 2
    meridian, parallel = (
        radius * (1 - flat) / curve**1.5,
        radius / curve**0.5 * np.cos(np.radians(latitude)),
    )
    new = log.drop(columns=["north [m]", "east [m]"])
    new["latitude [deg]"] = latitude + np.degrees(log["north [m]"] / meridian)
    new["longitude [deg]"] = longitude + np.degrees(log["east [m]"] / parallel)
    return new


def thinned(log, every=2):
    """Every second row."""
    return log.iloc[::every].reset_index(drop=True)


def thickened(log, parts=2):
    """Rows between the rows, on straight lines; angles the short way."""
    time = log["time [s]"].to_numpy()
    dense = np.linspace(time[0], time[-1], parts * (len(time) - 1) + 1)
    new = {}
    for name in log:
        good = log[name].notna().to_numpy()
        values = log[name].to_numpy()[good]
        if "[deg]" in name:
            values = np.degrees(np.unwrap(np.radians(values)))
        new[name] = np.interp(dense, time[good], values)
        if "[deg]" in name:
            new[name] = (
                new[name] % 360.0
                if name.startswith(("heading", "wind"))
                else (new[name] + 180.0) % 360.0 - 180.0
            )
    return pd.DataFrame(new)
