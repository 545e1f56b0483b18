"""Runs of scenarios as in CI, but in Python."""

import pytest
from scenarios.conftest import fmus, load_scenario, run_scenario

from shipcosim.cosim import simulate, system_of


@pytest.fixture(scope="session")
def run(fmus):
    """Table of a scenario's run."""
    return lambda scenario: simulate(system_of(scenario), scenario)
