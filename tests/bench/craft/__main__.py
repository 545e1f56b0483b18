"""`python tests/bench/craft 6110:6150 --faults none exchanged --changes ratio`: how often what is said is right."""

import argparse
import json
import sys
import warnings
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
if __name__ == "__main__":
    sys.path[:0] = [
        str(TESTS / "bench"),
        str(TESTS / "system"),
        str(TESTS),
    ]  # craft; diagnose; ships

from craft import CHANGES, FAULTS, draw  # noqa: E402
from craft.scoring import answer, counted, score  # noqa: E402


def main() -> None:
    """Draw, compare, print one line a log and the counts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("seeds", type=lambda text: range(*map(int, text.split(":"))))
    parser.add_argument("--faults", nargs="*", default=["none"], choices=FAULTS)
    parser.add_argument("--changes", nargs="*", default=["none"], choices=CHANGES)
    parser.add_argument("--into", type=Path)
    given = parser.parse_args()
    warnings.filterwarnings("ignore")
    rows = []
    for fault, change in [(fault, "none") for fault in given.faults] + [
        ("none", c) for c in given.changes if c != "none"
    ]:
        for seed in given.seeds:
            drawn = draw(seed, fault=fault, change=change)
            rows.append(score(drawn, answer(drawn)) | {"seed": seed})
            print(json.dumps(rows[-1]), flush=True)
            if given.into:
                with given.into.open("a") as file:
                    file.write(json.dumps(rows[-1]) + "\n")
    print(counted(rows))


main()
