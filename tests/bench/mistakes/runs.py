"""Logs with mistakes, drawn and answered."""

import os
import pickle
from pathlib import Path

import numpy as np

from mistakes.craft import boat
from mistakes.mistakes import MISTAKES, draw_mistakes
from mistakes.scoring import answered
from truth import draw

SHIPS = ("trial", "work", "hold")
SOURCES = (*SHIPS, "boat", "slow rows", "short", "position only")
MINUTES = 20
BASE = 10**6  # keeps streams of different sources apart


def log_of(source, seed):
    """A right log: a dict of arrays by role."""
    if source in SHIPS:
        return _ship(source, seed)
    if source == "boat":
        return boat(seed)
    if source == "slow rows":
        kind = SHIPS[seed % 3]
        log, every = (_ship(kind, seed), (5, 10)[seed % 2]) if seed % 4 else (boat(seed, step=1.0), 5)
        return {role: values[::every] for role, values in log.items()}
    log = _ship(SHIPS[seed % 3], seed) if seed % 2 else boat(seed)
    if source == "short":
        return {role: values[log["time"] - log["time"][0] < 45.0] for role, values in log.items()}
    return {role: log[role] for role in ("time", "north", "east", "heading")}


def _ship(kind, seed):
    """Navigation and wind of a log of the independent truth; kept on disc where MISTAKES_CACHE says."""
    cache = os.environ.get("MISTAKES_CACHE")
    file = Path(cache) / f"{kind}-{seed}.pickle" if cache else None
    if file and file.exists():
        return pickle.loads(file.read_bytes())
    frame = draw(kind, seed, causes=0, minutes=MINUTES).log
    log = {name.split(" [")[0]: frame[name].to_numpy(float) for name in frame}
    log = {role: v for role, v in log.items() if not role.startswith(("port", "starboard", "tunnel"))}
    if file:
        file.write_bytes(pickle.dumps(log))
    return log


def answers(sources, seeds, single=False, draws=4, among=None):
    """The answer to each log with each of its mistakes, as they come; the first of each log is to it as it is."""
    for source in sources:
        for seed in seeds:
            log, rng = log_of(source, seed), np.random.default_rng([seed, SOURCES.index(source), BASE])
            possible = [n for n in among or MISTAKES if set(MISTAKES[n].channels) <= set(log)]
            sets = [(name,) for name in possible] if single else _drawn(rng, log, draws)
            for names in [(), *sets]:
                yield answered(log, source, seed, names, bool(rng.random() < 0.5))


def _drawn(rng, log, draws):
    """Sets of one or two mistakes, alternately."""
    sets = []
    while len(sets) < draws:
        names = draw_mistakes(rng, 1 + len(sets) % 2)
        if all(set(MISTAKES[name].channels) <= set(log) for name in names):
            sets.append(names)
    return sets
