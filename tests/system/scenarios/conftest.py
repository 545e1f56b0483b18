"""Runs of the project's own scenarios, each made once for all tests that look at it.

They are compiled, which takes a fiftieth of the time. Engines agree to rounding: cosim/engines/test_native.py holds it
in CI, and at night tests/bench runs all scenarios in Python.
"""

import functools
import importlib.util

import pytest

from shipcosim.cosim import RunOptions, simulate, system_of
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario


@pytest.fixture(scope="session")
def fmus(root):
    """Folder of the project's FMUs, built from the present sources."""
    return build_stale(root)


@pytest.fixture(scope="session")
def load_scenario(root):
    """Scenario by its name in scenarios/, with changes to its fields."""

    def load(name, **changes):
        scenario = read_scenario(root / "scenarios" / f"{name}.toml")
        changes["set"] = scenario.set | changes.get("set", {})
        return scenario.model_copy(update=changes)

    return load


@pytest.fixture(scope="session")
def run(fmus, needs):
    """Table of a scenario's run."""
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')

    def run(scenario):
        return simulate(system_of(scenario), scenario, RunOptions(engine="native"))

    return run


@pytest.fixture(scope="session")
def run_scenario(load_scenario, run):
    """Table of the run of a scenario as it stands in scenarios/."""
    return functools.cache(lambda name: run(load_scenario(name)))
