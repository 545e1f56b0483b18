"""Runs of the project's own scenarios, each made once for all tests that look at it."""

import functools

import pytest

from shipcosim.cosim import simulate, system_of
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
def run(fmus):
    """Table of a scenario's run."""

    def run(scenario):
        return simulate(system_of(scenario), scenario)

    return run


@pytest.fixture(scope="session")
def run_scenario(load_scenario, run):
    """Table of the run of a scenario as it stands in scenarios/."""
    return functools.cache(lambda name: run(load_scenario(name)))
