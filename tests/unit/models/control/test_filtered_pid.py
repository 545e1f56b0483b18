"""PID behind a low-pass filter: the filter's closed forms, the law at constant errors, the ship's axes."""

from dataclasses import replace
from math import atan, cos, exp, pi, sin

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.control.filtered_pid import FilteredPidParameters, at_rest, errors, step
from shipcosim.models.control.pid import Desired

LAW = parameters(FilteredPidParameters, "osv")
HERE = Desired(*(0.0,) * 9)


def run(state, measured, seconds, desired=HERE, law=LAW):
    """States over a time at 20 Hz, what is measured as a function of time."""
    for k in range(round(20 * seconds)):
        state = step(state, measured(0.05 * k), desired, 0.05, parameters=law)
        yield state


def test_a_step_passes_the_filter_as_two_equal_poles_say():
    *_, last = run(at_rest(0.0, 0.0, 0.0), lambda t: (1.0, 0.0, 0.0), 5.0)
    w = LAW.filter_frequency
    assert last.x == pytest.approx(1.0 - (1.0 + 5.0 * w) * exp(-5.0 * w), rel=1e-9)
    assert last.x_dot == pytest.approx(w * w * 5.0 * exp(-5.0 * w), rel=1e-9)


def test_waves_are_weakened_and_late_as_the_frequency_response_says():
    """To 2 %: the wave is held over each step."""
    wave, ratio = 0.8, 0.8 / LAW.filter_frequency
    found = np.array(
        [s.y for s in run(at_rest(0.0, 0.0, 0.0), lambda t: (0.0, sin(wave * t), 0.0), 200.0)]
    )[2000:]
    times = 0.05 * np.arange(2001, 4001)
    late = 1.0 / (1.0 + ratio**2) * np.sin(wave * times - 2.0 * atan(ratio))
    assert np.abs(found - late).max() < 0.02
    assert found.max() == pytest.approx(1.0 / (1.0 + ratio**2), rel=0.02)


def test_a_constant_error_asks_for_the_gain_times_it_and_its_growing_integral():
    law = replace(LAW, surge_integral_time=100.0)
    *_, last = run(at_rest(-2.0, 0.0, 0.0), lambda t: (-2.0, 0.0, 0.0), 10.0, law=law)
    assert last.tau_X == pytest.approx(law.surge_gain * 2.0 * (1.0 + 10.0 / 100.0))
    assert last.tau_Y == last.tau_N == 0.0


@pytest.mark.parametrize("psi", [0.4, -2.0, 3.1])
def test_errors_turn_with_the_ship(psi):
    north = 3.0 * cos(psi) - 1.0 * sin(psi)
    east = 3.0 * sin(psi) + 1.0 * cos(psi)
    surge, sway, yaw = errors(
        at_rest(0.0, 0.0, psi), HERE._replace(x=north, y=east, psi=psi + 0.1 - 2.0 * pi)
    )
    assert (surge, sway, yaw) == pytest.approx((3.0, 1.0, 0.1))


def test_a_heading_that_passes_south_is_filtered_without_a_jump():
    desired = HERE._replace(psi=pi - 0.02)
    before = at_rest(0.0, 0.0, pi - 0.01)
    *_, last = run(before, lambda t: (0.0, 0.0, -pi + 0.01), 60.0, desired=desired)
    assert last.psi == pytest.approx(pi + 0.01) and errors(last, desired)[2] == pytest.approx(-0.03)
