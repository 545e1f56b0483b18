"""The binary of our FMUs: finds a Python where the host has none, and passes all calls on to pythonfmu's binary.

Compiled once, by tests/bench/fmi/export/compile_loader.py, and kept here: whoever builds an FMU needs no compiler, and
gets the same bytes everywhere.
"""

from pathlib import Path

FOLDER = Path(__file__).parent
SUFFIXES = {"linux64": ".so", "win64": ".dll"}
"""Platforms, named as FMI 2.0 does, and what their libraries end in."""


def loader_for(platform: str) -> Path:
    """The compiled loader for a platform."""
    return FOLDER / f"{platform}{SUFFIXES[platform]}"
