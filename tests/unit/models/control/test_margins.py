"""Margins of the DP loop: what they must be, and whether they are true."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters
from wave_suppression import wave_suppression

from shipcosim.models.control.margins import (
    AXES,
    Delays,
    is_stable,
    linear_loop,
    margins,
)
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters

SHIP, OBSERVER, LAW = (
    parameters(DpShip),
    parameters(ObserverParameters),
    parameters(ControlParameters),
)
PERIODS = (4.0, 5.0, 6.0, 8.0, 10.0, 12.0)


def loop_at(period, **delays):
    return linear_loop(SHIP, OBSERVER, LAW, Delays(**delays), 2.0 * math.pi / period)


@pytest.mark.parametrize("period", PERIODS)
def test_margins_are_those_that_must_hold(period):
    loop = loop_at(period)
    assert is_stable(loop)
    for axis in range(len(AXES)):
        found = margins(loop, axis)
        assert found.phase > math.radians(40.0) and found.sensitivity < 2.0 and found.delay > 3.0, (
            AXES[axis],
            found,
        )


@pytest.mark.parametrize("period", PERIODS)
def test_waves_at_the_peak_are_suppressed_by_20_dB(period):
    loop, w = loop_at(period), 2.0 * math.pi / period
    for axis in (1, 2):
        assert wave_suppression(loop, axis, np.array([w]), LAW).max() < 0.1


@pytest.mark.parametrize("axis", range(3))
def test_further_delay_beyond_the_margin_makes_the_loop_unstable(axis):
    """Only one axis is delayed, so the least margin of all axes is taken, and all are delayed alike."""
    least = min(margins(loop_at(6.0), one).delay for one in range(3))
    assert is_stable(loop_at(6.0, command=0.2 + 0.1 * math.floor(10.0 * least - 3.0)))
    assert not is_stable(loop_at(6.0, command=0.2 + 0.1 * math.ceil(10.0 * least + 3.0)))
    assert margins(loop_at(6.0), axis).delay >= least


@pytest.mark.parametrize("axis", range(3))
def test_gain_beyond_the_margin_makes_the_loop_unstable(axis):
    loop = loop_at(6.0)
    limit = margins(loop, axis).gain
    for factor, holds in ((0.95 * limit, True), (1.05 * limit, False)):
        stronger = loop.push.copy()
        stronger[:, axis] *= factor
        assert is_stable(loop._replace(push=stronger)) == holds


def test_quicker_law_has_less_phase():
    quick = replace(LAW, sway_frequency=1.3 * LAW.sway_frequency)
    found = margins(linear_loop(SHIP, OBSERVER, quick, Delays(), 1.0), 1)
    assert found.phase < margins(linear_loop(SHIP, OBSERVER, LAW, Delays(), 1.0), 1).phase
