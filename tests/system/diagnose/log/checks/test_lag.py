"""A channel that comes late is named with its lag, in all of a log or in a part, and brought back to its time."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.checks.lag import late_channels
from shipcosim.diagnose.log.repair import repaired

PAIRS = [("heading",), ("yaw_rate",), ("north", "east"), ("surge", "sway")]
PARTS = [(0, 9999), (600, 9999), (300, 800)]  # s


def with_lag(log, channels, lag, part):
    """A log in a part of which some channels come so many rows late."""
    here = (log["time"] >= part[0]) & (log["time"] <= part[1])
    late = {role: np.r_[[log[role][0]] * lag, log[role][:-lag]] for role in channels}
    return log | {role: np.where(here, values, log[role]) for role, values in late.items()}


@pytest.mark.parametrize("lag, part", [(2, PARTS[1]), (4, PARTS[0]), (9, PARTS[2])])
@pytest.mark.parametrize("channels", PAIRS)
def test_a_channel_that_comes_late_is_named_with_its_lag_and_moved_back(channels, lag, part):
    right = measured(seed=40 + lag)
    late = with_lag(right, channels, lag, part)
    (found,) = examine(table(late))
    assert (found.cause, found.channels) == ("channel_lag", channels)
    assert found.parameters["lag"].estimate == pytest.approx(lag, abs=0.3)
    first, last = found.segments[0] if found.segments else (0.0, 1199.0)
    assert first == pytest.approx(part[0], abs=45.0)
    assert last == pytest.approx(min(part[1], 1199.0), abs=45.0)
    # Moved back, a channel is off by its noise between rows and no more; late it was off by its motion.
    clean = repaired(table(late), [found])
    inner = slice(int(first) + 60, int(last) - 60)
    for role in channels:
        off = np.abs(wrapped(late[role] - right[role], role))[inner]
        still = np.abs(wrapped(clean[role].values - right[role], role))[inner]
        assert np.nanmedian(still) < 0.6 * np.median(off)


def wrapped(change, role):
    """Differences of a channel, of angles the short way round."""
    return np.mod(change + 180.0, 360.0) - 180.0 if role == "heading" else change


@pytest.mark.parametrize("every", [2, 4])
def test_a_lag_shows_in_slower_rows_too(every):
    late = with_lag(measured(seed=44), ("yaw_rate",), 10, PARTS[0])
    (found,) = examine(table({role: values[::every] for role, values in late.items()}))
    assert found.cause == "channel_lag"
    assert found.parameters["lag"].estimate == pytest.approx(10.0, abs=0.5)


@pytest.mark.parametrize("lag", [3, 8])
def test_navigation_that_is_late_as_a_whole_shows_no_lag_between_its_channels(lag):
    channels = ("north", "east", "heading", "surge", "sway", "yaw_rate")
    late = with_lag(measured(seed=45), channels, lag, PARTS[0])
    assert "channel_lag" not in {found.cause for found in examine(table(late))}


@pytest.mark.parametrize("noise", [1.0, 10.0])
@pytest.mark.parametrize("speed, ahead", [(1.0, -8.0), (2.0, -8.0), (2.0, 8.0), (4.0, -20.0)])
def test_an_antenna_beside_a_velocity_of_the_ship_is_no_lag(speed, ahead, noise):
    """At a steady speed an antenna that is ahead or aft looks like a velocity or a position that comes late."""
    log = measured(seed=46, noise=noise)
    course = np.exp(1j * np.radians(log["heading"]))
    way = np.cumsum(speed * course) + ahead * course
    log |= {"north": log["north"] + way.real, "east": log["east"] + way.imag}
    assert late_channels(log | {"surge": log["surge"] + speed}) == []
