"""What the DP loop must hold beside her place: quiet commands, a steady heading in spite of delay, suppressed waves."""

import math

import numpy as np
import pytest
from dp_runs import MODERATE, SEA, WIND_8, simulate
from ships import parameters
from wave_suppression import wave_suppression

from shipcosim.models.control.margins import Delays, linear_loop
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.ship.sensors import SensorParameters

UNITS = ("port", "starboard", "tunnel")
SETTLED = 120.0  # s


@pytest.fixture(scope="module")
def moderate():
    """Three seeds in 8 m/s, at the samples of the controller."""
    return simulate([1, 2, 3], MODERATE, stop_time=360.0, every=2)


@pytest.mark.parametrize("unit", UNITS)
def test_commands_lie_on_their_rate_limit_in_less_than_3_percent_of_the_controllers_samples(
    moderate, unit
):
    commands = moderate[f"allocator.{unit}_thrust_cmd"][moderate["time"] > SETTLED]
    assert np.mean(np.abs(np.diff(commands, axis=0)) > 0.999 * 1000.0 * 0.1) < 0.03


def test_heading_stays_within_a_quarter_of_a_degree_with_2_s_more_of_delay():
    known = parameters(SensorParameters)
    late = {
        f"sensors.{name}": getattr(known, name) + 2.0
        for name in ("position_latency", "heading_latency")
    }
    run = simulate(range(1, 9), MODERATE | late, stop_time=420.0, every=2, record="vessel.psi")
    assert np.std(run["vessel.psi"][run["time"] > SETTLED]) < math.radians(0.25)


def suppression(periods, heights, seeds, stop_time, start=1.1):
    """Largest request for waves at the peak over that without observer and filters, by period, time and axis. [dB]

    The frequency of the filter is the one that it has adapted to in the last 300 s, from `start`.
    """
    period, height = np.repeat(periods, len(seeds)), np.repeat(heights, len(seeds))
    sea = {"environment.significant_wave_height": height, "environment.peak_period": period}
    values = WIND_8 | SEA | sea | {"controller.wave_frequency": start}
    ship, noise, law = (
        parameters(kind) for kind in (DpShip, ObserverParameters, ControlParameters)
    )
    run = simulate(
        np.tile(seeds, len(periods)), values, stop_time=stop_time, every=200, record="controller"
    )
    found = run["controller.wave_frequency_hat"][run["time"] > stop_time - 300.0]
    worst = {}
    for one, least, largest in zip(period, found.min(axis=0), found.max(axis=0), strict=True):
        for frequency in (least, largest):
            loop = linear_loop(ship, noise, law, Delays(), frequency)
            sizes = [
                wave_suppression(loop, axis, np.array([2.0 * math.pi / one]), law)
                for axis in (1, 2)
            ]
            worst[one] = max(worst.get(one, -99.0), 20.0 * math.log10(np.max(sizes)))
    return worst


@pytest.mark.parametrize(("period", "height", "start"), [(6.0, 0.4, 1.1), (12.0, 0.8, 0.62)])
def test_waves_are_suppressed_by_20_dB_at_the_frequency_that_the_filter_keeps(
    period, height, start
):
    assert suppression([period], [height], [7], 500.0, start)[period] < -20.0
