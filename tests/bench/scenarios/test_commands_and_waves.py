"""At night: the DP loop suppresses waves of 4 to 12 s."""

import pytest
from scenarios.test_commands_and_waves import suppression


def test_waves_are_suppressed_by_20_dB_in_seas_of_4_to_12_s():
    """On seeds that nothing was tuned on."""
    periods, heights = [4.0, 5.0, 6.0, 8.0, 10.0, 12.0], [0.2, 0.3, 0.4, 0.5, 0.7, 0.8]
    worst = suppression(periods, heights, range(2001, 2007), 1800.0)
    print({period: round(value, 1) for period, value in worst.items()})
    assert max(worst.values()) < -20.0, worst
