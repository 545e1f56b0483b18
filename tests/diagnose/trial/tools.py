"""What the trial has diagnosed: functions of the path of a log."""

from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


@cache
def system():
    """The lengthened Gunnerus with her thrusters' inputs open."""
    from shipcosim.ssp import read_system

    return read_system(ROOT / "ssp" / "gunnerus_open", fmus=[ROOT / "build" / "fmus"])


def ours(path):
    """The project's own diagnosis."""
    from shipcosim.diagnose.run import diagnose

    return diagnose(path, system())[0]


def with_gain(path):
    """The same with its gain, in the array form."""
    from dataclasses import replace

    from shipcosim.diagnose.gain import compare, gain
    from shipcosim.diagnose.run import diagnose

    diagnosis, details = diagnose(path, system())
    found = compare(details.case, details.fit) if diagnosis.verdict == "named" else None
    return replace(diagnosis, gain=gain(found.errors)) if found else diagnosis
