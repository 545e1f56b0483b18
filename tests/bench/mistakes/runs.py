"""Logs with mistakes, drawn and answered."""

import os
import pickle
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from mistakes.craft import boat
from mistakes.mistakes import MISTAKES, draw_mistakes
from mistakes.scoring import answered
from mistakes.visible import is_visible
from truth.cases import run, set_up, write

SHIPS = ("trial", "work", "hold")
SOURCES = (*SHIPS, "boat", "slow rows", "short", "position only")
MINUTES = 20
BASE = 10**6  # keeps streams of different sources apart


def log_of(source, seed, noise=1.0):
    """A right log: a dict of arrays by role; with noise 0 the same log as sensors without noise would give it."""
    if source in SHIPS:
        return _ship(source, seed, noise)
    if source == "boat":
        return boat(seed, noise=noise)
    if source == "slow rows":
        kind = SHIPS[seed % 3]
        log = _ship(kind, seed, noise) if seed % 4 else boat(seed, step=1.0, noise=noise)
        every = (5, 10)[seed % 2] if seed % 4 else 5
        return {role: values[::every] for role, values in log.items()}
    log = _ship(SHIPS[seed % 3], seed, noise) if seed % 2 else boat(seed, noise=noise)
    if source == "short":
        return {role: values[log["time"] - log["time"][0] < 45.0] for role, values in log.items()}
    return {role: log[role] for role in ("time", "north", "east", "heading")}


def _ship(kind, seed, noise):
    """Navigation and wind of a log of the independent truth; kept on disc where MISTAKES_CACHE says."""
    folder = os.environ.get("MISTAKES_CACHE")
    file = Path(folder) / f"{kind}-{seed}-both.pickle" if folder else None
    both = pickle.loads(file.read_bytes()) if file and file.exists() else _simulated(kind, seed)
    if file and not file.exists():
        file.write_bytes(pickle.dumps(both))
    return both[bool(noise)]


@cache
def _simulated(kind, seed):
    """The log without noise and with it; the ship herself has sailed with noisy sensors."""
    setup = set_up(kind, seed, causes=0, minutes=MINUTES)
    record = run([setup, setup])[0]  # NumPy adds up a lone column in another order
    quiet = {
        name: 0.0 * getattr(setup.noise, name) for name in ("slow", "loop", "log", "thrusters")
    }
    setups = replace(setup, noise=replace(setup.noise, **quiet)), setup
    logs = []
    for frame in (write(one, record).log for one in setups):
        log = {name.split(" [")[0]: frame[name].to_numpy(float) for name in frame}
        logs.append(
            {
                role: v
                for role, v in log.items()
                if not role.startswith(("port", "starboard", "tunnel"))
            }
        )
    return logs


def answers(sources, seeds, single=False, draws=4, among=None, most=2):
    """The answer to each log with each of its mistakes, as they come; the first of each log is to it as it is."""
    for source in sources:
        for seed in seeds:
            log, true = log_of(source, seed), log_of(source, seed, noise=0.0)
            rng = np.random.default_rng([seed, SOURCES.index(source), BASE])
            possible = [n for n in among or MISTAKES if set(MISTAKES[n].channels) <= set(log)]
            sets = [(name,) for name in possible] if single else _drawn(rng, log, draws, most)
            for names in [(), *sets]:
                hidden = tuple(name for name in names if not is_visible(log, true, name))
                yield answered(log, source, seed, names, bool(rng.random() < 0.5), hidden)


def _drawn(rng, log, draws, most):
    """Sets of one to `most` mistakes, in turn."""
    sets = []
    while len(sets) < draws:
        names = draw_mistakes(rng, 1 + len(sets) % most)
        if all(set(MISTAKES[name].channels) <= set(log) for name in names):
            sets.append(names)
    return sets
