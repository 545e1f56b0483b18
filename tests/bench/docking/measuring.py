"""Records of dockings, kept a docking at a time, and what is measured of predictors over them."""

import os
import pickle
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np

from docking.rivals import PREDICTORS, ROOT
from shipcosim.learn.docking import dockings, predictions, regions, training
from shipcosim.learn.docking.inputs import Replay, ShipModel, replay
from shipcosim.learn.docking.records import Record
from shipcosim.library import build_stale
from shipcosim.models.prediction import docking, docking_laws, helm

FOLDER = ROOT / "results" / "docking"
EVERY = 45
"""Predictions that are drawn are made so many seconds apart. [s] Paper III, Fig. 6."""


def recorded(seed: int, folder: Path = FOLDER) -> Record | None:
    """The record of a docking, sailed where nobody has sailed it; none of one that does not end in time."""
    path = folder / f"record-{seed}.pickle"
    if not path.exists():
        build_stale(ROOT)
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}")
        found = dockings.sail_all([dockings.draw(seed)], processes=1)
        part.write_bytes(pickle.dumps(found[0] if found else None))
        os.replace(part, path)
    return pickle.loads(path.read_bytes())


def measure(
    records: Sequence[Record], model: ShipModel, names: Sequence[str] = tuple(PREDICTORS)
) -> dict:
    """How far off predictions are from every second of dockings, by predictor.

    Returns
    -------
    dict of str to dict
        `error` (m, 30): mean distance by docking and horizon [m]; `heading` (m, 3) likewise at 10, 20, 30 s [rad];
        `inside` (m, 3) share within the regions, none where a predictor has none; `inside_heading`; `radius` mean
        radius [m]; `learned` (m,) mean share of what is learned.
    """
    replayed = replay(records, model)
    return {name: _measured(name, replayed, model) for name in names}


def _measured(name: str, replayed: Replay, model: ShipModel) -> dict[str, np.ndarray]:
    predicted = PREDICTORS[name](replayed, model)
    error = []
    for horizon, (x, y, _) in enumerate(predicted.places, 1):
        off = np.hypot(replayed.truth["x"][horizon] - x, replayed.truth["y"][horizon] - y)
        error.append(np.nanmean(off, axis=-1))
    position, heading = regions.misses(predicted.places, replayed.truth)
    found = {"error": np.stack(error, axis=-1), "heading": np.nanmean(heading, axis=-1).T}
    found["learned"] = predicted.share.mean(axis=-1)
    widths = _widths(name)
    if widths is not None:
        radii, halves = docking.regions(widths, predictions.own_record(predicted.places, replayed))
        for key, missed, sizes in (
            ("inside", position, radii),
            ("inside_heading", heading, halves),
        ):
            within = np.where(np.isfinite(missed), missed <= np.stack(sizes), np.nan)
            found[key] = np.nanmean(within, axis=-1).T
        found["radius"] = np.stack(radii).mean(axis=-1).T
    return found


def _widths(name):
    from docking.rivals import arrays

    kept = {
        "kinetic": ("ours", "kinetic_widths"),
        "paper III": ("paper-iii", "widths"),
        "ours": ("ours", "widths"),
    }
    return arrays(kept[name][0])[kept[name][1]] if name in kept else None


def step_time(variant: str, record: Record, model: ShipModel, seconds: int = 200) -> float:
    """Median time of a prediction as the FMU makes it. [s]"""
    from docking.rivals import arrays

    law = docking_laws.law_of(variant, arrays("paper-iii" if variant == "paper-iii" else "ours"))
    laws, times, state = docking_laws.Model(model.hull, model.wind, model.helm), [], None
    for k in range(seconds):
        known = {key: float(values[k]) for key, values in record.known.items()}
        before = perf_counter()
        aboard = helm.aboard_of(known, model.mast)
        state = law.follow(state, aboard, laws) if state else law.begin(aboard, laws)
        _, _, state = law.predict(state, laws)
        times.append(perf_counter() - before)
    return float(np.median(times))


def track(record: Record, model: ShipModel, names: Sequence[str]) -> dict:
    """Way of a docking, and predictions of some predictors every `EVERY` seconds, for the picture."""
    replayed = replay([record], model)
    starts = range(0, replayed.start.x.shape[1] - 30, EVERY)
    found = {"x": replayed.truth["x"][0, 0], "y": replayed.truth["y"][0, 0], "starts": list(starts)}
    for name in names:
        places = PREDICTORS[name](replayed, model).places
        found[name] = [
            [[float(one[k][0, start]) for one in places] for k in (0, 1)] for start in starts
        ]
    return found


def ship() -> ShipModel:
    """The ship as the predictor knows her."""
    return training.ship()
