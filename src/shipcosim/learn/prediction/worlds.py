"""Worlds in which predictors are trained and tested: a seed gives a ship that differs from her nominal model.

The ship is R/V Gunnerus under DP, co-simulated as `gunnerus_dp`. Her controller, allocator and predictor keep the
nominal numbers; the ship herself, her thrusters, sensors and the weather are drawn. She is held, makes some low-speed
manoeuvres, loses all thrust at a drawn time and drifts for 160 s.
"""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from pathlib import Path

import numpy as np

from shipcosim.cosim import simulate, system_of
from shipcosim.learn.training import Progress
from shipcosim.learn.true_ships import (
    DAMPING,
    MEMORY,
    NOISE,
    POWER,
    SPEEDS,
    STRIPS,
    WIND,
    TrueLoads,
    factors,
    sailed,
    system_with,
)
from shipcosim.scenario import Event, Scenario

TRAINING = range(1, 200)
CALIBRATION = range(200, 300)
TUNING = range(300, 400)
"""Seeds of worlds to train on, to calibrate regions on, and to choose by."""
HELD_OUT = range(8700, 8748)
"""Seeds of worlds that nobody looks at before the end."""
KNOWN = (
    "x_hat",
    "y_hat",
    "psi_hat",
    "u_hat",
    "v_hat",
    "r_hat",
    "tau_X_bias",
    "tau_Y_bias",
    "tau_N_bias",
    "tau_X_allocated",
    "tau_Y_allocated",
    "tau_N_allocated",
    "wind_speed_meas",
    "wind_from_meas",
    "wind_rejected",
)
"""Inputs of a predictor, from the observer, the allocator and the wind sensor."""
TRUTH = ("x", "y", "psi", "u", "v", "r")
"""The low-frequency ship."""
TOLERATED = tuple(
    f"{component}.{name}"
    for component, names in tomllib.loads(
        Path(__file__).with_name("tolerated.toml").read_text("utf-8")
    ).items()
    for name in names
)
"""Numbers that are off by their tolerance in the parameter set, as a standard deviation."""
SYSTEM = "gunnerus_dp"
PARAMETERS = "gunnerus-33m9"
NOISY = tuple(
    f"sensors.{name}"
    for name in (
        "position_noise_std",
        "position_drift_std",
        "velocity_noise_std",
        "heading_noise_std",
        "heading_drift_std",
        "yaw_rate_noise_std",
        "wind_speed_noise",
        "wind_from_noise_std",
    )
)
"""Errors of sensors that are larger or smaller than those of the parameter set."""
HULL = ("vessel.water_density", "vessel.length", "vessel.draught")
MEMORY_TIMES = (3.0, 12.0)  # s
STEP = 0.1  # s
DRIFT = 160.0  # s
_THRUSTERS = ("port", "starboard", "tunnel")


@dataclass(frozen=True)
class World:
    """One ship, her weather and what happens to her.

    Parameters
    ----------
    seed : int
        From which it was drawn. [1]
    distance : float
        How far truth and nominal model are apart: 1 for the tolerances. [1]
    lost_at : float
        When she loses all thrust. [s]
    set : dict
        Start values that differ from those of the system.
    events : tuple of Event
        Setpoints, turns of current and wind, loss of thrust.
    """

    seed: int
    distance: float
    lost_at: float
    set: dict
    events: tuple


@dataclass(frozen=True)
class Record:
    """What a world gives, at 1 Hz.

    Parameters
    ----------
    seed : int
        Of the world. [1]
    lost_at : float
        When all thrust was lost, a whole second. [s]
    time : (n,) array
        [s]
    known : (n, 15) array
        What the ship knows, columns `KNOWN`; angles wrapped. [m, rad, m/s, rad/s, N, N.m]
    truth : (n, 6) array
        What became of her, columns `TRUTH`; for scoring, never to learn from. [m, m, rad, m/s, m/s, rad/s]
    """

    seed: int
    lost_at: float
    time: np.ndarray
    known: np.ndarray
    truth: np.ndarray

    def column(self, name: str) -> np.ndarray:
        """A column of what the ship knows, by its name."""
        return self.known[:, KNOWN.index(name)]


def draw(seed: int, distance: float = 1.0) -> World:
    """Draw a world.

    Parameters
    ----------
    seed : int
        Worlds of other seeds are independent. [1]
    distance : float
        How far truth and nominal model are apart: 0 alike, 1 the tolerances, 2 outside what is trained on. What is
        drawn is the same for each distance, only its size differs. [1]

    Returns
    -------
    World
        To be sailed.
    """
    # All draws in a fixed order, so that distance changes sizes only.
    rng = np.random.default_rng([26, seed])
    lost_at = float(rng.integers(180, 301))
    values, weather = _weather(rng, distance, lost_at)
    values |= _parameters(rng, distance)
    # Form errors have a generator of their own: other draws stay as they are.
    values |= _form(np.random.default_rng([26, seed, 1]), distance, values)
    # The predictor does not act here, so it predicts only once: this saves time.
    values |= {
        "environment.seed": seed,
        "sensors.seed": 20000 + seed,
        "predictor.prediction_period": 1e6,
    }
    # All thrusters fail at once; setpoints and weather events before and after.
    lost = Event(time=lost_at, override={f"{name}.failed": True for name in _THRUSTERS})
    events = sorted([*_setpoints(rng, lost_at), *weather, lost], key=lambda event: event.time)
    return World(seed, distance, lost_at, values, tuple(events))


def scenario(world: World, *, drift: float = DRIFT) -> Scenario:
    """The scenario of a world, for `shipcosim.cosim.simulate`.

    Parameters
    ----------
    world : World
        As drawn.
    drift : float
        How long she drifts. [s]

    Returns
    -------
    Scenario
        Of `gunnerus_dp`; her predictor rests, set `predictor.prediction_period` back to 1 s to wake it.
    """
    return Scenario(
        description=f"World {world.seed} at distance {world.distance:g}",
        system=SYSTEM,
        parameters=[PARAMETERS],
        components={"vessel": "rough_vessel"},
        stop_time=world.lost_at + drift,
        step_size=STEP,
        output_interval=1.0,
        set=world.set,
        events=list(world.events),
    )


def sail(world: World) -> Record:
    """Co-simulate a world; some 400 s of simulated time, about 6 s on a quiet core.

    Parameters
    ----------
    world : World
        As drawn.

    Returns
    -------
    Record
        At 1 Hz from the start on.
    """
    # Signals that the predictor sees, and apart from these the truth.
    what = scenario(world)
    table = simulate(system_of(what), what)
    measured = [np.asarray(table[_source(name)], float) for name in KNOWN]
    truth = [np.asarray(table[f"vessel.{name}"], float) for name in TRUTH]
    time = np.asarray(table["time"], float)
    return Record(
        world.seed, world.lost_at, time, np.column_stack(measured), np.column_stack(truth)
    )


def sail_all(
    worlds: Iterable[World],
    *,
    processes: int = 2,
    progress: Progress | None = None,
) -> list[Record]:
    """Co-simulate several worlds, in their order.

    Parameters
    ----------
    worlds : iterable of World
        As drawn.
    processes : int
        How many sail at a time. [1]
    progress : callable, optional
        Called with how many are done, and of how many.

    Returns
    -------
    list of Record
        One a world.
    """
    return list(sailed(sail, list(worlds), processes, progress))


def _source(name: str) -> str:
    """Signal that feeds an input of the predictor."""
    if name.endswith("_allocated"):
        return f"allocator.{name.removesuffix('_allocated')}"
    return f"{'sensors' if name.endswith('_meas') else 'controller'}.{name}"


@lru_cache(maxsize=1)
def _nominal() -> dict[str, tuple[float, float]]:
    """Value and tolerance of each number of `TOLERATED`, `NOISY` and `HULL`."""
    # Read the nominal system once; worlds differ from it.
    system = system_with(SYSTEM, PARAMETERS)
    nominal = {}
    # Numbers without a tolerance keep their value.
    for signal in (*TOLERATED, *NOISY, *HULL):
        name, variable = signal.split(".")
        component = system.components[name]
        nominal[signal] = float(component.start[variable]), component.tolerances.get(variable, 0.0)
    return nominal


def _parameters(rng: np.random.Generator, distance: float) -> dict[str, float]:
    """Numbers of hull, wind and thrusters off by their tolerances, errors of sensors by their share."""
    nominal = _nominal()
    # Parameters: normal, tolerance as standard deviation. Sensor errors: uniform share.
    numbers = {
        name: nominal[name][0] + distance * nominal[name][1] * rng.standard_normal()
        for name in TOLERATED
    }
    return numbers | {
        name: nominal[name][0] * (1.0 + distance * NOISE * rng.uniform(-1.0, 1.0)) for name in NOISY
    }


def _form(
    rng: np.random.Generator, distance: float, values: dict[str, float]
) -> dict[str, float | str]:
    """Form errors: drag along the hull, wind around her, powers of speed, damping and memory.

    `values` are her own parameters.
    """
    density, length, draught = (_nominal()[name][0] for name in HULL)
    # Cross-flow drag as quadratic coefficients: 1/2 rho T C_d L, in yaw over L^4/32.
    cross = 0.5 * density * draught * values["vessel.cross_flow_drag"]
    quadratic = np.array([values["vessel.X_uu"], -cross * length, -cross * length**4 / 32.0])
    # Linear damping as a share of the quadratic damping at low speed.
    damping = distance * DAMPING * rng.uniform(0.0, 1.0, 3) * SPEEDS * quadratic
    memory = distance * MEMORY * rng.uniform(0.0, 1.0, 3)
    # Factors along the hull and around the wind rose; powers of speed about 2.
    along = factors(rng, 5, STRIPS, distance)
    powers = 2.0 + distance * POWER * rng.uniform(-1.0, 1.0, 2)
    around = factors(rng, (8, 3), WIND, distance)
    return TrueLoads(along, around, powers, damping, memory).values() | {
        "vessel.memory_time": float(rng.uniform(*MEMORY_TIMES)),
    }


def _weather(
    rng: np.random.Generator, distance: float, lost_at: float
) -> tuple[dict[str, float], list[Event]]:
    """Weather during DP, and changes of current and wind: at most some tens of degrees."""
    # Constant wind and current; waves come roughly from the wind.
    wind = rng.uniform(3.0, 9.0)
    wind_from = rng.uniform(-pi, pi)
    current = rng.uniform(0.0, 0.5)
    current_to = rng.uniform(-pi, pi)
    values = {
        "environment.wind_speed": wind,
        "environment.wind_from": wind_from,
        "environment.current_speed": current,
        "environment.current_to": current_to,
        "environment.significant_wave_height": rng.uniform(0.1, 0.6),
        "environment.peak_period": rng.uniform(4.0, 7.0),
        "environment.waves_from": wind_from + rng.normal(0.0, 0.4),
        "environment.gust_scale": 1.0 + distance * rng.uniform(-0.3, 0.3),
    }
    # Current and wind change around the loss; both changes grow with distance.
    turned = {
        "environment.current_speed": abs(current + distance * rng.normal(0.0, 0.05)),
        "environment.current_to": current_to + distance * rng.normal(0.0, 0.4),
    }
    veered = {
        "environment.wind_speed": wind * (1.0 + distance * rng.uniform(-0.1, 0.1)),
        "environment.wind_from": wind_from + distance * rng.normal(0.0, 0.15),
    }
    # From a minute before the loss to two minutes after it.
    times = rng.integers(-60, 120, 2) + int(lost_at)
    return values, [
        Event(time=float(t), override=new) for t, new in zip(times, (turned, veered), strict=True)
    ]


def _setpoints(rng: np.random.Generator, lost_at: float) -> list[Event]:
    """Low-speed manoeuvres: two changes of place and heading, the second up to the loss of thrust."""
    # The second change may last up to the loss.
    times = 40.0, float(rng.integers(110, int(lost_at) + 1))
    return [
        Event(
            time=time,
            override={
                "reference.x_set": rng.uniform(-15.0, 15.0),
                "reference.y_set": rng.uniform(-15.0, 15.0),
                "reference.psi_set": rng.uniform(-pi / 2.0, pi / 2.0),
            },
        )
        for time in times
    ]
