"""A double-ended ferry of 96 m with four azimuth thrusters; and logs of her under a crude DP, by co-simulation."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import ships
from diagnose import twin
from scipy.ndimage import gaussian_filter1d

import shipcosim as sc
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.series import make_table

UNITS = {
    "fore_port": (42.0, -4.0),
    "fore_starboard": (42.0, 4.0),
    "aft_port": (-42.0, -4.0),
    "aft_starboard": (-42.0, 4.0),
}
STEP = 0.2  # s
HULL = {
    "mass": (2.6e6, 5e4),
    "inertia_yaw": (1.5e9, 3e7),
    "A11": (0.13e6, 8e3),
    "A22": (1.7e6, 8e4),
    "A26": (0.0, 0.0),
    "A62": (0.0, 0.0),
    "A66": (0.8e9, 4e7),
    "length": (96.0, 0.0),
    "breadth": (17.0, 0.0),
    "draught": (3.9, 0.0),
    "cross_flow_drag": (1.1, 0.08),
    "lift": (-90e3, 10e3),
    "lift_x": (0.0, 1.0),
    "X_uu": (-4500.0, 300.0),
}
AZIMUTH = {"diameter": 2.2, "rpm_max": 220.0, "thrust_max": 150e3, "thrust_min": -80e3}
WHITE = np.array([0.25, 0.25, np.radians(0.1), 0.02, 0.02, np.radians(0.03)])
SLOW = np.array([0.15, 0.15, np.radians(0.1)])
LEGS = {  # where to be from when on: s, m, m, deg
    "trial": (
        (0, 0, 0, 0),
        (120, 60, 0, 0),
        (360, 60, 40, 0),
        (600, 60, 40, 70),
        (840, -20, 40, 160),
        (1080, -20, -60, 250),
        (1320, 60, -60, 250),
        (1560, 60, 0, 330),
    ),
    "hold": ((0, 0, 0, 20),),
    "crossing": ((0, 0, 0, 30), (120, 1500, 900, 30), (900, 1500, 900, 200), (1020, 0, 0, 210)),
}


@cache
def helm():
    """The DP's FMU."""
    return sc.build_fmu(Path(__file__).with_name("helm.py"), mkdtemp(prefix="shipcosim-"))


def structure(name="ferry", **parameters):
    """The ferry without control, with inputs for what a log says."""
    ferry = _as_modelled(name).copy()
    with ferry.changes():
        for signal, value in parameters.items():
            ferry.set(signal, value)
    return ferry


@cache
def _as_modelled(name):
    """The same without changed numbers, put together once: that takes seconds."""
    ferry, fmus = sc.new(name), twin.build_stale(twin.ROOT)
    with ferry.changes():
        for part, fmu in {"environment": "environment", "ship": "vessel"}.items():
            ferry.add_component(part, fmus / f"{fmu}.fmu")
        for name, unit, target in (
            ("true_wind_speed", "m/s", "wind_speed"),
            ("true_wind_from", "deg", "wind_from"),
        ):
            ferry.add_connector(name, "input", unit=unit)
            ferry.connect(name, f"environment.{target}")
        ships.lend(ferry, "ship", HullParameters, DriftParameters)
        for what in ("wind", "current"):
            for axis in ("north", "east"):
                ferry.connect(f"environment.{what}_{axis}", f"ship.{what}_{axis}")
        for parameter, (value, tolerance) in HULL.items():
            ferry.set(f"ship.{parameter}", value, tolerance=tolerance or None)
        ferry.set("ship.wind_table", large(ships.parameters(WindParameters).wind_table))
        for number, (unit, place) in enumerate(UNITS.items(), start=1):
            ferry.add_component(unit, fmus / "azimuth_thruster.fmu")
            ships.lend(ferry, unit, AzimuthParameters)
            for kind, measure in (("rpm", "rpm"), ("azimuth", "deg")):
                ferry.add_connector(f"{unit}_{kind}", "input", unit=measure)
                ferry.connect(f"{unit}_{kind}", f"{unit}.{kind}_in")
            for given in ("u_r", "v_r", "r"):
                ferry.connect(f"ship.{given}", f"{unit}.{given}")
            for axis in "XYN":
                ferry.connect(f"{unit}.tau_{axis}", f"ship.tau_{axis}_{number}")
            ferry.set(f"{unit}.replay", True)
            for parameter, value in (AZIMUTH | dict(zip("xy", place, strict=True))).items():
                ferry.set(f"{unit}.{parameter}", value)
    ferry.step_size = STEP
    return ferry


def large(table):
    """The wind's loads on a ship of five times the area, three times the length."""
    rows = [[float(value) for value in row.split()] for row in table.split(";")]
    return "; ".join(f"{a} {5.0 * X} {5.0 * Y} {15.0 * N}" for a, X, Y, N in rows)


def under_dp(ferry):
    """The ferry with her DP instead of the inputs of the thrusters; changed."""
    with ferry.changes():
        ferry.add_component("helm", helm())
        for name in ("x", "y", "psi", "u", "v", "r"):
            ferry.connect(f"ship.{name}", f"helm.{name}")
        for name, unit in (("x_d", "m"), ("y_d", "m"), ("psi_d", "rad"), ("on", "1")):
            ferry.add_connector(name, "input", unit=unit)
            ferry.connect(name, f"helm.{name}")
        for number, unit in enumerate(UNITS, start=1):
            for kind in ("rpm", "azimuth"):
                for source, target in [
                    pair for pair in ferry.connections if pair[0] == f"{unit}_{kind}"
                ]:
                    ferry.disconnect(source, target)
                    ferry.connect(f"helm.{kind}_{number}", target)
    return ferry


def plan(time, legs):
    """Smoothed places and headings. (3, n)"""
    when, *where = np.array(legs, float).T
    at = np.searchsorted(when, time, side="right") - 1
    h = time[1] - time[0]
    steps = [gaussian_filter1d(series[at], 40.0 / h, mode="nearest") for series in where]
    return np.stack([steps[0], steps[1], np.radians(steps[2])])


def weather(time, seed, speed=9.0, from_=2.0):
    """Wind over ground with gusts: speed, direction. [m/s, rad]"""
    gusts = gaussian_filter1d(
        np.random.default_rng(seed).standard_normal((2, time.size)), 12.0 / (time[1] - time[0])
    )
    gusts /= gusts.std(axis=1, keepdims=True)
    return speed * (1.0 + 0.13 * gusts[0]), from_ + 0.08 * gusts[1]


def log(kind="trial", minutes=30.0, seed=0, ferry=None, errors=None, push=(), free=()):
    """What the ferry's instruments say of a co-simulation under her DP.

    Parameters
    ----------
    kind : str
        Of `LEGS`.
    minutes : float
    seed : int
    ferry : SystemStructure, optional
        As `structure` gives it, with something wrong.
    errors : dict of str to float, optional
        Of the instruments.
    push : tuple, optional
        North, east [N], and where they act forward of the origin [m].
    free : tuple of (float, float)
        Without power. [s]
    """
    time, random = np.arange(0.0, 60.0 * minutes + STEP / 2, STEP), np.random.default_rng(seed)
    ferry = under_dp((ferry or structure()).copy())
    if push:
        ferry.add_component("line", twin.build_stale(twin.ROOT) / "earth_force.fmu")
        ferry.connect("ship.psi", "line.psi")
        for axis in "XYN":
            ferry.connect(f"line.tau_{axis}", f"ship.tau_{axis}_6")
        for name, value in zip(("north", "east", "x"), push, strict=True):
            ferry.set(f"line.{name}", value)
    wish, (speed, from_) = plan(time, LEGS[kind]), weather(time, seed + 1)
    on = 1.0 - np.any(
        [(time > a) & (time < b) for a, b in free] or [np.zeros(time.size, bool)], axis=0
    )
    columns = [
        ("x_d", wish[0], "m", ""),
        ("y_d", wish[1], "m", ""),
        ("psi_d", wish[2], "rad", ""),
        ("on", on, "1", ""),
    ]
    columns += [
        ("true_wind_speed", speed, "m/s", ""),
        ("true_wind_from", np.degrees(from_), "deg", ""),
    ]
    run = sc.simulate(
        ferry,
        stop_time=float(time[-1]),
        step_size=STEP,
        inputs=make_table(time, columns),
        engine="native",  # but for the helm, which is Python: half the time
    )
    rows = slice(None, None, round(1.0 / STEP))
    seen = twin.seen(run, "ship", rows, errors)
    seen += noise(seen.shape[1], seen[2], random)
    return table(run, rows, seen, random)


def noise(n, psi, random, waves=0.05):
    """White noise, slow errors of position and heading, and waves of some 8 s; rows of 1 s. (6, n)"""
    found = WHITE[:, None] * random.standard_normal((6, n))
    slow = gaussian_filter1d(random.standard_normal((3, n)), 120.0)
    found[:3] += SLOW[:, None] * slow / slow.std(axis=1, keepdims=True)
    frequency = 0.75 + 0.1 * random.standard_normal((6, 1))
    for axis in range(2):
        angle = frequency * np.arange(n) + random.uniform(0.0, 2.0 * np.pi, (6, 1))
        found[3 + axis] += 0.5 * waves * (frequency * np.cos(angle)).sum(0)
        towards = psi + axis * 0.5 * np.pi
        found[:2] += (
            0.5 * waves * np.sin(angle).sum(0) * np.stack([np.cos(towards), np.sin(towards)])
        )
    return found


def table(run, rows, seen, random):
    """The log of a run, what is seen of the motion given."""
    listed = [
        (r, k * v, u, "")
        for (r, u), k, v in zip(twin.ROLES.items(), twin.TO_LOG, seen, strict=True)
    ]
    for number, unit in enumerate(UNITS, start=1):
        rpm, azimuth = (run[f"helm.{kind}_{number}"].values[rows] for kind in ("rpm", "azimuth"))
        listed.append((f"{unit}_rpm", np.round(rpm, 1), "rpm", ""))
        listed.append((f"{unit}_azimuth", np.round(np.degrees(azimuth), 1), "deg", ""))
    speed, from_ = (run[f"ship.apparent_wind_{name}"].values for name in ("speed", "from"))
    air, width = speed * np.exp(1j * from_), round(3.0 / STEP)  # the sensor averages over 3 s
    mean = np.convolve(
        np.append(np.full(width - 1, air[0]), air), np.full(width, 1.0 / width), "valid"
    )[rows]
    listed.append(
        ("wind_speed", np.abs(mean) * (1.0 + 0.02 * random.standard_normal(mean.size)), "m/s", "")
    )
    listed.append(
        ("wind_from", np.degrees(np.angle(mean)) + random.standard_normal(mean.size), "deg", "")
    )
    return make_table(run["time"].values[rows], listed)
