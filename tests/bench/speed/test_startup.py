"""How long a user waits before something happens: for the help, and for the first step of a run with built FMUs.

Each time is that of a process of its own, as the shell starts it, on an otherwise idle machine.
"""

import os
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest

from shipcosim.library import build_stale
from speed.measure import reported

RUNS = 5
LONGEST_HELP, LONGEST_START = 0.3, 2.0  # s
FIRST_STEP = """
import sys, time
from shipcosim.cosim.master.component import ComponentInstance
step = ComponentInstance.step
def first(*arguments):
    print("first step at", time.time(), file=sys.stderr)
    ComponentInstance.step = step
    return step(*arguments)
ComponentInstance.step = first
"""


def command():
    """The installed command."""
    return str(
        Path(sysconfig.get_path("scripts")) / ("shipcosim.exe" if os.name == "nt" else "shipcosim")
    )


def test_help_comes_at_once():
    seconds = []
    for _ in range(RUNS):
        start = time.perf_counter()
        subprocess.run([command(), "--help"], check=True, capture_output=True)
        seconds.append(time.perf_counter() - start)
    assert reported("shipcosim --help", seconds, "s", f"{LONGEST_HELP}") < LONGEST_HELP


def test_first_step_of_a_run_comes_within_two_seconds(root, tmp_path):
    """The clock runs from the start of the process to the call of the first component's first step."""
    build_stale(root)
    code = f"{FIRST_STEP}\nfrom shipcosim.cli import main; main()"
    arguments = ["run", "four_corner", "--until", "0.05", "--out", str(tmp_path)]
    seconds = []
    for _ in range(RUNS):
        start = time.time()
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments], cwd=root, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        seconds.append(float(done.stderr.partition("first step at ")[2].split()[0]) - start)
    assert reported("first step of shipcosim run", seconds, "s", f"{LONGEST_START}") < LONGEST_START
