"""Take over how long the files of tests took in the last run of pytest: `make durations`, after `make test`.

A run leaves build/durations.json. Files that it did not run keep their time; those that are gone are dropped.
"""

import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KEPT, MEASURED = ROOT / "tests" / "durations.json", ROOT / "build" / "durations.json"
SHORTEST = 1.0  # s: the order of shorter files does not matter


def main() -> None:
    before, now = (json.loads(path.read_text(encoding="utf-8")) for path in (KEPT, MEASURED))
    found = {
        file: round(seconds, 1)
        for file, seconds in sorted((before | now).items())
        if seconds >= SHORTEST and (ROOT / file).is_file()
    }
    KEPT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
