"""What is measured of a predictor in a world, kept a world at a time: what stands there is not redone."""

import os
from pathlib import Path
from time import process_time

import numpy as np

from prediction.rivals import PREDICTORS, ROOT
from shipcosim.angles import wrap_series
from shipcosim.interfaces.predictor import HORIZONS
from shipcosim.learn.prediction.worlds import KNOWN, Record, draw, sail

FOLDER = ROOT / "results" / "prediction"
STARTS = range(1, 21)
"""Seconds after the loss of thrust at which predictions start: at 0 s the ship does not know of it yet. [s]"""


def recorded(seed: int, distance: float, folder: Path = FOLDER) -> Record:
    """The record of a world, sailed where nobody has sailed it."""
    path = folder / f"record-{seed}-{distance:g}.npz"
    if not path.exists():
        record = sail(draw(seed, distance))
        save(
            path,
            seed=seed,
            lost_at=record.lost_at,
            time=record.time,
            known=record.known,
            truth=record.truth,
        )
    with np.load(path) as kept:
        return Record(
            int(kept["seed"]), float(kept["lost_at"]), kept["time"], kept["known"], kept["truth"]
        )


def measured(name: str, seed: int, distance: float, folder: Path = FOLDER) -> dict[str, np.ndarray]:
    """Measures of a predictor in a world, as `measure` gives them."""
    path = folder / f"{name.replace(' ', '-')}-{seed}-{distance:g}.npz"
    if not path.exists():
        save(path, **measure(name, recorded(seed, distance, folder)))
    with np.load(path) as kept:
        return dict(kept)


def measure(name: str, record: Record, starts=STARTS) -> dict[str, np.ndarray]:
    """How far off the predictions are that start some seconds after the loss.

    Returns
    -------
    dict of str to array
        `errors` (starts, horizons, 3): north, east, heading. [m, m, rad] `regions` (starts, horizons, 2): radius and
        half-width. [m, rad] `learned` (starts,). [1] `seconds` (starts,): processor time of a step. [s]
    """
    fmu, lost = PREDICTORS[name](), int(np.flatnonzero(record.time == record.lost_at)[0])
    found = {"errors": [], "regions": [], "learned": [], "seconds": []}
    give(fmu, KNOWN, record.known[0])
    fmu.start()
    for row in range(1, lost + max(starts) + 1):
        give(fmu, KNOWN, record.known[row])
        before = process_time()
        fmu.step(float(record.time[row]), 1.0)
        if row - lost in starts:
            found["seconds"].append(process_time() - before)
            found["errors"].append(errors(fmu, record.truth, row))
            ends = [f"{end:g}" for end in HORIZONS]
            found["regions"].append(
                [
                    [getattr(fmu, f"{what}_region_{end}") for what in ("position", "heading")]
                    for end in ends
                ]
            )
            found["learned"].append(fmu.learned)
    return {key: np.array(values, float) for key, values in found.items()}


def give(fmu, names, row):
    """Inputs of a predictor by name."""
    for name, value in zip(names, row, strict=True):
        setattr(fmu, name, bool(value) if name == "wind_rejected" else float(value))


def errors(fmu, truth, row):
    """Errors by horizon of what was predicted at a row: north, east, heading. [m, m, rad]"""
    off = []
    for end in HORIZONS:
        x, y, psi = truth[row + round(end), :3]
        said = [getattr(fmu, f"{axis}_{end:g}") for axis in ("x", "y", "psi")]
        off.append([said[0] - x, said[1] - y, float(wrap_series(said[2] - psi, 2.0 * np.pi))])
    return off


def save(path, **arrays):
    """Write a file that is there as a whole or not at all, also where two processes write it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.npz")
    np.savez(part, **arrays)
    os.replace(part, path)
