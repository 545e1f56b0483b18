"""Worlds in which the 82.7 m vessel holds her position, and records of measurements and truth.

The true ship differs from the model: less linear damping and some quadratic damping, other
wind loads, weaker thrusters. She is the same in all worlds: a ship learns from her own data.
Weather, current and sensor errors differ by world. The predictor knows none of these.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper II: Table I for
noise, Table IV for sea states, IV-A for how the weather changes.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipcosim.angles import TURN, wrap_series
from shipcosim.cosim import simulate, system_of
from shipcosim.learn.training import Progress
from shipcosim.scenario import Event, Scenario

SYSTEM = "osv_gnss_loss"
PARAMETERS = "osv"
STEP = 0.2
SEA_STATES = ((1.0, 2.0), (2.0, 4.0), (3.0, 7.0), (4.0, 11.0))
"""Significant wave height and wind speed. [m, m/s] Paper II, Table IV."""
TRANSITION = 420.0
SETTLED = 600.0
DURATION = 840.0
"""The wind has changed; three minutes later; the end of a condition. [s] Paper II, IV-A and IV-C."""
TRAINING = range(1, 13)
CALIBRATION = range(200, 224)
TUNING = range(300, 312)
HELD_OUT = range(8100, 8148)
"""Seeds of worlds, each for one purpose."""
SHIP: Mapping[str, float | str] = tomllib.loads(
    Path(__file__).with_name("true_ship.toml").read_text("utf-8")
)
"""The true ship where she differs from her parameter set, within its tolerances or in a form that it does not have."""
SENSORS: Mapping[str, float | str] = {
    "sensors.period": 0.2,
    "sensors.position_period": 0.2,
    "sensors.position_drift_std": 0.1,
    "sensors.position_noise_std": 0.2,
    "sensors.velocity_noise_std": 0.02,
    "sensors.heading_drift_std": "0.1 deg",
    "sensors.heading_noise_std": "0.1 deg",
    "sensors.yaw_rate_noise_std": "0.05 deg/s",
    "sensors.wind_speed_noise": 0.02,
    "sensors.wind_from_noise_std": "1 deg",
}
"""Noise of Table I of paper II; of velocities, yaw rate and wind, which it does not print, as of the DP ship."""
UNITS = ("bow_1", "bow_2", "stern_1", "stern_2", "port", "starboard")
MEASURED: Mapping[str, str] = {
    "x": "sensors.x_1_meas",
    "y": "sensors.y_1_meas",
    "psi": "sensors.psi_1_meas",
    "u": "sensors.u_1_meas",
    "v": "sensors.v_1_meas",
    "wind_speed": "sensors.wind_speed_meas",
    "wind_from": "sensors.wind_from_meas",
    **{f"command_{number}": f"{unit}.command" for number, unit in enumerate(UNITS, 1)},
    **{f"asked_{number}": f"allocator.thrust_cmd_{number}" for number in range(1, 7)},
    "valid": "sensors.position_1_valid",
    "second_x": "sensors.x_2_meas",
    "second_y": "sensors.y_2_meas",
}
"""Quantities known aboard: name, and signal that measures it. The second receiver is logged, and DP does not see it."""
RECKONED: Mapping[str, str] = {
    name: f"reckoning.{name}" for name in ("x_hat", "y_hat", "position_region", "lost_for")
}
"""What the FMU in the loop gave."""
DRILLS = tuple((time, time + 60.0) for time in (240.0, 360.0, 480.0, 600.0, 720.0))
"""From when to when GNSS is masked in a drill: DP rides on dead reckoning, the second receiver is logged. [s]"""


@dataclass(frozen=True)
class World:
    """Weather and errors of sensors in one run.

    Parameters
    ----------
    seed : int
        Of gusts, waves and noise. [1]
    wave_height, wave_period : float
        Of the sea, over the whole run. [m, s]
    wind_speed, wind_from : tuple of two floats
        Mean wind at the start, and from `TRANSITION` on; the waves come from where the second does. [m/s, rad]
    current_speed, current_to : float
        Current. [m/s, rad]
    position_bias : tuple of two floats
        Error of the position that stays. [m]
    compass_error : float
        Error of the heading that stays. [rad]
    """

    seed: int
    wave_height: float
    wave_period: float
    wind_speed: tuple[float, float]
    wind_from: tuple[float, float]
    current_speed: float
    current_to: float
    position_bias: tuple[float, float]
    compass_error: float


class Record(NamedTuple):
    """Record of one world or several.

    Parameters
    ----------
    measured : dict of str to (..., n) array
        One sample a second of what is aboard, by the names of `MEASURED`. [m, rad, m/s, units of the maps, N]
    x, y : (..., n) array
        True position, waves included. [m]
    reckoned : dict of str to (..., n) array
        By the names of `RECKONED`. [m, s]
    """

    measured: dict[str, np.ndarray]
    x: np.ndarray
    y: np.ndarray
    reckoned: dict[str, np.ndarray]


def drawn(seed: int) -> World:
    """A world of random weather within Table IV: wind and waves rise together, directions are any.

    Parameters
    ----------
    seed : int
        Seed of all that is random. [1]

    Returns
    -------
    World
    """
    # Severity in steps of the sea state table: now, and before the wind changes.
    rng = np.random.default_rng([26, seed])
    severity, before = rng.uniform(0.0, 3.0, 2)
    # Wave height and wind speed rise together, interpolated in Table IV.
    heights, speeds = zip(*SEA_STATES, strict=True)
    first, last = (float(np.interp(level, range(4), speeds)) for level in (before, severity))
    # Any direction before, and any after.
    start, end = map(float, rng.uniform(-math.pi, math.pi, 2))
    return world_of(
        seed, float(np.interp(severity, range(4), heights)), (first, last), (start, end), rng
    )


def world_of(
    seed: int,
    height: float,
    wind: tuple[float, float],
    towards: tuple[float, float],
    rng: np.random.Generator,
) -> World:
    """A world of this wave height, wind before and after it changes, and directions; what else there is is drawn."""
    # Current, position bias and compass error: constant in a world, unknown aboard.
    current = rng.uniform([0.0, -math.pi], [0.4, math.pi])
    bias = rng.uniform(-0.2, 0.2, 2)
    return World(
        seed,
        height,
        5.0 * math.sqrt(height),  # s; not printed: a wind sea of steepness 1/39
        wind,
        towards,
        float(current[0]),
        float(current[1]),
        (float(bias[0]), float(bias[1])),
        float(rng.uniform(-1.0, 1.0) * math.radians(0.1)),
    )


def scenario_of(
    world: World,
    duration: float = DURATION,
    losses: Sequence[tuple[float, float]] = (),
) -> Scenario:
    """The run of a world: the wind changes over seven minutes, then holds.

    Parameters
    ----------
    world : World
        The world.
    duration : float
        How long. [s]
    losses : sequence of two floats
        From when to when GNSS is lost, and DP rides on dead reckoning. [s]

    Returns
    -------
    Scenario
        Of the system `SYSTEM`.
    """
    # The wind changes from its first to its second value at constant rates over TRANSITION.
    turn = abs(wrap_series(world.wind_from[1] - world.wind_from[0], TURN))
    # Weather at the start, and sensor errors that stay.
    values = {
        "environment.wind_speed": world.wind_speed[0],
        "environment.wind_from": world.wind_from[0],
        "environment.wind_speed_rate": abs(world.wind_speed[1] - world.wind_speed[0]) / TRANSITION,
        "environment.wind_turn_rate": turn / TRANSITION,
        "environment.significant_wave_height": world.wave_height,
        "environment.peak_period": world.wave_period,
        "environment.waves_from": world.wind_from[1],
        "environment.current_speed": world.current_speed,
        "environment.current_to": world.current_to,
        "environment.seed": world.seed,
        "sensors.seed": world.seed,
        "sensors.position_1_north": world.position_bias[0],
        "sensors.position_1_east": world.position_bias[1],
        "sensors.compass_1_offset": world.compass_error,
        "reckoning.variant": "kinetic",
    }
    # Targets of speed and direction, given at time 0 and reached at these rates.
    wind = {
        "environment.wind_speed": world.wind_speed[1],
        "environment.wind_from": world.wind_from[1],
    }
    events = [Event(time=0.0, override=wind)]
    # Masking GNSS hands DP over to dead reckoning; it returns at the end of the drill.
    for lost, regained in losses:
        events.append(Event(time=lost, override={"sensors.position_1_lost": True}))
        events.append(Event(time=regained, reset=["sensors.position_1_lost"]))
    return Scenario(
        description=f"World {world.seed}",
        system=SYSTEM,
        parameters=PARAMETERS,
        stop_time=duration,
        step_size=STEP,
        output_interval=1.0,
        set={**SHIP, **SENSORS, **values},
        events=[event for event in events if event.time < duration],
    )


def recorded(
    worlds: Sequence[World],
    duration: float,
    progress: Progress,
    losses: Sequence[tuple[float, float]] = (),
) -> Record:
    """Records of worlds by co-simulation, one after the other.

    Parameters
    ----------
    worlds : sequence of World
        The worlds.
    duration : float
        How long each. [s]
    progress : callable
        Called with how many are done, and of how many.
    losses
        As in `scenario_of`.

    Returns
    -------
    Record
        With (worlds, duration + 1) arrays.
    """
    # The system is the same in all worlds: read it once, then run each scenario.
    tables = []
    system = system_of(scenario_of(worlds[0], duration))
    for number, world in enumerate(worlds, 1):
        tables.append(simulate(system, scenario_of(world, duration, losses)))
        progress(number, len(worlds))

    def stacked(signal):
        return np.stack([table[signal].values.astype(float) for table in tables])

    measured, reckoned = (
        {name: stacked(signal) for name, signal in names.items()} for names in (MEASURED, RECKONED)
    )
    # True position with wave motion: that is where the antenna is.
    x, y = (stacked(f"vessel.{axis}") + stacked(f"vessel.{axis}_wave") for axis in "xy")
    return Record(measured, x, y, reckoned)
