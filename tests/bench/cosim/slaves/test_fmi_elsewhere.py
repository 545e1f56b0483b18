"""At night: what other engines make of FMUs of other versions and forms: docs/fmi-versions.md, measured."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from cosim.slaves import test_fmi_elsewhere
from cosim.slaves.test_fmi_elsewhere import CASES, ENGINES, packages


def verdict(engine, path, right):
    """What becomes of an SSP in an engine, in a word of docs/interoperability.md."""
    command = [sys.executable, str(test_fmi_elsewhere.__file__), engine, str(path)]
    tests = Path(__file__).resolve().parents[3]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(tests / "system"), str(tests)))}
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=60, env=environment)
    except subprocess.TimeoutExpired:
        return "**hangs**"
    lines = [line for line in run.stdout.splitlines() if line.startswith("{")]
    if not lines:
        return "**crashes**"
    said = json.loads(lines[-1])
    if "error" in said:
        return "refused"
    return "right" if said["value"] == pytest.approx(right, rel=1e-5) else "*silently wrong*"


def table(packages):
    """The table as the page has it."""
    rows = [f"| | {' | '.join(ENGINES)} |", "|---|" + "---|" * len(ENGINES)]
    for name, (*_, right) in CASES.items():
        rows.append(
            f"| {name} | {' | '.join(verdict(engine, packages[name], right) for engine in ENGINES)} |"
        )
    return "\n".join(rows) + "\n"


def test_the_page_says_what_other_engines_make_of_it(packages, root, needs):
    for module in ("libcosimpy", "ecospy"):
        pytest.importorskip(module)
    measured = table(packages)
    print(measured)
    assert measured in (root / "docs" / "fmi-versions.md").read_text(encoding="utf-8")
