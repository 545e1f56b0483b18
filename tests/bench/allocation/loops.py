"""The DP loop over many seeds of wind, with any FMU for its law: requests are recorded there, and loops closed."""

from collections.abc import Sequence
from dataclasses import dataclass

import dp_runs
import numpy as np
from ships import parameters

from allocation.laws import LAWS, ROOT, UNITS
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.scenario import read_scenario
from shipcosim.units import number_in, spelled_unit

STEP = 0.05  # s, of the scenarios
SCENARIOS = ("four_corner", "stationkeeping")
LOST_AT = 300.0  # s: the wind has turned and the ship has come to rest


@dataclass(frozen=True)
class Commanded:
    """What a law was asked and what it commanded, over n steps and m seeds.

    Attributes
    ----------
    step : float
        [s]
    tau : (n, m, 3) array
        Requests. [N, N, N.m]
    thrusts : (n, m, 3) array
        Of port, starboard, tunnel. [N]
    azimuths : (n, m, 2) array
        Of port and starboard. [rad]
    seconds : (n, m) array
        Time that each allocation took. [s]
    available : (n, m, 3) array of bool
        Whether port, starboard and tunnel could be used.
    """

    step: float
    tau: np.ndarray
    thrusts: np.ndarray
    azimuths: np.ndarray
    seconds: np.ndarray
    available: np.ndarray


def loads(thrusts, azimuths):
    """Load of commands by the full configuration matrix: X, Y, N, each of the shape of a thrust. [N, N, N.m]"""
    p = parameters(AllocationParameters)
    port, starboard, tunnel = np.moveaxis(thrusts, -1, 0)
    X, Y, N = 0.0 * tunnel, tunnel, p.tunnel_x * tunnel
    for f, angle, x, y in (
        (port, azimuths[..., 0], p.port_x, p.port_y),
        (starboard, azimuths[..., 1], p.starboard_x, p.starboard_y),
    ):
        along, across = f * np.cos(angle), f * np.sin(angle)
        X, Y, N = X + along, Y + across, N + x * across - y * along
    return X, Y, N


def run(
    scenario: str,
    seeds,
    law: str | None = None,
    lost: Sequence[str | None] = (None,),
    until: float = np.inf,
):
    """A scenario with a law in the loop.

    Parameters
    ----------
    scenario : str
        Of scenarios/.
    seeds : sequence of int
        Of wind and waves; those of the sensors are 100 more.
    law : str, optional
        Of `LAWS`; the generalised inverse of the system by default.
    lost : sequence of str or None
        Units that stop at `LOST_AT`: all seeds are run with each, side by side; None is a run without a failure.
    until : float
        End of the run, if it is before that of the scenario. [s]

    Returns
    -------
    dict of str to array, Commanded or None
        Signals every 0.1 s, (n, k m); what was commanded at every step, where a law is given.
    """
    asked = read_scenario(ROOT / "scenarios" / f"{scenario}.toml")
    events = [(event.time, _in_si(event.override)) for event in asked.events]
    variations = np.tile(seeds, len(lost))
    for unit in UNITS:
        which = np.repeat([name == unit for name in lost], len(seeds))
        events += [(LOST_AT, {f"{unit}.failed": which})] if which.any() else []
    values = {
        name: value for name, value in _in_si(asked.set).items() if not name.endswith(".seed")
    }
    component, _, variant = (law or "").partition(", ")
    swapped = {"allocator": component} if law else None
    if variant:
        values["allocator.variant"] = VARIANTS[variant]
    if law:
        values["allocator.measure_solve_time"] = True
    shown = ["vessel", "reference", *UNITS, "controller", "allocator"]
    found = dp_runs.simulate(
        variations,
        values,
        events,
        stop_time=min(asked.stop_time, until),
        h=STEP,
        record=shown,
        components=swapped,
    )
    return {name: column[::2] for name, column in found.items()}, _commanded(found) if law else None


VARIANTS = {"walks": "paper-v-walks"}
"""What stands behind the name of a law in `LAWS`, and the parameter of its FMU."""


def _commanded(found):
    """What was asked and commanded in runs: what is asked in a row is answered in the next."""

    def stacked(names, rows):
        return np.stack([found[name][rows] for name in names], -1)

    asked, given = slice(None, -1), slice(1, None)

    return Commanded(
        STEP,
        stacked([f"controller.tau_{axis}_cmd" for axis in "XYN"], asked),
        stacked([f"allocator.{unit}_thrust_cmd" for unit in UNITS], given),
        stacked([f"allocator.{unit}_azimuth_cmd" for unit in UNITS[:2]], given),
        found["allocator.solve_time"][given],
        stacked([f"{unit}.available" for unit in UNITS], asked).astype(bool),
    )


def requests(scenario: str, seeds) -> np.ndarray:
    """Requests of the controller with the generalised inverse in the loop, every 0.1 s, (n, m, 3). [N, N, N.m]"""
    signals, _ = run(scenario, seeds)
    return np.stack([signals[f"controller.tau_{axis}_cmd"] for axis in "XYN"], -1)


def replay(
    law: str, asked: np.ndarray, available: np.ndarray | None = None, step: float = 0.1
) -> Commanded:
    """What a law commands on requests, (n, m, 3), at rest before each seed; all units can be used by default."""
    usable = np.ones(asked.shape, bool) if available is None else available
    thrusts, azimuths = np.zeros(asked.shape), np.zeros((*asked.shape[:2], 2))
    seconds = np.zeros(asked.shape[:2])
    for seed in range(asked.shape[1]):
        one = LAWS[law]()
        for k, (tau, units) in enumerate(
            zip(asked[:, seed].tolist(), usable[:, seed].tolist(), strict=True)
        ):
            thrusts[k, seed], azimuths[k, seed], seconds[k, seed] = one.step(tau, units, step)
    return Commanded(step, asked, thrusts, azimuths, seconds, usable)


def _in_si(given):
    """Values in SI units; radians are the only unit that these scenarios write."""
    radians = spelled_unit("rad")
    return {
        name: number_in(value, radians) if isinstance(value, str) else value
        for name, value in given.items()
    }
