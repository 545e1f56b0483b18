"""What is measured of a law, kept in results/allocation/, one file a law: what stands there is not redone."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from allocation import drawn, loops, measures, optimum
from allocation.laws import RIVALS, ROOT, UNITS

FOLDER = ROOT / "results" / "allocation"
REPEATS = 3
SPARSE = 20  # every how many requests the exact optimum is computed: every 2 s


def measured(law: str, seeds, random_steps: int, folder: Path = FOLDER) -> dict:
    """Measures of a law over seeds of wind: JSON as `_measure` makes it, read where it is there."""
    return _kept(_path(law, folder), lambda: _measure(law, seeds, random_steps, folder))


def times(law: str, seeds, folder: Path = FOLDER, again: bool = False) -> list[float] | None:
    """Median and 99th percentile of the time of an allocation, as `_seconds`; None where they were not measured. [s]

    They are kept in a file of their own, so that a machine that is quiet can measure them again, and nothing else.
    """
    path = _path(f"{law} times", folder)
    if again:
        path.unlink(missing_ok=True)
        return _kept(path, lambda: _seconds(law, requests("stationkeeping", seeds, folder)[:, :1]))
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def _path(name, folder):
    return folder / f"{name.replace(', ', '-').replace(' ', '-')}.json"


def _kept(path, make):
    """What a file holds, made if it is not there."""
    if not path.exists():
        found = make()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return json.loads(path.read_text(encoding="utf-8"))


def requests(scenario: str, seeds, folder: Path = FOLDER) -> np.ndarray:
    """Recorded requests, (n, m, 3), from the file of an earlier call where there is one. [N, N, N.m]"""
    path = folder / f"requests-{scenario}-{seeds[0]}-{seeds[-1]}.npy"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        np.save(path, loops.requests(scenario, seeds))
    return np.load(path)


def least(scenario: str, seeds, folder: Path = FOLDER) -> tuple[np.ndarray, np.ndarray]:
    """Power of the exact static optimum and whether it meets the request, on every `SPARSE`th, (n, m) each. [W]"""
    path = folder / f"optimum-{scenario}-{seeds[0]}-{seeds[-1]}.npz"
    if not path.exists():
        asked = requests(scenario, seeds, folder)[::SPARSE]
        found = optimum.best(asked.reshape(-1, 3))
        shape = asked.shape[:2]
        np.savez(path, power=found.power.reshape(shape), met=optimum.met(found).reshape(shape))
    kept = np.load(path)
    return kept["power"], kept["met"]


def _measure(law, seeds, random_steps, folder):
    found = {
        "law": law,
        "seeds": [int(seed) for seed in seeds],
        "steps": 0,
        "replayed": {},
        "loop": {},
        "lost": {},
    }
    for scenario in loops.SCENARIOS:
        commanded = loops.replay(law, requests(scenario, seeds, folder))
        found["replayed"][scenario] = _of_requests(commanded, *least(scenario, seeds, folder))
        found["steps"] += commanded.seconds.size
    if law in RIVALS:
        return found
    asked, available = drawn.requests(random_steps, seeds[0])
    found["random"] = {"steps": random_steps} | _listed(
        measures.violations(loops.replay(law, asked, available))
    )
    signals, commanded = loops.run("stationkeeping", seeds, law, (None, *UNITS))
    found["loop"] = _of_loop(signals, commanded, len(seeds))
    found["lost"] = {
        unit: _of_loss(signals, slice(k * len(seeds), (k + 1) * len(seeds)))
        for k, unit in enumerate(UNITS, 1)
    }
    return found


def _of_requests(commanded, best, met):
    """Measures on recorded requests, one value a seed each."""
    first = round(measures.SETTLED / commanded.step / SPARSE)
    force, moment = (values[::SPARSE] for values in measures.missed(commanded))
    within_rates = met & measures.reachable(commanded, SPARSE)

    def mean(values, where):
        counts = np.where(where, 1.0, 0.0)[first:]
        return (counts * values[first:]).sum(0) / np.maximum(counts.sum(0), 1.0)

    return _listed(
        {
            **measures.violations(commanded),
            "power": mean(measures.power(commanded.thrusts)[::SPARSE], met),
            "optimum": mean(best, met),
            "force_error": mean(force, met),
            "moment_error": mean(moment, met),
            "force_error_within_rates": mean(force, within_rates),
            "moment_error_within_rates": mean(moment, within_rates),
            "attainable": met[first:].mean(0),
            "attainable_within_rates": within_rates[first:].mean(0),
        }
    )


def _seconds(law, asked):
    """Median and 99th percentile of the time of an allocation. [s]

    Of each request the shortest of `REPEATS` replays, since other work on the machine only lengthens it; requests after
    which the commands stay are left out, since some laws sample more slowly than they are asked.
    """
    replays = [loops.replay(law, asked) for _ in range(REPEATS)]
    shortest = np.min([replay.seconds for replay in replays], axis=0)[1:]
    changed = (np.diff(replays[0].thrusts, axis=0) != 0.0).any(-1)
    return [float(np.percentile(shortest[changed], share)) for share in (50, 99)]


def _of_loop(signals, commanded, seeds):
    """Measures of stationkeeping with the law in the loop, one value a seed each: first columns: no failure."""
    rows, thrusts = measures.settled(commanded), commanded.thrusts[:, :seeds]
    distance = np.hypot(*(signals[f"vessel.{a}"] - signals[f"reference.{a}_d"] for a in "xy"))[
        :, :seeds
    ]
    turns = measures.reversals(thrusts)
    return _listed(
        {
            **{kind: count[:seeds] for kind, count in measures.violations(commanded).items()},
            "power": measures.power(thrusts)[rows].mean(0),
            "distance": np.sqrt((distance[signals["time"] > measures.SETTLED] ** 2).mean(0)),
            "azimuth_reversals": turns[:, :2].max(1),
            "tunnel_reversals": turns[:, 2],
        }
    )


def _of_loss(signals, columns):
    """Largest distance and turn from the loss of a unit on, one value a seed each. [m, deg]"""
    after = signals["time"] >= loops.LOST_AT
    distance = np.hypot(signals["vessel.x"], signals["vessel.y"])[after, columns].max(0)
    return _listed(
        {
            "distance": distance,
            "turn": np.degrees(np.abs(signals["vessel.psi"][after, columns])).max(0),
        }
    )


def _listed(values):
    return {name: np.asarray(value).tolist() for name, value in values.items()}
