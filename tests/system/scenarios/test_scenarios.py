"""Every scenario in scenarios/ holds, because it is there, and of its folders a representative share.

All of those in folders run at night: tests/bench/scenarios.
"""

from pathlib import Path

import numpy as np
import pytest

from shipcosim.scenario import judge

FOLDER = Path(__file__).parents[3] / "scenarios"
NAMES = sorted(
    path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.toml")
)
REPRESENTATIVE = {
    "sensors/all_references_lost",
    "failures/port_full_thrust",
    "failures/bus_a_short_of_power",
    "paper_i/north",
}
"""Scenarios in folders that run in CI."""
IN_CI = [name for name in NAMES if "/" not in name or name in REPRESENTATIVE]


@pytest.mark.parametrize("name", IN_CI)
def test_what_a_scenario_expects_holds(name, load_scenario, run_scenario):
    check_scenario(name, load_scenario, run_scenario)


def check_scenario(name, load_scenario, run_scenario):
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
    table = run(
        load_scenario(
            "four_corner", stop_time=400.0, events=[], set={"environment.wind_speed": 18.0}
        )
    )
    late = table.sel(time=slice(300.0, 400.0))
    assert float(late["allocator.saturated"].mean()) > 0.5
    error = table["controller.position_error"]
    assert float(error.sel(time=400.0)) > float(error.sel(time=200.0)) > 5.0
