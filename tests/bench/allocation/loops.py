"""The DP loop over all seeds of wind at once, with any law in it: requests are recorded there, and loops closed."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import dp_loop
import numpy as np

from allocation.laws import LAWS, ROOT, UNITS
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.allocation.units import Allocated
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
    proposed : (n, m, 2, 3) array, optional
        Thrusts and angles before the safety layer of a law that has one. [N, rad]
    """

    step: float
    tau: np.ndarray
    thrusts: np.ndarray
    azimuths: np.ndarray
    seconds: np.ndarray
    available: np.ndarray
    proposed: np.ndarray | None = None


class InLoop:
    """A law for `dp_loop`: one of its kind for each seed, and a record of what they commanded."""

    def __init__(self, name: str):
        self.name, self.laws, self.record = name, [], []

    def design(self, parameters):
        """Nothing that the laws do not make themselves."""

    def at_rest(self, tau, *, parameters):
        """As `pseudo_inverse.at_rest`."""
        self.laws, self.record = [LAWS[self.name]() for _ in tau[0]], []
        return self._state(tau, [law.step((0.0, 0.0, 0.0), (True, True, True), STEP) for law in self.laws])

    def step(self, state, tau, available, h, *, parameters, design):
        """As `pseudo_inverse.step`."""
        tau = [np.asarray(axis, float) for axis in tau]
        usable = [np.broadcast_to(unit, tau[0].shape) for unit in available]
        found = [
            law.step(tuple(float(axis[k]) for axis in tau), tuple(bool(unit[k]) for unit in usable), h)
            for k, law in enumerate(self.laws)
        ]
        self.record.append((tau, usable, found))
        return self._state(tau, found)

    def _state(self, tau, found):
        thrusts, azimuths = np.array([one.thrusts for one in found]), np.array([one.azimuths for one in found])
        X, Y, N = loads(thrusts, azimuths)
        beam = np.full(len(found), 0.5 * np.pi)
        return Allocated(tuple(thrusts.T), (*azimuths.T, beam), X, Y, N, np.zeros(len(found), bool))

    def commanded(self) -> Commanded:
        """What was asked and commanded."""
        asked = np.array([np.transpose(tau) for tau, _, _ in self.record])
        usable = np.array([np.transpose(units) for _, units, _ in self.record])
        thrusts = np.array([[one.thrusts for one in found] for _, _, found in self.record])
        azimuths = np.array([[one.azimuths for one in found] for _, _, found in self.record])
        seconds = np.array([[one.seconds for one in found] for _, _, found in self.record])
        return Commanded(STEP, asked, thrusts, azimuths, seconds, usable)


def loads(thrusts, azimuths):
    """Load of commands by the full configuration matrix: X, Y, N, each of the shape of a thrust. [N, N, N.m]"""
    p = dp_loop.parameters(AllocationParameters)
    port, starboard, tunnel = np.moveaxis(thrusts, -1, 0)
    X, Y, N = 0.0 * tunnel, tunnel, p.tunnel_x * tunnel
    for f, angle, x, y in (
        (port, azimuths[..., 0], p.port_x, p.port_y),
        (starboard, azimuths[..., 1], p.starboard_x, p.starboard_y),
    ):
        along, across = f * np.cos(angle), f * np.sin(angle)
        X, Y, N = X + along, Y + across, N + x * across - y * along
    return X, Y, N


def run(scenario: str, seeds, law: str | None = None, lost: Sequence[str | None] = (None,), until: float = np.inf):
    """A scenario with a law in the loop.

    Parameters
    ----------
    scenario : str
        Of scenarios/.
    seeds : sequence of int
        Of wind and waves; those of the sensors are 100 more.
    law : str, optional
        Of `LAWS`; the generalised inverse of the array form by default.
    lost : sequence of str or None
        Units that stop at `LOST_AT`: all seeds are run with each, side by side; None is a run without a failure.
    until : float
        End of the run, if it is before that of the scenario. [s]

    Returns
    -------
    dict of str to array, Commanded or None
        Signals of `dp_loop.simulate` every 0.1 s, (n, k m); what was commanded, where a law is given.
    """
    asked = read_scenario(ROOT / "scenarios" / f"{scenario}.toml")
    events = [(0.0, _inputs(asked.set)), *((event.time, _inputs(event.override)) for event in asked.events)]
    fails = {f"{unit}_failed": np.repeat([name == unit for name in lost], len(seeds)) for unit in UNITS}
    events.append((LOST_AT, {name: which for name, which in fails.items() if which.any()}))
    known = {field.name for field in fields(dp_loop.EnvironmentParameters)} - {"seed"}
    weather = {name: value for name, value in _settings(asked.set, "environment").items() if name in known}
    variations = np.tile(seeds, len(lost))
    system = dp_loop.with_seeds(variations, **weather)
    inside = InLoop(law) if law else None
    if inside:
        system = replace(system, law=inside)
    stop = min(asked.stop_time, until)
    signals = dp_loop.simulate(system, events, variations=len(variations), stop_time=stop, h=STEP, every=2)
    return signals, inside.commanded() if inside else None


def requests(scenario: str, seeds) -> np.ndarray:
    """Requests of the controller with the generalised inverse in the loop, every 0.1 s, (n, m, 3). [N, N, N.m]"""
    signals, _ = run(scenario, seeds)
    return np.stack([signals[f"controller.tau_{axis}_cmd"] for axis in "XYN"], -1)


def replay(law: str, asked: np.ndarray, available: np.ndarray | None = None, step: float = 0.1) -> Commanded:
    """What a law commands on requests, (n, m, 3), at rest before each seed; all units can be used by default."""
    usable = np.ones(asked.shape, bool) if available is None else available
    thrusts, azimuths = np.zeros(asked.shape), np.zeros((*asked.shape[:2], 2))
    seconds, proposed = np.zeros(asked.shape[:2]), np.zeros((*asked.shape[:2], 2, 3))
    for seed in range(asked.shape[1]):
        one = LAWS[law]()
        for k, (tau, units) in enumerate(zip(asked[:, seed].tolist(), usable[:, seed].tolist(), strict=True)):
            thrusts[k, seed], azimuths[k, seed], seconds[k, seed], before = one.step(tau, units, step)
            if before is not None:
                proposed[k, seed] = before
    return Commanded(step, asked, thrusts, azimuths, seconds, usable, proposed if proposed.any() else None)


def _settings(given, component):
    """Values of a component's connectors in SI units; radians are the only unit that these scenarios write."""
    own = {name.partition(".")[2]: value for name, value in given.items() if name.startswith(f"{component}.")}
    radians = spelled_unit("rad")
    return {name: number_in(value, radians) if isinstance(value, str) else value for name, value in own.items()}


def _inputs(given):
    """Fields of `dp_loop.Inputs` that a scenario sets."""
    values = _settings(given, "environment") | _settings(given, "reference")
    return {name: value for name, value in values.items() if name in dp_loop.Inputs._fields}
