"""At night: mistakes throughout a log show on a ship that keeps her station too; and further mistakes and seeds."""

import numpy as np
import pytest
from diagnose.log.test_readings import (
    CHANGES,
    check_left_open,
    check_mistake,
    check_rows_far_apart,
    check_signs_that_agree,
    check_turned_axes,
    check_turned_grid,
)
from diagnose.logs import smooth, table

from shipcosim.diagnose.log.checks.examine import examine


def on_station(seed):
    """A ship that hardly moves: at 1 cm/s, seen by 0.2 m, and by a third of a degree."""
    random, time = np.random.default_rng(seed), np.arange(1200.0)
    heading, velocity = (
        30.0 + smooth(time, seed, 0.2),
        smooth(time, seed + 1, 0.006) + 1j * smooth(time, seed + 2, 0.006),
    )
    noise = random.normal(size=(6, len(time)))
    position = np.cumsum(velocity * np.exp(1j * np.radians(heading))) + 0.2 * (
        noise[0] + 1j * noise[1]
    )
    return {
        "time": time,
        "north": position.real,
        "east": position.imag,
        "heading": heading + 0.1 * noise[2],
        "surge": velocity.real + 0.01 * noise[3],
        "sway": velocity.imag + 0.01 * noise[4],
        "yaw_rate": np.gradient(heading) + 0.02 * noise[5],
    }


@pytest.mark.parametrize(
    ("said", "change"),
    {
        "sway has the other sign": lambda log: {"sway": -log["sway"]},
        "yaw_rate has the other sign": lambda log: {"yaw_rate": -log["yaw_rate"]},
        "time is in ms, not s": lambda log: {"time": 1000.0 * log["time"]},
        "2 s pass in each logged second": lambda log: {"time": 0.5 * log["time"]},
    }.items(),
)
def test_what_is_wrong_shows_on_a_ship_that_keeps_her_station_too(said, change):
    """Motion that is less than the noise of a fix says it over twenty minutes."""
    log = on_station(31)
    assert examine(table(log)) == []
    (finding,) = examine(table(log | change(log)))
    assert said in (finding.note, *finding.alternatives) and not finding.segments
    assert finding.alternatives or finding.probability > 0.95


OTHERS = {
    "heading has the other sign": CHANGES["heading has the other sign"],
    "time is in tenths of a second, not s": lambda log: {"time": 10.0 * log["time"]},
    "time is in min, not s": lambda log: {"time": log["time"] / 60.0},
    "2 s pass in each logged second": lambda log: {"time": 0.5 * log["time"]},
    "surge and sway are in ft/s, not m/s": lambda log: {
        role: log[role] / 0.3048 for role in ("surge", "sway")
    },
    "north and east are in ft, not m": lambda log: {
        role: log[role] / 0.3048 for role in ("north", "east")
    },
}


@pytest.mark.parametrize("said", OTHERS)
def test_other_mistakes_throughout_are_named_alone_and_put_right(said):
    check_mistake(said, OTHERS[said])


def test_another_grid_that_is_turned_is_named_with_its_angle():
    check_turned_grid(35.0)


@pytest.mark.parametrize(("degrees", "seed"), [(90.0, 26), (-135.0, 1005)])
def test_other_axes_of_the_velocity_are_named_with_their_angle(degrees, seed):
    check_turned_axes(degrees, seed)


def test_signs_of_heading_and_yaw_rate_that_agree_are_named_in_another_log():
    check_signs_that_agree(1005)


def test_a_mistake_that_too_little_motion_shows_is_left_open_in_another_channel():
    check_left_open(201, "north", "north has the other sign")


@pytest.mark.parametrize("every", [5, 10])
def test_a_right_log_with_rows_less_far_apart_is_right(every):
    check_rows_far_apart(every)
