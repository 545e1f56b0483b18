"""How much faster the four corners run with compiled models than in Python: 1100 s, every signal at every step.

The engines take turns in one process, and what is compared is its CPU time. A whole run begins with instances of eleven
FMUs, which costs both the same; the steps alone are what a whole run takes more than one of a single second.
"""

import pytest

from shipcosim.cosim import RunOptions, simulate
from shipcosim.cosim.systems import system_of
from shipcosim.scenario import read_scenario
from speed.measure import cpu_seconds, reported

RUNS = 5
GOALS = {"whole run": 8.0, "steps": 25.0}  # to reach for both: 30


@pytest.fixture(scope="module")
def seconds(root):
    """Durations by engine and length, those of one round at the same place."""
    scenario = read_scenario(root / "scenarios" / "four_corner.toml").model_copy(
        update={"output_interval": None}
    )
    system = system_of(scenario)
    durations = {(engine, until): [] for engine in ("fmpy", "native") for until in (1.0, 1100.0)}
    for _ in range(RUNS + 1):
        for (engine, until), found in durations.items():
            options = RunOptions(engine=engine, until=until)
            found.append(cpu_seconds(lambda options=options: simulate(system, scenario, options)))
    return {
        key: found[1:] for key, found in durations.items()
    }  # the first round imports and compiles


@pytest.mark.parametrize("part", GOALS)
def test_compiled_models_are_faster_than_python(seconds, part):
    if part == "whole run":
        ratios = [
            a / b for a, b in zip(seconds["fmpy", 1100.0], seconds["native", 1100.0], strict=True)
        ]
    else:  # least times: a small difference of two of them is not lost in what else the machine does
        python, native = (
            min(seconds[e, 1100.0]) - min(seconds[e, 1.0]) for e in ("fmpy", "native")
        )
        ratios = [python / native]
    assert (
        reported(f"four corners, {part}, native", ratios, "times as fast as fmpy", "30")
        >= GOALS[part]
    )
