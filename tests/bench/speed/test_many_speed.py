"""Many variations of the four corners beside one run in Python: CPU time of each, whole runs, four signals kept."""

import pytest

import shipcosim
from shipcosim import read_scenario
from shipcosim.cosim import RunOptions, simulate
from shipcosim.cosim.systems import system_of
from speed.measure import cpu_seconds, reported

VARIATIONS, ROUNDS, AT_LEAST = 100, 3, 40.0
SHOWN = ["vessel.x", "vessel.y", "vessel.psi", "port.thrust"]
PYTHON = RunOptions(engine="fmpy")
SHORT = 1.0  # s: a run of which most is its start


def test_a_variation_is_forty_times_as_fast_on_one_core_as_the_run_in_python(root):
    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    system = system_of(scenario)
    many(SHORT)
    ratios, starts = [], []
    for _ in range(ROUNDS):
        alone = cpu_seconds(lambda: simulate(system, scenario, PYTHON))
        ratios.append(alone / (cpu_seconds(lambda: many(scenario.stop_time)) / VARIATIONS))
        starts.append(1000.0 * cpu_seconds(lambda: many(SHORT)) / VARIATIONS)
    reported("CPU time of a variation of 1 s", starts, "ms", "10")
    what = f"each of {VARIATIONS} variations, on each core"
    assert (
        reported(what, ratios, "times as fast as the run in Python", "150: 300 on two cores")
        >= AT_LEAST
    )


def many(stop_time):
    variations = [
        {"environment.seed": seed, "sensors.seed": 1000 + seed} for seed in range(VARIATIONS)
    ]
    scenario = read_scenario("four_corner").model_copy(
        update={"stop_time": stop_time, "expect": []}
    )
    if stop_time == SHORT:
        scenario = scenario.model_copy(update={"events": scenario.events[:1]})
    runs = shipcosim.simulate_many(None, scenario, variations, record=SHOWN)
    assert not any(runs.error.values)
