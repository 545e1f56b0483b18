"""Dockings: a seed gives weather, helmsman and harbour; co-simulation gives the record.

The ship is always the same: a ship learns from her own data. She differs from her model in
numbers (within tolerances), in form, and by a load that is new each time. The predictor knows
none of this.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi

import numpy as np

from shipcosim.cosim import simulate
from shipcosim.learn.docking.harbours import FAMILIAR, UNSEEN, Harbour, harbour
from shipcosim.learn.docking.records import KNOWN, TRUTH, Record
from shipcosim.learn.training import Progress
from shipcosim.learn.true_ships import (
    DAMPING,
    MEMORY,
    POWER,
    SPEEDS,
    STRIPS,
    WIND,
    TrueLoads,
    factors,
    sailed,
    system_with,
)
from shipcosim.models.core.tables import text
from shipcosim.scenario import Scenario
from shipcosim.ssp import System

SYSTEM = "gunnerus_docking"
PARAMETERS = "gunnerus-28m9"
PREDICTOR = "docking_predictor"
TRUE = {"vessel": "rough_vessel"}
TRAINING = range(1, 69)
CALIBRATION = range(200, 230)
CHOICES = range(300, 320)
"""Seeds of dockings at familiar harbours: to train on, to calibrate regions on, and to choose by."""
HELD_OUT = range(8300, 8320)
HELD_OUT_UNSEEN = range(8320, 8340)
"""Seeds of dockings that nobody looks at before the end, at familiar and at unseen harbours."""
SAMPLES = 1000
STEP = 0.2
STOP = 1500.0
"""Length of a record; step and latest end of the co-simulation. [1, s, s]"""
LOADING = 0.03
"""Most at distance 1 of the mass that a docking has more or less, over the ship's. [1]"""
CROSS_FLOW = 0.27
SPEED_LOSS = 0.1
ANGLE_LOSS = 0.1
"""At distance 1: cross-flow drag that stands for half of the quadratic damping in sway, loss of the tunnel's thrust
under way, loss of azimuths athwartships. [1, s2/m2, 1]"""


@dataclass(frozen=True)
class Docking:
    """One docking: helmsman, harbour and weather.

    Parameters
    ----------
    seed : int
        From which it was drawn. [1]
    harbour : int
        Number of the harbour. [1]
    set : dict
        Start values that differ from those of the system.
    """

    seed: int
    harbour: int
    set: dict


def draw(seed: int, distance: float = 1.0) -> Docking:
    """Draw a docking.

    Parameters
    ----------
    seed : int
        Of `HELD_OUT_UNSEEN` at an unseen harbour, others at a familiar one; those of training call at each. [1]
    distance : float
        How far truth and nominal model are apart: 0 alike, 1 the tolerances, 2 outside of them. [1]

    Returns
    -------
    Docking
        To be sailed.
    """
    # Harbour, helmsman and weather, all from one seed.
    rng = np.random.default_rng([26, 3, 2, seed])
    port = harbour(_number(seed, rng))
    manner, length = _manner(rng, seed)
    values = _weather(rng, port, seed) | manner
    # She starts at the first waypoint, on the course to the second, at transit speed.
    first, *others = port.waypoints(manner["helmsman.stand_off"], length)
    values |= {
        "helmsman.waypoints": text([first, *others]),
        "helmsman.berth_heading": port.berth_heading,
        "helmsman.berth_side": port.berth_side,
        "vessel.x_start": first[0],
        "vessel.y_start": first[1],
        "vessel.psi_start": float(np.arctan2(others[0][1] - first[1], others[0][0] - first[0])),
        "vessel.u_start": manner["helmsman.transit_speed"],
        "vessel.mass_scale": 1.0 + distance * LOADING * rng.uniform(-1.0, 1.0),
    }
    # Differences of the ship from her model come last: they are the same at every docking.
    return Docking(seed, port.number, values | true_ship(distance))


def scenario(docking: Docking) -> Scenario:
    """The scenario of a docking, for `shipcosim.cosim.simulate`.

    Parameters
    ----------
    docking : Docking
        As drawn.

    Returns
    -------
    Scenario
        With the FMU `rough_vessel` in the vessel's place.
    """
    return Scenario(
        description=f"Docking {docking.seed} at harbour {docking.harbour}",
        system=SYSTEM,
        parameters=[PARAMETERS],
        components=TRUE,
        stop_time=STOP,
        step_size=STEP,
        output_interval=1.0,
        set=docking.set,
    )


def sail(docking: Docking) -> Record:
    """Co-simulate a docking.

    Parameters
    ----------
    docking : Docking
        As drawn.

    Returns
    -------
    Record
        The last 1000 s before she lies at the berth.

    Raises
    ------
    RuntimeError
        She is not there after `STOP`, or too early.
    """
    # The predictor acts on nothing, so the run leaves it out.
    table = simulate(_without_predictor(), scenario(docking))
    # Stage 3 of the helmsman: she lies at the berth.
    moored = np.flatnonzero(np.asarray(table["helmsman.stage"]) == 3)
    if not len(moored) or moored[0] < SAMPLES:
        raise RuntimeError(
            f"docking {docking.seed}: lies at the berth too early or never: after {moored[:1]} s"
        )
    # Keep the last 1000 s before that; measurements and truth stay apart.
    last = slice(moored[0] + 1 - SAMPLES, moored[0] + 1)
    measured = {name: np.asarray(table[signal], float)[last] for name, signal in KNOWN.items()}
    truth = {name: np.asarray(table[f"vessel.{name}"], float)[last] for name in TRUTH}
    return Record(docking.seed, docking.harbour, np.arange(float(SAMPLES)), measured, truth)


def sail_all(
    dockings: Iterable[Docking],
    *,
    processes: int = 2,
    progress: Progress | None = None,
) -> list[Record]:
    """Co-simulate several dockings, in their order; those that `sail` refuses are left out.

    Parameters
    ----------
    dockings : iterable of Docking
        As drawn.
    processes : int
        How many sail at a time. [1]
    progress : callable, optional
        Called with how many are done, and of how many.

    Returns
    -------
    list of Record
        One a docking that ends in time.
    """
    return [record for record in sailed(_sailed, list(dockings), processes, progress) if record]


def _sailed(docking: Docking) -> Record | None:
    try:
        return sail(docking)
    except RuntimeError:
        return None


def true_ship(distance: float = 1.0) -> dict[str, float | str]:
    """Differences of the ship from her model; the same at every docking.

    Parameters
    ----------
    distance : float
        How far truth and nominal model are apart. [1]

    Returns
    -------
    dict of str to float or str
        Start values, by component and variable.
    """
    # Numbers within their tolerances, as standard deviations.
    rng = np.random.default_rng([26, 3, 1])
    values = {
        name: value + distance * off * rng.standard_normal() for name, value, off in _tolerated()
    }
    # The coupling of added mass is symmetric: A62 = A26.
    values["vessel.A62"] = values["vessel.A26"]
    # Form errors: drag along the hull, wind around her, powers of speed, memory of added mass.
    along = factors(rng, 5, STRIPS, distance)
    around = factors(rng, (8, 3), WIND, distance)
    powers = 2.0 + distance * POWER * rng.uniform(-1.0, 1.0, 2)
    memory = distance * MEMORY * rng.uniform(0.0, 1.0, 3)
    # Linear damping, in proportion to the quadratic damping at low speed.
    quadratic = [values[f"vessel.{name}"] for name in ("X_uu", "Y_modvv", "N_modrr")]
    damping = distance * DAMPING * rng.uniform(0.0, 1.0, 3) * SPEEDS * quadratic
    # At distance 1 cross-flow drag replaces half of the quadratic damping in sway and yaw.
    half = 0.5 * distance
    form = TrueLoads(along, around, powers, damping, memory)
    return values | {
        "vessel.cross_flow_drag": CROSS_FLOW * distance,
        "vessel.Y_modvv": (1.0 - half) * quadratic[1],
        "vessel.N_modrr": (1.0 - half) * quadratic[2],
        "tunnel.speed_loss": SPEED_LOSS * distance,
        "port.angle_loss": ANGLE_LOSS * distance,
        "starboard.angle_loss": ANGLE_LOSS * distance,
        **form.values(),
    }


@lru_cache(maxsize=1)
def _without_predictor() -> System:
    """The system without the predictor, which acts on nothing."""
    system = system_with(SYSTEM, PARAMETERS, TRUE)
    # Remove the component and all connections into it.
    components = {
        name: component for name, component in system.components.items() if name != PREDICTOR
    }
    connections = tuple(
        connection for connection in system.connections if connection.target[0] != PREDICTOR
    )
    return replace(system, components=components, connections=connections)


@lru_cache(maxsize=1)
def _tolerated() -> tuple[tuple[str, float, float], ...]:
    """Name, value and tolerance of each parameter of ship and thrusters with a tolerance."""
    system = system_with(SYSTEM, PARAMETERS)
    numbers = []
    for name in ("vessel", "port", "starboard", "tunnel"):
        component = system.components[name]
        numbers += [
            (f"{name}.{variable}", float(component.start[variable]), tolerance)
            for variable, tolerance in sorted(component.tolerances.items())
        ]
    return tuple(numbers)


def _number(seed, rng):
    """Number of the harbour: the home port most often."""
    if seed in HELD_OUT_UNSEEN:
        return UNSEEN[seed % len(UNSEEN)]
    # The lower the number of a harbour, the more often it is called at, as 1/number.
    often = 1.0 / np.array(FAMILIAR)
    drawn = int(rng.choice(FAMILIAR, p=often / often.sum()))
    # The first seeds call at each familiar harbour once.
    return seed if seed in FAMILIAR else drawn


def _manner(rng, seed):
    """Manner of this helmsman, and the length of the way, some 1100 s. [as the fields say, m]"""
    # Closing speed follows from distance and time constant, so that he can stop.
    closing = rng.uniform(35.0, 70.0)
    place_time = rng.uniform(45.0, 80.0)
    fast = rng.uniform(4.0, 5.6)
    slow = min(closing / place_time * rng.uniform(0.9, 1.4), 1.5)
    slowing = rng.uniform(500.0, 1300.0)
    # Time constant of yaw: longer for a helmsman who looks seldom and reacts late.
    look = rng.uniform(2.0, 6.0)
    reaction = rng.uniform(0.7, 2.0)
    yaw_time = 4.0 + look + reaction
    manner = {
        "transit_speed": fast,
        "closing_speed": slow,
        "sideways_speed": rng.uniform(0.15, 0.35),
        "slowing_distance": slowing,
        "closing_distance": closing,
        "stand_off": rng.uniform(8.0, 22.0),
        "speed_time": rng.uniform(18.0, 32.0),
        "place_time": place_time,
        "heading_time": yaw_time * rng.uniform(2.0, 3.0),
        "yaw_time": yaw_time,
        "yaw_rate": rng.uniform(0.012, 0.03),
        "wind_feel": rng.uniform(0.3, 1.0),
        "look_interval": look,
        "reaction_time": reaction,
        "lever_step": rng.uniform(0.03, 0.08),
        "angle_step": rng.uniform(0.025, 0.06),
        "lurch": rng.uniform(0.0, 0.25),
        "seed": seed,
    }
    # Length so that transit, slowing and closing take some 1100 s together.
    length = closing + slowing + fast * max(800.0 - 2.0 * slowing / (fast + slow), 60.0)
    return {f"helmsman.{name}": value for name, value in manner.items()}, length


def _weather(rng, port: Harbour, seed):
    """Wind, tide, river and sea, and the errors of the sensors of this day."""
    wind_from = rng.uniform(-pi, pi)
    # Tide along the first leg: ebb is the same current in the opposite direction.
    tide = port.tide * rng.uniform(-1.0, 1.0)
    # The sea comes with the wind; sensors have a seed of their own.
    values = {
        "environment.wind_speed": rng.uniform(0.0, 10.0),
        "environment.wind_from": wind_from,
        "environment.current_speed": abs(tide),
        "environment.current_to": port.courses[0]
        + (pi if tide < 0.0 else 0.0)
        + rng.normal(0.0, 0.2),
        "environment.significant_wave_height": rng.uniform(0.0, 0.2),
        "environment.peak_period": rng.uniform(2.5, 4.0),
        "environment.waves_from": wind_from,
        "environment.gust_scale": rng.uniform(0.7, 1.3),
        "environment.seed": seed,
        "sensors.seed": 20000 + seed,
    }
    # Land and river of the harbour; the river's flow varies by day.
    values |= {f"harbour.{name}": value for name, value in port.land.items()}
    values["harbour.river_speed"] *= rng.uniform(0.5, 1.4)
    return values
