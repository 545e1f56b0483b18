"""Command of the comparison of dead reckoning: `python tests/bench/dead_reckoning`; `--help` says more."""

import argparse
import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve()
if __name__ == "__main__":
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # dead_reckoning; ships

from dead_reckoning import measuring, pages  # noqa: E402


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seeds",
        type=_range,
        default=range(300, 348),
        help="FROM:TO of the worlds; 8100:8148 to report",
    )
    parser.add_argument(
        "--write", action="store_true", help="docs/generated/dead-reckoning.md and .json too"
    )
    options = parser.parse_args(arguments)
    found = measuring.measured(options.seeds)
    text = pages.page(found)
    print(text)
    if options.write:
        pages.PAGE.write_text(text, encoding="utf-8")
        pages.PAGE.with_suffix(".json").write_text(
            json.dumps(found, indent=1) + "\n", encoding="utf-8"
        )


def _range(text):
    first, _, last = text.partition(":")
    return range(int(first), int(last or int(first) + 1))


if __name__ == "__main__":
    main()
