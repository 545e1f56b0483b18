"""At night: what the scenarios expect that CI leaves out."""

import pytest
from scenarios.test_scenarios import IN_CI, NAMES, check_scenario


@pytest.mark.parametrize("name", [name for name in NAMES if name not in IN_CI])
def test_what_a_scenario_expects_holds(name, load_scenario, run_scenario):
    check_scenario(name, load_scenario, run_scenario)
