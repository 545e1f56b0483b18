"""Run the checks of a target and print how long each took: `python .ci/checks.py quick`, `test` or `nightly`.

Format and lint come first, since they take a second. The type checker runs beside the tests.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

BIN = Path(sys.executable).parent
TESTS = [
    str(BIN / "pytest"),
    "-n",
    "2",
    "--dist",
    "loadfile",
    "--no-loadscope-reorder",
    "--durations=25",
]
ALONE = [str(BIN / "pytest"), "-s", "--durations=25"]
LINT = {
    "ruff check": [str(BIN / "ruff"), "check", "."],
    "ruff format": [str(BIN / "ruff"), "format", "--check", "."],
}
BUILD = {"shipcosim build": [str(BIN / "shipcosim"), "build"]}
TIMED = ["tests/bench/speed", "tests/bench/report"]
"""Tests with limits by the clock: nothing else runs beside them."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""The workers already use both cores: more threads of linear algebra would only wait for each other."""
OTHER_PROCESSOR = {
    "OPENBLAS_CORETYPE": "Haswell",
    "MKL_ENABLE_INSTRUCTIONS": "SSE4_2",
    "ATEN_CPU_CAPABILITY": "default",
}
"""The linear algebra of NumPy, MKL and torch as on an older processor."""


def main(target: str) -> int:
    # Without the files of compiled code each of some hundred commands compiles all modules again.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if target == "quick":
        return run(LINT | {"tests": [*TESTS, "tests/unit"]}, **ONE_THREAD)
    if target == "test":
        beside = {"pyright": [str(BIN / "pyright")]}
        tests = {"tests": [*TESTS, "tests/unit", "tests/system", "src"]}
        return run(LINT | BUILD | tests, beside, **ONE_THREAD)
    benches = [
        *TESTS,
        "tests/bench",
        "tests/system/bench",
        *(f"--ignore={folder}" for folder in TIMED),
    ]
    numeric = [
        *TESTS,
        "tests/unit/models",
        "tests/system/models",
        "tests/system/learn",
        "tests/system/diagnose",
    ]
    failed = run(BUILD | {"tests by the clock": [*ALONE, *TIMED]})
    failed |= run({"benches": benches}, SHIPCOSIM_FRESH_SEEDS="1")
    failed |= run({"tests as on another processor": numeric}, **OTHER_PROCESSOR)
    return failed


def run(
    steps: dict[str, list[str]], beside: dict[str, list[str]] | None = None, **environment: str
) -> int:
    """Run steps one after the other up to the first that fails, others beside them; 0 if none failed."""
    start = time.monotonic()
    started = {
        name: subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for name, command in (beside or {}).items()
    }
    seconds, failed = {}, []
    for name, command in steps.items():
        before = time.monotonic()
        code = subprocess.run(command, env=os.environ | environment).returncode
        seconds[name] = time.monotonic() - before
        if code:
            failed.append(name)
            break
    for name, process in started.items():
        output, _ = process.communicate()
        print(output, end="")
        if process.returncode:
            failed.append(name)
    times = ", ".join(f"{name} {value:.0f} s" for name, value in seconds.items())
    print(f"{times}; in all {time.monotonic() - start:.0f} s", flush=True)
    if failed:
        print(f"failed: {', '.join(failed)}", flush=True)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
