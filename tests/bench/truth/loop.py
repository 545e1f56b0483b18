"""The closed loop: many ships under their own DPs, moved on together in NumPy arrays."""

from dataclasses import dataclass

import numpy as np

from truth import effects, plant, sensors, unknowns
from truth.autopilot import Autopilot, Plan, Style
from truth.knobs import Knobs
from truth.sensors import RECORDED, THRUSTER_ROWS, Noise
from truth.ship import Coefficients
from truth.weather import Weather

BEFORE = 240  # s that the loop runs before the log, so that it starts settled
AFTER = 130  # and after it, for clocks that run fast
STEP = 0.25
HALF_SECOND = 0.5  # spacing of the records


@dataclass(frozen=True)
class Setup:
    """All that makes one log; series are at the records, from BEFORE ahead of the log."""

    kind: str
    seed: int
    rows: int
    planned_rows: int  # before whatever is sailed after it
    coefficients: Coefficients
    weather: Weather
    mast_wind: np.ndarray
    wind: np.ndarray
    sea: np.ndarray
    style: Style
    plan: Plan
    noise: Noise
    effects: tuple
    day: int = 0


def run(setups):
    """Simulate a batch; the ships do not know of each other.

    Parameters
    ----------
    setups : sequence of Setup
        All of the same length.

    Returns
    -------
    list of dict
        Per ship the (m,) series of RECORDED and THRUSTER_ROWS, and "sensor" (7, m), every HALF_SECOND.
    """
    n = len(setups)
    coefficients = Coefficients.stack([s.coefficients for s in setups])
    wind, mast = (
        np.stack([getattr(s, name).T for s in setups], axis=-1) for name in ("wind", "mast_wind")
    )
    sea = np.stack([s.sea for s in setups], axis=-1)
    slow, white = (
        np.stack([getattr(s.noise, name) for s in setups], axis=-1) for name in ("slow", "loop")
    )
    period, waves_to = (
        np.array([getattr(s.weather, name) for s in setups]) for name in ("wave_period", "waves_to")
    )
    wave_number = (2 * np.pi / period) ** 2 / plant.GRAVITY
    toe = np.array([s.style.toe for s in setups])
    start = np.array([s.plan.eta[:, 0] for s in setups]).T
    azimuth = np.array([-toe, toe])
    knobs = Knobs(n)
    ship = plant.at_rest(*start, np.zeros((3, n)), azimuth, coefficients, knobs)
    act(setups, range(n), knobs, -BEFORE, ship)
    ship = plant.at_rest(*start, np.zeros((3, n)), azimuth, coefficients, knobs)
    changing = [i for i, s in enumerate(setups) if any(changes(e) for e in s.effects)]
    pilot = Autopilot([s.plan for s in setups], [s.style for s in setups], azimuth)
    ticks = setups[0].plan.mode.size
    record = np.empty(
        (int(ticks / HALF_SECOND) + 1, len(RECORDED) + len(THRUSTER_ROWS) + len(knobs.sensor), n)
    )
    keep(record[0], ship, coefficients, knobs)
    for tick in range(ticks):
        act(setups, changing, knobs, tick - BEFORE, ship)
        k = 2 * tick
        state = [getattr(ship, name) for name in RECORDED]
        readings = sensors.loop_readings(
            state,
            knobs.sensor,
            sea[k],
            period,
            waves_to,
            mast[k],
            slow[:, tick].copy(),
            white[:, tick],
        )
        rpm, azimuth = pilot.command(tick, *readings)
        for k in (2 * tick, 2 * tick + 1):
            slope = 0.5 * wave_number * sea[k].real * np.sin(waves_to - ship.psi)
            for _ in range(round(HALF_SECOND / STEP)):
                ship = plant.step(ship, rpm, azimuth, wind[k], slope, coefficients, knobs, STEP)
            keep(record[k + 1], ship, coefficients, knobs)
    return [unpack(record[:, :, i]) for i in range(n)]


def changes(effect):
    """Whether an effect's knobs move during the log."""
    cause = effect.answer.cause
    return cause == "unknown" or cause in effects.CHANGES_IN_TIME or effect.answer.onset > 0


def act(setups, which, knobs, t, ship):
    """Turn the knobs of some ships to what their effects make of them at time t of the log."""
    for i in which:
        knobs.reset(i)
        for effect in setups[i].effects:
            law = (
                unknowns.act_unknown
                if effect.answer.cause == "unknown"
                else effects.ACT.get(effect.answer.cause)
            )
            if law:
                law(effect, knobs, i, t, ship, effect.ramp(t))


def keep(row, ship, coefficients, knobs):
    """Write the state, the thrusters as they measure themselves, and the sensor knobs into a row (quantities, n)."""
    for i, name in enumerate(RECORDED):
        row[i] = getattr(ship, name)
    first = len(RECORDED)
    row[first : first + 3] = ship.rpm + knobs.rpm + coefficients.rpm_error
    row[first + 3 : first + 5] = ship.azimuth - knobs.azimuth - coefficients.azimuth_error
    row[first + 5 :] = knobs.sensor


def unpack(record):
    """Series by name of one ship's record (m, quantities)."""
    names = (*RECORDED, *THRUSTER_ROWS)
    series = {name: np.ascontiguousarray(record[:, i]) for i, name in enumerate(names)}
    return series | {"sensor": np.ascontiguousarray(record[:, len(names) :].T)}
