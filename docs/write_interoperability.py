"""Writes the table of docs/interoperability.md from what the conformance suite finds in each engine.

Run it from the project's root where all engines are installed: .venv/bin/python docs/write_interoperability.py. With
names of engines behind it, the columns of the others stay.
"""

import re
import sys
from importlib.metadata import version
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from conformance.recording import ENGINES, record, rows  # noqa: E402

PAGE = HERE / "interoperability.md"
MARK = re.compile(r"(<!-- recorded -->\n).*?(<!-- end -->)", re.S)


def table(found):
    """Markdown of verdicts by engine and feature."""
    versions = {"libcosim": "libcosimpy", "ecos": "ecospy", "FMPy": "fmpy"}
    heads = [f"{engine} ({version(versions[engine])})" if engine in versions else engine for engine in ENGINES]
    lines = [f"| feature | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    last = ""
    for group, feature, _ in sorted(rows().values(), key=lambda row: row[0]):
        if group != last:
            lines.append(f"| **{group}** |" + " |" * len(heads))
            last = group
        lines.append(f"| {feature} | " + " | ".join(found[engine][feature] for engine in ENGINES) + " |")
    return "\n".join(lines) + "\n"


def recorded(text):
    """Verdicts that the page states, by engine and feature."""
    body = [line for line in MARK.search(text)[0].splitlines() if line.startswith("| ")][1:]
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in body if not line.startswith("| **")]
    return {engine: {row[0]: row[1 + i] for row in cells} for i, engine in enumerate(ENGINES)}


def main(*engines):
    """Run everything and write the table."""
    text = PAGE.read_text(encoding="utf-8")
    found = recorded(text) if engines else {}
    for engine in engines or ENGINES:
        found[engine] = {rows()[name][1]: verdict for name, (verdict, _) in record(engine).items()}
    PAGE.write_text(MARK.sub(rf"\1{table(found)}\2", text), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
