"""Our neural allocator against the quadratic program with forbidden sectors, where slipstreams take thrust.

Run `python tests/bench/allocation/slipstreams.py KIND`, with `--lost NUMBER` for a missing unit. Requests are those of
the DP controller in the two scenarios, by seeds that no training has seen. What the slipstreams take is the same truth
for all; what a law misses of the request is added to what it is asked, slowly, as the integral action of a controller
does: so all laws give the same mean load, and their powers can be compared.
"""

import argparse
import json
import sys
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # allocation; ships, dp_runs

from allocation.loops import SCENARIOS  # noqa: E402
from allocation.measures import spread  # noqa: E402
from allocation.measuring import FOLDER, requests  # noqa: E402
from shipcosim.learn.neural import RECIPES  # noqa: E402
from shipcosim.models.allocation import neural, neural_law, sqp  # noqa: E402
from shipcosim.models.core.networks import read_arrays  # noqa: E402

ROOT = HERE.parents[3]
FMUS = {"neural": "neural_allocator", "neural-slipstreams": "neural_allocator"}
STEP, CORRECTION, SETTLED = 0.5, 5.0, 60.0  # s
ASTERN = -30e3  # N: what a unit that turns may give where another is missing
NAMED = (-0.25 * pi, 0.75 * pi, 0.5 * pi)
NUMBERED = (-0.25 * pi, 0.25 * pi, -0.25 * pi, 0.25 * pi)


class Law(NamedTuple):
    """A law in arrays: its state at rest for m seeds, and its step."""

    rest: object
    step: object


def quadratic_program(units, first, last, start):
    """The optimal allocator with an interval of angles for each unit."""
    rows = zip(
        units.x,
        units.y,
        units.least,
        units.most,
        units.rate,
        units.turn,
        units.full_power,
        strict=True,
    )
    made = []
    for k, (x, y, least, most, rate, turn, power) in enumerate(rows):
        interval = (first[k], last[k]) if turn > 0.0 else (units.azimuth[k],) * 2
        degraded = ASTERN if turn > 0.0 else least
        made.append(
            sqp.AllocatedThruster(
                x, y, least, most, degraded, rate, *interval, turn, power / most**1.5
            )
        )
    design = sqp.designed(tuple(made), 10.0, units.lever, _degraded(units))
    return Law(
        lambda m: sqp.resting((np.zeros(m),) * 3, start),
        lambda state, tau, on: sqp.power_step(state, tau, on, STEP, design=design),
    )


def ours(units, arrays, start):
    """The neural allocator."""
    least = tuple(np.where(units.turn > 0.0, ASTERN, units.least))
    design = neural_law.designed(units, tuple(range(len(units.x))), arrays, least, _degraded(units))
    return Law(
        lambda m: neural_law.resting((np.zeros(m),) * 3, start),
        lambda state, tau, on: neural_law.step(state, tau, on, STEP, design=design),
    )


def silent(units):
    """A network that says nothing."""
    n = len(units.x)
    return {"1.weights": np.zeros((8 + 5 * n, 2 * n)), "1.bias": np.zeros(2 * n)}


def laws_of(kind):
    """Laws to compare, by name, and the units."""
    units = RECIPES[kind].units
    fmu = FMUS.get(kind, "neural_units_allocator")
    arrays = read_arrays(ROOT / "fmus" / fmu / "weights" / f"{kind}.npz")
    start = NUMBERED if len(units.x) == 4 else NAMED
    beside = (
        (4.0, 4.0, 3.0, 3.0) if len(units.x) == 4 else (4.0, 4.0, 1.0)
    )  # m to the unit beside it
    half = [np.arctan(0.1 + 1.9 / distance) for distance in beside]  # DNV-ST-0111
    first = [side + h for side, h in zip((-0.5 * pi, -1.5 * pi) * 2, half, strict=False)]
    last = [side - h for side, h in zip((1.5 * pi, 0.5 * pi) * 2, half, strict=False)]
    if len(units.x) == 3:
        first[1], last[1] = 0.5 * pi + half[1], 2.5 * pi - half[1]
    found = {
        "quadratic program, sectors of DNV-ST-0111": quadratic_program(units, first, last, start)
    }
    if len(units.x) == 3:
        cones = np.radians((-80.0, 100.0, 0.0)), np.radians((80.0, 260.0, 0.0))
        found["quadratic program, cones of the thesis"] = quadratic_program(units, *cones, start)
    found["ours, a network that says nothing"] = ours(units, silent(units), start)
    found["ours, trained"] = ours(units, arrays, start)
    return found, units


def run(law, units, asked, lost):
    """Thrusts, angles and given loads, (n, m, ...), for requests (n, m, 3)."""
    m, n = asked.shape[1], len(units.x)
    on = tuple(np.full(m, k != lost) for k in range(n))
    state, more, rows = law.rest(m), np.zeros((m, 3)), []
    for tau in asked:
        state = law.step(state, tuple((tau + more).T), on)
        thrusts, azimuths = (
            np.stack([values + np.zeros(m) for values in of], -1) for of in state[:2]
        )
        effect = neural.effects(thrusts, azimuths, units=units)
        given = (effect @ thrusts[..., None])[..., 0] * (1.0, 1.0, units.lever)
        more = more + STEP / CORRECTION * (tau - given)
        rows.append((thrusts, azimuths, given))
    return [np.array(column) for column in zip(*rows, strict=True)]


def measured(kind, seeds, lost=-1, folder=FOLDER):
    """Of each law and scenario power [kW], mean missed force and moment [N, N.m], one value a seed each.

    Kept in the folder, one file a kind: what stands there is not redone.
    """
    name = kind if lost < 0 else f"{kind}-without-{lost + 1}"
    path = folder / f"slipstreams-{name}-{seeds[0]}-{seeds[-1]}.json"
    if not path.exists():
        found = {
            scenario: dict(_measure(kind, scenario, seeds, lost, folder)) for scenario in SCENARIOS
        }
        path.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return json.loads(path.read_text(encoding="utf-8"))


def _measure(kind, scenario, seeds, lost, folder):
    laws, units = laws_of(kind)
    asked = requests(scenario, seeds, folder)[:: round(STEP / 0.1)][: round(650.0 / STEP)]
    skip = round(SETTLED / STEP)
    for name, law in laws.items():
        thrusts, _, given = run(law, units, asked, lost)
        missed = np.abs(asked - given)[skip:]
        force, moment = np.hypot(missed[..., 0], missed[..., 1]).mean(0), missed[..., 2].mean(0)
        power = neural.power(thrusts, units=units)[skip:].mean(0) / 1e3
        yield name, {"power": power.tolist(), "force": force.tolist(), "moment": moment.tolist()}


def lines(kind, found):
    """The table in Markdown: power of each law against the first one, and what it misses."""
    said = [
        f"| {kind} | power [kW] | against the first [%] | missed [N] | missed [N m] |",
        "|---|---|---|---|---|",
    ]
    for scenario, laws in found.items():
        first = np.array(next(iter(laws.values()))["power"])
        for name, one in laws.items():
            more = spread(100.0 * (np.array(one["power"]) / first - 1.0))
            power, force, moment = (np.mean(one[key]) for key in ("power", "force", "moment"))
            change = f"{more.mean:+.1f} ± {more.half:.1f}"
            said.append(
                f"| {scenario}: {name} | {power:.2f} | {change} | {force:.0f} | {moment:.0f} |"
            )
    return said


def _degraded(units):
    return 300.0 if len(units.x) == 3 else units.lever


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=list(RECIPES))
    parser.add_argument("--lost", type=int, help="number of a unit that is missing, from 1")
    parser.add_argument("--seeds", default="1:9", help="FROM:TO of the wind; 7200:7208 to report")
    options = parser.parse_args()
    first, last = map(int, options.seeds.split(":"))
    print(
        "\n".join(
            lines(options.kind, measured(options.kind, range(first, last), (options.lost or 0) - 1))
        )
    )
