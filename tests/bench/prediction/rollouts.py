"""One-step training of paper IV's networks beside training over whole predictions: the same but for the loss.

`python tests/bench/prediction/rollouts.py` trains both on the same worlds and prints errors 60 s ahead in worlds 300 to
311, over the first 5 and 20 starts: `docs/reports/prediction.md` has them. It takes some ten minutes, records included.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # prediction; ships

from prediction import measuring, paper_iv_rollouts  # noqa: E402
from shipcosim.angles import wrap_series  # noqa: E402
from shipcosim.learn.datasets import mapped  # noqa: E402
from shipcosim.learn.prediction import paper_iv, rollouts, training  # noqa: E402
from shipcosim.models.prediction import paper_iv as law  # noqa: E402

BEFORE, STARTS, SECONDS = 170, 20, 60
TRAINING = range(1, 13), range(1, 25)
CHOICE = range(300, 312)
STEPS = 20, 60, 150
NO_RESIDUAL = law.Ensemble(
    ((np.zeros((1, 9, 3)), np.zeros((1, 1, 3))),), np.zeros(9), np.ones(9), np.zeros(3), np.ones(3)
)


def errors(ensemble, seeds, ship):
    """What predictions miss 60 s ahead of the true ship, (starts, worlds, 3): north, east, heading. [m, m, deg]"""
    records = [measuring.recorded(seed, 1.0) for seed in seeds]
    sailed = training.aligned(records, BEFORE)
    truth = np.stack(
        [one.truth[int(np.searchsorted(one.time, one.lost_at - 1e-6)) :][:81] for one in records],
        axis=1,
    )
    everything = rollouts.known_of(sailed.known, ship)
    past, found = law.begin(mapped(lambda array: array[0], everything)), []
    for row in range(1, BEFORE + STARTS + 1):
        known = mapped(lambda array, row=row: array[row], everything)
        past = law.step(past, known, hull=ship.hull, wind=ship.wind)
        if row > BEFORE:
            last = law.predict(
                past, known, ensemble, seconds=SECONDS, hull=ship.hull, wind=ship.wind
            )[-1]
            reached = truth[row - BEFORE + SECONDS]
            turned = wrap_series(last.psi - reached[:, 2], 2.0 * np.pi)
            found.append(
                np.stack(
                    [last.x - reached[:, 0], last.y - reached[:, 1], np.degrees(turned)], axis=-1
                )
            )
    return np.array(found)


def show(name, ensemble, seeds, ship):
    """A row of the table."""
    off = np.abs(errors(ensemble, seeds, ship))
    cells = [
        ", ".join(f"{value:.1f}" for value in off[:first].mean(axis=(0, 1)))
        for first in (5, STARTS)
    ]
    print(f"| {name} | {cells[0]} | {cells[1]} |", flush=True)


def main():
    ship = training.ship()
    show("the equations of motion alone", NO_RESIDUAL, CHOICE, ship)
    for seeds in TRAINING:
        sailed = training.aligned([measuring.recorded(seed, 1.0) for seed in seeds], BEFORE)
        inputs, targets = paper_iv.samples(sailed, ship)
        arrays, _ = paper_iv.fit(inputs, targets, training.PAPER_IV, lambda done, total: None)
        show(f"one step, {len(seeds)} worlds", law.ensemble_of(arrays), CHOICE, ship)
        pieces = paper_iv_rollouts.stretches(sailed, ship)
        for steps in STEPS:
            kept, losses = paper_iv_rollouts.fit(
                arrays, pieces, ship, training.PAPER_IV, steps, lambda done, of: None
            )
            name = f"whole predictions, {len(seeds)} worlds, {steps} steps (loss {losses[0]:.2f} to {losses[-1]:.2f})"
            show(name, law.ensemble_of(kept), CHOICE, ship)


if __name__ == "__main__":
    main()
