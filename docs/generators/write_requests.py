"""Writes the requests that allocators are trained on: what the DP controller of R/V Gunnerus sends in all weather.

Run `python docs/generators/write_requests.py` after the controller or its gains have changed; it takes some minutes.
Half of the runs are those of the scenario stationkeeping, half those of the four corners, with wind, waves and current
drawn anew for each seed. The seeds, from `FIRST_SEED` on, are of training alone: scenarios and benchmarks have others.
"""

import math
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import dp_runs  # noqa: E402

from shipcosim.learn.requests import FIRST_SEED, REQUESTS  # noqa: E402

RUNS = 24  # of each of the two
INTERVAL = 0.5  # s
UNIT = np.array([10.0, 10.0, 100.0])  # N, N, N.m: requests are rounded to these
SECTION = math.pi / 4.0


def weather(seeds):
    """Wind, waves and current of each seed: wind of 2 to 14 m/s from anywhere, waves that such wind makes near land."""
    draw = np.random.default_rng(int(seeds[0]))
    wind, towards = (
        draw.uniform(2.0, 14.0, len(seeds)),
        draw.uniform(-math.pi, math.pi, (2, len(seeds))),
    )
    return {
        "environment.significant_wave_height": 0.05 * wind,
        "environment.peak_period": draw.uniform(4.0, 7.0, len(seeds)),
        "environment.waves_from": towards[0],
        "environment.wind_turn_rate": math.radians(9.0),
        "environment.wind_speed": wind,
        "environment.wind_from": towards[0],
        "environment.current_speed": draw.uniform(0.0, 0.5, len(seeds)),
        "environment.current_to": towards[1],
    }


def recorded(seeds, events, stop_time):
    """Requests of each seed, (m, n, 3), in multiples of UNIT."""
    values = weather(seeds)
    changes = [(time, change(values)) for time, change in events]
    found = dp_runs.simulate(
        seeds,
        values,
        changes,
        stop_time=stop_time,
        every=round(INTERVAL / 0.05),
        record="controller",
    )
    requests = np.stack([found[f"controller.tau_{axis}_cmd"].T for axis in "XYN"], -1)
    return np.round(requests / UNIT).astype(np.int16)


STATIONKEEPING = [
    (150.0, lambda values: {"environment.wind_from": values["environment.wind_from"] - SECTION})
]
FOUR_CORNERS = [
    (0.0, lambda _: {"reference.x_set": 20.0}),
    (250.0, lambda _: {"reference.y_set": -20.0}),
    (450.0, lambda _: {"reference.psi_set": -SECTION}),
    (650.0, lambda _: {"reference.x_set": 0.0}),
    (850.0, lambda _: {"reference.y_set": 0.0, "reference.psi_set": 0.0}),
]

if __name__ == "__main__":
    seeds = np.arange(FIRST_SEED, FIRST_SEED + 2 * RUNS)
    still = recorded(seeds[:RUNS], STATIONKEEPING, 600.0)
    moving = recorded(seeds[RUNS:], FOUR_CORNERS, 1100.0)
    arrays = {
        "stationkeeping": still,
        "four_corner": moving,
        "seeds": seeds,
        "interval": np.array(INTERVAL),
        "unit": UNIT,
    }
    np.savez_compressed(REQUESTS, **arrays)
