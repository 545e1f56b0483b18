"""Logs of the modelled ship herself with a known number wrong: what the diagnosis must find if its inference is right.

Several ships sail at once, one for each planted cause, by the same thrusters and wind. Physics is the ship model's, so
these logs say nothing about the models, only about what is concluded from them.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter1d
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.inference.innovations import _process, _steady, _uncertain
from shipcosim.diagnose.inference.linearisation import STATES
from shipcosim.diagnose.inference.noise import waves_of
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.library import build_stale
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import apparent_wind
from shipcosim.models.ship import instruments
from shipcosim.series import make_table
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[3]
FINE = 0.25  # s
WHITE = np.array([0.2, 0.2, np.radians(0.1), 0.02, 0.02, np.radians(0.05)])
JOLT = np.array([1e-3, 1e-3, 1e-4])
TO_LOG = (1.0, 1.0, 180.0 / np.pi, 1.0, 1.0, 180.0 / np.pi)
ROLES = {
    "north": "m",
    "east": "m",
    "heading": "deg",
    "surge": "m/s",
    "sway": "m/s",
    "yaw_rate": "deg/s",
}
WIND = 9.0, 2.0  # m/s, rad it comes from, before gusts

PLANTED = {
    "healthy": {},
    "current": {"water.current_north": 0.22, "water.current_east": -0.12},
    "thrust_loss": {"port.thrust_loss": 0.25},
    "heading_bias": {"instruments.heading_bias": np.radians(3.0)},
    "mass": {"vessel.mass_scale": 1.25},
    "two": {"tunnel.thrust_loss": 0.3, "instruments.lever_x": 5.0, "instruments.lever_y": 2.0},
    "tow": {"water.tow_north": -2500.0, "water.tow_east": 1500.0},
    "azimuth_offset": {"starboard.azimuth_offset": np.radians(9.0)},
}


def seen(run, ship, rows, errors=None):
    """What instruments with some errors show of the motion of a component in a co-simulation, headings without jumps.

    (6, n) array, before noise.
    """
    motion = [run[f"{ship}.{name}"].values[rows] for name in ("x", "y", "psi", "u", "v", "r")]
    motion[2] = np.unwrap(motion[2])
    given = {"heading_bias": 0.0, "lever_x": 0.0, "lever_y": 0.0, "velocity_scale": 1.0} | (
        errors or {}
    )
    found = np.stack(instruments.readings(*motion, **given))
    found[2] = motion[2] + given["heading_bias"]
    return found


@cache
def system():
    """The lengthened Gunnerus with inputs for her thrusters."""
    return read_system(ROOT / "ssp" / "gunnerus_open", fmus=[build_stale(ROOT)])


@cache
def model(minutes=6.0):
    """Her array form, for a log of so many minutes."""
    return replace(ship_model_of(system()), span=(0.0, 60.0 * minutes))


def commands(time, seed=0):
    """Speed [rpm] and direction [rad] of each thruster over time, so that the ship turns, stops, reverses and crabs."""
    random, h = np.random.default_rng(seed), time[1] - time[0]

    def held(levels, every, first):
        at = ((time + first) // every).astype(int)
        return gaussian_filter1d(np.asarray(levels)[at % len(levels)], 5.0 / h)

    a, b, c = random.uniform(0.0, 40.0, 3)
    return {
        "port": (
            held([110.0, 60.0, -80.0, 90.0, 40.0], 45.0, a),
            held([0.2, -0.9, 0.3, 1.1], 70.0, b),
        ),
        "starboard": (
            held([90.0, -60.0, 100.0, 50.0], 55.0, b),
            held([-0.3, 0.8, -1.0, 0.1, 0.5], 60.0, c),
        ),
        "tunnel": (held([700.0, -900.0, 300.0, -500.0, 1000.0], 50.0, c), np.zeros(time.size)),
    }


def sailed(problems, minutes=6.0, seed=0, push=None):
    """Logs of ships with numbers changed.

    Parameters
    ----------
    problems : dict of str to dict of str to float
        By name, what is wrong.
    minutes : float
    seed : int
    push : callable, optional
        Time [s] to a further load on all of them. [N, N, N.m]

    Returns
    -------
    dict of str to xarray.Dataset
        As `repaired` gives them.
    """
    random, m = np.random.default_rng(seed), len(problems)
    paths = {path for values in problems.values() for path in values}
    ship = model(minutes).with_values(
        {
            path: np.array([values.get(path, model().get(path)) for values in problems.values()])
            for path in paths
        }
    )
    time = np.arange(0.0, 60.0 * minutes + FINE / 2, FINE)
    units = commands(time, seed)
    gusts = gaussian_filter1d(random.standard_normal((2, time.size)), 15.0 / FINE)
    gusts /= gusts.std(axis=1, keepdims=True)
    speed, from_ = WIND[0] + 1.2 * gusts[0], WIND[1] + 0.1 * gusts[1]
    jolts = random.standard_normal((time.size, 3, 1)) * (JOLT * np.sqrt(FINE))[:, None]
    motion, rows, winds = Motion(*np.zeros((6, m))), [], []
    for k, t in enumerate(time):
        wind = apparent_wind(
            motion.psi,
            motion.u,
            motion.v,
            -speed[k] * np.cos(from_[k]),
            -speed[k] * np.sin(from_[k]),
        )
        rows.append(np.stack(motion))
        winds.append(np.stack(wind))
        inputs = Inputs(
            t, {name: (n[k] / 60.0, azimuth[k]) for name, (n, azimuth) in units.items()}, *wind
        )
        extra = push(t) if push else (0.0, 0.0, 0.0)
        first = motion_rates(motion, inputs, ship, extra)
        middle = Motion(
            *(value + 0.5 * FINE * rate for value, rate in zip(motion, first, strict=True))
        )
        rates = motion_rates(middle, inputs, ship, extra)
        motion = Motion(*(value + FINE * rate for value, rate in zip(motion, rates, strict=True)))
        motion = motion._replace(
            u=motion.u + jolts[k, 0], v=motion.v + jolts[k, 1], r=motion.r + jolts[k, 2]
        )
    seen = np.stack(readings(Motion(*np.moveaxis(np.stack(rows), 1, 0)), ship))[
        :, :: round(1 / FINE)
    ]
    noise = WHITE[:, None] * random.standard_normal((6, seen.shape[1]))
    table = _table(time, seen + noise[..., None], np.stack(winds), units)
    return {name: table(i) for i, name in enumerate(problems)}


def _table(time, seen, winds, units):
    every = round(1 / FINE)
    trailing = np.cumsum(np.concatenate([np.repeat(winds[:1], 10, axis=0), winds]), axis=0)
    winds = (trailing[10:] - trailing[:-10])[::every] / 10.0  # a sensor that averages over 2.5 s

    def of(i):
        values = [
            (role, scale * seen[j, :, i], unit, role)
            for j, ((role, unit), scale) in enumerate(_scaled())
        ]
        values += [
            ("wind_speed", winds[:, 0, i], "m/s", ""),
            ("wind_from", np.degrees(winds[:, 1, i]), "deg", ""),
        ]
        for name, (n, azimuth) in units.items():
            values.append((f"{name}_rpm", n[::every], "rpm", ""))
            if name != "tunnel":
                values.append((f"{name}_azimuth", np.degrees(azimuth[::every]), "deg", ""))
        return make_table(time[::every], values)

    return of


def _scaled():
    return zip(ROLES.items(), TO_LOG, strict=True)


@cache
def logs(minutes=6.0, seed=0):
    """One log for each of `PLANTED`."""
    return sailed(PLANTED, minutes, seed)


def ready(log):
    """A log as a case."""
    with threadpool_limits(1):  # small matrices: threads would only wait for each other
        return identification_problem(log, model(), read_catalogue())


def explained(log):
    """A log as a case, and what explains it, best first."""
    with threadpool_limits(1):
        problem = ready(log)
        return problem, explain(problem)


@cache
def of(name):
    """The same for a log of `PLANTED`."""
    return explained(logs()[name])


def problem(name):
    return of(name)[0]


def fits(name):
    return of(name)[1]


def drawn(seed, linear, noise, record):
    """A linear problem whose log is drawn from itself."""
    random, n = np.random.default_rng(seed), record.time.size
    calm = replace(noise, wave=np.zeros(3))
    each, turns = np.linalg.eigh(_process(calm, record.step))
    steady, moved = _steady(calm, record.step), linear.transition.shape[-1]
    root = turns * np.sqrt(np.maximum(each, 0.0))
    x, rows = np.sqrt(np.diag(_uncertain(calm))) * random.standard_normal(STATES), []
    for k in range(n):
        rows.append(linear.output[k] @ x + noise.white * random.standard_normal(6))
        if k < n - 1:
            ahead = steady @ x
            ahead[:moved] += linear.transition[k] @ x[:moved]
            x = ahead + root @ random.standard_normal(STATES)
    added = waves_of(noise, record.step, (n, 1), random)[:, 0]
    rows = np.stack(rows) + (linear.output[..., 12:] @ added[..., None])[..., 0]
    return linear._replace(driven=np.zeros((n - 1, STATES, 1)), seen=rows[..., None])
