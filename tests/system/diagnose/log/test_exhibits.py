"""Ordinary mistakes that were once called something else, with units in the headers: the right name or none."""

import time as clock

import numpy as np
import pytest
from diagnose.logs import UNITS, measured, smooth

from mistakes.craft import boat
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.series import make_table


def stated(log):
    """The log as a file with all units in its headers gives it."""
    table = make_table(
        log["time"], [(role, log[role], UNITS[role], role) for role in log if role != "time"]
    )
    table["time"].attrs["units"] = "s"
    return read_log(table)


EXHIBITS = {
    "2 s pass in each logged second": lambda log: {"time": 0.5 * log["time"]},
    "0.5 s pass in each logged second": lambda log: {"time": 2.0 * log["time"]},
    "time is in tenths of a second, not s": lambda log: {"time": 10.0 * log["time"]},
    "heading is in rad, not deg": lambda log: {"heading": np.radians(log["heading"])},
    "surge and sway are in km/h, not m/s": lambda log: {
        role: 3.6 * log[role] for role in ("surge", "sway")
    },
}


@pytest.mark.parametrize("said", EXHIBITS)
def test_what_is_wrong_is_named_although_the_header_states_otherwise(said):
    log = measured(seed=41)
    assert [finding.note for finding in examine(stated(log | EXHIBITS[said](log)))] == [said]


def test_a_craft_that_spins_and_is_averaged_over_four_seconds_is_in_no_other_unit():
    """Her heading turns by more than half a circle between rows: nothing tells how she went."""
    for seed in range(3):
        fine = boat(seed, style="spin", step=0.1, minutes=6.0)
        log = {
            role: values[: len(values) // 40 * 40]
            for role, values in fine.items()
            if not role.startswith("wind")
        }
        assert np.median(np.abs(log["yaw_rate"])) > 30.0
        angle = np.exp(1j * np.radians(log["heading"])).reshape(-1, 40).mean(axis=1)
        log = {role: values.reshape(-1, 40).mean(axis=1) for role, values in log.items()}
        log["heading"] = np.mod(np.degrees(np.angle(angle)), 360.0)
        assert examine(stated(log)) == []


@pytest.mark.parametrize("seed", range(4))
def test_positions_of_five_decimals_of_a_degree_are_not_interpolated(seed):
    log = measured(seed=42 + seed, minutes=10)
    grain = 1e-5 * 111195.0
    log |= {
        "north": grain * np.round(log["north"] / grain),
        "east": 0.5 * grain * np.round(2.0 * log["east"] / grain),
    }
    assert examine(stated(log)) == []


def test_steps_of_coarse_positions_in_quick_rows_are_no_leaps_of_the_ship():
    """Ten rows a second, a grain of 1.1 m and fixes that jitter across it: seed of the bench on which they were."""
    assert examine(stated(boat(202))) == []


def test_three_samples_on_both_sides_of_north_are_no_heading_wrap():
    """A craft that swings by more than 45 deg to either side, seen by three rows on her way."""
    log = measured(seed=46, minutes=10)
    log["heading"] = np.mod(smooth(log["time"], 47, 20.0, (20.0, 31.0, 47.0)), 360.0)
    fine = np.unwrap(np.radians(log["heading"]))
    log["yaw_rate"] = np.degrees(np.gradient(fine))
    few = {role: log[role] for role in ("time", "heading", "yaw_rate")}
    few["heading"][200:206] = [310.0, 318.0, 330.0, 30.0, 42.0, 50.0]
    few["yaw_rate"] = np.degrees(np.gradient(np.unwrap(np.radians(few["heading"]))))
    assert not [f for f in examine(stated(few)) if f.cause == "heading_wrap"]


def test_velocities_that_are_zero_throughout_are_said():
    log = measured(seed=48)
    found = examine(stated(log | {role: np.zeros(len(log["time"])) for role in ("surge", "sway")}))
    assert ("gap", ("surge", "sway")) in {(f.cause, f.channels) for f in found}
    assert not [f for f in found if f.cause != "gap"]


def test_time_in_milliseconds_is_named_at_once():
    log = measured(seed=49)
    start = clock.process_time()
    (finding,) = examine(stated(log | {"time": 1000.0 * log["time"]}))
    assert finding.note == "time is in ms, not s"
    assert clock.process_time() - start < 20.0
