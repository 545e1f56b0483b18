"""Runs of the DP ship, one variation a seed, which tests and benchmarks of the closed loop share."""

import math

import numpy as np

import shipcosim
from shipcosim.scenario import Scenario

NORTH_EAST = math.pi / 4.0
WIND_8 = {
    "environment.wind_speed": 8.0,
    "environment.wind_from": NORTH_EAST,
    "environment.current_speed": 0.3,
    "environment.current_to": math.pi,
}
WIND_10 = WIND_8 | {"environment.wind_speed": 10.0, "environment.current_speed": 0.5}
SEA = {"environment.waves_from": NORTH_EAST}
MODERATE = (
    WIND_8 | SEA | {"environment.significant_wave_height": 0.3, "environment.peak_period": 5.0}
)
ROUGH = WIND_10 | SEA | {"environment.significant_wave_height": 0.5, "environment.peak_period": 6.0}


def simulate(seeds, values, events=(), *, stop_time, h=0.05, every=1, record=None, components=None):
    """Run the DP ship with each seed; that of the sensors is 100 more.

    Parameters
    ----------
    seeds : (m,) sequence of int
        Of wind, gusts and waves.
    values : dict of str to value or (m,) array
        Start values by full name, one for all seeds or one for each.
    events : iterable of (float, dict of str to value or (m,) array)
        Times, and what is held at a value from then on. [s]
    stop_time, h : float
        Length of the run, and step. [s]
    every : int
        Steps from one row to the next.
    record, components
        As of `shipcosim.simulate_many`.

    Returns
    -------
    dict of str to array
        ``"time"`` (n,) and signals, each (n, m).
    """
    seeds = [int(seed) for seed in seeds]
    columns = {"environment.seed": seeds, "sensors.seed": [seed + 100 for seed in seeds]}
    columns |= {name: np.broadcast_to(value, len(seeds)).tolist() for name, value in values.items()}
    held = [
        (
            time,
            {name: np.broadcast_to(value, len(seeds)).tolist() for name, value in changes.items()},
        )
        for time, changes in events
    ]
    variations = [
        {name: column[k] for name, column in columns.items()}
        | {
            "events": [
                {"time": t, "override": {name: column[k] for name, column in all_.items()}}
                for t, all_ in held
            ]
        }
        for k in range(len(seeds))
    ]
    scenario = Scenario(
        description="A run of the DP ship",
        system="gunnerus_dp",
        parameters=["gunnerus-33m9"],
        stop_time=stop_time,
        step_size=h,
        output_interval=every * h,
    )
    runs = shipcosim.simulate_many(None, scenario, variations, record=record, components=components)
    assert not any(runs.error.values), runs.error.values
    return {"time": runs.time.values} | {
        str(name): signal.values.T for name, signal in runs.items()
    }
