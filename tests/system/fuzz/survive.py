"""Gives damaged inputs to the program, many in one process, and says of each how it ended.

`survive` follows processes that may die of it; `fuzz.process` is what runs in them.
"""

import json
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SILENCE = 120.0  # s, after which a process is taken to hang
PROCESS = Path(__file__).resolve().with_name("process.py")


def survive(seed, first, last):
    """What ended in another way than it should.

    Parameters
    ----------
    seed, first, last : int
        Inputs `first` to `last` - 1 of a seed.

    Returns
    -------
    (list of dict, dict)
        Failures, each with number, how it was made, and what happened; counts of how the others ended.
    """
    failures, counts = [], {}
    with tempfile.TemporaryDirectory(prefix="fuzz-") as around:
        while first < last:
            first = _watch(seed, first, last, Path(around), failures, counts)
    return failures, counts


def _watch(seed, first, last, around, failures, counts):
    """Follow one process until it ends or is to be ended; the number of the input that comes next."""
    command = [sys.executable, str(PROCESS), str(seed), str(first), str(last), str(around)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    beat, done = [time.monotonic()], threading.Event()
    threading.Thread(target=_end_if_silent, args=(process, beat, done), daemon=True).start()
    current = None
    for line in process.stdout:
        beat[0] = time.monotonic()
        said = json.loads(line)
        if "ended" not in said:
            current = said
            continue
        first = said["number"] + 1
        counts[said["ended"]] = counts.get(said["ended"], 0) + 1
        if said["ended"] not in ("success", "clear error"):
            failures.append(said)
    done.set()
    if process.wait() != 0:
        if current is None:
            raise RuntimeError(f"the process does not start: {' '.join(command)}")
        what = (
            "killed after no word for too long"
            if process.returncode == -9
            else f"died ({process.returncode})"
        )
        failures.append({**current, "ended": what})
        return current["number"] + 1
    return last


def _end_if_silent(process, beat, done):
    while not done.wait(0.5):
        if time.monotonic() - beat[0] > SILENCE:
            process.kill()
