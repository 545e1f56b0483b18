"""How fast the four corners run: 1100 s, base step 0.05 s, every signal recorded at full precision at every step.

The engines take turns in one process, so that what else the machine does meets all of them; each delivers the table.
A first round that is not counted imports and builds what is made once.
"""

import time

import pytest

from shipcosim.cosim import RunOptions, engines_missing, simulate
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system
from speed.measure import reported

RUNS = 5
TO_REACH = {"libcosim": (2.5, 3.4), "ecos": (1.5, 2.0)}  # times as long as ours: goal and aim
TIMES_REAL_TIME = (150.0, 300.0)


@pytest.fixture(scope="module")
def seconds(root):
    """Durations of the runs by engine, those of one round at the same place."""
    scenario = read_scenario(root / "scenarios" / "four_corner.toml").model_copy(
        update={"output_interval": None}
    )
    system = read_system(
        scenario.system_path, scenario.parameter_paths, fmus=[root / "build" / "fmus"]
    )
    engines = ["fmpy", *(name for name in TO_REACH if name not in engines_missing())]
    for engine in engines:
        simulate(system, scenario.model_copy(update={"stop_time": 5.0}), RunOptions(engine=engine))
    durations = {engine: [] for engine in engines}
    for _ in range(RUNS):
        for engine in engines:
            begin = time.perf_counter()
            table = simulate(system, scenario, RunOptions(engine=engine))
            durations[engine].append(time.perf_counter() - begin)
            assert table.sizes["time"] == 22001
    return durations


@pytest.mark.parametrize("engine", TO_REACH)
def test_faster_than_other_engines(seconds, engine, needs):
    if engine not in seconds:
        needs(f"engine {engine}")
    ratios = [theirs / ours for ours, theirs in zip(seconds["fmpy"], seconds[engine], strict=True)]
    goal, aim = TO_REACH[engine]
    assert (
        reported(f"four corners, beside {engine}", ratios, "times as fast", f"{goal}, aim {aim}")
        >= goal
    )


def test_faster_than_real_time(seconds):
    factors = [1100.0 / duration for duration in seconds["fmpy"]]
    goal, aim = TIMES_REAL_TIME
    assert reported("four corners", factors, "times real time", f"{goal:g}, aim {aim:g}") >= goal
