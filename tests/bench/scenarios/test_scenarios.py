"""At night: what every scenario expects holds in Python too."""

import pytest
from scenarios.test_scenarios import NAMES, check_scenario


@pytest.mark.parametrize("name", NAMES)
def test_what_a_scenario_expects_holds(name, load_scenario, run_scenario):
    check_scenario(name, load_scenario, run_scenario)
