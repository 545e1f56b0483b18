"""At night: further ways for a component in a process of its own to go down, and the other order of steps."""

import pytest
from cosim.conftest import fmus, make_scenario, make_system
from cosim.processes.test_processes import (
    check_fallen,
    check_fallen_in_c,
    check_same_digits,
    dangerous,
    falling,
    pytestmark,
    same,
    system,
)

from shipcosim.cosim import RunOptions, simulate
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system


def test_results_are_the_same_to_the_last_digit(make_system, make_scenario):
    check_same_digits(make_system, make_scenario, "jacobi")


@pytest.mark.parametrize(
    "how, said",
    [
        ("signal", "Its process was ended in DoStep by signal 11, Segmentation fault."),
        ("exit", "Its process ended itself in DoStep, with exit code 0."),
    ],
)
def test_a_component_that_goes_down_is_named_and_the_rows_before_are_there(
    system, make_scenario, how, said
):
    check_fallen(system, make_scenario, how, said)


@pytest.mark.parametrize("how, said", [(2, "gave no answer"), (3, "signal 6")])
def test_the_same_holds_for_an_fmu_made_from_c(falling, make_system, make_scenario, how, said):
    check_fallen_in_c(make_system, make_scenario, how, said)


def test_the_dp_ship_gives_the_same_digits(root):
    scenario = read_scenario(root / "scenarios" / "gust.toml")
    scenario = scenario.model_copy(
        update={"stop_time": 1.0, "events": [], "expect": [], "output_interval": None}
    )
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(root)])
    same(simulate(system, scenario), simulate(system, scenario, RunOptions(isolate=True)))
