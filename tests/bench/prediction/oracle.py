"""The bound of drift prediction: an oracle that knows the true ship and the moment, and nothing of the future.

It has the true ship with her state and memory, the run-down of thrust, and the current, mean wind and mean wave drift
of the moment. What it still misses is weather to come: no predictor that knows only the past can do clearly better.
`python tests/bench/prediction/oracle.py --seeds 9601:9625` prints the share of the closable.
"""

import argparse
import sys
from collections.abc import Sequence
from copy import copy
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # prediction; ships

from prediction import measuring, pages  # noqa: E402
from prediction.acting import source_of  # noqa: E402
from prediction.rivals import fmu_class  # noqa: E402
from shipcosim.angles import wrap_series  # noqa: E402
from shipcosim.cosim import simulate, system_of  # noqa: E402
from shipcosim.interfaces.predictor import HORIZONS  # noqa: E402
from shipcosim.learn.prediction.worlds import KNOWN, TRUTH, draw, scenario  # noqa: E402
from shipcosim.models.core.motion import Motion  # noqa: E402
from shipcosim.models.environment.wave_loads import drift_table  # noqa: E402
from shipcosim.models.environment.wave_motion import wave_response  # noqa: E402
from shipcosim.models.environment.waves import components  # noqa: E402

STEP = 0.5
"""Of the integration. [s] With the future known it leaves errors of centimetres: a test holds that."""
HEADINGS = np.linspace(-np.pi, np.pi, 37)
"""At which the mean wave drift is worked out. [rad]"""
SPACING = 3.0
"""Of the times before the loss over which it is the mean. [s] Not a multiple of the wave periods, 4 to 7 s."""
WAVES = ("wave_height", "wave_period", "wave_from", "wave_peak_enhancement", "wave_seed")
SURROUNDINGS = (
    *(
        f"environment.{name}"
        for name in ("wind_north", "wind_east", "current_north", "current_east")
    ),
    *(f"environment.{name}" for name in WAVES),
    *("environment.wind_speed_mean", "environment.wind_from_mean"),
    *(f"vessel.tau_{load}_{axis}" for load in ("thrusters", "drift") for axis in "XYN"),
)
Measures = dict[str, list[dict[str, np.ndarray]]]
"""By predictor: what was measured, a world after another."""
RIVALS = (
    "constant velocity",
    "kinetic of the thesis",
    "kinetic without current",
    "kinetic",
    "paper IV",
    "ours",
)


def sailed(seed: int, folder: Path = measuring.FOLDER) -> dict[str, np.ndarray]:
    """True surroundings of a world at 1 Hz, by signal, and `truth`; leaves the record for the rivals as well."""
    path = folder / f"surroundings-{seed}-1.npz"
    if not path.exists():
        world = draw(seed)
        what = scenario(world)
        table = simulate(system_of(what), what)
        time = np.asarray(table["time"], float)
        truth = np.column_stack([np.asarray(table[f"vessel.{name}"], float) for name in TRUTH])
        known = np.column_stack([np.asarray(table[source_of(name)], float) for name in KNOWN])
        fields = {"seed": seed, "lost_at": world.lost_at, "time": time, "truth": truth}
        measuring.save(folder / f"record-{seed}-1.npz", known=known, **fields)
        values = {name: np.asarray(table[name], float) for name in SURROUNDINGS}
        measuring.save(path, **fields, **values)
    with np.load(path) as kept:
        return dict(kept)


def true_ship(seed: int):
    """The ship of a world, in calm water."""
    what = scenario(draw(seed))
    start = system_of(what).components["vessel"].start
    drawn = {
        name.removeprefix("vessel."): value
        for name, value in what.set.items()
        if name.startswith("vessel.")
    }
    fmu = fmu_class("rough_vessel")()
    for name, value in {**start, **drawn}.items():
        # Numbers of the file are texts; tables stay texts.
        given = getattr(fmu, name)
        setattr(fmu, name, type(given)(value) if isinstance(given, float) else value)
    fmu.start()
    return fmu


def errors(
    seed: int,
    sea: dict[str, np.ndarray],
    *,
    future: bool = False,
    starts: Sequence[int] = measuring.STARTS,
):
    """Errors of the oracle after the loss of thrust.

    Parameters
    ----------
    seed : int
        Of the world.
    sea : dict of str to array
        As `sailed` gives it.
    future : bool
        Whether it is given the wind, current and wave drift to come: then it must miss nearly nothing.
    starts : sequence of int
        Seconds after the loss. [s]

    Returns
    -------
    (starts, horizons, 3) array
        North, east, heading. [m, m, rad]
    """
    ship = true_ship(seed)
    drift = mean_drift(ship, sea)
    lost = int(np.flatnonzero(sea["time"] == sea["lost_at"])[0])
    found = []
    for row in range(lost + max(starts) + 1):
        _place(ship, sea, row)
        if row == 0:
            ship.settle()
        if row - lost in starts:
            found.append(_missed(copy(ship), sea, row, drift, future))
        ship.remember(1.0)
    return np.array(found)


def mean_drift(ship, sea: dict[str, np.ndarray]) -> np.ndarray:
    """Mean wave drift of the sea before the loss by heading, (3, headings), in body axes at rest. [N, N, N.m]"""
    values = [float(sea[f"environment.{name}"][0]) for name in WAVES]
    height, period, source, enhancement, wave_seed = values
    wave = components(height, period, source, enhancement, round(wave_seed))
    table = drift_table(ship.drift.drift_table)
    hull = ship.hull
    size = {"length": hull.length, "breadth": hull.breadth, "draught": hull.draught}
    times = np.arange(0.0, float(sea["lost_at"]), SPACING)
    loads = [
        [
            wave_response(time, 0.0, 0.0, psi, 0.0, 0.0, wave, table, **size)[0]
            for time in times.tolist()
        ]
        for psi in HEADINGS.tolist()
    ]
    return np.mean(loads, axis=1).T


def _place(ship, sea, row):
    """Give the ship her true state, and the water she is in."""
    ship.state = Motion(*map(float, sea["truth"][row]))
    ship.current_north = float(sea["environment.current_north"][row])
    ship.current_east = float(sea["environment.current_east"][row])
    ship.water = ship.current_north, ship.current_east


def _missed(ship, sea, row, drift, future):
    """Integrate the true ship from a row on, and compare her at the horizons."""
    # Mean wind of the moment, towards north and east.
    speed, source = (sea[f"environment.wind_{name}_mean"][row] for name in ("speed", "from"))
    wind = -speed * np.cos(source), -speed * np.sin(source)
    # The sea of the ship is calm: her wave drift comes from here.
    ship.wave_height = 0.0
    off = []
    for step in range(round(max(HORIZONS) / STEP)):
        ahead = row + step * STEP
        if future:
            wind = [_at(sea[f"environment.wind_{name}"], ahead) for name in ("north", "east")]
            ship.current_north, ship.current_east = (
                _at(sea[f"environment.current_{name}"], ahead) for name in ("north", "east")
            )
            load = [_at(sea[f"vessel.tau_drift_{axis}"], ahead) for axis in "XYN"]
        else:
            load = [np.interp(ship.state.psi, HEADINGS, one) for one in drift]
        ship.wind_north, ship.wind_east = (float(one) for one in wind)
        # Thrust runs down as it truly does: after the loss that is no choice of anybody.
        thrust = [_at(sea[f"vessel.tau_thrusters_{axis}"], ahead) for axis in "XYN"]
        ship.tau_X_1, ship.tau_Y_1, ship.tau_N_1 = (
            float(a + b) for a, b in zip(load, thrust, strict=True)
        )
        ship.step(step * STEP, STEP)
        passed = (step + 1) * STEP
        if passed in HORIZONS:
            x, y, psi = sea["truth"][row + round(passed), :3]
            turned = float(wrap_series(ship.state.psi - psi, 2.0 * np.pi))
            off.append([ship.state.x - x, ship.state.y - y, turned])
    return off


def _at(values, row):
    """Value between two rows, at the middle of the step."""
    return np.interp(row + 0.5 * STEP, np.arange(len(values)), values)


def measured(seed: int, folder: Path = measuring.FOLDER) -> dict[str, np.ndarray]:
    """Errors of the oracle in a world, kept as those of predictors are."""
    path = folder / f"oracle-{seed}-1.npz"
    if not path.exists():
        measuring.save(path, errors=errors(seed, sailed(seed, folder)))
    with np.load(path) as kept:
        return dict(kept)


def closable(rival: np.ndarray, ours: np.ndarray, oracle: np.ndarray) -> tuple[float, float, float]:
    """Share of the closable, (rival - ours) / (rival - oracle), and its 95 % interval over worlds; (worlds,) each."""
    share, low, high = pages.interval(rival - ours, rival - oracle)
    return float(share), float(low), float(high)


def page(found: Measures) -> str:
    """Errors of all predictors and of the oracle, and the share of the closable, 60 s ahead."""
    text = ""
    for first in pages.FIRST:
        off = {name: pages.by_world(worlds, first)[:, -1] for name, worlds in found.items()}
        rows = []
        for name, sizes in off.items():
            mean, low, high = pages.interval(sizes)
            cells = [f"{mean[a]:.2f} ({low[a]:.2f} to {high[a]:.2f})" for a in range(4)]
            for a in (3, 2):
                if name in ("kinetic", "oracle"):
                    cells.append("")
                    continue
                share = closable(off["kinetic"][:, a], sizes[:, a], off["oracle"][:, a])
                cells.append("{:.0f} % ({:.0f} to {:.0f})".format(*(100.0 * one for one in share)))
            rows.append((name, *cells))
        head = (f"first {first} starts", "north [m]", "east [m]", "yaw [deg]", "place [m]")
        text += pages.table((*head, "closed, place", "closed, yaw"), rows) + "\n"
    return text


def worst_tenth(found: Measures) -> str:
    """Place of ours against kinetic 60 s ahead, in each tenth of the starts by what the kinetic one misses."""
    off = {name: np.array([one["errors"] for one in found[name]]) for name in ("kinetic", "ours")}
    place = {
        name: np.hypot(one[:, :, -1, 0], one[:, :, -1, 1]).ravel() for name, one in off.items()
    }
    tenths = np.array_split(np.argsort(place["kinetic"]), 10)
    cells = [
        f"{100.0 * (place['ours'][rows].mean() / place['kinetic'][rows].mean() - 1.0):+.0f} %"
        for rows in tenths
    ]
    head = ("tenth of starts", *(str(k) for k in range(1, 11)))
    return pages.table(head, [("ours against kinetic, place", *cells)])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="9601:9625", help="FROM:TO of worlds")
    parser.add_argument("--into", type=Path, default=measuring.FOLDER, help="records and measures")
    options = parser.parse_args(arguments)
    found = {name: [] for name in (*RIVALS, "oracle")}
    for seed in range(*map(int, options.seeds.split(":"))):
        found["oracle"].append(measured(seed, options.into))
        for name in RIVALS:
            found[name].append(measuring.measured(name, seed, 1.0, options.into))
    print(page(found))
    print(worst_tenth(found))


if __name__ == "__main__":
    main()
