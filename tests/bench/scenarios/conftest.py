"""What the tests in scenarios have at hand too."""

from scenarios.conftest import fmus, load_scenario, run, run_scenario
