"""What every test may ask for, and the order in which files of tests run."""

import json
import os
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DURATIONS = json.loads((ROOT / "tests" / "durations.json").read_text(encoding="utf-8"))
"""How long files take [s], by their path; shorter ones than a second are left out. `make durations` measures again."""
MOST_SHOWN = 15  # files
_seconds: Counter[str] = Counter()


@pytest.fixture(scope="session")
def root():
    """Folder of the project."""
    return ROOT


@pytest.fixture(scope="session")
def needs():
    """Function to call where something is missing: skips the test, or fails it where SHIPCOSIM_NO_SKIP is set (CI)."""

    def missing(what, why=""):
        reason = f"needs {what}, which is not here. {why}".strip()
        if os.environ.get("SHIPCOSIM_NO_SKIP"):
            pytest.fail(reason)
        pytest.skip(reason)

    return missing


@pytest.fixture(scope="session")
def shared():
    """Folder of reference data that is not part of the project; the test skips where it is absent."""
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        pytest.skip("needs the reference data in ../shared, which is not here")
    return folder


def file_of(nodeid):
    return nodeid.partition("::")[0]


def pytest_collection_modifyitems(items):
    """Run the longest files first: of two processes none is left with a long one when the other has finished."""
    items.sort(key=lambda item: -DURATIONS.get(file_of(item.nodeid), 0.0))


def pytest_runtest_logreport(report):
    """Add up set-up, call and tear-down by file."""
    _seconds[file_of(report.nodeid)] += report.duration


def pytest_terminal_summary(terminalreporter, config):
    """Show which files took longest, and leave all times for `make durations`."""
    if hasattr(config, "workerinput") or sum(_seconds.values()) < 10.0:
        return
    terminalreporter.section("longest files")
    for file, seconds in _seconds.most_common(MOST_SHOWN):
        terminalreporter.write_line(f"{seconds:7.1f} s  {file}")
    folder = ROOT / "build"
    folder.mkdir(exist_ok=True)
    (folder / "durations.json").write_text(json.dumps(_seconds, indent=1), encoding="utf-8")
