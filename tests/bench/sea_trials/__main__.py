"""Sea trials of two simulated ships with hidden causes: how often the right one is named.

Where sets fit alike, the hidden ship sails the manoeuvres that are prescribed, without noise, and all is weighed again.
`python tests/bench/sea_trials SEED [SEED ...]` prints a row a log and the counts. Half a minute a log on one core.
"""

import sys
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "system"))

from diagnose import ferry, twin
from diagnose.sea_trials import trials

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.experiment.design import prescribed
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.sea_trials.evidence import ranked, trial_evidence
from shipcosim.diagnose.sea_trials.manoeuvres import as_trials, catalogue
from shipcosim.diagnose.sea_trials.separation import separations
from shipcosim.diagnose.sea_trials.study import best_of, causes_of_trials, rivals_of
from shipcosim.diagnose.sea_trials.windows import as_ordered, sea_trials_of
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of


@cache
def ship(name):
    """Model of a ship, and how much slower than Gunnerus she sails her trials."""
    return (
        (twin.model(), 1.0)
        if name == "gunnerus"
        else (ship_model_of(ferry.structure().checked()), 2.0)
    )


def hidden(model, random):
    """Causes to plant: name, causes that are right, and numbers of the ship."""
    of, size = model.vessel, random.uniform(0.7, 1.3)
    return {
        "nothing": (set(), {}),
        "drag in drift, late orders": (
            {"drift_drag", "late_orders"},
            {f"{of}.mmg_X_vv": -0.6 * size, "lag": 2.5},
        ),
        "yaw inertia": (
            {"yaw_inertia"},
            {f"{of}.inertia_yaw": (1.0 + 0.8 * size) * model.get(f"{of}.inertia_yaw")},
        ),
        "yaw damping": ({"yaw_damping"}, {f"{of}.mmg_N_r": -0.03 * size}),
        "resistance over speed": ({"drag_over_speed"}, {f"{of}.drag_growth": 1.2 * size}),
    }


def answered(log, model, right, truth):
    """What is said of a log, and where sets fit alike of the log with the prescribed manoeuvres sailed by the ship."""
    read = checked(ReadLog(log, model, read_catalogue()))
    record = as_ordered(record_of(read.repaired, read.ship), read.repaired, read.ship)
    found = sea_trials_of(record, read.ship, orders=True)
    causes = causes_of_trials(read.ship, read_catalogue(), orders=True)
    evidence = trial_evidence(found, read.ship, causes)
    ranking = ranked(evidence)
    sets = [best_of(ranking), *rivals_of(ranking)]
    said = f"{len(found)} trials: {' | '.join(one.label for one in sets)}"
    if len(sets) == 1:
        return verdict(sets, right), "-", said
    designs = prescribed(separations(evidence, sets), sets)
    chosen = [
        one for one in catalogue(read.ship) if one.name in {design.manoeuvre for design in designs}
    ]
    if not chosen:
        return verdict(sets, right), "nothing prescribed", said
    numbers, lag = truth
    changes = {path: value - model.get(path) for path, value in numbers.items()} | {
        "instruments.order_lag": lag
    }
    shafts = dict.fromkeys(model.azimuths, trials.LEGS[0][1] / 60.0)
    more = [trial for _, pair in as_trials(chosen, read.ship, shafts, changes) for trial in pair]
    again = ranked(trial_evidence([*found, *more], read.ship, causes))
    sets = [best_of(again), *rivals_of(again)]
    then = f"{' and '.join(one.name for one in chosen)}: {' | '.join(one.label for one in sets)}"
    return (
        verdict([best_of(ranking), *rivals_of(ranking)], right),
        verdict(sets, right),
        f"{said}; {then}",
    )


def verdict(sets, right):
    """One word on a best set and its rivals; silent where nothing is named and something is hidden."""
    named = [{cause.cause for cause in one.hypotheses} for one in sets]
    if len(sets) == 1 and not named[0] and right:
        return "silent"
    if len(sets) == 1:
        return "right" if named[0] == right else "wrong"
    return "ambiguous with the right one" if right in named else "ambiguous without it"


if __name__ == "__main__":
    counts = Counter()
    for seed in map(int, sys.argv[1:]):
        for name in ("gunnerus", "ferry"):
            model, slow = ship(name)
            planted = hidden(model, np.random.default_rng(seed))
            problems = {what: numbers for what, (_, numbers) in planted.items()}
            logs = trials.logs(problems, seed, model, slow)
            drawn = trials.drawn(problems, np.random.default_rng(seed), model)
            for i, (what, (right, numbers)) in enumerate(planted.items()):
                truth = (
                    {path: float(values[i]) for path, values in drawn.items()},
                    numbers.get("lag", 0.0),
                )
                word, then, said = answered(logs[what], model, right, truth)
                counts[name, what, word, then] += 1
                print(seed, name, what, word, then, said, sep="; ", flush=True)
    for key, count in sorted(counts.items()):
        print(*key, count, sep="; ")
