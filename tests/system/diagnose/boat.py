"""A boat of 6 m with our hull and two fixed propellers of somebody else; and logs of her, by co-simulation."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import ships
from diagnose import twin
from scipy.ndimage import gaussian_filter1d

import shipcosim as sc
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.series import make_table

SIDES = {"left": -0.9, "right": 0.9}
GAIN, TOLERANCE = 6.0, 0.3
STEP = 0.1  # s
SEA = 7.0, 2.0  # m/s, rad it comes from, before gusts
WHITE = np.array([0.1, 0.1, np.radians(0.1), 0.02, 0.02, np.radians(0.1)])
HULL = {
    "mass": (1500.0, 15.0),
    "inertia_yaw": (3500.0, 35.0),
    "A11": (100.0, 3.0),
    "A22": (900.0, 30.0),
    "A26": (-200.0, 20.0),
    "A62": (-200.0, 20.0),
    "A66": (2200.0, 70.0),
    "length": (6.0, 0.0),
    "breadth": (2.4, 0.0),
    "draught": (0.45, 0.0),
    "lift": (-500.0, 50.0),
    "lift_x": (-0.4, 0.04),
    "X_uu": (-70.0, 4.0),
    "Y_v": (-300.0, 30.0),
    "N_r": (-900.0, 50.0),
}


@cache
def screw():
    """The propeller's FMU."""
    return sc.build_fmu(Path(__file__).with_name("screw.py"), mkdtemp(prefix="shipcosim-"))


def structure(name="boat", **factors):
    """The boat, whose propellers' loads reach her by factors other than 1 where given."""
    return _put_together(name, **factors).copy()


@cache
def _put_together(name, **factors):
    """The same once for all tests: that takes a second."""
    boat = sc.new(name)
    with boat.changes():
        boat.add_component("boat", twin.build_stale(twin.ROOT) / "vessel.fmu")
        ships.lend(boat, "boat", HullParameters, DriftParameters)
        for parameter, (value, tolerance) in HULL.items():
            boat.set(f"boat.{parameter}", value, tolerance=tolerance or None)
        boat.set("boat.wind_table", small(ships.parameters(WindParameters).wind_table))
        for axis in ("north", "east"):
            boat.add_connector(f"wind_{axis}", "input", unit="m/s")
            boat.connect(f"wind_{axis}", f"boat.wind_{axis}")
        for number, (side, aside) in enumerate(SIDES.items(), start=1):
            boat.add_component(side, screw())
            boat.add_connector(f"{side}_rpm", "input", unit="rpm")
            boat.connect(f"{side}_rpm", f"{side}.shaft")
            boat.connect("boat.u_r", f"{side}.way")
            boat.connect("boat.r", f"{side}.swing")
            boat.connect(f"{side}.push", f"boat.tau_X_{number}", factor=factors.get(side))
            boat.connect(f"{side}.twist", f"boat.tau_N_{number}", factor=factors.get(side))
            boat.set(f"{side}.aside", aside)
            boat.set(f"{side}.gain", GAIN, tolerance=TOLERANCE)
    boat.step_size = STEP
    return boat


def small(table):
    """The wind's loads on a ship of a thirtieth of the area, a fifth of the length."""
    rows = [[float(value) for value in row.split()] for row in table.split(";")]
    return "; ".join(f"{a} {X / 30.0} {Y / 30.0} {N / 150.0}" for a, X, Y, N in rows)


def commands(time, seed):
    """Speeds of both propellers: ahead, astern, against each other. [rpm]"""
    random, h = np.random.default_rng(seed), time[1] - time[0]
    found = {}
    for side, every in (("left", 41.0), ("right", 53.0)):
        levels = random.uniform(-350.0, 500.0, int(time[-1] / every) + 2)
        found[f"{side}_rpm"] = gaussian_filter1d(levels[(time // every).astype(int)], 3.0 / h)
    return found


def wind(time, seed):
    """Velocity of the air towards north and east. [m/s]"""
    gusts = gaussian_filter1d(
        np.random.default_rng(seed).standard_normal((2, time.size)), 10.0 / (time[1] - time[0])
    )
    gusts /= gusts.std(axis=1, keepdims=True)
    speed, from_ = SEA[0] + 1.2 * gusts[0], SEA[1] + 0.1 * gusts[1]
    return -speed * np.cos(from_), -speed * np.sin(from_)


def log(minutes=20.0, seed=0, boat=None, rate=1.0, off=None):
    """What the boat's instruments say of a co-simulation.

    Parameters
    ----------
    minutes : float
    seed : int
    boat : SystemStructure, optional
    rate : float
        Between rows. [s]
    off : dict of str to float, optional
        Speed that the log has too much. [rpm]
    """
    time, random = np.arange(0.0, 60.0 * minutes + STEP / 2, STEP), np.random.default_rng(seed)
    told, air = commands(time, seed), wind(time, seed + 1)
    columns = [(name, values, "rpm", "") for name, values in told.items()]
    columns += [
        (f"wind_{axis}", values, "m/s", "")
        for axis, values in zip(("north", "east"), air, strict=True)
    ]
    run = sc.simulate(
        boat or structure(),
        stop_time=float(time[-1]),
        step_size=STEP,
        inputs=make_table(time, columns),
        engine="native",  # a tenth of the time of Python
    )
    rows = slice(None, None, round(rate / STEP))
    seen = np.stack([run[f"boat.{name}"].values[rows] for name in ("x", "y", "psi", "u", "v", "r")])
    seen[2] = np.unwrap(seen[2])
    seen = seen + WHITE[:, None] * random.standard_normal(seen.shape)
    listed = [
        (r, k * v, u, "")
        for (r, u), k, v in zip(twin.ROLES.items(), twin.TO_LOG, seen, strict=True)
    ]
    listed += [
        (name, values[rows] + (off or {}).get(name, 0.0), "rpm", "")
        for name, values in told.items()
    ]
    for role, unit, scale in (("speed", "m/s", 1.0), ("from", "deg", 180.0 / np.pi)):
        listed.append(
            (f"wind_{role}", scale * run[f"boat.apparent_wind_{role}"].values[rows], unit, "")
        )
    return make_table(run["time"].values[rows], listed)
