"""A USV of 5 m with our hull and two of our thrusters that nothing turns; and logs of her, by co-simulation."""

from functools import cache

import numpy as np
import ships
from diagnose import boat, twin
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

import shipcosim as sc
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.series import make_table

TOE = np.radians(4.0)
SIDES = {"left": (-0.7, TOE), "right": (0.7, -TOE)}  # m to starboard, rad of the thrust
STEP = 0.1  # s
HULL = {
    "mass": (620.0, 12.0),
    "inertia_yaw": (950.0, 20.0),
    "A11": (35.0, 5.0),
    "A22": (300.0, 20.0),
    "A26": (0.0, 10.0),
    "A62": (0.0, 10.0),
    "A66": (350.0, 25.0),
    "length": (5.0, 0.0),
    "breadth": (1.8, 0.0),
    "draught": (0.35, 0.0),
    "cross_flow_drag": (1.2, 0.1),
    "lift": (0.0, 0.0),
    "X_u": (-20.0, 2.0),
    "X_uu": (-22.0, 1.5),
    "Y_v": (-120.0, 12.0),
    "N_r": (-350.0, 30.0),
}
THRUSTER = {
    "x": -2.2,
    "diameter": 0.25,
    "rpm_max": 1200.0,
    "thrust_max": 800.0,
    "thrust_min": -500.0,
    "azimuth_rate": 0.0,
}


def structure(name="usv", **parameters):
    """The USV, her propellers driven by inputs of the system."""
    usv = _as_modelled(name).copy()
    with usv.changes():
        for signal, value in parameters.items():
            usv.set(signal, value)
    return usv


@cache
def _as_modelled(name):
    """The same without changed numbers, put together once: that takes seconds."""
    usv, fmus = sc.new(name), twin.build_stale(twin.ROOT)
    with usv.changes():
        usv.add_component("hull", fmus / "vessel.fmu")
        ships.lend(usv, "hull", HullParameters, DriftParameters)
        for parameter, (value, tolerance) in HULL.items():
            usv.set(f"hull.{parameter}", value, tolerance=tolerance or None)
        usv.set("hull.wind_table", boat.small(ships.parameters(WindParameters).wind_table))
        for axis in ("north", "east"):
            usv.add_connector(f"wind_{axis}", "input", unit="m/s")
            usv.connect(f"wind_{axis}", f"hull.wind_{axis}")
            usv.add_connector(f"current_{axis}", "input", unit="m/s")
            usv.connect(f"current_{axis}", f"hull.current_{axis}")
        for number, (side, (aside, toe)) in enumerate(SIDES.items(), start=1):
            usv.add_component(side, fmus / "azimuth_thruster.fmu")
            ships.lend(usv, side, AzimuthParameters)
            usv.add_connector(f"{side}_rpm", "input", unit="rpm")
            usv.connect(f"{side}_rpm", f"{side}.rpm_in")
            for given in ("u_r", "v_r", "r"):
                usv.connect(f"hull.{given}", f"{side}.{given}")
            for axis in "XYN":
                usv.connect(f"{side}.tau_{axis}", f"hull.tau_{axis}_{number}")
            usv.set(f"{side}.replay", True)
            for parameter, value in (THRUSTER | {"y": aside, "azimuth_in": toe}).items():
                usv.set(f"{side}.{parameter}", value)
    usv.step_size = STEP
    return usv


def commands(time, seed):
    """Speeds of both propellers: runs ahead, turns, astern, drifting. [rpm]"""
    random, h = np.random.default_rng(seed), time[1] - time[0]
    each = {}
    for name, every, low, high in (("both", 47.0, -400.0, 900.0), ("apart", 31.0, -350.0, 350.0)):
        levels = random.uniform(low, high, int(time[-1] / every) + 2)
        each[name] = gaussian_filter1d(levels[(time // every).astype(int)], 2.0 / h)
    return {"left_rpm": each["both"] + each["apart"], "right_rpm": each["both"] - each["apart"]}


def wind(time, seed, speed=6.0, from_=2.0):
    """Velocity of the air towards north and east, with gusts that forget within 15 s. [m/s]"""
    random, h = np.random.default_rng(seed), time[1] - time[0]
    keep = np.exp(-h / 15.0)
    gusts = lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], random.standard_normal((2, time.size)))
    along = speed + 0.8 * gusts[0]
    angle = from_ + 0.1 * gusts[1]
    return -along * np.cos(angle), -along * np.sin(angle)


def log(minutes=20.0, seed=0, usv=None, rate=1.0, errors=None, current=(0.0, 0.0)):
    """What the USV's instruments say of a co-simulation; `rate` between rows [s], `errors` of the instruments."""
    time, random = np.arange(0.0, 60.0 * minutes + STEP / 2, STEP), np.random.default_rng(seed)
    told, air = commands(time, seed), wind(time, seed + 1)
    columns = [(name, values, "rpm", "") for name, values in told.items()]
    columns += [
        (f"wind_{axis}", values, "m/s", "")
        for axis, values in zip(("north", "east"), air, strict=True)
    ]
    columns += [
        (f"current_{a}", np.full(time.size, v), "m/s", "")
        for a, v in zip(("north", "east"), current, strict=True)
    ]
    run = sc.simulate(
        usv or structure(),
        stop_time=float(time[-1]),
        step_size=STEP,
        inputs=make_table(time, columns),
        engine="native",  # a tenth of the time of Python
    )
    rows = slice(None, None, round(rate / STEP))
    seen = twin.seen(run, "hull", rows, errors)
    seen = seen + boat.WHITE[:, None] * random.standard_normal(seen.shape)
    slow = gaussian_filter1d(random.standard_normal((2, seen.shape[1])), 100.0 / rate)
    seen[:2] += 0.1 * slow / slow.std(axis=1, keepdims=True)
    listed = [
        (r, k * v, u, "")
        for (r, u), k, v in zip(twin.ROLES.items(), twin.TO_LOG, seen, strict=True)
    ]
    listed += [(name, values[rows], "rpm", "") for name, values in told.items()]
    for role, unit, scale, sure in (
        ("speed", "m/s", 1.0, 0.2),
        ("from", "deg", 180.0 / np.pi, 2.0),
    ):
        air = scale * run[f"hull.apparent_wind_{role}"].values[rows]
        listed.append((f"wind_{role}", air + sure * random.standard_normal(air.size), unit, ""))
    return make_table(run["time"].values[rows], listed)
