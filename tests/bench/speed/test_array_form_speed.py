"""The array form against the co-simulation: time of one variation of the four-corner run, 1000 variations at once."""

from dataclasses import replace

import dp_loop
import numpy as np
import pytest

from shipcosim.cosim import simulate
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system
from speed.measure import cpu_seconds, reported

VARIATIONS, REPEATS, TO_REACH = 1000, 5, 50.0
START, ALONE, MANY = 1.0, 120.0, 20.0  # s of the run: what both take off, and how far each goes; a step costs the same


@pytest.mark.slow
def test_a_variation_of_the_array_form_is_50_times_as_fast_as_the_co_simulation(root):
    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    scenario = scenario.model_copy(update={"events": scenario.events[:1], "expect": []})
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(root)])
    ratios = []
    for _ in range(REPEATS):
        alone = _per_second(lambda duration: simulate(system, _until(scenario, duration)), ALONE)
        many = _per_second(_arrays, MANY)
        ratios.append(alone / (many / VARIATIONS))
    what = f"array form, {VARIATIONS} variations, each against the co-simulation"
    assert reported(what, ratios, "times as fast", f"{TO_REACH:.0f}, aim 100") >= TO_REACH


def _until(scenario, duration):
    return scenario.model_copy(update={"stop_time": duration})


def _per_second(run, duration):
    """CPU seconds of a simulated second, the start left out."""
    return (cpu_seconds(lambda: run(duration)) - cpu_seconds(lambda: run(START))) / (duration - START)


def _arrays(duration):
    weather = {"wind_speed": 8.0, "wind_from": 0.785, "current_speed": 0.3, "current_to": 3.14}
    default = dp_loop.dp_system()
    system = replace(
        default,
        environment=replace(
            default.environment, significant_wave_height=0.3, peak_period=5.0, seed=np.arange(VARIATIONS)
        ),
        sensors=replace(default.sensors, seed=np.arange(VARIATIONS)),
    )
    events = [(0.0, weather | {"x_set": 20.0})]
    return dp_loop.simulate(system, events, variations=VARIATIONS, stop_time=duration, every=10)
