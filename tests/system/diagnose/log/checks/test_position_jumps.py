"""A position that jumps and stays there is named with its size and moved back; lost rows and turns are no jumps."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.checks.position_jumps import position_jumps
from shipcosim.diagnose.log.repair import repaired

LEAST = 2.5  # m, at 1 Hz with a position noise of 0.2 m
# From her course, deg. Within 26 deg of it a jump looks like rows that were lost.
ASIDE = (40, 95, 150, 205, 260, 320)
VELOCITY = ("surge", "sway", "yaw_rate")


def jumped(log, size, aside, first, last=9999):
    """A log with its position moved by a size [m] so many degrees from her course, from one time [s] to another."""
    here = (log["time"] >= first) & (log["time"] < last)
    before, after = (log["time"].searchsorted(first + off) for off in (-20, 20))
    course = np.arctan2(*(log[role][after] - log[role][before] for role in ("east", "north")))
    north, east = (
        size * np.cos(course + np.radians(aside)),
        size * np.sin(course + np.radians(aside)),
    )
    return log | {"north": log["north"] + north * here, "east": log["east"] + east * here}


@pytest.mark.parametrize("aside", ASIDE)
@pytest.mark.parametrize("size", [LEAST, 12.0, 80.0])
def test_a_jump_is_named_with_its_size_and_moved_back(aside, size):
    right = measured(seed=50 + aside)
    (found,) = examine(table(jumped(right, size, aside, 500)))
    assert (found.cause, found.channels) == ("position_jump", ("north", "east"))
    assert found.segments == ((500.0, 1199.0),)
    jump = found.parameters["jump"]
    assert jump.estimate == pytest.approx(size, abs=5.0 * jump.std)
    clean = repaired(table(jumped(right, size, aside, 500)), [found])
    for role in ("north", "east"):
        assert np.nanmax(np.abs(clean[role].values - right[role])) < 5.0 * jump.std


def test_a_jump_there_and_back_is_one_finding():
    (found,) = examine(table(jumped(measured(seed=61), 12.0, 75, 400, 700)))
    assert (found.cause, found.segments) == ("position_jump", ((400.0, 1199.0),))
    assert "jump 2 times" in found.note


@pytest.mark.parametrize("aside", ASIDE)
@pytest.mark.parametrize("every, left_out", [(1, VELOCITY), (2, VELOCITY), (2, ()), (5, ())])
def test_a_jump_shows_in_slower_rows_and_without_velocities(aside, every, left_out):
    log = jumped(measured(seed=70 + aside), 25.0, aside, 500)
    seen = {role: values[::every] for role, values in log.items() if role not in left_out}
    assert [fault.cause for fault in examine(table(seen))] == ["position_jump"]


@pytest.mark.parametrize("lost", [3, 10, 40])
def test_rows_that_were_lost_are_no_jump_of_the_position(lost):
    log = {
        role: np.delete(values, slice(500, 500 + lost))
        for role, values in measured(seed=80).items()
    }
    assert not position_jumps(log | {"time": np.arange(len(log["time"]), dtype=float)})


@pytest.mark.parametrize("seed", range(90, 100))
def test_a_right_log_has_no_jump(seed):
    log = measured(seed=seed)
    assert not position_jumps(log)
    assert not position_jumps(
        {role: values for role, values in log.items() if role not in VELOCITY}
    )
