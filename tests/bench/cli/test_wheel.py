"""At night: the quickstart, word for word, in an environment with everything installed."""

import sys
import time

import pytest
from cli.test_wheel import BIN, LARGEST, check_first, follow, fresh, megabytes, quickstart, wheel

FIRST_RESULT = 120.0  # s, from a cold start of the first run to its page, on two cores


@pytest.mark.timeout(1800)
def test_quickstart_runs_word_for_word_with_everything_installed(fresh):
    """Needs a package index. The time is that of the first run, which builds the FMUs: a cold start."""
    venv, folder, run = fresh
    run([sys.executable, "-m", "venv", str(venv)], folder)
    install, first, *others = quickstart()
    assert install[:2] == ["pip", "install"] and first == ["shipcosim", "run", "four_corner"]
    run([str(venv / BIN / "python"), "-m", *install], folder)
    size = megabytes(venv.rglob("*"))
    print(f"environment of {size:.0f} MB")
    assert size < LARGEST
    start = time.perf_counter()
    said = follow([first], folder, run)
    seconds = time.perf_counter() - start
    print(f"first result after {seconds:.0f} s")
    said |= follow(others, folder, run)
    check_first(said)
    assert "2 passed" in said["pytest"]
    assert all(
        "PASS" in said[f"shipcosim run {name}"] for name in ("four_corner", "squall", "tern")
    )
    assert seconds < FIRST_RESULT
