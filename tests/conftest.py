"""What every test may ask for."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


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
