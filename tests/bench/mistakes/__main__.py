"""Command of the bench: `python tests/bench/mistakes --seeds 100:106`; `--help` says more."""

import argparse
import json
import sys
import time
from dataclasses import asdict
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # truth, mistakes

from mistakes.runs import SOURCES, answers
from mistakes.tables import table


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sources", nargs="+", choices=SOURCES, default=SOURCES)
    parser.add_argument(
        "--seeds", type=_range, default=range(100, 106), help="FROM:TO, logs of each source"
    )
    parser.add_argument(
        "--single", action="store_true", help="every mistake alone in every log, not drawn ones"
    )
    parser.add_argument(
        "--draws", type=int, default=4, help="drawn mistakes for each log, besides none"
    )
    parser.add_argument("--most", type=int, default=2, help="most mistakes in a log")
    parser.add_argument("--among", nargs="+", help="mistakes, where not all")
    parser.add_argument("--into", type=Path, help="file for the answers, one JSON line each")
    options = parser.parse_args(arguments)
    start, found = time.monotonic(), []
    for answer in answers(
        options.sources, options.seeds, options.single, options.draws, options.among, options.most
    ):
        found.append(answer)
        if answer.outcome != "right":
            print(*asdict(answer).values())
        if options.into:
            with options.into.open("a") as file:
                file.write(json.dumps(asdict(answer)) + "\n")
    print(table(found), f"\n{len(found)} logs, {time.monotonic() - start:.0f} s")


def _range(text):
    first, last = text.split(":")
    return range(int(first), int(last))


if __name__ == "__main__":
    main()
