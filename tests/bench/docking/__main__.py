"""Command of the comparison of docking predictors: `python tests/bench/docking`; `--help` says more."""

import argparse
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # docking; ships

from docking import measuring, pages  # noqa: E402
from shipcosim.learn.docking import dockings  # noqa: E402

VARIANTS = ("kinetic", "paper-iii", "ours")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--held-out",
        action="store_true",
        help="seeds 8300 to 8339, once; else those of the choices",
    )
    parser.add_argument(
        "--write", action="store_true", help="docs/generated/docking.md and docking.json too"
    )
    options = parser.parse_args(arguments)
    seeds = {"familiar": dockings.CHOICES}
    if options.held_out:
        seeds = {"familiar": dockings.HELD_OUT, "unseen": dockings.HELD_OUT_UNSEEN}
    every = [seed for some in seeds.values() for seed in some]
    with ThreadPoolExecutor(2) as pool:
        known = [record for record in pool.map(measuring.recorded, every) if record]
    records = {
        kind: [record for record in known if record.seed in some] for kind, some in seeds.items()
    }
    model = measuring.ship()
    found = {kind: measuring.measure(some, model) for kind, some in records.items()}
    times = {variant: measuring.step_time(variant, known[0], model) for variant in VARIANTS}
    ended = {kind: [record.seed for record in some] for kind, some in records.items()}
    text = pages.page(
        found,
        seeds,
        ended,
        times,
        f"python tests/bench/docking {' '.join(arguments or sys.argv[1:])}",
    )
    print(text)
    if options.write:
        pages.PAGE.write_text(text, encoding="utf-8")
        drawn = measuring.track(known[0], model, ("kinetic", "ours"))
        curves = {
            kind: {name: one["error"] for name, one in some.items()} for kind, some in found.items()
        }
        numbers = {"error_m": curves, "track": drawn | {"seed": known[0].seed}}
        pages.NUMBERS.write_text(json.dumps(plain(numbers)) + "\n", encoding="utf-8")


def plain(value):
    """What JSON can hold, to a millimetre."""
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    return np.round(np.asarray(value, float), 3).tolist()


if __name__ == "__main__":
    main()
