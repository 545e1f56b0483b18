"""Command of the comparison of predictors: `python tests/bench/prediction`; `--help` says more."""

import argparse
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve()
if __name__ == "__main__":
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # prediction; ships

from prediction import measuring, pages  # noqa: E402
from prediction.rivals import PREDICTORS, there  # noqa: E402


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--predictors", nargs="+", choices=list(PREDICTORS), default=there())
    parser.add_argument(
        "--seeds",
        type=_range,
        default=range(300, 308),
        help="FROM:TO of worlds; 8700:8748 to report",
    )
    parser.add_argument(
        "--distances",
        nargs="+",
        type=float,
        default=[0.0, 0.5, 1.0, 2.0],
        help="1 must be among them",
    )
    parser.add_argument(
        "--far", type=_range, help="FROM:TO of worlds at distances other than 1; as --seeds"
    )
    parser.add_argument(
        "--into",
        type=Path,
        default=measuring.FOLDER,
        help="measures: what stands there is not redone",
    )
    parser.add_argument(
        "--write", action="store_true", help="docs/generated/drift_prediction.md too"
    )
    options = parser.parse_args(arguments)
    found = {name: {distance: [] for distance in options.distances} for name in options.predictors}
    far = options.far or options.seeds
    for distance in options.distances:
        for seed in options.seeds if distance == 1.0 else far:
            before = time.monotonic()
            for name in options.predictors:
                found[name][distance].append(measuring.measured(name, seed, distance, options.into))
            print(
                f"world {seed} at {distance:g}: {time.monotonic() - before:.0f} s", file=sys.stderr
            )
    distances = " ".join(f"{distance:g}" for distance in options.distances)
    seeds = f"{options.seeds[0]}:{options.seeds[-1] + 1}"
    command = f"python tests/bench/prediction --seeds {seeds} --far {far[0]}:{far[-1] + 1} --distances {distances} --write"
    text = pages.page(found, options.seeds, command)
    print(text)
    if options.write:
        pages.PAGE.write_text(text, encoding="utf-8")


def _range(text):
    first, _, last = text.partition(":")
    return range(int(first), int(last or int(first) + 1))


if __name__ == "__main__":
    main()
