"""A single channel that is stuck in a part of a log is a gap of this channel, and of no other."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine

CHANNELS = "north east heading surge sway yaw_rate wind_speed wind_from".split()


@pytest.mark.parametrize("part", [(400, 460), (600, 1100)])
@pytest.mark.parametrize("channel", CHANNELS)
def test_a_stuck_channel_is_a_gap_of_its_own(channel, part):
    log = measured(seed=50, noise=3.0)
    # Instruments give the wind in whole degrees and tenths of m/s.
    log |= {"wind_from": np.round(log["wind_from"]), "wind_speed": np.round(log["wind_speed"], 1)}
    here = (log["time"] >= part[0]) & (log["time"] <= part[1])
    stuck = log | {channel: np.where(here, log[channel][here][0], log[channel])}
    gaps = [found for found in examine(table(stuck)) if found.cause == "gap"]
    assert [found.channels for found in gaps] == [(channel,)]
    assert gaps[0].segments[0] == pytest.approx(part, abs=3.0)


def test_channels_that_are_not_stuck_are_no_gap():
    log = measured(seed=50, noise=3.0)
    log |= {"wind_from": np.round(log["wind_from"]), "wind_speed": np.round(log["wind_speed"], 1)}
    assert examine(table(log)) == []
