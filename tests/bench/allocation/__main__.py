"""Command of the comparison of allocators: `python tests/bench/allocation`; `--help` says more."""

import argparse
import sys
from pathlib import Path

HERE = Path(__file__).resolve()
if __name__ == "__main__":
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # allocation; ships, dp_runs

from allocation import measuring, pages  # noqa: E402
from allocation.laws import LAWS, there  # noqa: E402


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--laws", nargs="+", choices=list(LAWS), default=[name for name in LAWS if there(name)]
    )
    parser.add_argument(
        "--seeds", type=_range, default=range(1, 9), help="FROM:TO of the wind; 7200:7208 to report"
    )
    parser.add_argument(
        "--random",
        type=int,
        default=20_000,
        help="random and adversarial requests; 1000000 to report",
    )
    parser.add_argument(
        "--into",
        type=Path,
        default=measuring.FOLDER,
        help="measures: what stands there is not redone",
    )
    parser.add_argument(
        "--times", action="store_true", help="measure times again, on a machine that is quiet"
    )
    parser.add_argument("--write", action="store_true", help="docs/generated/allocation.md too")
    options = parser.parse_args(arguments)
    found = {
        name: measuring.measured(name, options.seeds, options.random, options.into)
        for name in options.laws
    }
    for name, one in found.items():
        one["seconds"] = measuring.times(name, options.seeds, options.into, again=options.times)
    text = pages.page(found)
    print(text)
    if options.write:
        pages.PAGE.write_text(text, encoding="utf-8")


def _range(text):
    first, _, last = text.partition(":")
    return range(int(first), int(last or int(first) + 1))


if __name__ == "__main__":
    main()
