"""What is measured: the distance of the reckoned from the true place over a minute without GNSS."""

import json
from pathlib import Path

import numpy as np

from dead_reckoning import rivals
from dead_reckoning.loop import Loop
from dead_reckoning.paper_ii_worlds import worlds_of_test
from shipcosim.learn.dead_reckoning import motion_filter as training
from shipcosim.learn.dead_reckoning import worlds
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.prediction import motion_filter, velocity_network
from shipcosim.models.prediction.outage import radius, region_of

LOST, FOUND = int(worlds.SETTLED), int(worlds.SETTLED) + 60
WEIGHTS = Path(__file__).resolve().parents[3] / "fmus" / "dead_reckoning" / "weights"
OURS = "motion-filter"
HORIZONS = (10, 30, 60)
BIASES = (0.1,)  # m/s


def laws():
    """All laws by name: module or object, and its design."""
    found = {}
    for name in (OURS, "paper-ii", "paper-ii-single-layer", "kinetic", "last-position"):
        arrays = read_arrays(WEIGHTS / f"{name}.npz")
        law = motion_filter if "bow" in arrays else velocity_network
        found[name] = law, law.design(arrays)
    return found | {
        "kalman": (rivals.Kalman(), None),
        "constant-velocity": (rivals.ConstantVelocity(), None),
    }


def measured(seeds, tell=print):
    """Mean errors of all laws in all worlds, as the page and the figure need them.

    Parameters
    ----------
    seeds : sequence of int
        Of the worlds, 48 for all sea states and directions.
    tell : callable
        Is told what is done.
    """
    given, every = worlds_of_test(seeds), laws()
    loop = Loop(given, every, OURS)
    before = loop.run(0, LOST)
    tell("until the loss: done")
    held = _joined(before, loop.fork(OURS).run(LOST, FOUND))
    found = {
        "seeds": [int(seed) for seed in seeds],
        "sea_state": [number % 4 for number in range(len(seeds))],
        "direction_deg": [30 * (number // 4 % 12) for number in range(len(seeds))],
        "held": {name: _masked(held, law, design) for name, (law, design) in every.items()},
        "rides": {},
    }
    for name in every:
        record = loop.fork(name).run(LOST, FOUND, ((LOST, FOUND),))
        error = np.hypot(record.reckoned["x_hat"] - record.x, record.reckoned["y_hat"] - record.y)[
            :, 1:
        ]
        found["rides"][name] = _rounded(error.mean(-1))
        tell(f"{name} in the loop: done")
        if name == OURS or "paper" in name:
            found.setdefault("regions", {})[name] = _regions(name, record, error)
        if name == OURS:
            found["offset"] = _rounded(np.hypot(record.x, record.y)[:, -1])
    found["biased"] = {
        f"our filter, {bias} m/s": _masked(_biased(held, bias), *every[OURS]) for bias in BIASES
    }
    law, design = every["paper-ii"]
    for bias in BIASES:
        found["biased"][f"LSTM of paper II, {bias} m/s"] = _masked(
            held, law, _learned_with(bias, design)
        )
    return json.loads(json.dumps(found))


def _joined(before, after):
    """Two records, one after the other."""
    parts = (
        {k: np.concatenate([a[k][:, :-1], b[k]], -1) for k in a}
        for a, b in zip(before[::3], after[::3], strict=True)
    )
    measured, reckoned = parts
    x, y = (
        np.concatenate([a[:, :-1], b], -1) for a, b in zip(before[1:3], after[1:3], strict=True)
    )
    return worlds.Record(measured, x, y, reckoned)


def _masked(record, law, design):
    """Mean error of a law over the last minute of a record, of which it does not see GNSS."""
    valid = np.ones_like(record.x)
    valid[:, LOST + 1 :] = 0.0
    states = training.reckoned(record, law, design, valid)[LOST + 1 :]
    x, y = (np.stack([getattr(state, name) for state in states], -1) for name in "xy")
    return _rounded(np.hypot(x - record.x[:, LOST + 1 :], y - record.y[:, LOST + 1 :]).mean(-1))


def _biased(record, bias):
    """With a bias of GNSS's velocities, forward and to starboard each."""
    return record._replace(
        measured=record.measured | {name: record.measured[name] + bias for name in "uv"}
    )


def _learned_with(bias, design):
    """Networks that learned from velocities with a bias: standardised these are the same, so only the mean is other."""
    both = (one._replace(velocity_mean=one.velocity_mean + bias) for one in design[:2])
    return velocity_network.VelocityNetworks(*both, *design[2:])


def _regions(name, record, error):
    """Share of cases within the region, and its mean radius, some seconds after the loss and over all of them."""
    region = region_of(read_arrays(WEIGHTS / f"{name}.npz"))
    radii = radius(record.reckoned["lost_for"], record.reckoned["sea"], region=region)[:, 1:]
    inside = error <= radii
    rows = {
        str(h): [float(inside[:, h - 1].mean()), float(radii[:, h - 1].mean())] for h in HORIZONS
    }
    rows |= {
        f"sea state {n + 1}": [float(inside[n::4].mean()), float(radii[n::4].mean())]
        for n in range(4)
    }
    return rows | {"all": [float(inside.mean()), float(radii.mean())]}


def _rounded(values):
    return [round(float(value), 4) for value in values]
