"""Every scenario in scenarios/ holds, because it is there."""

from pathlib import Path

import numpy as np
import pytest

from shipcosim.scenario import judge

SCENARIOS = sorted(path.stem for path in (Path(__file__).parents[2] / "scenarios").glob("*.toml"))


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_a_scenario_expects_holds(name, load_scenario, run_scenario):
    verdicts = judge(run_scenario(name), load_scenario(name))
    assert verdicts, "a scenario without expectations shows nothing"
    assert not [verdict for verdict in verdicts if not verdict.passed]


def test_halving_the_step_changes_the_track_by_less_than_5_cm(load_scenario, run, run_scenario):
    """Noise, waves and gusts are on: they keep their own clocks."""
    whole = run_scenario("four_corner")
    half = run(load_scenario("four_corner", step_size=0.025))
    apart = np.hypot(half["vessel.x"] - whole["vessel.x"], half["vessel.y"] - whole["vessel.y"])
    assert float(apart.max()) < 0.05


def test_a_wind_that_fixed_angles_cannot_hold_is_seen_in_the_run(load_scenario, run):
    """Twice the wind of four_corner: thrust at its limits, the error grows."""
    table = run(load_scenario("four_corner", stop_time=400.0, events=[], set={"environment.wind_speed": 18.0}))
    late = table.sel(time=slice(300.0, 400.0))
    assert float(late["allocator.saturated"].mean()) > 0.5
    error = table["controller.position_error"]
    assert float(error.sel(time=400.0)) > float(error.sel(time=200.0)) > 5.0
